"""Treatment of infeasible paths: colliding segments are pushed out of obstacles, by a degree phi.

Source: SPSFA paper, section III, "treatment for infeasible path": a parallel movement of the segment by
phi times its degree of collision. The order (segments from the start, obstacles as listed, each seeing what
the ones before did) and what happens to shared waypoints are readings, see docs/readings.md.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import inlined_kernel
from swarm_gym.problem.collision import clearing_shifts
from swarm_gym.problem.waypoints import WaypointTable


@inlined_kernel
def repair(table: WaypointTable, path: NDArray[np.float64], repair_degree: float) -> None:
    """One pass over all segments; changes `path`, shape (n + 2,), in place, but not its ends.

    A segment in contact moves along y' by `repair_degree` (phi in [0, 1]) times the smaller of its two
    clearing shifts, to that side, and not out of the workspace.
    """
    spacing = table.spacing
    last = path.shape[0] - 1
    for j in range(last):
        for pair in range(table.first_pair[j], table.first_pair[j + 1]):
            left, right = path[j], path[j + 1]
            if not (min(left, right) < table.pair_top[pair] and max(left, right) > table.pair_bottom[pair]):
                continue
            slope = (right - left) / spacing
            cosine = spacing / math.sqrt(spacing * spacing + (right - left) * (right - left))
            up, down = clearing_shifts(table, pair, left, slope, cosine)
            if up > 0.0 and down > 0.0:
                shift = repair_degree * (up if up <= down else -down)
                if j > 0:
                    path[j] = min(max(left + shift, table.lower[j - 1]), table.upper[j - 1])
                if j + 1 < last:
                    path[j + 1] = min(max(right + shift, table.lower[j]), table.upper[j])
