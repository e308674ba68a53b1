"""Readings of the one-fifth rule: how a real lambda becomes whole numbers, and what it is worth exactly.

The runs of the rule are published (`published.ONE_FIFTH`), but not the code that made them. Other code of the
same authors rounds in several ways; each is one reading here. Sources: github.com/ndangtt/1LLGA, which goes
with N. Dang, C. Doerr, "Hyper-parameter tuning for the (1+(lambda,lambda)) GA", GECCO 2019;
github.com/ndangtt/DACBench, `bestknown_onell.py` and `test_onell.py`; github.com/taindp98/OneMax-MPDAC.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from experiments.studies.onemax import published
from experiments.studies.onemax.runtimes import Floats
from experiments.tables import Table
from experiments.tables.cell import Cell, Entry
from swarm_gym.controllers.onemax_rules import OneFifth
from swarm_gym.reference.onemax.adaptive import ladder_runtimes
from swarm_gym.reference.onemax.runtimes import LambdaDecisions

SIZES = (100, 200, 500, 1000)


class Reading(NamedTuple):
    """A way to use a real lambda.

    Attributes:
        mutants: function of lambda that returns the number of mutants.
        children: function of lambda that returns the number of children.
        strength: function of lambda that returns the expected number of bits that a mutant flips.
        inverse: function of lambda that returns 1 over the probability that a child takes a bit.
    """

    mutants: Callable[[Floats], Floats]
    children: Callable[[Floats], Floats]
    strength: Callable[[Floats], Floats]
    inverse: Callable[[Floats], Floats]


def _real(sizes: Floats) -> Floats:
    return sizes


READINGS = {
    "whole part; flips of the real lambda (here)": Reading(np.floor, np.floor, _real, np.floor),
    "whole part; rates of the real lambda (DACBench of the authors)": Reading(
        np.floor, np.floor, _real, _real
    ),
    "whole part, children to nearest; rates of the real lambda (its test)": Reading(
        np.floor, np.rint, _real, _real
    ),
    "whole part everywhere (OneMax-MPDAC)": Reading(np.floor, np.floor, np.floor, np.floor),
    "to nearest; rates of the real lambda (1LLGA)": Reading(np.rint, np.rint, _real, _real),
    "to nearest everywhere": Reading(np.rint, np.rint, np.rint, np.rint),
}


def expected_of_reading(reading: Reading, size: int) -> float:
    """Return the expected evaluations of the one-fifth rule in a reading, the first string included."""
    ladder = OneFifth().ladder(size)
    sizes = ladder.rungs.mutants * ladder.rungs.strength
    mutants, children = reading.mutants(sizes), reading.children(sizes)
    rungs = LambdaDecisions(
        mutants.astype(np.int64),
        children.astype(np.int64),
        reading.strength(sizes) / mutants,
        children / reading.inverse(sizes),
    )
    return float(ladder_runtimes(replace(ladder, rungs=rungs), size // 2)[0, size // 2]) + 1.0


def readings() -> Table:
    """Return the table of how far the published means are from each reading, in their standard errors."""
    rows: list[tuple[Entry, ...]] = []
    for label, reading in READINGS.items():
        cells = []
        for size in SIZES:
            mean, deviation = published.ONE_FIFTH[size]
            exact = expected_of_reading(reading, size)
            errors = (mean - exact) / (deviation / np.sqrt(published.NUM_RUNS))
            cells.append(Cell.of("{value:,.1f} ({errors:+.1f})", value=exact, errors=errors))
        rows.append((label, *cells))
    caption = (
        "The one-fifth rule in several readings: exact expected evaluations, and in brackets how many of its "
        "standard errors the published mean lies above"
    )
    return Table("readings", caption, ("mutants and children", *(f"n = {size:,}" for size in SIZES)), rows)
