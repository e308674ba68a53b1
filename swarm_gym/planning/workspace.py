"""The workspace that a robot stays in: a box or a polygon, with a frame of obstacles around it."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.errors import ScenarioError, SettingError, shown
from swarm_gym.planning.geojson import Shape, read_features
from swarm_gym.planning.shapes import extent_of, obstacles_of
from swarm_gym.scenarios import Circle, Obstacle, Point, Polygon, Scenario
from swarm_gym.scenarios.formats.data_files import find_data_file

Floats = NDArray[np.float64]
Box = tuple[float, float, float, float]

WIDTH = 0.1  # of the frame, as a share of the extent of the workspace
BOX = "x_min,y_min,x_max,y_max"


class RobotWorkspace(NamedTuple):
    """A polygon that the robot stays in.

    Attributes:
        shape: polygon; its name is for messages.
        reference: member "crs" of its file, which names a coordinate reference system; None without one.
    """

    shape: Shape
    reference: object = None


def read_workspace(given: str | Path | ArrayLike) -> RobotWorkspace:
    """Return a workspace.

    Args:
        given: (x_min, y_min, x_max, y_max), also as text; corners of a polygon, (k, 2); or the name of a
            GeoJSON file with one polygon, here or in the data folder.

    Raises:
        SettingError: for another value.
        ScenarioError: if the file is missing or malformed.
    """
    if isinstance(given, Path | str):
        numbers = _numbers(str(given))
        return _of_file(str(given)) if numbers is None else RobotWorkspace(_box(numbers))
    try:
        values = np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise _refused(given) from error
    if values.shape == (4,):
        return RobotWorkspace(_box(values.tolist()))
    if values.ndim != 2 or values.shape[1] != 2 or len(values) < 3 or not np.isfinite(values).all():
        raise _refused(given)
    ring: tuple[Point, ...] = tuple(map(tuple, values.tolist()))
    return RobotWorkspace(_checked(Shape("workspace", "Polygon", ((*ring, ring[0]),))))


def confined(scenario: Scenario, shape: Shape) -> Scenario:
    """Return the scenario with a frame of obstacles around a workspace, and without what lies beyond.

    Args:
        scenario: a map of obstacles, with start and goal in the workspace.
        shape: workspace, in map units.

    Raises:
        MissingExtraError: if the workspace is no box, and shapely is missing.
    """
    corners = np.array(shape.parts[0])
    low, high = corners.min(axis=0), corners.max(axis=0)
    width = WIDTH * extent_of(corners)
    outer = (*(low - width).tolist(), *(high + width).tolist())
    inside = [one for one in scenario.obstacles if _overlap(_bounds(one), (*low.tolist(), *high.tolist()))]
    obstacles = (*inside, *_frame(shape, outer))
    bounds = np.array([_bounds(one) for one in obstacles])
    workspace = (*bounds[:, :2].min(axis=0).tolist(), *bounds[:, 2:].max(axis=0).tolist())
    return replace(scenario, obstacles=obstacles, workspace=workspace)


def _frame(shape: Shape, outer: Box) -> list[Obstacle]:
    """Return obstacles that fill a box except for the workspace in it."""
    corners = set(shape.parts[0])
    xs, ys = (sorted({corner[k] for corner in corners}) for k in (0, 1))
    if len(shape.parts) == 1 and len(xs) == len(ys) == 2 and len(corners) == 4:
        (x_min, y_min, x_max, y_max), (left, right), (bottom, top) = outer, xs, ys
        # They overlap at the corners, so that no edges meet there.
        return [
            Polygon.rectangle(x_min, y_min, left, y_max),
            Polygon.rectangle(right, y_min, x_max, y_max),
            Polygon.rectangle(x_min, y_min, x_max, bottom),
            Polygon.rectangle(x_min, top, x_max, y_max),
        ]
    x_min, y_min, x_max, y_max = outer
    around = ((x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max), (x_min, y_min))
    extent = max(x_max - x_min, y_max - y_min)
    found = obstacles_of(Shape(shape.name, "Polygon", (around, shape.parts[0])), extent, 0.0)
    for hole in shape.parts[1:]:
        found += obstacles_of(Shape(shape.name, "Polygon", (hole,)), extent, 0.0)
    return found


def _of_file(name: str) -> RobotWorkspace:
    path = Path(name) if Path(name).is_file() else find_data_file(name)
    features = read_features(path)
    if len(features.shapes) != 1 or features.shapes[0].kind != "Polygon":
        kinds = [shape.kind for shape in features.shapes]
        raise ScenarioError(f"workspace {path}: expected one Polygon and nothing else, got {shown(kinds)}")
    (shape,) = features.shapes
    return RobotWorkspace(_checked(shape._replace(name=f"workspace of {path}")), features.reference)


def _numbers(text: str) -> list[float] | None:
    """Return the numbers of a text that has four of them; None for another text, such as a file's name."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        return None
    return numbers if len(numbers) == 4 else None


def _box(values: Sequence[float]) -> Shape:
    x_min, y_min, x_max, y_max = values
    if not (np.isfinite(values).all() and x_min < x_max and y_min < y_max):
        raise SettingError(
            f"workspace {BOX}: expected finite numbers, x_min < x_max and y_min < y_max, got {shown(values)}"
        )
    ring = ((x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max), (x_min, y_min))
    return Shape(f"workspace {','.join(f'{value:g}' for value in values)}", "Polygon", (ring,))


def _checked(shape: Shape) -> Shape:
    """Return the shape.

    Raises:
        ScenarioError: if its rings cross, or it has no area.
    """
    try:
        import shapely
    except ImportError:
        return shape  # the frame needs shapely as well, and says so
    polygon = shapely.Polygon(shape.parts[0], shape.parts[1:])
    if not polygon.is_valid or polygon.area == 0.0:
        reason = shapely.is_valid_reason(polygon)
        raise ScenarioError(f"{shape.name}: expected a polygon whose edges do not cross: {reason}")
    return shape


def _refused(given: object) -> SettingError:
    return SettingError(
        f"workspace: expected {BOX}, corners of shape (k, 2), or a GeoJSON file with one polygon, "
        f"got {shown(given)}"
    )


def _bounds(obstacle: Obstacle) -> Box:
    if isinstance(obstacle, Circle):
        x, y, radius = obstacle.x, obstacle.y, obstacle.radius
        return x - radius, y - radius, x + radius, y + radius
    xs, ys = zip(*obstacle.vertices, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def _overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
