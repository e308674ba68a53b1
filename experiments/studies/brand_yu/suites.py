"""The suites of the paper of Brand and Yu: table 1, an obstacle that appears, and grids of growing size.

Source: Brand and Yu, "Autonomous robot path optimization using firefly algorithm", ICMLC 2013, table 1: a
grid of 500 x 500 with one obstacle. Where start, goal and obstacle are is in figures only; how many runs is
not stated. Figures 8 and 9, length and time against the size of the grid, have no numbers in the text.
"""

from functools import partial
from typing import NamedTuple

from experiments.runs.experiment import FRESH_SEEDS
from experiments.runs.suite import Suite


class PublishedLength(NamedTuple):
    """A row of table 1 of Brand and Yu: length of the path in cells, and running time in seconds."""

    length: float
    seconds: float


# Table 1 by number of fireflies, of which one begins at the start and the others in a square.
TABLE_1 = {
    10: PublishedLength(449.0, 14.2),
    26: PublishedLength(430.0, 14.3),
    65: PublishedLength(435.0, 18.0),
    122: PublishedLength(447.0, 49.8),
    626: PublishedLength(443.0, 1088.3),
}
# The obstacle of the dynamic example appears after this iteration.
APPEARS = 70


GLOWWORMS = tuple(f"glowworm+fixed:{count}" for count in TABLE_1)
FEW, ANTS = "glowworm+fixed:26", "ant-colony(100)+fixed:50"
SIDES = (50, 100, 200, 500, 1000, 2000)

_suite = partial(Suite, optimizer="glowworm", first_seed=FRESH_SEEDS)
_of_counts = partial(
    _suite,
    controllers=GLOWWORMS,
    num_seeds=20,
    baseline=GLOWWORMS[0],
    tables=("brand-yu-counts", "claims"),
    figures=("brand-yu-ways",),
)
STATIC = _of_counts(
    name="brand-yu-static",
    scenarios=("block:500",),
    options={"encoding": "walk", "iterations": 600},
    snapshots=tuple((controller, "block:500", FRESH_SEEDS, (0, 90)) for controller in GLOWWORMS),
)
DYNAMIC = _of_counts(
    name="brand-yu-dynamic",
    scenarios=(f"dynamic:open:500-block@{APPEARS}",),
    options={"encoding": "walk", "iterations": 1500},
)
GRIDS = _suite(
    name="brand-yu-grids",
    controllers=(FEW, ANTS),
    scenarios=tuple(f"block:{side}" for side in SIDES),
    num_seeds=10,
    baseline=FEW,
    options={"encoding": "walk", "iterations": 600},
    tables=("brand-yu-grids", "claims"),
    figures=("brand-yu-grids",),
)

SUITES = (STATIC, DYNAMIC, GRIDS)
COLLECTIONS = {"brand-yu": tuple(suite.name for suite in SUITES)}
