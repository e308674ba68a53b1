"""One block between start and target on a square grid: the scenarios `block:<side>`.

Source: Brand and Yu, "Autonomous robot path optimization using firefly algorithm", ICMLC 2013. The paper
shows a grid of 500 x 500 cells with one obstacle, and grids of 50 to 2000, as figures without coordinates.
These are ours, chosen so that the shortest path on `block:500`, about 431, is near the paper's lengths. Map
coordinates are cells: x is the column, y the row, which grows downwards.
"""

import re

import numpy as np

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.family import NUMBER, Family
from swarm_gym.scenarios.grid_map import GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario

NAME = "block"
USAGE = f"{NAME}:<side>"
SMALLEST, LARGEST = 20, 4000


def expand(name: str) -> tuple[str, ...]:
    """The name itself; a range would be of maps of different sizes.

    Raises:
        ScenarioError: if it has not the form of these names, or the side is out of range.
    """
    match = re.fullmatch(f"{NAME}:({NUMBER})", name)
    if not match or not SMALLEST <= int(match[1]) <= LARGEST:
        raise ScenarioError(
            f"scenario {name!r}: expected {USAGE}, a number of cells from {SMALLEST} to {LARGEST}"
        )
    return (name,)


def make(name: str) -> GridScenario:
    """The scene of that name."""
    side = int(name.removeprefix(f"{NAME}:"))
    blocked = np.zeros((side, side), np.bool_)
    blocked[side * 44 // 100 : side * 56 // 100, side * 35 // 100 : side * 65 // 100] = True
    column, row = side // 2, side // 10
    return GridScenario(name, GridMap(name, blocked), (column, row), (column, side - row))


FAMILY = Family(USAGE, (f"{NAME}:50", f"{NAME}:500"), expand, make)
