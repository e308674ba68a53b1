"""The problem table of flights over terrain, and their encodings.

| encoding | components of a decision vector |
|---|---|
| `waypoints` | n offsets to the left of the start-goal line, then n upwards from the line's altitude |
| `shifted` | the same, then n offsets forwards along the line |
| `spherical` | r, psi and phi of each of n steps: length, climb and heading |

Waypoints of the first stand evenly spaced along the line; those of the second move along it. Altitudes are
above ground. Spherical steps come from M. D. Phung, Q. P. Ha, "Safety-enhanced UAV path planning with
spherical vector-based particle swarm optimization", Applied Soft Computing 107, 2021; docs/readings.md says
what is read how.
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from swarm_gym.compiler.elementary import arctangent, sine_and_cosine
from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import padded
from swarm_gym.problem.geometry.bends import modes
from swarm_gym.problem.geometry.rotated_axes import RotatedAxes, offset_bounds
from swarm_gym.problem.padding import Floats, Integers, Real, Whole, pad
from swarm_gym.scenarios import TerrainScenario

# Numbers of encodings; those before `SPHERICAL` have offsets from the line. Published code swaps the axes of
# headings, see `tabulate`.
WAYPOINTS, SHIFTED, SPHERICAL, SWAPPED = range(4)
ENCODINGS = {"waypoints": WAYPOINTS, "shifted": SHIFTED, "spherical": SPHERICAL}
DOCUMENTED, METABOX = range(2)
COSTS = {"documented": DOCUMENTED, "metabox": METABOX}
SIZES = {WAYPOINTS: 2, SHIFTED: 3, SPHERICAL: 3, SWAPPED: 3}  # components of a waypoint

# Largest offsets forwards and backwards, in the first population and later, in distances between waypoints.
FIRST_SHIFT, LARGEST_SHIFT = 0.5, 2.0
# Largest climb and deviation of the heading of a spherical step, in radians.
REACH = math.pi / 4.0
# Cells along a side of the blocks whose lowest and highest ground is known. Blocks tile the map.
BLOCK = 8
# Windows begin at every `STEP` cells along both sides of the map. Those of level l have STEP (1 + 2^l) cells
# along a side, and one more, since published code reads the ground one cell off. So a part of a flight that
# begins in the first STEP cells of a window, and is no longer than STEP 2^l, lies in it.
STEP = 16
# Equal parts into which segments are cut.
NUM_PARTS = 8
_EXTREMES = (np.minimum, np.maximum)
# Rows of the threats of a table. A cylinder ends where it touches a drone of the scenario's size.
CENTRE_X, CENTRE_Y, TOP, CONTACT, DANGER, SQUARED_DANGER = range(6)
NUM_THREAT_ROWS = 6
# Places in other arrays of a table.
X, Y, ABOVE = range(3)
X_MIN, Y_MIN, X_MAX, Y_MAX = range(4)
LOWEST, HIGHEST = range(2)
TURN, CLIMB = range(2)


class TerrainTable(NamedTuple, Generic[Whole, Real]):
    """The problem table of a flight, with n waypoints; in a stacked table every field has a problem axis."""

    dimension: Whole  # D
    lower: Floats  # (C,) bounds of decision vectors
    upper: Floats  # (C,)
    initial_lower: Floats  # (C,) bounds of the first population: narrower if waypoints are shifted
    initial_upper: Floats  # (C,)
    encoding: Whole  # WAYPOINTS, SHIFTED, SPHERICAL or SWAPPED
    cost: Whole  # DOCUMENTED or METABOX
    num_waypoints: Whole  # n
    spacing: Real  # distance between waypoints along the line, seen from above
    forward: Floats  # (2,) unit vector along the line, seen from above
    width: Real  # largest extent of the map across the line, at a waypoint
    middles: Floats  # (K, 2 n) or, if shifted, (K, 3 n) offsets of flights that smooth bends lie next to
    modes: Floats  # (2, NUM_MODES, n) modes of smooth bends
    ends: Floats  # (2, 3) x, y and altitude of start and goal
    extent: Floats  # (4,) of the map
    band: Floats  # (2,) altitudes
    limits: Floats  # (2,) largest turn and climb in degrees
    tangents: Floats  # (2,) tangents below which an angle is within these limits
    cell: Real  # distance between neighbouring heights
    num_rows: Whole  # heights along y
    num_columns: Whole  # heights along x
    heights: Floats  # (rows, columns)
    blocks: Floats  # (2, rows of blocks, columns of blocks) lowest and highest ground in and around a block
    windows: Floats  # (2, levels, rows of windows, columns of windows) lowest and highest ground of windows
    threats: Floats  # (NUM_THREAT_ROWS, T) columns beyond the threats change nothing


TerrainTables = TerrainTable[Integers, Floats]  # of stacked problems


@kernel
def select(tables: TerrainTables, index: int) -> TerrainTable:
    """Return one problem table out of stacked ones, as views."""
    return TerrainTable(
        tables.dimension[index],
        tables.lower[index],
        tables.upper[index],
        tables.initial_lower[index],
        tables.initial_upper[index],
        tables.encoding[index],
        tables.cost[index],
        tables.num_waypoints[index],
        tables.spacing[index],
        tables.forward[index],
        tables.width[index],
        tables.middles[index],
        tables.modes[index],
        tables.ends[index],
        tables.extent[index],
        tables.band[index],
        tables.limits[index],
        tables.tangents[index],
        tables.cell[index],
        tables.num_rows[index],
        tables.num_columns[index],
        tables.heights[index],
        tables.blocks[index],
        tables.windows[index],
        tables.threats[index],
    )


def tabulate(
    scenario: TerrainScenario, encoding: int, cost: int, num_waypoints: int, ways: Floats | None
) -> TerrainTable:
    """Return the problem table of a scenario.

    Published code turns headings into steps (r sin phi, r cos phi). Yet it bounds them around the angle of
    the goal from the x axis. So phi is mirrored; the cost `metabox` takes it so, `documented` does not.

    Args:
        scenario: the map and the task.
        encoding: a value of `ENCODINGS`.
        cost: a value of `COSTS`.
        num_waypoints: n.
        ways: (K, 2 n) the flights that smooth bends lie next to, as offsets sideways and upwards, and
            (K, 3 n) with those forwards for `shifted`; the start-goal line if there are none.
    """
    axes = axes_of(scenario)
    length = plan_length(scenario)
    spacing = length / (num_waypoints + 1)
    x = spacing * np.arange(1.0, num_waypoints + 1)
    low, high = offset_bounds(axes, x, scenario.workspace)
    if encoding < SPHERICAL:
        along = np.arange(1.0, num_waypoints + 1) / (num_waypoints + 1)
        line = scenario.start[2] + (scenario.goal[2] - scenario.start[2]) * along
        lower = np.concatenate([low, scenario.band[LOWEST] - line])
        upper = np.concatenate([high, scenario.band[HIGHEST] - line])
        first = lower, upper
        if encoding == SHIFTED:
            (lower, upper), first = _with_shifts(lower, upper, x, length)
    else:
        heading = arctangent(axes.sine, axes.cosine)
        longest = 2.0 * math.hypot(length, scenario.goal[2] - scenario.start[2]) / num_waypoints
        lower = np.tile([0.0, -REACH, heading - REACH], num_waypoints)
        upper = np.tile([longest, REACH, heading + REACH], num_waypoints)
        first = lower, upper
        encoding = SWAPPED if cost == METABOX else SPHERICAL
    rows, columns = scenario.heights.shape
    return TerrainTable(
        len(lower),
        pad(lower),
        pad(upper),
        pad(first[0]),
        pad(first[1]),
        encoding,
        cost,
        num_waypoints,
        float(spacing),
        np.array([axes.cosine, axes.sine]),
        float((high - low).max()),
        np.zeros((1, (3 if encoding == SHIFTED else 2) * num_waypoints)) if ways is None else ways,
        modes(num_waypoints),
        np.array([scenario.start, scenario.goal]),
        np.array(scenario.workspace),
        np.array(scenario.band),
        np.array([scenario.largest_turn, scenario.largest_climb]),
        np.array([_safe_tangent(scenario.largest_turn), _safe_tangent(scenario.largest_climb)]),
        scenario.cell,
        rows,
        columns,
        scenario.heights,
        _blocks(scenario.heights),
        _windows(scenario.heights),
        _threats(scenario),
    )


def _with_shifts(
    lower: Floats, upper: Floats, x: Floats, length: float
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Return bounds of offsets sideways, upwards and forwards, and those of the first population.

    A waypoint may be as far from the line as the map is wide anywhere, since it moves along the line. Places
    off the map are moved to its edge. No waypoint lies behind the start or beyond the goal.

    Args:
        lower: lower bounds of the offsets sideways and upwards of waypoints that are not shifted.
        upper: upper bounds of the same.
        x: places of these waypoints along the line.
        length: length of the line, seen from above.
    """
    n, spacing = len(x), x[0]
    first = np.full(n, FIRST_SHIFT * spacing)
    back = np.minimum(LARGEST_SHIFT * spacing, x)
    ahead = np.minimum(LARGEST_SHIFT * spacing, length - x)
    lowest, highest = np.full(n, lower[:n].min()), np.full(n, upper[:n].max())
    bounds = np.concatenate([lowest, lower[n:], -back]), np.concatenate([highest, upper[n:], ahead])
    return bounds, (np.concatenate([lower, -first]), np.concatenate([upper, first]))


def axes_of(scenario: TerrainScenario) -> RotatedAxes:
    """Return the axes along and across the start-goal line, seen from above."""
    (x, y), (goal_x, goal_y), length = scenario.start[:2], scenario.goal[:2], plan_length(scenario)
    return RotatedAxes((x, y), (goal_x - x) / length, (goal_y - y) / length)


def plan_length(scenario: TerrainScenario) -> float:
    """Return the distance from the start to the goal, seen from above."""
    return math.hypot(scenario.goal[0] - scenario.start[0], scenario.goal[1] - scenario.start[1])


def _blocks(heights: Floats) -> Floats:
    """Return the lowest and the highest corner of the cells of each block, (2, block rows, block columns)."""
    found = []
    for least in _EXTREMES:
        cells = least(least(heights[:-1, :-1], heights[1:, :-1]), least(heights[:-1, 1:], heights[1:, 1:]))
        rows = least.reduceat(cells, np.arange(0, cells.shape[0], BLOCK), axis=0)
        found.append(least.reduceat(rows, np.arange(0, cells.shape[1], BLOCK), axis=1))
    return np.stack(found)


def _windows(heights: Floats) -> Floats:
    """Return the lowest and the highest ground of windows, (2, levels, window rows, window columns).

    The last level holds the longest part of a segment on the map.
    """
    num_rows, num_columns = ((side - 1) // STEP + 1 for side in heights.shape)
    reaches = [STEP]
    while reaches[-1] * NUM_PARTS < max(heights.shape):
        reaches.append(2 * reaches[-1])
    found = np.empty((2, len(reaches), num_rows, num_columns))
    for k, extreme in enumerate(_EXTREMES):
        for level, reach in enumerate(reaches):
            num_heights = STEP + reach + 2
            rows = _along_first(heights, num_rows, num_heights, extreme)
            found[k, level] = _along_first(rows.T, num_columns, num_heights, extreme).T
    return found


def _along_first(values: Floats, num_windows: int, num_heights: int, extreme: np.ufunc) -> Floats:
    """Return the least or the largest rows, (num_windows, columns), in windows from every STEP-th row on."""
    return np.stack([extreme.reduce(values[k * STEP : k * STEP + num_heights]) for k in range(num_windows)])


def _safe_tangent(degrees: float) -> float:
    """Return a tangent below which an angle is within a limit for certain, whatever rounding adds to it."""
    if degrees >= 90.0:
        return math.inf
    sine, cosine = sine_and_cosine(math.radians(degrees))
    return sine / cosine * (1.0 - 1e-9)


def _threats(scenario: TerrainScenario) -> Floats:
    out = np.zeros((NUM_THREAT_ROWS, padded(max(len(scenario.threats), 1))))
    x, y, top, radius = scenario.threats.T
    contact = radius + scenario.drone_size
    danger = contact + scenario.danger_distance
    out[:, : len(x)] = x, y, top + scenario.drone_size, contact, danger, danger * danger
    return out
