"""Least sums over the cells of a grid map: Dijkstra's algorithm over steps to sixteen neighbours."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Steps (columns, rows), one of each two that are opposite, and the cells that they pass on the way.
STEPS: tuple[tuple[tuple[int, int], tuple[tuple[int, int], ...]], ...] = (
    ((1, 0), ()),
    ((0, 1), ()),
    ((1, 1), ((1, 0), (0, 1))),
    ((1, -1), ((1, 0), (0, -1))),
    ((2, 1), ((1, 0), (1, 1))),
    ((2, -1), ((1, 0), (1, -1))),
    ((1, 2), ((0, 1), (1, 1))),
    ((1, -2), ((0, -1), (1, -1))),
)


class LeastSums(NamedTuple):
    """Least sums from one cell to all others.

    Attributes:
        sums: (height, width) least sum of the field along steps to a cell; infinite where none leads.
        before: (height * width) the cell before each cell, row * width + column; negative without one.
    """

    sums: Floats
    before: NDArray[np.int32]

    def path_to(self, cell: tuple[int, int]) -> Integers:
        """Return the cells (column, row) of the path to a cell (column, row) that steps lead to, (k, 2)."""
        width = self.sums.shape[1]
        cells = [cell[1] * width + cell[0]]
        while self.before[cells[-1]] >= 0:
            cells.append(int(self.before[cells[-1]]))
        rows, columns = np.divmod(np.array(cells[::-1]), width)
        return np.stack([columns, rows], axis=-1)


def least_sums(blocked: NDArray[np.bool_], field: Floats, cell: tuple[int, int]) -> LeastSums:
    """Return the least sums of a field over steps from a cell.

    A step costs its length in cells times the mean of the field over the cells that it passes. It leads
    through the areas of free cells only, and cuts no corner.

    Args:
        blocked: (height, width) the grid.
        field: (height, width) positive costs of the cells.
        cell: the first cell, (column, row).
    """
    from scipy import sparse
    from scipy.sparse import csgraph

    height, width = blocked.shape
    free = ~blocked
    numbers = np.arange(height * width, dtype=np.int32).reshape(height, width)
    begins, ends, sums = [], [], []
    for (dx, dy), between in STEPS:
        rows, columns = slice(max(-dy, 0), height - max(dy, 0)), slice(0, width - dx)
        if rows.stop <= rows.start or columns.stop <= 0:
            continue

        def moved(array: NDArray[np.generic], x: int, y: int, rows: slice = rows, columns: slice = columns):  # type: ignore[no-untyped-def]
            return array[rows.start + y : rows.stop + y, x : columns.stop + x]

        is_open = moved(free, 0, 0) & moved(free, dx, dy)
        total = moved(field, 0, 0) + moved(field, dx, dy)
        for x, y in between:
            is_open = is_open & moved(free, x, y)
            total = total + moved(field, x, y)
        begins.append(moved(numbers, 0, 0)[is_open])
        ends.append(moved(numbers, dx, dy)[is_open])
        sums.append((np.hypot(dx, dy) / (2 + len(between)) * total)[is_open])
    graph = sparse.csr_matrix(
        (np.concatenate(sums), (np.concatenate(begins), np.concatenate(ends))), shape=(blocked.size,) * 2
    )
    found, before = csgraph.dijkstra(
        graph, directed=False, indices=cell[1] * width + cell[0], return_predecessors=True
    )
    return LeastSums(found.reshape(height, width), before)
