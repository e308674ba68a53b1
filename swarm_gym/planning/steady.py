"""Steady replanning: a path stays in the corridor of the one before, unless another is clearly better."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.certificate import is_free
from swarm_gym.planning.corridor_map import CorridorMap

Floats = NDArray[np.float64]

SWITCH_MARGIN = 0.05  # by which another corridor must be better, as a share


def kept_corridor(
    corridors: CorridorMap,
    before: Floats,
    best: Floats,
    cost_of: Callable[[Floats], float],
    switch_margin: float,
    bettered: Callable[[Floats], Floats],
) -> Floats | None:
    """Return the path in the corridor of a previous path to keep instead of the best path; None to take that.

    It is the previous path itself while that is free and good enough, else the shortest one of its corridor.

    Args:
        corridors: corridors of the task.
        before: previous path, (k, 2), which need not be free now.
        best: best path, (k, 2).
        cost_of: cost that is compared: the length, or the sum of wishes.
        switch_margin: share of its cost by which the best path must be better than the corridor's.
        bettered: function that makes the shortest path of a corridor one of low cost.
    """
    if switch_margin == 0.0 or not corridors.differ(before, best):
        return None
    most = cost_of(best) / (1.0 - switch_margin) if switch_margin < 1.0 else math.inf
    if is_free(corridors.task, before) and cost_of(before) <= most:
        return before
    along = corridors.shortest_along(before, best)
    if along is None:
        return None
    along = bettered(along)
    return along if cost_of(along) <= most else None
