"""Scenes of Brand and Yu: a square grid with one block between start and target, or without any.

The scenarios are `block:<side>` and `open:<side>`, with the number of cells along a side.

Source: Brand and Yu, "Autonomous robot path optimization using firefly algorithm", ICMLC 2013. The paper
shows a grid of 500 x 500 cells with one obstacle, and grids of 50 to 2000 cells a side. Its figures have no
coordinates. The scenes here are chosen so that the shortest path on `block:500`, about 431, is close to the
paper's lengths. On the open grid an obstacle can appear, see `swarm_gym.scenarios.dynamic`.

Map coordinates are cells: x is the column, y is the row, and y grows downwards.
"""

import re

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.family import NUMBER, Family
from swarm_gym.scenarios.grid_map import GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario

BLOCK, OPEN = "block", "open"
SMALLEST, LARGEST = 20, 4000


def _family(kind: str, height: int) -> Family:
    """Return the family of that name, whose block has that height, in percent of the side."""
    usage = f"{kind}:<side>"

    def expand(name: str) -> tuple[str, ...]:
        """Return the name itself; ranges are not allowed, since their maps would differ in size.

        Raises:
            ScenarioError: if the name has another form or the side is out of range.
        """
        match = re.fullmatch(f"{kind}:({NUMBER})", name)
        if not match or not SMALLEST <= int(match[1]) <= LARGEST:
            raise ScenarioError(
                f"scenario {shown(name)}: expected {usage}, a number of cells from {SMALLEST} to {LARGEST}"
            )
        return (name,)

    def make(name: str) -> GridScenario:
        """Return the scene of that name."""
        side = int(name.removeprefix(f"{kind}:"))
        blocked = np.zeros((side, side), np.bool_)
        top, bottom = (side * (100 + sign * height) // 200 for sign in (-1, 1))
        blocked[top:bottom, side * 35 // 100 : side * 65 // 100] = True
        column, row = side // 2, side // 10
        return GridScenario(name, GridMap(name, blocked), (column, row), (column, side - row))

    return Family(usage, (f"{kind}:50",), expand, make)


FAMILIES = {BLOCK: _family(BLOCK, 12), OPEN: _family(OPEN, 0)}
