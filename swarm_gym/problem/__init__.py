"""Problems that are optimised: paths on maps, with encoding, fitness, collision and repair; or functions."""

from swarm_gym.problem.analytic.problem import AnalyticProblem
from swarm_gym.problem.bbob.problem import BbobProblem
from swarm_gym.problem.function.problem import FunctionProblem
from swarm_gym.problem.grid.problem import GridProblem
from swarm_gym.problem.map_problem import MapProblem
from swarm_gym.problem.onemax.problem import OneMaxProblem
from swarm_gym.problem.problem import Problem
from swarm_gym.problem.terrain.problem import TerrainProblem
from swarm_gym.problem.walk.problem import WalkProblem
from swarm_gym.scenarios import BbobScenario, FunctionScenario, OneMaxScenario

__all__ = [
    "AnalyticProblem",
    "BbobProblem",
    "FunctionProblem",
    "GridProblem",
    "MapProblem",
    "OneMaxProblem",
    "Problem",
    "TerrainProblem",
    "WalkProblem",
    "problem_of_function",
]


def problem_of_function(scenario: FunctionScenario) -> FunctionProblem:
    """Return the problem of a test function, which may be one of BBOB, or of a bit string."""
    if isinstance(scenario, OneMaxScenario):
        return OneMaxProblem(scenario)
    return BbobProblem(scenario) if isinstance(scenario, BbobScenario) else FunctionProblem(scenario)
