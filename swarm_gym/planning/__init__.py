"""Plan a path that a robot can drive: a map, a start and a goal in, a free path out."""

from swarm_gym.planning.alternatives import Alternative
from swarm_gym.planning.curve import Curve
from swarm_gym.planning.planner import plan
from swarm_gym.planning.planner_object import Planner
from swarm_gym.planning.previous import rest_of
from swarm_gym.planning.result import Plan
from swarm_gym.scenarios.graded_map import GradedMap

__all__ = ["Alternative", "Curve", "GradedMap", "Plan", "Planner", "plan", "rest_of"]
