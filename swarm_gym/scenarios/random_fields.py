"""Random fields of obstacles, in any number: the scenarios `random-fields:<split>:<number>`.

The splits `train`, `validation` and `test` are drawn from one distribution. Their fields are about as hard as
the cases of the SPSFA paper: obstacles of similar sizes are scattered around the line from (20, 300) to (980,
300) in a workspace of 1000 x 600. The other splits test how controllers generalise; each differs from the
first three in one respect.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from swarm_gym.scenarios.family import Family, expand_split
from swarm_gym.scenarios.field_generators import Scatter, Walls
from swarm_gym.scenarios.scenario import Scenario

NAME = "random-fields"
USAGE = f"{NAME}:<split>:<number>"


class FieldSplit(NamedTuple):
    """A split of the random fields.

    Attributes:
        first_seed: seed of field 0; field k is drawn by the generator of seed `first_seed` + k.
        size: number of fields.
        draw: function that draws a field, given its name and the generator.
    """

    first_seed: int
    size: int
    draw: Callable[[str, np.random.Generator], Scenario]


# The ranges of seeds are disjoint. Never change the seeds or the generator of a split: results refer to them.
SPLITS = {
    "train": FieldSplit(0, 1_000_000, Scatter().draw),
    "validation": FieldSplit(1_000_000, 100_000, Scatter().draw),
    "test": FieldSplit(1_100_000, 100_000, Scatter().draw),
    "denser": FieldSplit(1_200_000, 100_000, Scatter(count=(22, 30), size=(30, 44), clearance=10).draw),
    "larger": FieldSplit(
        1_300_000,
        100_000,
        Scatter(count=(20, 35), workspace=(1500, 900), reach=330, initial_reach=270, blocking=4).draw,
    ),
    "narrow": FieldSplit(1_400_000, 100_000, Walls().draw),
    "large-obstacles": FieldSplit(
        1_500_000, 100_000, Scatter(count=(4, 7), size=(80, 110), reach=250, blocking=2).draw
    ),
    "rotated": FieldSplit(1_600_000, 100_000, Scatter(workspace=(1200, 1200), turned=True).draw),
}


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single fields that a name stands for; `...:0-511` stands for 512 of them.

    Raises:
        UnknownNameError: if there is no such split.
        ScenarioError: if the name has another form, or a number is not in its split.
    """
    return expand_split(name, NAME, SPLITS, "0-511")


def make(name: str) -> Scenario:
    """Return the single field of that name."""
    _, split, number = name.split(":")
    first_seed, _, draw = SPLITS[split]
    return draw(name, np.random.Generator(np.random.PCG64(first_seed + int(number))))


FAMILY = Family(USAGE, tuple(f"{NAME}:{split}:0" for split in SPLITS), expand, make)
