"""The ground of a task: heights of an elevation model around start and goal, on a square grid in metres.

A model in metres keeps its posts, if they are as far apart to the east as to the north. Any other is sampled.
The grid is twice as fine as the posts where that is not too much. It is a rectangle in metres, and ends near
the edge of a map in degrees make it reach beyond. Nodes off the map have the height of its edge;
`Survey.ground` knows no ground there. Nodes beside start and goal are changed a little, so that the ground
between them has the height of the file there.
"""

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.formats.elevation import Elevation
from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC, PLANE, PlaneSystem, Projection
from swarm_gym.scenarios.terrain.scenario import MAX_SIDE, Point3

Floats = NDArray[np.float64]
System = Projection | PlaneSystem | None

REACH = 0.5  # of the straight line, around start and goal: ground that the task has
LEAST_REACH = 500.0  # in metres
FINER = 2  # nodes between posts of a map that is sampled
MANY = 4096  # nodes of a side, beyond which they are as far apart as posts
LOWEST, HIGHEST = -500.0, 9000.0  # of land, in metres; files have values such as -9999 for no data


def task_ground(
    path: Path, elevation: Elevation, system: System, ends: Floats, given: Sequence[Point3], kind: str
) -> tuple[Floats, tuple[float, float], float]:
    """Return heights around start and goal, the coordinates of the first one, and their distance, in metres.

    Args:
        path: file of the elevation model, for messages.
        elevation: the elevation model.
        system: projection between degrees and the metres of the task.
        ends: (2, 2) start and goal in metres.
        given: start and goal as the user gave them.
        kind: kind of the coordinates that the user gave.

    Raises:
        ScenarioError: if start or goal is off the map, if cells near them have no data or no height of land,
            or if the posts around them are too many.
    """
    _require_inside(path, elevation, in_file(elevation, system, ends), given, kind)
    reach = max(REACH * math.dist(*ends.tolist()), LEAST_REACH)
    low, high = ends.min(axis=0) - reach, ends.max(axis=0) + reach
    if is_square(elevation):
        spacing = elevation.spacing[0]
        rows, columns = elevation.heights.shape
        first = np.floor((low - elevation.origin) / spacing)
        first = np.clip(first, 0, [columns - 2, rows - 2]).astype(int)
        last = np.ceil((high - elevation.origin) / spacing)
        last = np.clip(last, first + 1, [columns - 1, rows - 1]).astype(int)
        _require_few(path, *(last - first + 1).tolist())
        heights = elevation.heights[first[1] : last[1] + 1, first[0] : last[0] + 1]
        _require_heights(path, elevation, first, last, system if kind == GEOGRAPHIC else None)
        x, y = (np.array(elevation.origin) + first * spacing).tolist()
        return heights, (x, y), spacing
    spacing = _least_spacing(elevation, system)
    inner = _on_map(elevation, system, low, high)
    low = np.minimum(inner[0], ends.min(axis=0))
    high = np.maximum(inner[1], ends.max(axis=0))
    if (high - low).max() / spacing * FINER <= MANY:
        spacing /= FINER
    columns, rows = np.ceil((high - low) / spacing).astype(int) + 1
    _require_few(path, columns, rows)
    across, along = low[0] + spacing * np.arange(columns), low[1] + spacing * np.arange(rows)
    nodes = np.stack(np.meshgrid(across, along), axis=-1).reshape(-1, 2)
    x_min, y_min, x_max, y_max = elevation.box
    places = np.clip(in_file(elevation, system, nodes), (x_min, y_min), (x_max, y_max))
    posts = (places - elevation.origin) / elevation.spacing
    last_post = np.array(elevation.heights.shape[::-1]) - 1
    first = np.clip(np.floor(posts.min(axis=0)), 0, last_post - 1).astype(int)
    last = np.clip(np.ceil(posts.max(axis=0)), first + 1, last_post).astype(int)
    _require_heights(path, elevation, first, last, system if kind != elevation.kind else None)
    x, y = low.tolist()
    heights = elevation.at(places).reshape(rows, columns)
    on_map = np.clip(in_file(elevation, system, ends), (x_min, y_min), (x_max, y_max))
    _agree_at((ends - low) / spacing, elevation.at(on_map), heights)
    return heights, (x, y), float(spacing)


def _agree_at(places: Floats, wanted: Floats, heights: Floats) -> None:
    """Change heights beside two places in the array so that the ground there is right, as little as possible.

    The change of least squares is W' m with W W' m = missing, where W has the weights of the nodes. It is
    computed without BLAS, so that its last digits are those of any processor.

    Args:
        places: (2, 2) columns and rows of the places, between those of nodes.
        wanted: (2,) heights of the ground there.
        heights: (rows, columns) heights of the nodes.
    """
    rows, columns = heights.shape
    weights: list[dict[tuple[int, int], float]] = []  # of each node beside a place
    missing = []
    for (x, y), height in zip(places.tolist(), wanted.tolist(), strict=True):
        i, j = min(max(int(x), 0), columns - 2), min(max(int(y), 0), rows - 2)
        right, up = min(max(x - i, 0.0), 1.0), min(max(y - j, 0.0), 1.0)
        beside = {
            (j, i): (1.0 - right) * (1.0 - up),
            (j, i + 1): right * (1.0 - up),
            (j + 1, i): (1.0 - right) * up,
            (j + 1, i + 1): right * up,
        }
        weights.append(beside)
        missing.append(height - sum(weight * float(heights[node]) for node, weight in beside.items()))
    first, second = weights
    both = sum(weight * second.get(node, 0.0) for node, weight in first.items())
    squares = [sum(weight * weight for weight in beside.values()) for beside in weights]
    determinant = squares[0] * squares[1] - both * both
    multiples = [missing[0] / squares[0], 0.0]  # for places that are nearly one
    if determinant > 1e-9 * squares[0] * squares[1]:
        multiples = [
            (missing[0] * squares[1] - missing[1] * both) / determinant,
            (missing[1] * squares[0] - missing[0] * both) / determinant,
        ]
    for beside, multiple in zip(weights, multiples, strict=True):
        for node, weight in beside.items():
            heights[node] += multiple * weight


def is_square(elevation: Elevation) -> bool:
    """Return whether the posts of an elevation model suit a task: in metres, evenly spaced both ways."""
    dx, dy = elevation.spacing
    return elevation.kind == PLANE and abs(dx - dy) <= 1e-9 * dx


def in_file(elevation: Elevation, system: System, points: Floats) -> Floats:
    """Return points (n, 2) in metres of a task in the coordinates of the elevation model.

    Longitudes go on beyond 180 degrees where those of the file do.
    """
    if elevation.kind == PLANE:
        return points
    assert system is not None
    degrees = system.to_degrees(points)
    west, _, east, _ = elevation.box
    middle = 0.5 * (west + east)
    degrees[:, 0] -= 360.0 * np.round((degrees[:, 0] - middle) / 360.0)
    return degrees


def words(point: Iterable[float]) -> str:
    """Return numbers of a point as they may be given: 7.404, 46.525, 150."""
    return ", ".join(f"{number:.10g}" for number in point)


def _least_spacing(elevation: Elevation, system: System) -> float:
    """Return the least distance of posts in metres, around the middle of the task."""
    if elevation.kind == PLANE:
        return min(elevation.spacing)
    assert isinstance(system, Projection)
    middle = np.array([[system.longitude, system.latitude]])
    step = np.abs(system.to_metres(middle + np.array([elevation.spacing])) - system.to_metres(middle))[0]
    return float(step.min())


def _on_map(elevation: Elevation, system: System, low: Floats, high: Floats) -> Floats:
    """Return the part of a box in metres that is on the map, (2, 2): lowest and highest x and y.

    An edge of a map in degrees is no straight line. Where it lies within the box, the part ends before it.
    """
    x_min, y_min, x_max, y_max = elevation.box
    if elevation.kind == PLANE:
        return np.array([np.maximum(low, (x_min, y_min)), np.minimum(high, (x_max, y_max))])
    assert isinstance(system, Projection)
    share = np.linspace(0.0, 1.0, 101)
    across, along = (low + share[:, None] * (high - low)).T
    sides = [(across, low[1]), (across, high[1]), (low[0], along), (high[0], along)]
    degrees = in_file(elevation, system, np.concatenate([_points(x, y) for x, y in sides]))
    (west, south), (east, north) = degrees.min(axis=0), degrees.max(axis=0)
    longitudes = max(west, x_min) + share * (min(east, x_max) - max(west, x_min))
    latitudes = max(south, y_min) + share * (min(north, y_max) - max(south, y_min))

    def metres(x: ArrayLike, y: ArrayLike) -> Floats:
        return system.to_metres(_points(x, y))

    part = np.array([low, high])
    if west < x_min:
        part[0, 0] = max(low[0], metres(x_min, latitudes)[:, 0].max())
    if east > x_max:
        part[1, 0] = min(high[0], metres(x_max, latitudes)[:, 0].min())
    if south < y_min:
        part[0, 1] = max(low[1], metres(longitudes, y_min)[:, 1].max())
    if north > y_max:
        part[1, 1] = min(high[1], metres(longitudes, y_max)[:, 1].min())
    return part


def _points(x: ArrayLike, y: ArrayLike) -> Floats:
    """Return points (n, 2) of coordinates, of which one may be the same for all."""
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def _require_few(path: Path, columns: int, rows: int) -> None:
    """Raise a ScenarioError if there are more heights around start and goal than a task may have."""
    if max(columns, rows) > MAX_SIDE:
        raise ScenarioError(
            f"{path}: {columns} x {rows} heights around start and goal, expected at most {MAX_SIDE} of a "
            "side; make the file coarser, for example with gdalwarp -tr"
        )


def _require_inside(
    path: Path, elevation: Elevation, ends: Floats, given: Sequence[Point3], kind: str
) -> None:
    """Raise a ScenarioError if start or goal, (2, 2) in the coordinates of the file, is off the map."""
    x_min, y_min, x_max, y_max = elevation.box
    low, high = np.array([x_min, y_min]), np.array([x_max, y_max])
    slack = 1e-6 * np.array(elevation.spacing)  # for roundings
    for role, end, user in zip(("start", "goal"), ends, given, strict=True):
        if not ((end >= low - slack) & (end <= high + slack)).all():
            hint = "is it in another system?"
            if elevation.kind == kind == PLANE and abs(user[0]) <= 180.0 and abs(user[1]) <= 90.0:
                hint = f"for degrees choose coordinates {GEOGRAPHIC!r}"
            there = "" if elevation.kind == kind else f", {words(end)} in its coordinates,"
            raise ScenarioError(
                f"{path}: {role} {words(user[:2])}{there} lies outside the map, which reaches from "
                f"{x_min:.10g}, {y_min:.10g} to {x_max:.10g}, {y_max:.10g} ({elevation.kind}); {hint}"
            )


def _require_heights(
    path: Path, elevation: Elevation, first: NDArray[np.int64], last: NDArray[np.int64], system: System
) -> None:
    """Raise a ScenarioError for gaps and for heights of no land among posts, from a first one to a last one.

    It names one place, in the coordinates of the file, or in degrees by a system.
    """
    heights = elevation.heights[first[1] : last[1] + 1, first[0] : last[0] + 1]
    gaps, odd = np.isnan(heights), (heights < LOWEST) | (heights > HIGHEST)
    wrong = gaps if gaps.any() else odd
    if not wrong.any():
        return
    row, column = np.argwhere(wrong)[0].tolist()
    place = elevation.origin + (np.array([[column, row]]) + first) * elevation.spacing
    place = place if system is None else system.to_degrees(place)
    where = f"{path}: {int(wrong.sum())} of {wrong.size} cells around start and goal"
    if gaps.any():
        raise ScenarioError(
            f"{where} have no data, one at {words(place[0])}; fill the gaps, for example with gdal_fillnodata"
        )
    raise ScenarioError(
        f"{where} have heights that no land has, {heights[row, column]:g} metres at {words(place[0])}, "
        f"expected {LOWEST:g} to {HIGHEST:g}; if it stands for no data, say so in the file, for example with "
        "gdal_edit -a_nodata"
    )
