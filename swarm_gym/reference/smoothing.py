"""A path over cells, straightened where cells see each other: shorter, but no optimum."""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import entry
from swarm_gym.problem.geometry.traversal import segment_is_free


@entry
def smooth(blocked: NDArray[np.bool_], cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Go from each cell of a path straight to the last one in sight.

    Args:
        blocked: the grid, (height, width).
        cells: a path (column, row) whose steps are free, as of `shortest_grid_path`, (k, 2).

    Returns:
        The cells that are kept, (m, 2), with the first and the last one.
    """
    kept = np.empty_like(cells)
    kept[0] = cells[0]
    here, number, last = 0, 1, cells.shape[0] - 1
    while here < last:
        onward = last
        while onward > here + 1 and not segment_is_free(
            blocked,
            float(cells[here, 0]),
            float(cells[here, 1]),
            float(cells[onward, 0]),
            float(cells[onward, 1]),
        ):
            onward -= 1
        kept[number] = cells[onward]
        number += 1
        here = onward
    return kept[:number].copy()
