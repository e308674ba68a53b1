"""A previous path: the path that was valid before the map changed, from which planning goes on."""

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.errors import SettingError
from swarm_gym.planning.curve import COLUMNS
from swarm_gym.planning.tasks import Task

Floats = NDArray[np.float64]

HEADS = ("x,y", ",".join(COLUMNS))  # of CSV files of polylines and of curves
SAME = 1e-6  # how far ends may be from start and goal, as a share of the distance between these


def require_previous(path: ArrayLike, task: Task, *, underway: bool = False) -> Floats:
    """Return a previous path as an array, (k, 2), in map units.

    Args:
        path: points from start to goal, (k, 2), in the user's coordinates.
        task: task on the map as it is now.
        underway: whether the robot has left the start of the path: the rest from the task's start counts.

    Raises:
        SettingError: if it has another shape, numbers that are not finite, or other ends.
    """
    try:
        points = np.array(path, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SettingError(f"previous: expected points of shape (k, 2), got {path!r:.80}") from error
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2:
        raise SettingError(f"previous: expected at least two points, shape (k, 2), got shape {points.shape}")
    if not np.isfinite(points).all():
        raise SettingError(f"previous: expected finite numbers, got {points[~np.isfinite(points)][0]}")
    on_map = task.on_map(points)
    if not np.isfinite(on_map).all():
        raise SettingError(f"previous: expected longitudes and latitudes, got {points.tolist()!r:.80}")
    if underway:  # in metres: degrees of longitude are shorter than those of latitude
        on_map = rest_of(on_map, task.given.start)
    limit = SAME * task.given.straight_line
    for index, verb, end, expected in (
        (0, "starts", task.given.start, task.start),
        (-1, "ends", task.given.target, task.goal),
    ):
        if not np.hypot(*(on_map[index] - end)) <= limit:
            x, y = points[index].tolist()
            raise SettingError(f"previous: expected a path that {verb} at {expected}, got {(x, y)}")
        on_map[index] = end
    return on_map


def rest_of(path: Floats, start: tuple[float, float]) -> Floats:
    """Return the rest of a path, (k, 2), for a robot off it, which first goes to the nearest point of it.

    Args:
        path: points from a former start to the goal.
        start: place of the robot.
    """
    points = np.asarray(path, dtype=np.float64)
    begins, changes = points[:-1], np.diff(points, axis=0)
    squares = (changes**2).sum(axis=1)
    along = ((np.asarray(start) - begins) * changes).sum(axis=1)
    share = np.clip(np.divide(along, squares, out=np.zeros_like(along), where=squares > 0.0), 0.0, 1.0)
    feet = begins + share[:, None] * changes
    k = int(np.argmin(np.hypot(*(feet - start).T)))
    rest = np.vstack([start, feet[k : k + 1], points[k + 1 :]])
    is_new = np.append(True, (np.diff(rest[:-1], axis=0) != 0.0).any(axis=1))
    return np.vstack([rest[:-1][is_new & (rest[:-1] != rest[-1]).any(axis=1)], rest[-1]])


def read_previous(file: Path) -> Floats:
    """Return the path of a CSV file with columns x and y, (k, 2), as `--output path.csv` writes it.

    Further columns, which curves have, are left out.

    Raises:
        SettingError: if the file is missing or has other content.
    """
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise SettingError(f"previous: {file} cannot be read: {error}") from error
    if not lines or lines[0].strip() not in HEADS:
        first = lines[0] if lines else ""
        raise SettingError(f"previous: {file}, line 1: expected x,y, got {first!r:.80}")
    columns = lines[0].count(",") + 1
    points: list[tuple[float, float]] = []
    for number, line in enumerate(lines[1:], 2):
        try:
            x, y = list(map(float, line.split(",", columns - 1)))[:2]
        except ValueError as error:
            raise SettingError(f"previous: {file}, line {number}: expected x,y, got {line!r:.80}") from error
        points.append((x, y))
    return np.array(points, dtype=np.float64).reshape(-1, 2)
