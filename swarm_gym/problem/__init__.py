"""Problems that are optimised: paths on maps, with encoding, fitness, collision and repair; or functions."""

from swarm_gym.problem.analytic.problem import AnalyticProblem
from swarm_gym.problem.function.problem import FunctionProblem
from swarm_gym.problem.grid.problem import GridProblem
from swarm_gym.problem.map_problem import MapProblem
from swarm_gym.problem.problem import Problem
from swarm_gym.problem.walk.problem import WalkProblem

__all__ = ["AnalyticProblem", "FunctionProblem", "GridProblem", "MapProblem", "Problem", "WalkProblem"]
