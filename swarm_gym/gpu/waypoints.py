"""Waypoint paths among circles and convex polygons on the device: cost, repair and bends.

The same formulas in the same order as `swarm_gym.problem.analytic` and `swarm_gym.problem.geometry.bends`,
which say what they mean; here lane k has segment k and the waypoint at its right end. `place` is the offset
of that waypoint; the last segment ends at the target, whose offset is 0.
"""

import math

from swarm_gym.gpu.warps import (
    BLOCK,
    NUM_LANES,
    ONE,
    TWO,
    ZERO,
    ballot,
    cosine,
    from_lane,
    kernel,
    largest,
    logarithm,
    lowest_bit,
    maximum,
    minimum,
    natural,
    sine,
    square_root,
    total,
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
    PRESENCE,
    RADIUS_SHARE,
    WaypointTables,
)
from swarm_gym.problem.geometry.bends import (
    FIRST_COEFFICIENT,
    HARMONICS,
    LARGEST_OFFSET,
    NUM_HARMONICS,
    NUM_MODES,
)

_SPACING = 2.0**-53  # of the random numbers in [0, 1)


@kernel
def left_end(place: float, lane: int) -> float:
    """Return the offset at the left end of this lane's segment: the offset of the waypoint before."""
    before = from_lane(place, (lane - 1) & (NUM_LANES - 1))
    return before if lane > 0 else ZERO


@kernel
def circle_shifts(
    tables: WaypointTables, p: int, entry: int, left: float, rise: float, length: float
) -> tuple[float, float]:
    """Return the shifts that clear a circle, see `swarm_gym.problem.analytic.cost`.

    `entry` is the place of the first number of the circle among the numbers of problem `p`.
    """
    from_centre = left - tables.rows[p, entry + CENTRE_Y * BLOCK]
    begin = from_centre + rise * tables.rows[p, entry + BEGIN_SHARE * BLOCK]
    end = from_centre + rise * tables.rows[p, entry + END_SHARE * BLOCK]
    middle = from_centre + rise * tables.rows[p, entry + CENTRE_SHARE * BLOCK]
    begin_chord = tables.rows[p, entry + BEGIN_CHORD * BLOCK]
    end_chord = tables.rows[p, entry + END_CHORD * BLOCK]
    up = maximum(begin_chord - begin, end_chord - end)
    down = maximum(begin_chord + begin, end_chord + end)
    tangent = length * tables.rows[p, entry + RADIUS_SHARE * BLOCK]
    lowest = length * tables.rows[p, entry + LOWEST_SINE * BLOCK]
    highest = length * tables.rows[p, entry + HIGHEST_SINE * BLOCK]
    if rise > lowest and rise < highest:
        up = tangent - middle
    fall = ZERO - rise
    if fall > lowest and fall < highest:
        down = tangent + middle
    return up, down


@kernel
def polygon_shifts(
    tables: WaypointTables, p: int, entry: int, num_corners: int, left: float, rise: float
) -> tuple[float, float]:
    """Return the shifts that clear a convex polygon, see `swarm_gym.problem.analytic.cost`."""
    height = left + rise * tables.rows[p, entry + CORNER_SHARE * BLOCK]
    up = tables.rows[p, entry + CORNER_TOP * BLOCK] - height
    down = height - tables.rows[p, entry + CORNER_BOTTOM * BLOCK]
    corner, last = entry, entry + (num_corners - 1) * CORNER_ROWS * BLOCK
    while corner < last:
        corner = natural(corner + CORNER_ROWS * BLOCK)
        height = left + rise * tables.rows[p, corner + CORNER_SHARE * BLOCK]
        up = maximum(up, tables.rows[p, corner + CORNER_TOP * BLOCK] - height)
        down = maximum(down, height - tables.rows[p, corner + CORNER_BOTTOM * BLOCK])
    return up, down


@kernel
def clearing_shifts(
    tables: WaypointTables, p: int, tile: int, column: int, left: float, rise: float, length: float
) -> tuple[float, float]:
    """Return the shifts that clear the obstacle of a tile over one segment."""
    tile = natural(tile)
    entry, num_corners = natural(tables.first_row[p, tile] + column), tables.num_corners[p, tile]
    if num_corners > 0:
        return polygon_shifts(tables, p, entry, num_corners, left, rise)
    return circle_shifts(tables, p, entry, left, rise, length)


@kernel
def smaller_shifts(
    tables: WaypointTables, p: int, lane: int, left: float, rise: float, length: float
) -> float:
    """Return the sum of the smaller shifts of this lane's segment over all obstacles in contact."""
    block, column = lane // BLOCK, lane % BLOCK
    shifts: float = ZERO
    for tile in range(natural(tables.first_tile[p, block]), natural(tables.first_tile[p, block + 1])):
        up, down = clearing_shifts(tables, p, tile, column, left, rise, length)
        shifts = shifts + maximum(minimum(up, down), ZERO)
    return shifts


@kernel
def evaluate(tables: WaypointTables, p: int, lane: int, place: float) -> tuple[float, float]:
    """Return fitness and degree of collision of the path whose offsets the lanes hold, for problem `p`."""
    left = left_end(place, lane)
    rise = place - left
    length = square_root(tables.squared_spacing[p, lane] + rise * rise)
    cleared = smaller_shifts(tables, p, lane, left, rise, length) / length
    collision = total(cleared) * tables.spacing[p]
    weight = tables.length_weight[p]
    return weight * total(length) + (ONE - weight) * collision, collision


@kernel
def repair_segment(
    tables: WaypointTables, p: int, segment: int, left: float, right: float, repair_degree: float
) -> tuple[float, float]:
    """Return the ends of one segment after it was pushed out of one obstacle after the other."""
    block, column = segment // BLOCK, segment % BLOCK
    for tile in range(natural(tables.first_tile[p, block]), natural(tables.first_tile[p, block + 1])):
        entry = natural(tables.first_row[p, natural(tile)] + column)
        if tables.rows[p, entry + PRESENCE * BLOCK] == -math.inf:
            continue
        rise = right - left
        length = square_root(tables.squared_spacing[p, segment] + rise * rise)
        up, down = clearing_shifts(tables, p, tile, column, left, rise, length)
        if up > 0.0 and down > 0.0:
            shift = repair_degree * (up if up <= down else -down)
            if segment > 0:
                lower, upper = tables.lower[p, segment - 1], tables.upper[p, segment - 1]
                left = min(max(left + shift, lower), upper)
            right = min(max(right + shift, tables.lower[p, segment]), tables.upper[p, segment])
    return left, right


@kernel
def repair(tables: WaypointTables, p: int, lane: int, place: float, repair_degree: float) -> float:
    """Return the offset of this lane after the repair of all segments, from the start on.

    All lanes find the segments in contact at once. These are repaired one after the other, by all lanes
    alike, since a segment that moves takes the left end of the next one along.
    """
    left = left_end(place, lane)
    rise = place - left
    length = square_root(tables.squared_spacing[p, lane] + rise * rise)
    contacts = ballot(smaller_shifts(tables, p, lane, left, rise, length) > 0.0)
    segment = lowest_bit(contacts)
    while 0 <= segment < NUM_LANES:
        segment = natural(segment)
        before = from_lane(place, segment)
        from_left = from_lane(place, (segment - 1) & (NUM_LANES - 1))
        from_left = ZERO if segment == 0 else from_left
        from_left, right = repair_segment(tables, p, segment, from_left, before, repair_degree)
        if lane == segment:
            place = right
        if lane == segment - 1:
            place = from_left
        if right != before:
            segment += 1  # what was found for the next segment does not hold any more
        else:
            later = contacts >> (segment + 1) << (segment + 1) if segment < NUM_LANES - 1 else 0
            segment = lowest_bit(later)
    return place


@kernel
def draw_bend(
    tables: WaypointTables, p: int, lane: int, amplitude: float, kind: int, noise: float, share: float
) -> float:
    """Return the offset of this lane in a smooth bend, see `swarm_gym.problem.geometry.bends.draw_bend`.

    `noise` is a number of each lane, uniform in [0, 1), or 1 by rounding; the number of lane 0, which is
    below `share`, chooses the middle path.
    """
    num_middles = tables.middles.shape[1]
    chosen = min(int(from_lane(noise, 0) / share * num_middles), num_middles - 1)
    drawn = from_lane(noise, LARGEST_OFFSET)
    offset = ZERO
    if kind == HARMONICS:
        for h in range(NUM_HARMONICS):
            weight = TWO * from_lane(noise, FIRST_COEFFICIENT + h) - ONE
            offset = offset + weight * tables.modes[p, kind, h, lane]
    else:
        whole_turn = tables.modes.dtype.type(2.0 * math.pi)
        # In float32, a number below 1 may round to 1, whose logarithm below would be infinite.
        smallest = tables.modes.dtype.type(_SPACING)
        for h in range(0, NUM_MODES, 2):  # Box-Muller
            first, second = (
                from_lane(noise, FIRST_COEFFICIENT + h),
                from_lane(noise, FIRST_COEFFICIENT + h + 1),
            )
            rest = maximum(ONE - first, smallest)
            radius, angle = square_root(-TWO * logarithm(rest)), whole_turn * second
            offset = offset + radius * cosine(angle) * tables.modes[p, kind, h, lane]
            offset = offset + radius * sine(angle) * tables.modes[p, kind, h + 1, lane]
    highest = largest(abs(offset))
    scale = drawn * amplitude * tables.width[p] / highest if highest > 0.0 else ZERO
    place = tables.middles[p, chosen, lane] + scale * offset * tables.across[p, lane]
    return minimum(maximum(place, tables.lower[p, lane]), tables.upper[p, lane])
