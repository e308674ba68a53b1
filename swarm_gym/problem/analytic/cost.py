"""Fitness of a path: its length and its degree of collision, weighted.

Source: SPSFA paper, section II: `f = mu * Length + (1 - mu) * Collis`. The printed mu = 0.1 contradicts the
paper's tables; the default is 0.3. Closed forms and the reading of the degree of collision are in
docs/readings.md.

Segments of a path clear obstacles by shifts along y'. The functions of shifts treat eight segments of a block
at once, one per SIMD lane (`swarm_gym.compiler.simd`; `lane` is None), or a single one (`lane` is its number
in the block). `left` is y' of the left end, `rise` the difference to the right end, and `length` the length.
The two shifts are the smallest movements of the whole segment along +y' and along -y', in map units. Segment
and obstacle are in contact if and only if both are positive; if one is not, neither has a meaning.
"""

from typing import overload

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import (
    NUM_LANES,
    Lanes,
    LanesOrNumber,
    broadcast,
    load,
    maximum,
    minimum,
    read,
    square_root,
    total,
    where,
)
from swarm_gym.problem.analytic.table import (
    BEGIN_CHORD,
    BEGIN_SHARE,
    CENTRE_SHARE,
    CENTRE_Y,
    CORNER_BOTTOM,
    CORNER_ROWS,
    CORNER_SHARE,
    CORNER_TOP,
    END_CHORD,
    END_SHARE,
    HIGHEST_SINE,
    LOWEST_SINE,
    RADIUS_SHARE,
    WaypointTable,
)

Floats = NDArray[np.float64]

# A member whose degree of collision is no larger is feasible (map units).
FEASIBILITY_TOLERANCE = 1e-9


@kernel(inline="late")
def segments_of(table: WaypointTable, path: Floats, block: int) -> tuple[Lanes, Lanes, Lanes]:
    """Return `left`, `rise` and `length` of the segments of a block; `path` is as in `evaluate`."""
    first = block * NUM_LANES
    left = load(path, first)
    rise = load(path, first + 1) - left
    return left, rise, square_root(load(table.squared_spacing, first) + rise * rise)


@kernel(inline="late")
def circle_shifts(
    rows: Floats,
    row: int,
    lane: int | None,
    left: LanesOrNumber,
    rise: LanesOrNumber,
    length: LanesOrNumber,
) -> tuple[LanesOrNumber, LanesOrNumber]:
    """Return the shifts that clear circles, whose rows begin at `row`.

    The top of a circle is highest above a line at an end of the overlap, or where its tangent is parallel: at
    -r sin from the centre. That tangent passes r / cos above the centre, so that no root is needed.
    """
    from_centre = left - read(rows, row + CENTRE_Y, lane)
    begin = from_centre + rise * read(rows, row + BEGIN_SHARE, lane)
    end = from_centre + rise * read(rows, row + END_SHARE, lane)
    middle = from_centre + rise * read(rows, row + CENTRE_SHARE, lane)
    begin_chord, end_chord = read(rows, row + BEGIN_CHORD, lane), read(rows, row + END_CHORD, lane)
    up = maximum(begin_chord - begin, end_chord - end)
    down = maximum(begin_chord + begin, end_chord + end)
    tangent = length * read(rows, row + RADIUS_SHARE, lane)
    lowest, highest = (
        length * read(rows, row + LOWEST_SINE, lane),
        length * read(rows, row + HIGHEST_SINE, lane),
    )
    up = where((rise > lowest) & (rise < highest), tangent - middle, up)
    fall = 0.0 - rise
    down = where((fall > lowest) & (fall < highest), tangent + middle, down)
    return up, down


@kernel(inline="late")
def polygon_shifts(
    rows: Floats, row: int, num_corners: int, lane: int | None, left: LanesOrNumber, rise: LanesOrNumber
) -> tuple[LanesOrNumber, LanesOrNumber]:
    """Return the shifts that clear convex polygons, whose corners' rows begin at `row`.

    The top of a polygon is concave and its bottom convex. So each differs most from a line at a corner or at
    an end of the overlap.
    """
    height = left + rise * read(rows, row + CORNER_SHARE, lane)
    up, down = read(rows, row + CORNER_TOP, lane) - height, height - read(rows, row + CORNER_BOTTOM, lane)
    for corner in range(row + CORNER_ROWS, row + num_corners * CORNER_ROWS, CORNER_ROWS):
        height = left + rise * read(rows, corner + CORNER_SHARE, lane)
        up = maximum(up, read(rows, corner + CORNER_TOP, lane) - height)
        down = maximum(down, height - read(rows, corner + CORNER_BOTTOM, lane))
    return up, down


@overload
def clearing_shifts(
    table: WaypointTable, tile: int, lane: None, left: Lanes, rise: Lanes, length: Lanes
) -> tuple[Lanes, Lanes]: ...


@overload
def clearing_shifts(
    table: WaypointTable, tile: int, lane: int, left: float, rise: float, length: float
) -> tuple[float, float]: ...


@kernel(inline="late")
def clearing_shifts(
    table: WaypointTable,
    tile: int,
    lane: int | None,
    left: LanesOrNumber,
    rise: LanesOrNumber,
    length: LanesOrNumber,
) -> tuple[LanesOrNumber, LanesOrNumber]:
    """Return the shifts that clear the obstacles of a tile."""
    if table.num_corners[tile] > 0:
        return polygon_shifts(table.rows, table.first_row[tile], table.num_corners[tile], lane, left, rise)
    return circle_shifts(table.rows, table.first_row[tile], lane, left, rise, length)


@kernel(inline="late")
def smaller_shifts(table: WaypointTable, block: int, left: Lanes, rise: Lanes, length: Lanes) -> Lanes:
    """Return, for each segment of a block, the sum of its smaller shifts over all obstacles in contact.

    This sum times the cosine of the slope is the segment's degree of collision: for each obstacle the
    distance between the segment and its nearer cleared parallel.
    """
    shifts = broadcast(0.0)
    for tile in range(table.first_tile[block], table.first_tile[block + 1]):
        up, down = clearing_shifts(table, tile, None, left, rise, length)
        shifts = shifts + maximum(minimum(up, down), 0.0)
    return shifts


@kernel(inline="late")
def segment_collision(table: WaypointTable, segment: int, left: float, right: float, length: float) -> float:
    """Return the degree of collision of one segment with all obstacles, in map units.

    Args:
        table: the problem table, with n waypoints.
        segment: number of the segment, 0 to n.
        left: y' of the left end.
        right: y' of the right end.
        length: length of the segment.
    """
    block, lane = segment // NUM_LANES, segment % NUM_LANES
    shifts = 0.0
    for tile in range(table.first_tile[block], table.first_tile[block + 1]):
        up, down = clearing_shifts(table, tile, lane, left, right - left, length)
        shifts += maximum(minimum(up, down), 0.0)
    return shifts * (table.spacing / length)


@kernel(inline="late")
def evaluate(table: WaypointTable, path: Floats) -> tuple[float, float]:
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
