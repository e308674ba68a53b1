"""Measures of runs that sentences compare: smaller is better."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from experiments.runs.outcomes import Sample
from experiments.runs.run import (
    STILL_TO_COME,
    Floats,
    Run,
    arrives,
    convergence_iteration,
    trajectory_of,
    turning_of,
)
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.scenarios import FunctionScenario, Point, make_scenario, worlds_of

NEAR = 0.01  # gap up to which a run counts as close to the optimum
LEAST_PRECISION = -8  # decimal logarithm of the least distance to the optimum that is told apart from 0


class Measure(NamedTuple):
    """A measure of runs.

    Attributes:
        of: returns the measure of every run of a sample, (training seeds, scenarios, seeds), nan for runs
            that do not count; takes the price of 100,000 evaluations besides.
        said: words about the measure for captions.
        form: format of its numbers.
    """

    of: Callable[[Sample, float], Floats]
    said: str
    form: str = ".2f"


def log_precision(gaps: Floats) -> Floats:
    """Return the decimal logarithms of distances to an optimum of 0, which are at least `LEAST_PRECISION`."""
    return np.log10(np.maximum(gaps, 10.0**LEAST_PRECISION))


def _spread(sample: Sample) -> Floats:
    gap = 100.0 * sample.gap
    return abs(gap - np.median(gap, axis=(0, 2), keepdims=True))


def _convergence(run: Run) -> int:
    return convergence_iteration(run.course("best_fitness"))


@cache
def _target_of(scenario: str) -> Point:
    """Return the target on the last map of a scenario; maps can be large, so that each is made once."""
    _, last = worlds_of(make_scenario(scenario))[-1]
    assert not isinstance(last, FunctionScenario)
    return last.target


def _if_arrived(measure: Callable[[Floats], float]) -> Callable[[Run], float]:
    """Return a measure of the trajectory of a run, or of its best path; nan if it did not arrive."""

    def of_run(run: Run) -> float:
        return measure(trajectory_of(run)) if arrives(run, _target_of(run.scenario)) else np.nan

    return of_run


MEASURES: dict[str, Measure] = {
    "gap": Measure(lambda sample, _: 100.0 * sample.gap, "gaps are in per cent of the optimum"),
    "evaluations": Measure(lambda sample, _: sample.evaluations / 1000.0, "evaluations are in thousands"),
    "objective": Measure(
        Sample.objective, "the objective is the gap in per cent plus the price times evaluations / 100,000"
    ),
    "far": Measure(
        lambda sample, _: np.where(sample.gap <= NEAR, 0.0, 100.0),
        f"far is the per cent of the runs that are not within {100 * NEAR:.0f} % of the optimum",
    ),
    "spread": Measure(
        lambda sample, _: _spread(sample),
        "spread is the mean distance of a gap from the median of its scenario, in per cent",
    ),
    "fitness": Measure(lambda sample, _: sample.fitness, "fitness is the best of the run", ".3g"),
    "log precision": Measure(
        lambda sample, _: log_precision(sample.gap),
        f"log precision is the decimal logarithm of the distance to the optimum, at least {LEAST_PRECISION}",
    ),
    "length": Measure(
        # The fitness of a feasible path is its length.
        lambda sample, _: np.where(sample.feasible, sample.fitness, np.nan),
        "length is taken over the best paths that are feasible, in map units",
    ),
    "offline error": Measure(
        lambda sample, _: 100.0 * sample.find_offline_error(),
        "the offline error is the mean gap since the first event on the map, in per cent",
    ),
    "offline objective": Measure(
        lambda sample, price: 100.0 * sample.find_offline_error() + sample.cost(price),
        "the offline objective is the mean gap since the first event on the map in per cent plus the price "
        "times evaluations / 100,000",
    ),
    "infeasible": Measure(
        lambda sample, _: 100.0 * (1.0 - sample.feasible),
        "infeasible is the per cent of the best paths that are not feasible",
    ),
    "convergence": Measure(
        lambda sample, _: sample.each(_convergence).astype(np.float64),
        f"convergence is the iteration after which at most {STILL_TO_COME:g} of the run's whole gain is "
        "still to come",
        ".1f",
    ),
    "evaluations to converge": Measure(
        lambda sample, _: sample.each(lambda run: run.course("evaluations")[_convergence(run)]),
        "evaluations to converge are those until then",
        ",.0f",
    ),
    "way": Measure(
        lambda sample, _: sample.each(_if_arrived(length_of)),
        "way is the length that the robot went, or of the best path, in the runs that arrived",
        ".1f",
    ),
    "turning": Measure(
        lambda sample, _: sample.each(_if_arrived(turning_of)),
        "turning is the sum of all turns on the way, in degrees, of the runs that arrived",
        ".0f",
    ),
    "seconds": Measure(lambda sample, _: sample.seconds, "seconds are the processor time of a run", ".3f"),
}
