"""The table of free paths: how many best paths are free, how many are after final repair, how long."""

from functools import cache
from typing import NamedTuple

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.run import Floats, Run
from experiments.runs.suite import Suite
from experiments.statistics import draw, interval, mean_of_present, means
from experiments.tables.cell import MISSING, Entry, number, share, share_in
from experiments.tables.table import Row, Table
from swarm_gym.final_repair import final_repair
from swarm_gym.problem import MapProblem
from swarm_gym.problem.geometry.clearance import clearance_of
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import shortest_path
from swarm_gym.worlds import make_problem

SEEDS = 50  # of each controller and scenario, at most
CAPTION = (
    f"Best paths of the first {SEEDS} seeds of each scenario: share that is free of any collision, checked "
    "exactly; share that is after final repair; length after it against the best path's length, and above "
    "the exact shortest path of the map, which need not go through waypoints; its least distance from any "
    "obstacle, mean, in map units; share of the repaired paths of which a planner had to find a piece. "
    "[95 % interval over training seeds, scenarios of a set and seeds]"
)


class _FinalRepairs(NamedTuple):
    """Final repairs of some runs, (runs,) each; NaN where a path was not repaired."""

    free: Floats
    repaired: Floats
    change: Floats
    excess: Floats
    clearance: Floats
    planned: Floats


def free_path_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a row for each set of scenarios and group, fewest free paths last."""
    # Every scenario is in a set of its own, and in the union of all sets.
    freed_of = {
        (controller, name): _freed(outcomes.runs(controller, name)[:SEEDS], suite, name)
        for controller in outcomes.controllers
        for name in outcomes.scenarios
    }
    rows: list[Row] = []
    for scenario_set, strata in outcomes.sets.items():
        names = [scenario for stratum in strata for scenario in stratum]
        found = {}
        for group, controllers in outcomes.groups.items():
            each = [[freed_of[controller, name] for name in names] for controller in controllers]
            found[group] = _FinalRepairs(
                *(
                    np.array([[getattr(one, part) for one in row] for row in each])
                    for part in _FinalRepairs._fields
                )
            )
        sizes = tuple(map(len, strata))
        rows += [
            {"scenarios": scenario_set, "controller": label(group), **_cells(found[group], sizes)}
            for group in sorted(found, key=lambda name: -found[name].free.mean())
        ]
    return [Table.of("free-paths", CAPTION, rows)]


def _cells(freed: _FinalRepairs, set_sizes: tuple[int, ...]) -> Row:
    """Return the entries of a group, from arrays (training seeds, scenarios, seeds)."""
    draws = draw(freed.free.shape[0], set_sizes, freed.free.shape[2])

    def mean(values: Floats, form: str = ".1f") -> Entry:
        if not np.isfinite(values).any():
            return MISSING
        return share_in(mean_of_present(values), interval(means(values, draws)), form)

    return {
        "strictly free": mean(freed.free),
        "free after repair": mean(freed.repaired),
        "change of length": mean(freed.change, "+.2f"),
        "above the shortest": mean(freed.excess, "+.2f"),
        "clearance": number(mean_of_present(freed.clearance), ".2g"),
        "planned anew": share(mean_of_present(freed.planned)),
    }


def _freed(runs: list[Run], suite: Suite, scenario: str) -> _FinalRepairs:
    problem, shortest = _problem(scenario, tuple(suite.options.items()))
    freed = _FinalRepairs(np.zeros(len(runs)), np.zeros(len(runs)), *np.full((4, len(runs)), np.nan))
    for k, run in enumerate(runs):
        freed.free[k] = problem.is_clear(run.best_path)
        found = final_repair(problem, run.best_path)
        if found is not None:
            freed.repaired[k] = 1.0
            freed.change[k] = found.length / length_of(run.best_path) - 1.0
            freed.excess[k] = found.length / shortest - 1.0
            freed.clearance[k] = clearance_of(problem.scenario, found.path)
            freed.planned[k] = found.planned > 0
    return freed


@cache
def _problem(scenario: str, options: tuple) -> tuple[MapProblem, float]:
    """Return the problem of a scenario, and the length of the shortest path on its map."""
    problem = make_problem(scenario, **dict(options))
    assert isinstance(problem, MapProblem)
    return problem, shortest_path(problem.scenario)[0]
