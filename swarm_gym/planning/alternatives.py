"""Alternatives: good paths of which no two lead through the same corridor."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.corridor_map import CorridorMap
from swarm_gym.planning.curve import Curve

Floats = NDArray[np.float64]

MOST = 100  # alternatives that can be asked for
MORE = 4  # paths that are looked at besides, as the search has a rounded order


@dataclass(frozen=True)
class Alternative:
    """A free path through a corridor of its own.

    Attributes:
        path: (k, 2) points from start to goal, in the coordinates of the map's file.
        length: length of the path, in map units.
        clearance: least distance of the path from an obstacle, in map units; infinite without obstacles.
        costs: length, the integral of each wish and their sum, by name; the length alone without wishes.
        curve: the path as a curve that can be driven; None without a turning radius.
    """

    path: Floats
    length: float
    clearance: float
    costs: dict[str, float]
    curve: Curve | None = None


def through_other_corridors(
    corridors: CorridorMap,
    best: Floats,
    number: int,
    cost_of: Callable[[Floats], float],
    bettered: Callable[[Floats], Floats],
    is_over: Callable[[], bool],
) -> list[Floats]:
    """Return paths with low costs, (k, 2) each, between any two of which and the best one an obstacle lies.

    Args:
        corridors: corridors of the task.
        best: best path, (k, 2).
        number: number of paths, at most.
        cost_of: the length of a path, or its sum of wishes.
        bettered: function that makes the shortest path of a corridor one of low cost.
        is_over: whether time is up.
    """
    found: list[Floats] = []
    for path in corridors.paths(is_over):
        better = bettered(path)
        if all(corridors.differ(better, other) for other in (best, *found)):
            found.append(better)
        if len(found) >= number + MORE:
            break
    return sorted(found, key=cost_of)[:number]
