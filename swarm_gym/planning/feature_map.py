"""Maps of features: a GeoJSON file with start, goal and workspace as a scenario, in metres for degrees."""

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.planning.geojson import Shape, read_features
from swarm_gym.planning.shapes import End, extent_of, obstacles_of, thinnest
from swarm_gym.planning.workspace import RobotWorkspace, confined
from swarm_gym.scenarios import Point, Scenario
from swarm_gym.scenarios.formats.geographic import (
    GEOGRAPHIC,
    PLANE,
    Projection,
    look_geographic,
    named_by,
    projection_for,
)
from swarm_gym.scenarios.obstacles import require_point

Floats = NDArray[np.float64]

MARGIN = 0.1  # of the extent of obstacles and ends, around them where no workspace is given


def read_feature_map(
    path: Path,
    start: Point,
    goal: Point,
    margin: float,
    workspace: RobotWorkspace | None,
    coordinates: str | None,
) -> tuple[Scenario, Projection | None, object]:
    """Return the task among the features of a file.

    Features without a geometry are left out, with one warning.

    Args:
        path: GeoJSON file.
        start: (x, y) in the coordinates of the file.
        goal: (x, y) in the coordinates of the file.
        margin: distance that the robot keeps from obstacles, in map units.
        workspace: polygon that the robot stays in, in the coordinates of the file; None for no limit.
        coordinates: kind of the coordinates, see `COORDINATES`; None takes what the file names.

    Returns:
        The scenario in map units, the projection that brought it there, None if the file is in map units, and
        the member "crs" of the file, None without one.

    Raises:
        ScenarioError: if the file is malformed, or an end lies in a feature, too close to it, or outside the
            workspace; the message names the feature.
        MissingExtraError: if shapely or pyproj is missing and the file needs it.
    """
    features = read_features(path)
    left_out = features.left_out()
    if left_out is not None:
        warnings.warn(left_out, stacklevel=2)
    if not features.shapes and workspace is None:
        raise ScenarioError(f"{path}: expected at least one polygon, line or point, got none")
    shapes = [*features.shapes, *([] if workspace is None else [workspace.shape])]
    given = [require_point(str(path), name, end) for name, end in (("start", start), ("goal", goal))]
    points = np.array([*given, *(point for shape in shapes for part in shape.parts for point in part)])
    kind = _kind(features.path, features.reference, workspace, points, coordinates)
    projection = projection_for(str(path), points) if kind == GEOGRAPHIC else None
    if projection is not None:
        points = projection.to_metres(points)
        shapes = [_moved(shape, projection.to_metres) for shape in shapes]
    ends: list[Point] = [(x, y) for x, y in points[:2].tolist()]
    area = None if workspace is None else shapes.pop()
    extent, half_width = extent_of(points), thinnest(points)
    for end in map(End, ("start", "goal"), ends, given):
        for shape in shapes:
            end.require_outside(shape, half_width, margin)
        if area is not None:
            end.require_within(area, half_width, margin)
    obstacles = tuple(one for shape in shapes for one in obstacles_of(shape, extent, half_width))
    low, high = points.min(axis=0) - MARGIN * extent, points.max(axis=0) + MARGIN * extent
    scenario = Scenario(path.stem, ends[0], ends[1], obstacles, (*low.tolist(), *high.tolist()))
    if area is not None:
        scenario = confined(scenario, area)
    return scenario, projection, features.reference


def _kind(
    path: Path, reference: object, workspace: RobotWorkspace | None, points: Floats, coordinates: str | None
) -> str:
    """Return the kind of the coordinates: what the user says, else what the file names, else a plane."""
    if coordinates is not None:
        return coordinates
    named = named_by(str(path), reference)
    if workspace is not None and workspace.reference is not None:
        of_workspace = named_by(workspace.shape.name, workspace.reference)
        if of_workspace != (named or PLANE):
            raise ScenarioError(
                f"{workspace.shape.name} has coordinates {of_workspace!r}, and {path} {named or PLANE!r}; "
                "expected the same, or choose coordinates for both"
            )
    if named is None and look_geographic(points):
        warnings.warn(
            f"{path}: the coordinates look like longitude and latitude, but are taken as x and y in one "
            f"unit; choose coordinates {GEOGRAPHIC!r} to plan in metres, or {PLANE!r} to silence this",
            stacklevel=3,
        )
    return named or PLANE


def _moved(shape: Shape, mapped: Callable[[Floats], Floats]) -> Shape:
    """Return the shape with all its points mapped."""
    parts = tuple(tuple(map(tuple, mapped(np.array(part)).tolist())) for part in shape.parts)
    return shape._replace(parts=parts)
