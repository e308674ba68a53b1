"""Checks of the input of planners on grids."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError


def as_grid(blocked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return a copy of a grid, (height, width), as kernels take it.

    Raises:
        ScenarioError: if it is no array of booleans with two axes and a cell.
    """
    given = np.asarray(blocked)
    if given.ndim != 2 or given.dtype != np.bool_ or given.size == 0:
        raise ScenarioError(
            f"blocked is an array of {given.dtype}, shape {given.shape}; expected booleans, (height, width)"
        )
    return np.array(given, order="C")


def as_point(point: Sequence[float], name: str) -> tuple[float, float]:
    """Return a point (column, row).

    Raises:
        ScenarioError: if it is not two finite numbers; the message names it by `name`.
    """
    given = np.asarray(point)
    if given.shape != (2,) or given.dtype.kind not in "iuf" or not np.isfinite(given).all():
        raise ScenarioError(f"{name} is {point!r}; expected two finite numbers, (column, row)")
    return float(given[0]), float(given[1])


def as_free_cell(blocked: NDArray[np.bool_], cell: Sequence[int], name: str) -> tuple[int, int]:
    """Return a free cell (column, row) of a grid.

    Raises:
        ScenarioError: if it is no cell, not on the grid or blocked; the message names it by `name`.
    """
    column, row = as_point(cell, name)
    height, width = blocked.shape
    if column != int(column) or row != int(row):
        raise ScenarioError(f"{name} is ({column:g}, {row:g}); expected the integers (column, row) of a cell")
    if not (0 <= column < width and 0 <= row < height):
        raise ScenarioError(
            f"{name} ({column:g}, {row:g}) is outside the grid of {width} columns and {height} rows"
        )
    if blocked[int(row), int(column)]:
        raise ScenarioError(f"{name} ({column:g}, {row:g}) is a blocked cell; expected a free one")
    return int(column), int(row)
