"""The check of driven curves by other code than the planners': poses a millimetre apart, and shapely."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from numpy.typing import NDArray

from experiments.planners.drive_tasks import DriveTask
from swarm_gym.scenarios import GridMap

Floats = NDArray[np.float64]

STEP = 0.001  # between poses, in map units: a millimetre where these are metres
TOUCHING = 1e-6  # how much closer than its radius a robot may come, in cells
SHORT = 1e-5  # a chord that is left out: its direction is little known
BENDING = 1e-3  # share by which curvature may be above the limit, for rounding
TURNED = 2e-3  # how far headings may be off, in radians
CHUNK = 256  # poses whose pieces are looked up at once


@dataclass(frozen=True)
class DriveVerdict:
    """The result of the check.

    Attributes:
        broken: limit that the curve breaks: "ends", "curvature", "distance"; empty if it obeys all.
        length: length of the sampled curve, in map units.
        clearance: least distance of the robot's centre from blocked cells, in map units.
    """

    broken: str
    length: float
    clearance: float


def check(task: DriveTask, poses: Floats) -> DriveVerdict:
    """Return whether sampled poses, (n, 3) with headings in radians, obey all limits of a task.

    The curvature is that of the points alone: the angle between neighbouring chords, over their mean length.
    The robot only drives forwards.
    """
    chords = np.diff(poses[:, :2], axis=0)
    lengths = np.hypot(*chords.T)
    kept = lengths > SHORT
    chords, lengths = chords[kept], lengths[kept]
    length, clearance = float(lengths.sum()), _clearance(task.scenario.map, poses[:, :2])
    angles = np.arctan2(chords[:, 1], chords[:, 0])
    turns = np.abs(_wrapped(np.diff(angles)))
    ends = np.array([task.scenario.start, task.scenario.target])
    off = np.abs(_wrapped(angles[[0, -1]] - np.radians(task.headings)))
    most = (1.0 + BENDING) / task.turning_radius
    is_at_ends = np.allclose(poses[[0, -1], :2], ends, atol=1e-6 * task.scenario.map.resolution)
    broken = ""
    if not is_at_ends or (off > TURNED + STEP / task.turning_radius).any() or lengths.max() > 1.01 * STEP:
        broken = "ends"
    elif (turns > most * (0.5 * (lengths[1:] + lengths[:-1]) + SHORT) + 1e-7).any():
        broken = "curvature"
    elif clearance < task.radius - TOUCHING * task.scenario.map.resolution:
        broken = "distance"
    return DriveVerdict(broken, length, clearance)


def _wrapped(angles: Floats) -> Floats:
    """Return angles in [-pi, pi)."""
    return np.asarray((angles + math.pi) % math.tau - math.pi)


def _clearance(grid: GridMap, points: Floats) -> float:
    """Return the least distance of a polyline from blocked cells, in map units; infinite without any."""
    cells = grid.to_cells(points)
    begins = range(0, len(cells) - 1, CHUNK)
    lines = [shapely.LineString(cells[k : k + CHUNK + 1]) for k in begins]
    _, apart = _blocked(grid).query_nearest(lines, return_distance=True)
    return float(apart.min(initial=math.inf)) * grid.resolution


@lru_cache(maxsize=4)
def _blocked(grid: GridMap) -> shapely.STRtree:
    """Return the blocked cells as squares, in cells."""
    rows, columns = np.nonzero(grid.blocked)
    return shapely.STRtree(shapely.box(columns - 0.5, rows - 0.5, columns + 0.5, rows + 0.5))
