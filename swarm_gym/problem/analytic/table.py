"""The waypoint encoding: a path as offsets from the line between start and target.

Source: SPSFA paper, section II, eq. 1. The map is rotated so that the start is the origin and the line to
the target the x' axis. `num_waypoints` waypoints stand evenly spaced on that axis; a decision vector holds
their offsets y'.

Eight segments are one block, and kernels work on a block at once. The obstacles over a block
are laid out in tiles: a tile holds at most one obstacle for each of the eight segments, all circles or all
polygons.

`num_waypoints` is not printed in the paper; see docs/readings.md.
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES
from swarm_gym.errors import ScenarioError
from swarm_gym.problem.analytic.pairs import Pair, Shape, extent_of_all, rotated_shapes
from swarm_gym.problem.geometry.bends import modes_of_components
from swarm_gym.problem.geometry.rotated_axes import RotatedAxes, offset_bounds, spacing_of
from swarm_gym.problem.padding import Floats, Integers, Real, Whole, columns, pad
from swarm_gym.scenarios import Scenario

# Rows of a tile of circles. A share is a part of the segment, from its left end on. The chords are half the
# chords of the circle at both ends of its overlap with the segment. A sine is the rise of a segment over its
# length. Between the lowest and the highest sine, the tangent at the top touches the circle over the overlap;
# for the tangent at the bottom, this holds for the sine of the mirrored segment.
CENTRE_Y, BEGIN_CHORD, BEGIN_SHARE, END_SHARE, END_CHORD = range(5)
CENTRE_SHARE, RADIUS_SHARE, LOWEST_SINE, HIGHEST_SINE = range(5, 9)
CIRCLE_ROWS = 9
# Rows of a corner of a tile of polygons.
CORNER_SHARE, CORNER_TOP, CORNER_BOTTOM = range(3)
CORNER_ROWS = 3
# In tiles of both kinds, -inf in this row marks a segment without an obstacle.
PRESENCE = BEGIN_CHORD
assert PRESENCE == CORNER_TOP


class WaypointTable(NamedTuple, Generic[Whole, Real]):
    """The problem table of the waypoint encoding, with n waypoints, C = `columns(n)`, T tiles and R rows.

    Entries beyond n waypoints or n + 1 segments are such that they change nothing. In a stacked table every
    field has a leading problem axis.
    """

    dimension: Whole  # n
    spacing: Real  # x' distance between waypoints
    length_weight: Real  # mu
    lower: Floats  # (C,) bounds of the offsets: the workspace
    upper: Floats  # (C,)
    initial_lower: Floats  # (C,) bounds of the first population
    initial_upper: Floats  # (C,)
    width: Real  # largest extent of the workspace across the line, at a waypoint
    middles: Floats  # (K, C) decision vectors of the paths that smooth bends lie next to
    across: Floats  # (C,) change of the components per unit of offset
    modes: Floats  # (2, NUM_MODES, C) modes of smooth bends
    squared_spacing: Floats  # (C,) squared x' length of the segments; tiny beyond them
    first_tile: Integers  # (C / 8 + 1,) tiles of block b: first_tile[b] .. first_tile[b + 1] - 1
    first_row: Integers  # (T,) first row of a tile
    num_corners: Integers  # (T,) corners of the polygons of a tile; 0 for circles
    rows: Floats  # (R, 8) tiles: CIRCLE_ROWS, or num_corners times CORNER_ROWS


WaypointTables = WaypointTable[Integers, Floats]  # of stacked problems


@kernel
def select(tables: WaypointTables, index: int) -> WaypointTable:
    """Return one problem table out of stacked ones, as views."""
    return WaypointTable(
        tables.dimension[index],
        tables.spacing[index],
        tables.length_weight[index],
        tables.lower[index],
        tables.upper[index],
        tables.initial_lower[index],
        tables.initial_upper[index],
        tables.width[index],
        tables.middles[index],
        tables.across[index],
        tables.modes[index],
        tables.squared_spacing[index],
        tables.first_tile[index],
        tables.first_row[index],
        tables.num_corners[index],
        tables.rows[index],
    )


def points_beside(line: Floats, across: Floats, offsets: Floats) -> Floats:
    """Return paths in map coordinates, (..., n + 2, 2).

    Args:
        line: (n + 2, 2) the start, the waypoints of offset 0, and the target.
        across: (2,) movement of a waypoint per unit of its offset.
        offsets: decision vectors, shape (..., n).
    """
    y = np.zeros((*offsets.shape[:-1], len(line), 1))
    y[..., 1:-1, 0] = offsets
    return line + y * across


def tabulate(
    scenario: Scenario, pairs: list[Pair], num_waypoints: int, length_weight: float, ways: Floats | None
) -> WaypointTable:
    """Return the problem table of a scenario and its pairs.

    Args:
        scenario: the map and the task.
        pairs: the pairs of a segment and an obstacle over it.
        num_waypoints: n, number of waypoints.
        length_weight: mu.
        ways: (K, n) the paths that smooth bends lie next to; the straight line if there are none.
    """
    spacing = spacing_of(scenario, num_waypoints)
    shapes = rotated_shapes(scenario)
    axes, x = RotatedAxes.of(scenario), spacing * np.arange(1.0, num_waypoints + 1)
    lower, upper = offset_bounds(axes, x, scenario.workspace)
    initial_lower, initial_upper = _initial_range(scenario, shapes, lower, upper)
    # Beyond the path a length is not 0 but 1.5e-154, which is lost in the sum, but can be divided by.
    squared_spacing = np.full(columns(num_waypoints), np.finfo(np.float64).tiny)
    squared_spacing[: num_waypoints + 1] = spacing**2
    first_tile, first_row, num_corners, rows = _lay_out(pairs, columns(num_waypoints) // NUM_LANES, spacing)
    return WaypointTable(
        num_waypoints,
        float(spacing),
        float(length_weight),
        pad(lower),
        pad(upper),
        pad(initial_lower),
        pad(initial_upper),
        float((upper - lower).max()),
        pad(np.zeros((1, num_waypoints)) if ways is None else ways),
        pad(np.ones(num_waypoints)),
        modes_of_components(np.arange(num_waypoints), num_waypoints),
        squared_spacing,
        first_tile,
        first_row,
        num_corners,
        rows,
    )


def _initial_range(
    scenario: Scenario, shapes: list[Shape], lower: Floats, upper: Floats
) -> tuple[Floats, Floats]:
    low, high = scenario.initial_range or extent_of_all(shapes)
    initial_lower, initial_upper = np.maximum(lower, low), np.minimum(upper, high)
    empty = initial_lower >= initial_upper
    if scenario.initial_range is None:
        # Obstacles far from this part of the line say nothing about it.
        return np.where(empty, lower, initial_lower), np.where(empty, upper, initial_upper)
    if empty.any():
        raise ScenarioError(
            f"scenario {scenario.name!r}: the initial range ({low}, {high}) does not meet the workspace "
            f"{scenario.workspace} at every waypoint"
        )
    return initial_lower, initial_upper


class _Tile:
    """Pairs of one block and one kind of obstacle, at most one pair for each lane."""

    def __init__(self, is_circle: bool) -> None:
        self.is_circle = is_circle
        self.pairs: dict[int, Pair] = {}

    @property
    def num_corners(self) -> int:
        return max(len(pair.corners) for pair in self.pairs.values())

    def rows(self, spacing: float) -> Floats:
        if self.is_circle:
            rows = np.zeros((CIRCLE_ROWS, NUM_LANES))
            rows[[BEGIN_CHORD, END_CHORD]] = -np.inf  # without an obstacle there is nothing to clear
            rows[LOWEST_SINE], rows[HIGHEST_SINE] = np.inf, -np.inf
            for lane, pair in self.pairs.items():
                rows[:, lane] = _circle_column(pair, spacing)
            return rows
        rows = np.zeros((self.num_corners, CORNER_ROWS, NUM_LANES))
        rows[:, CORNER_TOP], rows[:, CORNER_BOTTOM] = -np.inf, np.inf
        for lane, pair in self.pairs.items():
            for k, (x, top, bottom) in enumerate(pair.corners):
                rows[k, :, lane] = x / spacing, top, bottom
        return rows.reshape(-1, NUM_LANES)


def _circle_column(pair: Pair, spacing: float) -> tuple[float, ...]:
    assert pair.circle is not None
    x, y, radius, begin, end = pair.circle
    return (
        y,
        math.sqrt(max(radius**2 - begin**2, 0.0)),
        (x + begin) / spacing,
        (x + end) / spacing,
        math.sqrt(max(radius**2 - end**2, 0.0)),
        x / spacing,
        radius / spacing,
        -end / radius,
        -begin / radius,
    )


def _lay_out(
    pairs: list[Pair], num_blocks: int, spacing: float
) -> tuple[Integers, Integers, Integers, Floats]:
    """Return `first_tile`, `first_row`, `num_corners` and `rows`; the pairs of a segment keep their order."""
    blocks: list[list[_Tile]] = [[] for _ in range(num_blocks)]
    next_tile = [0] * (num_blocks * NUM_LANES)  # for each segment
    for pair in pairs:
        tiles, lane = blocks[pair.segment // NUM_LANES], pair.segment % NUM_LANES
        is_circle = pair.circle is not None
        number = next_tile[pair.segment]
        while number < len(tiles) and tiles[number].is_circle != is_circle:
            number += 1
        if number == len(tiles):
            tiles.append(_Tile(is_circle))
        tiles[number].pairs[lane] = pair
        next_tile[pair.segment] = number + 1
    all_tiles = [tile for tiles in blocks for tile in tiles]
    rows = [tile.rows(spacing) for tile in all_tiles]
    ends = np.cumsum([0, *map(len, rows)])
    return (
        np.cumsum([0, *map(len, blocks)], dtype=np.int64),
        ends[:-1].astype(np.int64),
        np.array([tile.num_corners for tile in all_tiles], dtype=np.int64),
        np.concatenate([np.empty((0, NUM_LANES)), *rows]),
    )
