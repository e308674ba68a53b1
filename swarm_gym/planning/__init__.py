"""Plan a path that a robot can drive: a map, a start and a goal in, a free path out."""

from swarm_gym.planning.planner import plan
from swarm_gym.planning.result import Plan

__all__ = ["Plan", "plan"]
