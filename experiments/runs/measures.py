"""Measures of runs that sentences compare: smaller is better."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from experiments.runs.outcomes import Sample
from experiments.runs.run import Floats

NEAR = 0.01  # gap up to which a run counts as close to the optimum


class Measure(NamedTuple):
    """A measure of runs.

    Attributes:
        of: returns the measure of every run of a sample, (training seeds, scenarios, seeds), nan for runs
            that do not count; takes the price of 100,000 evaluations besides.
        said: words about the measure for captions.
    """

    of: Callable[[Sample, float], Floats]
    said: str


def _gap(sample: Sample, price: float) -> Floats:  # noqa: ARG001
    return 100.0 * sample.gap


def _evaluations(sample: Sample, price: float) -> Floats:  # noqa: ARG001
    return sample.evaluations / 1000.0


def _far(sample: Sample, price: float) -> Floats:  # noqa: ARG001
    return np.where(sample.gap <= NEAR, 0.0, 100.0)


def _spread(sample: Sample, price: float) -> Floats:  # noqa: ARG001
    gap = 100.0 * sample.gap
    return abs(gap - np.median(gap, axis=(0, 2), keepdims=True))


def _fitness(sample: Sample, price: float) -> Floats:  # noqa: ARG001
    return sample.fitness


def _length(sample: Sample, price: float) -> Floats:  # noqa: ARG001
    # The fitness of a feasible path is its length.
    return np.where(sample.feasible, sample.fitness, np.nan)


def _infeasible(sample: Sample, price: float) -> Floats:  # noqa: ARG001
    return 100.0 * (1.0 - sample.feasible)


def _offline(sample: Sample, price: float) -> Floats:  # noqa: ARG001
    return 100.0 * sample.find_offline_error()


def _offline_objective(sample: Sample, price: float) -> Floats:
    return _offline(sample, price) + price * sample.evaluations / 100_000.0


MEASURES: dict[str, Measure] = {
    "gap": Measure(_gap, "gaps are in per cent of the optimum"),
    "evaluations": Measure(_evaluations, "evaluations are in thousands"),
    "objective": Measure(
        Sample.objective, "the objective is the gap in per cent plus the price times evaluations / 100,000"
    ),
    "far": Measure(
        _far, f"far is the per cent of the runs that are not within {100 * NEAR:.0f} % of the optimum"
    ),
    "spread": Measure(
        _spread, "spread is the mean distance of a gap from the median of its scenario, in per cent"
    ),
    "fitness": Measure(_fitness, "fitness is the best of the run"),
    "length": Measure(_length, "length is that of the best paths that are feasible, in map units"),
    "offline error": Measure(
        _offline, "the offline error is the mean gap since the first event on the map, in per cent"
    ),
    "offline objective": Measure(
        _offline_objective,
        "the offline objective is the mean gap since the first event on the map in per cent plus the price "
        "times evaluations / 100,000",
    ),
    "infeasible": Measure(_infeasible, "infeasible is the per cent of the best paths that are not feasible"),
}
