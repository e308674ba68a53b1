"""Maps as GeoJSON: polygons are obstacles. Coordinates are taken as they are, as x and y in one unit.

Source: H. Butler et al., "The GeoJSON format", RFC 7946 (2016).
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from swarm_gym.errors import MissingExtraError, ScenarioError, shown
from swarm_gym.scenarios import Point, Polygon, Scenario
from swarm_gym.scenarios.formats.data_files import open_file

MAX_FILE = 2**24  # bytes
MARGIN = 0.1  # of the extent of obstacles and ends, around them in the workspace


def read_geojson(path: Path, start: Point, goal: Point) -> Scenario:
    """Return the task among the polygons of a file; what is no polygon, such as a point, is left out.

    Polygons with holes are obstacles as a whole. Those that are not convex are cut into triangles.

    Raises:
        ScenarioError: if the file cannot be read, is no GeoJSON, or has no polygon.
        MissingExtraError: if a polygon is not convex and shapely is missing.
    """
    try:
        with open_file(path) as file:
            content = file.read(MAX_FILE + 1)
        if len(content) > MAX_FILE:
            raise ScenarioError(f"{path}: expected at most {MAX_FILE} bytes, the file has more")
        rings = list(_rings(path, json.loads(content)))
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    except (ValueError, RecursionError) as error:
        if isinstance(error, ScenarioError):
            raise
        raise ScenarioError(f"{path}: expected GeoJSON: {error}") from error
    if not rings:
        raise ScenarioError(f"{path}: expected at least one polygon, got none")
    points = np.vstack([*rings, [start, goal]])
    low, high = points.min(axis=0), points.max(axis=0)
    around = MARGIN * (high - low).max()
    obstacles = tuple(part for k, ring in enumerate(rings) for part in _parts(path, k, ring))
    workspace = (*(low - around).tolist(), *(high + around).tolist())
    return Scenario(path.stem, start, goal, obstacles, workspace)


def _rings(path: Path, found: Any) -> Iterator[np.ndarray]:
    """Yield the outer rings of all polygons, (k, 2), without the last point, which repeats the first."""
    if not isinstance(found, dict) or "type" not in found:
        raise ScenarioError(f"{path}: expected GeoJSON objects with a type, got {shown(found)}")
    kind = found["type"]
    if kind == "FeatureCollection":
        for feature in found.get("features", ()):
            yield from _rings(path, feature)
    elif kind == "Feature" and found.get("geometry") is not None:
        yield from _rings(path, found["geometry"])
    elif kind == "GeometryCollection":
        for geometry in found.get("geometries", ()):
            yield from _rings(path, geometry)
    elif kind in ("Polygon", "MultiPolygon"):
        coordinates: Any = found.get("coordinates", ())
        for polygon in [coordinates] if kind == "Polygon" else coordinates:
            try:
                ring = np.array([[float(x) for x in point[:2]] for point in polygon[0]])
            except (TypeError, ValueError, LookupError) as error:
                raise ScenarioError(
                    f"{path}: expected rings of points [x, y], got {shown(polygon)}"
                ) from error
            if ring.shape[0] < 4 or ring.shape[1:] != (2,) or not np.isfinite(ring).all():
                raise ScenarioError(f"{path}: a ring needs at least 4 points [x, y], got {shown(polygon[0])}")
            yield ring[:-1] if (ring[0] == ring[-1]).all() else ring


def _parts(path: Path, number: int, ring: np.ndarray) -> list[Polygon]:
    """Return a ring as convex polygons."""
    try:
        return [Polygon(tuple(map(tuple, ring.tolist())))]
    except ScenarioError:
        pass
    try:
        import shapely
    except ImportError as error:
        raise MissingExtraError(
            f"polygon {number} of {path}, which is not convex", "shapely", "maps"
        ) from error
    area = shapely.make_valid(shapely.Polygon(ring))
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(area))
    return [Polygon(tuple(map(tuple, np.array(one.exterior.coords)[:3].tolist()))) for one in triangles]
