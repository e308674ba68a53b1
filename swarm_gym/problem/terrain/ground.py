"""The ground below a flight: its height, and how much of a segment lies below it or outside the band.

Between four neighbouring heights the ground is bilinear, so along a segment its height is quadratic in each
cell. That makes the parts of a segment below the ground or outside the altitude band exact but for rounding.
Most of a segment is decided without its cells. It is cut into eight equal parts, and each lies in a window of
the map that two additions find. Where a part stays above the highest ground of its window, nothing else is
read. Blocks of cells, with their lowest and highest ground, decide most of the rest.
"""

import math

import numpy as np

from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.terrain.table import BLOCK, NUM_PARTS, STEP, X_MIN, Y_MIN, TerrainTable

# Share of a piece that touches the ground at least, where rounding could leave nothing of it.
TOUCH = 1e-9
# Metres between a flight and a limit of the band, at least, where the corners of a cell, or the lowest and
# highest ground of a window, alone decide: far more than rounding of heights.
MARGIN = 1e-6
# Cells by which a part of a segment counts as longer at both ends: far more than rounding of places.
SLACK = 1e-6


@kernel(inline="late")
def in_cells(table: TerrainTable, x: float, y: float) -> tuple[float, float]:
    """Return a point of the map in cells, from the first height on."""
    return (x - table.extent[X_MIN]) / table.cell, (y - table.extent[Y_MIN]) / table.cell


@kernel(inline="late")
def _height_in(table: TerrainTable, column: int, row: int, right: float, up: float) -> float:
    """Return the height of the ground in a cell, at shares of its sides."""
    near, far = table.heights[row, column], table.heights[row, column + 1]
    below = near + (far - near) * right
    near, far = table.heights[row + 1, column], table.heights[row + 1, column + 1]
    return below + (near + (far - near) * right - below) * up


@kernel(inline="late")
def height_of_place(table: TerrainTable, u: float, v: float) -> float:
    """Return the height of the ground at a point in cells, which lies on the map."""
    column, row = min(int(u), table.num_columns - 2), min(int(v), table.num_rows - 2)
    return _height_in(table, column, row, u - column, v - row)


@kernel(inline="late")
def highest_near(table: TerrainTable, u: float, v: float) -> float:
    """Return the highest ground in the block of a point in cells, which lies on the map."""
    column, row = min(int(u), table.num_columns - 2), min(int(v), table.num_rows - 2)
    return table.blocks[1, row // BLOCK, column // BLOCK]


@kernel(inline="late")
def height(table: TerrainTable, x: float, y: float) -> float:
    """Return the height of the ground at a point of the map."""
    u, v = in_cells(table, x, y)
    return height_of_place(table, u, v)


@kernel(inline="late", borrows=True)
def height_as_coded(table: TerrainTable, x: float, y: float) -> float:
    """Return the nearest height to a point, halves to even places from 1 on, as published code reads it."""
    u, v = in_cells(table, x, y)
    return table.heights[int(np.rint(v + 1.0)) - 1, int(np.rint(u + 1.0)) - 1]


@kernel(borrows=True)
def share_below(begin: float, end: float, sag: float) -> float:
    """Return the share of [0, 1] in which begin + (end - begin) s + sag (s^2 - s) is negative.

    It is positive wherever the function is negative anywhere.
    """
    slope = end - begin - sag
    least, most = min(begin, end), max(begin, end)
    if abs(end - begin) < abs(sag):  # the vertex lies within
        vertex = begin - slope * slope / (4.0 * sag)
        least, most = min(least, vertex), max(most, vertex)
    if least >= 0.0:
        return 0.0
    if most <= 0.0:
        return 1.0
    if sag == 0.0:
        root = begin / (begin - end)
        return max(root if begin < 0.0 else 1.0 - root, TOUCH)
    root = math.sqrt(max(slope * slope - 4.0 * sag * begin, 0.0))
    half = -0.5 * (slope + (root if slope >= 0.0 else -root))
    one, other = half / sag, (begin / half if half != 0.0 else 0.0)
    first, last = min(max(min(one, other), 0.0), 1.0), min(max(one, other, 0.0), 1.0)
    between = last - first
    return max(between if sag > 0.0 else 1.0 - between, TOUCH)


@kernel(inline="late")
def _next_line(number: int, last: int, size: int, begin: float, change: float) -> float:
    """Return the share of a segment at which it leaves a strip, of `size` cells; infinite where it cannot.

    Args:
        number: number of the strip.
        last: number of the last strip of the map, which a segment leaves by its other side only.
        size: width of a strip in cells.
        begin: coordinate at which the segment begins, in cells.
        change: difference to the coordinate at which it ends.
    """
    if change > 0.0 and number < last:
        return ((number + 1) * size - begin) / change
    return (number * size - begin) / change if change < 0.0 and number > 0 else math.inf


@kernel(inline="late", borrows=True)
def unsure(
    table: TerrainTable,
    u: float,
    v: float,
    z: float,
    du: float,
    dv: float,
    dz: float,
    lowest: float,
    highest: float,
) -> tuple[float, float]:
    """Return the shares of a segment between which it may leave a band of altitudes above ground.

    Before the first share and after the second one it stays in the band, by `MARGIN` at least. The first is
    above the second where the whole segment does. The same holds above ground one cell further in x and y.

    Args:
        table: the problem table.
        u: first point of the segment along x, in cells.
        v: first point along y, in cells.
        z: height of the first point.
        du: way to the last point along x, in cells.
        dv: way along y, in cells.
        dz: way upwards.
        lowest: least altitude of the band.
        highest: largest altitude of the band.
    """
    share, scale = 1.0 / NUM_PARTS, 1.0 / STEP
    longest = max(abs(du), abs(dv)) * share + 4.0 * SLACK
    level, reach = 0, float(STEP)
    while longest > reach:
        level, reach = level + 1, 2.0 * reach
    # The least corner of part k is that of part 0 and k times the way of a part.
    column, columns = (u + min(du * share, 0.0) - SLACK) * scale, du * share * scale
    row, rows = (v + min(dv * share, 0.0) - SLACK) * scale, dv * share * scale
    low, high, rise = z + min(dz * share, 0.0) - MARGIN, z + max(dz * share, 0.0) + MARGIN, dz * share
    first, last = NUM_PARTS, 0
    for k in range(NUM_PARTS):
        i, j = int(max(row + rows * k, 0.0)), int(max(column + columns * k, 0.0))
        is_low = low + rise * k < table.windows[1, level, i, j] + lowest
        is_high = high + rise * k > table.windows[0, level, i, j] + highest
        if is_low or is_high:
            first, last = min(first, k), k + 1
    return first * share, last * share


@kernel(inline="late", borrows=True)
def below_ground(
    table: TerrainTable,
    x: float,
    y: float,
    z: float,
    to_x: float,
    to_y: float,
    to_z: float,
    lowest: float,
    highest: float,
) -> tuple[float, float, float]:
    """Measure a straight segment between two points of the map and their heights.

    Args:
        table: the problem table.
        x: x of the first point.
        y: y of the first point.
        z: height of the first point.
        to_x: x of the second point.
        to_y: y of the second point.
        to_z: height of the second point.
        lowest: least altitude of a band above ground, at least 0.
        highest: largest altitude of the band.

    Returns:
        The share of the segment below the ground, the share outside the band, and an upper bound of its
        largest depth below the ground.
    """
    u, v = in_cells(table, x, y)
    to_u, to_v = in_cells(table, to_x, to_y)
    begin, end = unsure(table, u, v, z, to_u - u, to_v - v, to_z - z, lowest, highest)
    if begin >= end:
        return 0.0, 0.0, 0.0
    return in_blocks(table, u, v, z, to_u - u, to_v - v, to_z - z, lowest, highest, begin, end)


@kernel(inline="late")
def _block_at(place: float, change: float, last: int) -> int:
    """Return the block of a place in cells; on the line between two blocks, the one behind counts."""
    place += SLACK if change < 0.0 else (-SLACK if change > 0.0 else 0.0)
    return min(int(max(place, 0.0)) // BLOCK, last)


@kernel(inline="late")
def _line_behind(number: int, last: int, begin: float, change: float) -> float:
    """Return the share of a segment at which it comes to a strip of blocks, as `_next_line` does; or 0."""
    if change > 0.0 and number > 0:
        return (number * BLOCK - begin) / change
    return ((number + 1) * BLOCK - begin) / change if change < 0.0 and number < last else 0.0


@kernel(inline="late", borrows=True)
def in_blocks(
    table: TerrainTable,
    u: float,
    v: float,
    z: float,
    du: float,
    dv: float,
    dz: float,
    lowest: float,
    highest: float,
    begin: float,
    end: float,
) -> tuple[float, float, float]:
    """Measure all blocks that a segment touches between two shares; places and ways are in cells.

    Returns:
        What `below_ground` does, if the rest of the segment lies in the band.
    """
    last_column = (table.num_columns - 2) // BLOCK
    last_row = (table.num_rows - 2) // BLOCK
    column, row = _block_at(u + du * begin, du, last_column), _block_at(v + dv * begin, dv, last_row)
    # A block behind the first one has no width: its lines are not further than those of the first.
    here = max(_line_behind(column, last_column, u, du), _line_behind(row, last_row, v, dv), 0.0)
    below, outside, deepest = 0.0, 0.0, 0.0
    leaves_column = _next_line(column, last_column, BLOCK, u, du)
    leaves_row = _next_line(row, last_row, BLOCK, v, dv)
    while True:
        there = max(min(leaves_column, leaves_row, 1.0), here)
        if there > here or (du == 0.0 and dv == 0.0):
            near, far = z + dz * here, z + dz * there
            low = min(near, far) - table.blocks[1, row, column]
            high = max(near, far) - table.blocks[0, row, column]
            if low < lowest or high > highest:
                if low >= 0.0 and (high < lowest or low > highest):
                    outside += there - here
                else:
                    found = _in_cells_of_block(table, u, v, z, du, dv, dz, here, there, lowest, highest)
                    below, outside, deepest = below + found[0], outside + found[1], max(deepest, found[2])
        if there >= end:
            return below, outside, deepest
        here = there
        if leaves_column <= leaves_row:
            column += 1 if du > 0.0 else -1
            leaves_column = _next_line(column, last_column, BLOCK, u, du)
        else:
            row += 1 if dv > 0.0 else -1
            leaves_row = _next_line(row, last_row, BLOCK, v, dv)


@kernel(inline="late", borrows=True)
def _in_cells_of_block(
    table: TerrainTable,
    u: float,
    v: float,
    z: float,
    du: float,
    dv: float,
    dz: float,
    begin: float,
    end: float,
    lowest: float,
    highest: float,
) -> tuple[float, float, float]:
    """Measure the part of a segment from one share to another, cell by cell, as `below_ground` does."""
    last_column, last_row = table.num_columns - 2, table.num_rows - 2
    middle = begin + 1e-9 * (end - begin)  # on the line between two cells, the one ahead counts
    column = min(max(math.floor(u + du * middle), 0), last_column)
    row = min(max(math.floor(v + dv * middle), 0), last_row)
    here, below, outside, deepest = begin, 0.0, 0.0, 0.0
    leaves_column = _next_line(column, last_column, 1, u, du)
    leaves_row = _next_line(row, last_row, 1, v, dv)
    while True:
        there = max(min(leaves_column, leaves_row, end), here)
        width = there - here
        if width > 0.0 or (du == 0.0 and dv == 0.0):
            one, other = table.heights[row, column], table.heights[row, column + 1]
            up_one, up_other = table.heights[row + 1, column], table.heights[row + 1, column + 1]
            # Above ground along the piece: near + (far - near) s + sag (s^2 - s), for s from 0 to 1.
            twist = (one + up_other) - (other + up_one)
            sag = -twist * du * dv * width * width
            spare = 0.25 * abs(sag)
            first, last = z + dz * here, z + dz * there
            low = min(first, last) - max(one, other, up_one, up_other)
            high = max(first, last) - min(one, other, up_one, up_other)
            if low - spare < lowest + MARGIN or high + spare > highest - MARGIN:
                right, up = u + du * here - column, v + dv * here - row
                near = first - _height_in(table, column, row, right, up)
                right, up = u + du * there - column, v + dv * there - row
                far = last - _height_in(table, column, row, right, up)
                if min(near, far) - spare < lowest:
                    share = share_below(near, far, sag)
                    if share > 0.0:
                        below += share * width
                        deepest = max(deepest, spare - min(near, far))
                    outside += share_below(near - lowest, far - lowest, sag) * width
                if max(near, far) + spare > highest:
                    outside += share_below(highest - near, highest - far, -sag) * width
        if there >= end:
            return below, outside, deepest
        here = there
        if leaves_column <= leaves_row:
            column += 1 if du > 0.0 else -1
            leaves_column = _next_line(column, last_column, 1, u, du)
        else:
            row += 1 if dv > 0.0 else -1
            leaves_row = _next_line(row, last_row, 1, v, dv)
