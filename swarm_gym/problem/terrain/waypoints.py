"""Waypoints of decision vectors, and decision vectors of waypoints; altitudes are above ground.

A `path` is a zero and then a decision vector. Waypoint 0 is the start and waypoint n + 1 the goal.
"""

import math

import numpy as np

from swarm_gym.compiler.elementary import arctangent, sine_and_cosine
from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.problem.padding import Floats
from swarm_gym.problem.terrain.ground import height
from swarm_gym.problem.terrain.table import (
    ABOVE,
    HIGHEST,
    LOWEST,
    REACH,
    SHIFTED,
    SPHERICAL,
    SWAPPED,
    X_MAX,
    X_MIN,
    Y_MAX,
    Y_MIN,
    TerrainTable,
    X,
    Y,
)


@kernel(inline="late")
def clipped(value: float, low: float, high: float) -> float:
    """Return the number in [low, high] that is nearest to a value."""
    return min(max(value, low), high)


@kernel(inline="late", borrows=True)
def waypoint(
    table: TerrainTable, path: Floats, number: int, x: float, y: float, above: float
) -> tuple[float, float, float]:
    """Return x, y and altitude of the waypoint of a number from 1 on, where the one before is known."""
    n = table.num_waypoints
    if number > n:
        return table.ends[1, X], table.ends[1, Y], table.ends[1, ABOVE]
    if table.encoding < SPHERICAL:
        along, sideways = number * table.spacing, path[number]
        if table.encoding == SHIFTED:
            along += path[2 * n + number]
        share = number / (n + 1)
        to_x = table.ends[0, X] + along * table.forward[X] - sideways * table.forward[Y]
        to_y = table.ends[0, Y] + along * table.forward[Y] + sideways * table.forward[X]
        line = table.ends[0, ABOVE] + (table.ends[1, ABOVE] - table.ends[0, ABOVE]) * share
        to_above = line + path[n + number]
    else:
        step, climb, heading = path[3 * number - 2], path[3 * number - 1], path[3 * number]
        rise, level = sine_and_cosine(climb)
        aside, ahead = sine_and_cosine(heading)
        aside, ahead = step * level * aside, step * level * ahead
        to_x, to_y = (x + aside, y + ahead) if table.encoding == SWAPPED else (x + ahead, y + aside)
        to_above = above + step * rise
    return (
        clipped(to_x, table.extent[X_MIN], table.extent[X_MAX]),
        clipped(to_y, table.extent[Y_MIN], table.extent[Y_MAX]),
        clipped(to_above, table.band[LOWEST], table.band[HIGHEST]),
    )


@kernel(borrows=True)
def head_for(
    table: TerrainTable,
    path: Floats,
    number: int,
    before: tuple[float, float, float],
    there: tuple[float, float, float],
) -> None:
    """Write the components of a waypoint into a path, so that it lies as near to a place as bounds let it.

    Args:
        table: the problem table.
        path: path that is written.
        number: number of the waypoint, 1 to n.
        before: x, y and altitude of the waypoint before.
        there: x, y and altitude of the place.
    """
    n = table.num_waypoints
    if table.encoding < SPHERICAL:
        dx, dy = there[0] - table.ends[0, X], there[1] - table.ends[0, Y]
        share = number / (n + 1)
        line = table.ends[0, ABOVE] + (table.ends[1, ABOVE] - table.ends[0, ABOVE]) * share
        path[number] = dy * table.forward[X] - dx * table.forward[Y]
        path[n + number] = there[2] - line
        _keep(table, path, number)
        _keep(table, path, n + number)
        if table.encoding == SHIFTED:
            along = dx * table.forward[X] + dy * table.forward[Y]
            path[2 * n + number] = along - number * table.spacing
            _keep(table, path, 2 * n + number)
        return
    dx, dy, rise = there[0] - before[0], there[1] - before[1], there[2] - before[2]
    level = math.sqrt(dx * dx + dy * dy)
    first = 3 * number - 2
    heading = arctangent(dx, dy) if table.encoding == SWAPPED else arctangent(dy, dx)
    middle = table.lower[first + 1] + REACH
    if heading - middle > math.pi:
        heading -= 2.0 * math.pi
    elif heading - middle < -math.pi:
        heading += 2.0 * math.pi
    path[first], path[first + 1] = math.sqrt(level * level + rise * rise), arctangent(rise, level)
    path[first + 2] = heading
    for k in range(first, first + 3):
        _keep(table, path, k)


@kernel(inline="late")
def _keep(table: TerrainTable, path: Floats, k: int) -> None:
    """Keep a component within its bounds."""
    path[k] = clipped(path[k], table.lower[k - 1], table.upper[k - 1])


@kernel
def write_waypoints(table: TerrainTable, path: Floats, out: Floats) -> None:
    """Write x, y and altitude of all waypoints, start and goal among them, into an array (n + 2, 3)."""
    x, y, above = table.ends[0, X], table.ends[0, Y], table.ends[0, ABOVE]
    out[0, X], out[0, Y], out[0, ABOVE] = x, y, above
    for number in range(1, table.num_waypoints + 2):
        x, y, above = waypoint(table, path, number, x, y, above)
        out[number, X], out[number, Y], out[number, ABOVE] = x, y, above


@entry
def flights(table: TerrainTable, paths: Floats) -> Floats:
    """Return x, y, height and altitude above ground, (m, n + 2, 4), of the waypoints of paths, (m, C + 1)."""
    out = np.empty((paths.shape[0], table.num_waypoints + 2, 4))
    for i in range(paths.shape[0]):
        places = np.empty((table.num_waypoints + 2, 3))
        write_waypoints(table, paths[i], places)
        for k in range(places.shape[0]):
            x, y, above = places[k, X], places[k, Y], places[k, ABOVE]
            out[i, k, 0], out[i, k, 1] = x, y
            out[i, k, 2], out[i, k, 3] = height(table, x, y) + above, above
    return out
