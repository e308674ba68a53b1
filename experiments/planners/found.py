"""Paths that planners find, with their times, and their validation by other code than the planners'."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from numpy.typing import NDArray

from swarm_gym.scenarios import GridMap, GridScenario

Floats = NDArray[np.float64]

# How far, in cells, a path may enter a blocked cell and still only touch it.
TOUCHING = 1e-6


@dataclass(frozen=True)
class Found:
    """A path that a planner has found.

    Attributes:
        seconds: time since planning began.
        path: (k, 2) points from start to target, in map units.
        of_swarm: whether a swarm found it; None of a planner that has none.
    """

    seconds: float
    path: Floats
    of_swarm: bool | None = None


@dataclass(frozen=True)
class Valid:
    """A path that was found free.

    Attributes:
        seconds: time since planning began.
        length: length, in map units.
        clearance: least distance from a blocked cell, in cells.
        of_swarm: as of `Found`.
    """

    seconds: float
    length: float
    clearance: float
    of_swarm: bool | None


def validate(scenario: GridScenario, found: Found) -> Valid | None:
    """Return the length and clearance of a path by shapely, or None if it is not free or has other ends."""
    ends = np.array([scenario.start, scenario.target])
    path = np.asarray(found.path, dtype=np.float64)
    if not np.allclose(path[[0, -1]], ends, atol=1e-6 * scenario.map.resolution):
        return None
    line = shapely.LineString(scenario.map.to_cells(path))
    if walls(scenario.map, TOUCHING).query(line, predicate="intersects").size:
        return None
    length = line.length * scenario.map.resolution
    clearance = float(walls(scenario.map, 0.0).query_nearest(line, return_distance=True)[1].min())
    return Valid(found.seconds, length, clearance, found.of_swarm)


@lru_cache(maxsize=4)
def walls(grid: GridMap, margin: float) -> shapely.STRtree:
    """Return the blocked cells and a border around the map as squares, smaller by a margin on each side."""
    rows, columns = np.nonzero(np.pad(grid.blocked, 1, constant_values=True))
    half = 0.5 - margin
    return shapely.STRtree(
        shapely.box(columns - 1.0 - half, rows - 1.0 - half, columns - 1.0 + half, rows - 1.0 + half)
    )
