"""Optima that environments compute without being asked to, since that takes less than about a second."""

import math
from collections.abc import Sequence

from swarm_gym.problem import AnalyticProblem, GridProblem, Problem
from swarm_gym.scenarios import GridScenario

# What takes about a second: so many cells of grid maps, and so many pairs of candidates of waypoints.
CELLS, PAIRS = 2.0**20, 4.5e7


def quick_optima(problems: Sequence[Problem]) -> list[float]:
    """Return the least fitness of each problem, computed; NaN for all if that is not quick for all together.

    On a grid map that is the length of the shortest path at any angle, which a curve may not reach. Whether
    it is quick depends on sizes of maps alone, so that it is the same on every machine.
    """
    if sum(map(_work, problems)) > 1.0:
        return [math.nan] * len(problems)
    from swarm_gym.reference.waypoint_optimum import compute_optimum

    return [compute_optimum(problem) for problem in problems]


def _work(problem: Problem) -> float:
    """Return the work of computing an optimum, as a share of what is quick."""
    if isinstance(problem, GridProblem) and problem.wishes:
        return math.inf  # the shortest path is no optimum there
    if isinstance(problem.scenario, GridScenario):
        return problem.scenario.map.blocked.size / CELLS
    if isinstance(problem, AnalyticProblem):
        lower, upper = problem.bounds
        return problem.dimension * float((upper - lower).max()) ** 2 / PAIRS
    return math.inf
