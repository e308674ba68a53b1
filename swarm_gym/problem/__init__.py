"""What is optimised: path encoding, length, degree of collision, fitness, repair."""

from swarm_gym.problem.analytic import AnalyticProblem
from swarm_gym.problem.grid_problem import GridProblem
from swarm_gym.problem.problem import Problem

__all__ = ["AnalyticProblem", "GridProblem", "Problem"]
