"""Fitness of a path: its length and its degree of collision, weighted.

Source: SPSFA paper, section II: `f = mu * Length + (1 - mu) * Collis`. The printed mu = 0.1 contradicts the
paper's tables; the default is 0.3, see docs/readings.md.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES, broadcast, total
from swarm_gym.problem.analytic.collision import segments_of, smaller_shifts
from swarm_gym.problem.analytic.table import WaypointTable

# A member whose degree of collision is no larger is feasible (map units).
FEASIBILITY_TOLERANCE = 1e-9


@kernel(inline="late")
def evaluate(table: WaypointTable, path: NDArray[np.float64]) -> tuple[float, float]:
    """Return the fitness (minimised) and the degree of collision of a path, both in map units.

    Args:
        table: the problem table, with n waypoints and C columns.
        path: (C + 1,) a zero for the start, the offsets, and zeros from the target on.
    """
    lengths, cleared = broadcast(0.0), broadcast(0.0)
    for block in range(table.squared_spacing.shape[0] // NUM_LANES):
        left, rise, length = segments_of(table, path, block)
        lengths = lengths + length
        cleared = cleared + smaller_shifts(table, block, left, rise, length) / length
    collision = total(cleared) * table.spacing
    return table.length_weight * total(lengths) + (1.0 - table.length_weight) * collision, collision
