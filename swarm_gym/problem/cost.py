"""Fitness of a path: its length and its degree of collision, weighted.

Source: SPSFA paper, section II: `f = mu * Length + (1 - mu) * Collis`. The printed mu = 0.1 contradicts the
paper's tables; the default is 0.3, see docs/readings.md.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import inlined_kernel
from swarm_gym.problem.collision import segment_collision
from swarm_gym.problem.waypoints import WaypointTable

# A member whose degree of collision is no larger is feasible (map units).
FEASIBILITY_TOLERANCE = 1e-9


@inlined_kernel
def evaluate(
    table: WaypointTable, path: NDArray[np.float64], lengths: NDArray[np.float64]
) -> tuple[float, float]:
    """Fitness (minimised) and degree of collision of a path, both in map units.

    Args:
        table: the problem, with n waypoints.
        path: shape (n + 2,), the offsets with the zeros of start and target at both ends.
        lengths: shape (n + 1,), a workspace that receives the lengths of the segments.
    """
    spacing = table.spacing
    segments = lengths.shape[0]
    for j in range(segments):
        rise = path[j + 1] - path[j]
        lengths[j] = math.sqrt(spacing * spacing + rise * rise)
    # Four accumulators: a fixed order of summation that the processor can overlap.
    sum0, sum1, sum2, sum3 = 0.0, 0.0, 0.0, 0.0
    whole = segments - segments % 4
    for j in range(0, whole, 4):
        sum0 += lengths[j]
        sum1 += lengths[j + 1]
        sum2 += lengths[j + 2]
        sum3 += lengths[j + 3]
    for j in range(whole, segments):
        sum0 += lengths[j]
    length = (sum0 + sum1) + (sum2 + sum3)

    collision = 0.0
    for j in range(segments):
        collision += segment_collision(table, j, path[j], path[j + 1], lengths[j])
    return table.length_weight * length + (1.0 - table.length_weight) * collision, collision
