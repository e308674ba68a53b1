"""What is optimised: path encoding, length, degree of collision, fitness, repair; or a function."""

from swarm_gym.problem.analytic.problem import AnalyticProblem
from swarm_gym.problem.function.problem import FunctionProblem
from swarm_gym.problem.grid.problem import GridProblem
from swarm_gym.problem.map_problem import MapProblem
from swarm_gym.problem.problem import Problem
from swarm_gym.problem.walk.problem import WalkProblem

__all__ = ["AnalyticProblem", "FunctionProblem", "GridProblem", "MapProblem", "Problem", "WalkProblem"]
