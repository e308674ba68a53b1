"""The path of a disc's centre, of segments and arcs, as a polyline that is as far from everything.

A polyline inside an arc would cut the corner. So points lie outside of the arc: the polyline touches the arc
in the middle of its edges, and it is longer than the arc.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.reference.disc_arcs import SLACK, disc_is_free
from swarm_gym.reference.disc_tangents import strip_is_free
from swarm_gym.reference.grid_sight import SightGrid

LONGER = (
    2.5e-7  # how much longer than the path the polyline is at most, as a share, unless a passage needs more
)
MOST_HALVINGS = 30  # of an arc that has obstacles on its other side


class Arc(NamedTuple):
    """An arc around a corner, see `disc_arcs`."""

    corner: int
    begin: float
    "Angle where the path enters the arc."
    end: float
    "Angle where the path leaves it."


def as_polyline(
    grid: SightGrid,
    radius: float,
    start: tuple[float, float],
    arcs: list[Arc],
    goal: tuple[float, float],
    length: float,
) -> NDArray[np.float64]:
    """Return a polyline, (k, 2), in shifted cells, that is nowhere closer to blocked cells than the path.

    It is longer by `LONGER` at most. Blocked cells on the other side of an arc may be so close that points
    outside of it would be too close to them. There are more points there.

    Args:
        grid: the grid with its corners.
        radius: radius of the disc in cells.
        start: shifted column and row where the path begins.
        arcs: arcs in order; tangents join them.
        goal: shifted column and row where the path ends.
        length: length of the path in cells.
    """
    turned = math.fsum(abs(arc.end - arc.begin) for arc in arcs)
    # An edge that touches an arc of angle a is longer than it by the share a^2 / 12.
    widest = math.sqrt(12.0 * LONGER * length / max(radius * turned, LONGER * length))
    points = [start]
    for arc in arcs:
        pieces = max(math.ceil(abs(arc.end - arc.begin) / widest), 1)
        angles = np.linspace(arc.begin, arc.end, pieces + 1).tolist()
        for begin, end in pairwise(angles):
            points += _outside(grid, radius, Arc(arc.corner, begin, end), MOST_HALVINGS)
    return np.array([*points, goal])


def place(grid: SightGrid, corner: int, angle: float, distance: float) -> tuple[float, float]:
    """Return the point (column, row), shifted, at an angle and a distance from a corner."""
    x = grid.corner_columns[corner] - grid.blocked_columns[corner] * distance * math.cos(angle)
    y = grid.corner_rows[corner] - grid.blocked_rows[corner] * distance * math.sin(angle)
    return float(x), float(y)


def _outside(grid: SightGrid, radius: float, arc: Arc, halvings: int) -> list[tuple[float, float]]:
    """Return points outside an arc: one where its tangents meet if it is free, else points of its halves."""
    middle, half = 0.5 * (arc.begin + arc.end), 0.5 * (arc.end - arc.begin)
    point = place(grid, arc.corner, middle, radius / math.cos(half))
    if halvings == 0 or half == 0.0 or _is_free(grid, radius, arc, point):
        return [point]
    return [
        *_outside(grid, radius, arc._replace(end=middle), halvings - 1),
        *_outside(grid, radius, arc._replace(begin=middle), halvings - 1),
    ]


def _is_free(grid: SightGrid, radius: float, arc: Arc, point: tuple[float, float]) -> bool:
    """Return whether the disc is free on its way from one end of an arc to a point, and to the other end."""
    least = radius - 1.5 * SLACK
    first, last = (place(grid, arc.corner, angle, radius) for angle in (arc.begin, arc.end))
    return (
        disc_is_free(grid, *point, least)
        and strip_is_free(grid, *first, *point, least)
        and strip_is_free(grid, *point, *last, least)
    )
