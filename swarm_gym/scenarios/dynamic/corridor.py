"""The shortest way on a lattice around obstacles: which corridor an obstacle closes, and whether any is left.

The lattice spans the workspace along the line from start to target, which is horizontal. A way goes from
column to column, and to the same row or one of the two next to it. All numbers that are compared are integers
or square roots of them, so a way is the same on every machine.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios.obstacles import Circle, Obstacle
from swarm_gym.scenarios.scenario import Scenario

ALONG, ACROSS = 5, 10  # distances between columns and between rows, in map units
# A way keeps more than half of an edge away from obstacles, so that whole edges are free.
MARGIN = 6.0
_FLAT, _STEEP = float(ALONG), float(np.sqrt(ALONG**2 + ACROSS**2))

Floats = NDArray[np.float64]


def shortest_way(scenario: Scenario, obstacles: list[Obstacle]) -> Floats | None:
    """Return the points (k, 2) of the shortest way on the lattice, or None if every way is closed.

    Args:
        scenario: a task whose line from start to target is horizontal.
        obstacles: obstacles to keep away from: circles, and rectangles whose sides are parallel to the axes.
    """
    points = _lattice(scenario)
    closed = np.zeros(points.shape[:2], dtype=np.bool_)
    for obstacle in obstacles:
        closed |= covered(points, obstacle, MARGIN)
    height = points[0, :, 1]
    line = int(np.argmin(abs(height - scenario.start[1])))
    length = np.full(len(height), np.inf)
    length[line] = 0.0
    origin = np.zeros(closed.shape, dtype=np.int64)
    for column in range(1, len(points)):
        # From the row below, the same row, the row above.
        reached = np.stack(
            [np.append(np.inf, length[:-1]) + _STEEP, length + _FLAT, np.append(length[1:], np.inf) + _STEEP]
        )
        origin[column] = np.argmin(reached, axis=0) - 1
        length = np.where(closed[column], np.inf, reached.min(axis=0))
    if np.isinf(length[line]):
        return None
    rows = [line]
    for column in range(len(points) - 1, 0, -1):
        rows.append(rows[-1] + origin[column, rows[-1]])
    return points[np.arange(len(points)), rows[::-1]]


def covered(points: Floats, obstacle: Obstacle, margin: float) -> NDArray[np.bool_]:
    """Return which points (..., 2) lie in an obstacle or at most a margin away from it.

    A rectangle with a margin is a larger rectangle: its corners are not rounded.
    """
    if isinstance(obstacle, Circle):
        squares = (points - (obstacle.x, obstacle.y)) ** 2
        return squares.sum(axis=-1) <= (obstacle.radius + margin) ** 2
    low, high = corners(obstacle)
    inside = (low - margin <= points) & (points <= high + margin)
    return inside[..., 0] & inside[..., 1]


def corners(obstacle: Obstacle) -> tuple[Floats, Floats]:
    """Return the lower and the upper corner, (2,) each, of the box that an obstacle fits in."""
    if isinstance(obstacle, Circle):
        centre = np.array([obstacle.x, obstacle.y], dtype=np.float64)
        return centre - obstacle.radius, centre + obstacle.radius
    vertices = np.array(obstacle.vertices)
    return vertices.min(axis=0), vertices.max(axis=0)


def _lattice(scenario: Scenario) -> Floats:
    """Return the points of the lattice, (columns, rows, 2), start and target among them."""
    _, bottom, _, top = scenario.workspace
    x = np.arange(scenario.start[0], scenario.target[0] + ALONG / 2, ALONG)
    below, above = int((scenario.start[1] - bottom) // ACROSS), int((top - scenario.start[1]) // ACROSS)
    y = scenario.start[1] + ACROSS * np.arange(-below, above + 1)
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).astype(np.float64)
