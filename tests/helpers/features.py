"""GeoJSON files for tests, and what is blocked on the maps that are made of them."""

import json
import math

import numpy as np
import shapely

from helpers.shapes import shape
from swarm_gym.planning.feature_map import read_feature_map
from swarm_gym.planning.workspace import read_workspace

BOX = [[2, -1], [3, -1], [3, 1], [2, 1], [2, -1]]


def feature(kind, coordinates, **members):
    """Return a feature with a geometry of this type."""
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "properties": {}, "geometry": geometry, **members}


def collection(*features, **members):
    """Return a collection of features."""
    return {"type": "FeatureCollection", "features": list(features), **members}


def written(folder, content, name="map.geojson"):
    """Return the path of a new file with this content, an object or text."""
    path = folder / name
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def read(folder, content, start=(-50.0, -50.0), goal=(50.0, 50.0), margin=0.0, workspace=None, kind=None):
    """Return the scenario that a file with this content is made into."""
    area = None if workspace is None else read_workspace(workspace)
    return read_feature_map(written(folder, content), start, goal, margin, area, kind)[0]


def blocked(scenario):
    """Return everything that is blocked as one shape."""
    return shapely.union_all([shape(obstacle) for obstacle in scenario.obstacles])


def random_area(rng):
    """Return random polygons with holes, aligned or not, that touch themselves now and then."""
    area = shapely.union_all([_blob(rng) for _ in range(rng.integers(2, 7))])
    for _ in range(rng.integers(0, 5)):
        area = area.difference(_blob(rng, 0.4))
    area = shapely.transform(area, rng.choice([_same, _turned]))
    return [one for one in shapely.get_parts(area) if one.geom_type == "Polygon" and one.area > 1e-6]


def _blob(rng, size=1.0):
    x, y = rng.uniform(0.0, 10.0, 2)
    if rng.random() < 0.5:
        x, y, (width, height) = round(x), round(y), size * rng.integers(1, 5, 2)
        return shapely.box(x, y, x + width, y + height)
    angles = np.sort(rng.uniform(0.0, math.tau, rng.integers(3, 9)))
    radii = size * rng.uniform(0.5, 4.0, len(angles))
    return shapely.Polygon(
        np.stack([x + radii * np.cos(angles), y + radii * np.sin(angles)], axis=-1)
    ).buffer(0.0)


def _same(points):
    return points


def _turned(points):
    return points @ np.array([[0.8, 0.6], [-0.6, 0.8]])
