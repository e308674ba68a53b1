"""Plan a flight over terrain: an elevation model, threats, a start and a goal in, a flight out."""

from swarm_gym.planning.flights.planner import plan_flight
from swarm_gym.planning.flights.result import Flight

__all__ = ["Flight", "plan_flight"]
