"""What is optimised: path encoding, length, degree of collision, fitness, repair; or a function."""

from swarm_gym.problem.analytic import AnalyticProblem
from swarm_gym.problem.function_problem import FunctionProblem
from swarm_gym.problem.grid_problem import GridProblem
from swarm_gym.problem.map_problem import MapProblem
from swarm_gym.problem.problem import Problem
from swarm_gym.problem.walk_problem import WalkProblem

__all__ = ["AnalyticProblem", "FunctionProblem", "GridProblem", "MapProblem", "Problem", "WalkProblem"]
