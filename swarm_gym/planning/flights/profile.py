"""The heights of a flight over a given route: the shortest ones in the altitude band, by a taut string.

The band above the ground is a channel over the distance along the route. A string that is pulled tight in it
is the shortest flight, and no other flight in the channel needs a smaller angle of climb. So if the string is
too steep, the route cannot be flown.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.flights.ground_track import NEAREST, GroundTrack, ground_track
from swarm_gym.scenarios import TerrainScenario
from swarm_gym.scenarios.terrain.scenario import RADIUS, TOP, X, Y
from swarm_gym.scenarios.terrain.survey import Survey

Floats = NDArray[np.float64]

# Shares of the band that a flight keeps from its limits; the first that can be flown counts.
INSETS = (0.25, 0.1, 0.0)
NARROWING = 0.2  # metres of inset for each metre from start and goal
SPARE = 1e-3  # metres that a flight keeps from the limits, a metre and more from start and goal


def flown(task: Survey, route: Floats) -> Floats | None:
    """Return the flight over a route, (k, 3): x, y and height above sea level; None if it cannot be flown.

    Args:
        task: the task.
        route: (k, 2) points from start to goal, seen from above.
    """
    scenario = task.scenario
    x_min, y_min, x_max, y_max = scenario.workspace
    if (route < (x_min, y_min)).any() or (route > (x_max, y_max)).any() or _turns_too_much(scenario, route):
        return None
    track = _track(task, route)
    low, high = _channel(scenario, track)
    if np.isnan(low).any():  # beside a gap of the file
        return None
    limit = math.tan(math.radians(scenario.largest_climb)) * (1.0 - 1e-9)
    width = scenario.band[1] - scenario.band[0]
    for share in INSETS:
        inset = np.minimum(share * width, NARROWING * track.from_ends)
        low_line, high_line = low + inset, high - inset
        if (low_line > high_line).any():
            continue
        places, heights = _taut(track.along, low_line, high_line)
        if (np.abs(np.diff(heights)) <= limit * np.diff(track.along[places])).all():
            return _joined(track, places, heights)
    return None


def least_climb(task: Survey, route: Floats) -> float:
    """Return the smallest angle of climb in degrees with which a route stays in the band, or infinity.

    Args:
        task: the task.
        route: (k, 2) points of the map from start to goal, seen from above, whatever its turns.
    """
    track = _track(task, route)
    low, high = _channel(task.scenario, track)
    if not (low <= high).all():  # also beside a gap of the file
        return math.inf
    places, heights = _taut(track.along, low, high)
    return float(np.degrees(np.arctan2(np.abs(np.diff(heights)), np.diff(track.along[places]))).max())


def _turns_too_much(scenario: TerrainScenario, route: Floats) -> bool:
    steps = np.diff(route, axis=0)
    steps = steps[(steps != 0.0).any(axis=1)]
    if not len(steps):
        return True
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    turns = np.abs((np.diff(headings) + np.pi) % (2.0 * np.pi) - np.pi)
    return bool((np.degrees(turns) > scenario.largest_turn * (1.0 - 1e-12)).any())


def _track(task: Survey, route: Floats) -> GroundTrack:
    """Return the ground below a route, with nodes wherever the channel has a step or is narrow."""
    return ground_track(task, _with_rims(task.scenario, route), finer_ends=True)


def _with_rims(scenario: TerrainScenario, route: Floats) -> Floats:
    """Return a route with vertices where it enters or leaves a threat: the channel has steps there."""
    added = []
    for x, y, top, radius in scenario.threats.tolist():
        if math.isinf(top):
            continue
        reach = radius + scenario.drone_size
        for begin, end in pairwise(route):
            step = end - begin
            length = math.hypot(*step.tolist())
            if length == 0.0:
                continue
            ahead = float(((x, y) - begin) @ step) / length
            aside = float((x - begin[0]) * step[1] - (y - begin[1]) * step[0]) / length
            if abs(aside) < reach:
                half = math.sqrt(reach * reach - aside * aside)
                rims = [s for s in (ahead - half, ahead + half) if NEAREST < s < length - NEAREST]
                added += [begin + step * (s / length) for s in rims]
    if not added:
        return route
    finer = [route[:1]]  # turns at rims are zero
    for begin, end in pairwise(route):
        step = end - begin
        length = math.hypot(*step.tolist())
        on = [p for p in added if length and _is_on(p, begin, step, length)]
        on.sort(key=lambda p: float((p - begin) @ step))
        finer += [np.array([*on, end])]
    return np.vstack(finer)


def _is_on(point: Floats, begin: Floats, step: Floats, length: float) -> bool:
    ahead = float((point - begin) @ step) / length
    return 0.0 < ahead < length and math.dist(begin + step * (ahead / length), point) < 1e-6


def _channel(scenario: TerrainScenario, track: GroundTrack) -> tuple[Floats, Floats]:
    """Return the least and the greatest height of a flight at every node."""
    lowest, highest = scenario.band
    ends = np.array([scenario.start[2], scenario.goal[2]])
    spare = SPARE * np.minimum(track.from_ends, 1.0)
    low = track.ground + lowest + spare + _room(track.bulge, ends - lowest)
    high = track.ground + highest - spare - _room(track.sink, highest - ends)
    for threat in scenario.threats:
        reach = threat[RADIUS] + scenario.drone_size
        inside = _pieces_inside(track, threat[X], threat[Y], reach)
        if inside.any():
            nodes = np.append(inside, False) | np.append(False, inside)
            low[nodes] = np.maximum(low[nodes], threat[TOP] + scenario.drone_size + SPARE)
    low[[0, -1]] = high[[0, -1]] = track.ground[[0, -1]] + ends
    return low, high


def _room(bulge: Floats, ends: Floats) -> Floats:
    """Return how far each node has to be from a limit of the band, so that no point between nodes passes it.

    Let the flight be a and b away from the limit at two neighbours, and the ground bulge by c between them.
    It keeps the limit if (1 - s) a + s b >= 4 c s (1 - s) for all s in [0, 1]. This is so exactly where
    sqrt(a) + sqrt(b) >= 2 sqrt(c). Inner nodes keep c on both sides; beside an end a is given, and b follows.

    Args:
        bulge: (n - 1,) how far the ground bulges towards the limit, between nodes.
        ends: distances of start and goal from the limit, which are given.
    """
    needed = bulge.copy()
    needed[[0, -1]] = np.maximum(2.0 * np.sqrt(bulge[[0, -1]]) - np.sqrt(np.maximum(ends, 0.0)), 0.0) ** 2
    return np.maximum(np.append(needed, 0.0), np.append(0.0, needed))


def _pieces_inside(track: GroundTrack, x: float, y: float, reach: float) -> NDArray[np.bool_]:
    """Return for each piece whether it comes closer to a point than a distance."""
    begin, step = track.points[:-1], np.diff(track.points, axis=0)
    squared = (step**2).sum(axis=1)
    ahead = (x - begin[:, 0]) * step[:, 0] + (y - begin[:, 1]) * step[:, 1]
    share = ahead / np.where(squared > 0.0, squared, 1.0)
    near = begin + np.clip(share, 0.0, 1.0)[:, None] * step
    # A piece that only ends on the rim is outside.
    inside: NDArray[np.bool_] = np.hypot(near[:, 0] - x, near[:, 1] - y) < reach - 1e-7
    return inside


def _taut(along: Floats, low: Floats, high: Floats) -> tuple[list[int], Floats]:
    """Return the nodes at which a string through a channel bends, its ends among them, and its heights there.

    At the first and the last node the channel has no width.
    """
    s, floor, roof = along.tolist(), low.tolist(), high.tolist()
    places, heights = [0], [floor[0]]
    anchor, height, last = 0, floor[0], len(s) - 1
    while anchor < last:
        steepest, flattest, at_floor, at_roof = -math.inf, math.inf, anchor, anchor
        k = anchor + 1
        while k <= last:
            step = s[k] - s[anchor]
            if step <= 0.0:
                k += 1
                continue
            rise, fall = (floor[k] - height) / step, (roof[k] - height) / step
            if rise > flattest:  # the string bends around the roof
                anchor, height = at_roof, roof[at_roof]
                break
            if fall < steepest:  # the string bends around the floor
                anchor, height = at_floor, floor[at_floor]
                break
            if rise >= steepest:
                steepest, at_floor = rise, k
            if fall <= flattest:
                flattest, at_roof = fall, k
            k += 1
        else:
            anchor, height = last, floor[last]
        places.append(anchor)
        heights.append(height)
    return places, np.array(heights)


def _joined(track: GroundTrack, places: list[int], heights: Floats) -> Floats:
    """Return the waypoints of the route and of the string together, as (k, 3)."""
    nodes = np.unique(np.concatenate([track.vertices, places]))
    z = np.interp(track.along[nodes], track.along[places], heights)
    return np.column_stack([track.points[nodes], z])
