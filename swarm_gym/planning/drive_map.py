"""Drive maps: the map of a task as searches for drivable curves read it, with coordinates of its own."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.planning.curve import Curve
from swarm_gym.planning.curves.field import REACH, SLACK, Field, Integers, entries_of, nearest
from swarm_gym.planning.tasks import Task
from swarm_gym.problem.grid.nearness import nearness
from swarm_gym.scenarios import Circle, GridMap, GridScenario, Scenario

Floats = NDArray[np.float64]

MOST_NODES = 2**18  # of the lattice
FEWEST = 192  # steps of the lattice along the longer side of a map of circles and polygons
WIDTH = 0.01  # of half a wall, in steps of the lattice; guides would step through thinner ones
AROUND = 4.0  # turning radii around the obstacles of such a map in which curves may lie


class Lattice(NamedTuple):
    """Obstacles on a lattice; attributes as in `Field`, in steps of the lattice."""

    capsules: Floats
    first: Integers
    entries: NDArray[np.int32]
    apart: Floats
    about: Floats
    "Distance of each node from obstacles, which is no bound, (rows, columns)."


@dataclass(frozen=True, eq=False)
class DriveMap:
    """A task's obstacles and costs on a lattice.

    Attributes:
        task: the task.
        radius: least turning radius, in map units.
        weights: weights of ground and distance.
    """

    task: Task
    radius: float
    weights: Mapping[str, float]

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        """Least x and y and largest x and y of the robot's centre, in map units."""
        given = self.task.given
        if isinstance(given, GridScenario):
            return given.map.extent
        points = [given.start, given.target]
        for one in given.obstacles:
            if isinstance(one, Circle):
                points += [(one.x - one.radius, one.y - one.radius), (one.x + one.radius, one.y + one.radius)]
            else:
                points += one.vertices
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        around = 2.0 * self.task.margin + AROUND * self.radius + 0.05 * float((high - low).max())
        (x_min, y_min), (x_max, y_max) = (low - around).tolist(), (high + around).tolist()
        return x_min, y_min, x_max, y_max

    @cached_property
    def unit(self) -> float:
        """Distance of neighbouring nodes of the lattice, in map units."""
        x_min, y_min, x_max, y_max = self.box
        width, height = x_max - x_min, y_max - y_min
        fewest = math.sqrt(width * height / MOST_NODES)
        if isinstance(self.task.given, GridScenario):
            cell = self.task.given.map.resolution
            return cell * (1 if fewest <= cell else 2 * math.ceil((fewest / cell - 1.0) / 2.0) + 1)
        return max(fewest, min(max(width, height) / FEWEST, max(self.radius / 4.0, self.task.margin / 2.0)))

    @cached_property
    def corner(self) -> Floats:
        """Place of the node (0, 0), in map units, (2,)."""
        half = self.task.given.map.resolution / 2.0 if isinstance(self.task.given, GridScenario) else 0.0
        return np.array(self.box[:2]) + half

    def to_nodes(self, points: ArrayLike) -> Floats:
        """Return lattice coordinates of points in map units, both (..., 2)."""
        return (np.asarray(points, dtype=np.float64) - self.corner) / self.unit

    def to_map(self, points: ArrayLike) -> Floats:
        """Return points in map units of lattice coordinates, both (..., 2)."""
        return np.asarray(points, dtype=np.float64) * self.unit + self.corner

    @property
    def slack(self) -> float:
        """Distance that curves keep from obstacles besides the margin, in map units."""
        return SLACK * self.unit

    @property
    def decay(self) -> float:
        """Distance within which the cost of nearness falls to 1 / e on a map of circles and polygons."""
        return max(self.task.margin, self.radius)

    @cached_property
    def lattice(self) -> Lattice:
        """The obstacles on the lattice."""
        columns, rows = (np.floor(self.to_nodes(self.box[2:]) + 0.5).astype(np.int64) + 1).tolist()
        reach = self.task.margin / self.unit + REACH
        if isinstance(self.task.given, GridScenario):
            return _lattice_of_cells(self.task.given.map, self.unit, rows, columns, reach)
        return _lattice_of(self._outlines(), rows, columns, reach)

    @cached_property
    def field(self) -> Field:
        """The obstacles and costs for kernels."""
        capsules, first, entries, apart, _ = self.lattice
        low, high = self.to_nodes(np.reshape(self.box, (2, 2)))
        ends = self.to_nodes([self.task.given.start, self.task.given.target])
        # Between two steps of a test the centre may go over the border by the slack.
        region = np.append(
            np.minimum(low + SLACK, ends.min(axis=0)), np.maximum(high - SLACK, ends.max(axis=0))
        )
        cost = self._costs()
        margin = self.task.margin / self.unit
        is_even = bool((cost == 1.0).all())
        return Field(capsules, first, entries, apart, cost, region, margin, margin + REACH, is_even)

    def walled(self, walls: Floats) -> Field:
        """Return the field with walls that the robot's centre does not cross.

        Walls have hardly any width, no margin, and no cost of nearness. The margin of obstacles is a little
        above 0, since guides step through edges that are as far from two nodes as these are apart.

        Args:
            walls: ends of each wall, (m, 4), in map units.
        """
        field = self.field
        if not len(walls):
            return field
        (rows, columns), margin = field.apart.shape, max(field.margin, WIDTH)
        reach = margin + REACH
        ends = self.to_nodes(walls.reshape(-1, 2)).reshape(-1, 4)
        thin = np.column_stack([ends, np.full(len(walls), WIDTH)])
        apart = np.minimum(field.apart, _lattice_of(thin, rows, columns, REACH).apart + margin)
        thin[:, 4] -= margin  # so the margin of the field ends at the wall itself
        capsules = np.vstack([field.capsules, thin])
        first, entries, _ = entries_of(capsules, rows, columns, reach)
        return field._replace(
            capsules=capsules, first=first, entries=entries, apart=apart, margin=margin, reach=reach
        )

    def path_of(self, curve: Curve) -> Floats:
        """Return the points of a curve of the task in map units, (k, 2), with exact ends."""
        path = curve.poses[:, :2].copy()
        path[0], path[-1] = self.task.given.start, self.task.given.target
        return path

    def nearness_at(self, points: Floats) -> Floats:
        """Return the cost of nearness at points in map units, (n, 2)."""
        given = self.task.given
        if isinstance(given, GridScenario):
            return _values_at(given.map, nearness(given.map, self.task.margin), points)
        apart = nearest(self.lattice.capsules, self.to_nodes(points)) * self.unit
        return np.asarray(np.exp(-np.maximum(apart - self.task.margin, 0.0) / self.decay))

    def ground_at(self, points: Floats) -> Floats:
        """Return the cost of ground at points in map units, (n, 2)."""
        given = self.task.given
        if self.task.costs is None or not isinstance(given, GridScenario):
            return np.zeros(len(points))
        return _values_at(given.map, self.task.costs, points)

    def _costs(self) -> Floats:
        """Return the cost of a unit of length at each node, (rows, columns)."""
        about, given = self.lattice.about, self.task.given
        cost = np.ones(about.shape)
        nodes = self.to_map(np.stack(np.meshgrid(*map(np.arange, about.shape[::-1])), axis=-1))
        if self.weights["distance"] > 0.0:
            if isinstance(given, GridScenario):
                near = self.nearness_at(nodes)
            else:
                near = np.exp(-np.maximum(about * self.unit - self.task.margin, 0.0) / self.decay)
            cost += self.weights["distance"] * near
        if self.weights["ground"] > 0.0:
            cost += self.weights["ground"] * self.ground_at(nodes.reshape(-1, 2)).reshape(about.shape)
        return cost

    def _outlines(self) -> Floats:
        """Return circles and edges of polygons as capsules, (m, 5)."""
        assert isinstance(self.task.given, Scenario)
        found: list[tuple[float, ...]] = []
        for one in self.task.given.obstacles:
            if isinstance(one, Circle):
                found.append((one.x, one.y, one.x, one.y, one.radius))
            else:
                found += [(*a, *b, 0.0) for a, b in one.edges()]
        capsules = np.array(found, dtype=np.float64).reshape(-1, 5)
        capsules[:, :4] = self.to_nodes(capsules[:, :4].reshape(-1, 2)).reshape(-1, 4)
        capsules[:, 4] /= self.unit
        return capsules


def _values_at(grid: GridMap, values: Floats, points: Floats) -> Floats:
    """Return the values of the cells of points in map units, (..., 2)."""
    cells = np.floor(grid.to_cells(points) + 0.5).astype(np.int64)
    columns, rows = cells[..., 0], cells[..., 1]
    found: Floats = values[np.clip(rows, 0, grid.height - 1), np.clip(columns, 0, grid.width - 1)]
    return found


@lru_cache(maxsize=4)
def _lattice_of_cells(grid: GridMap, unit: float, rows: int, columns: int, reach: float) -> Lattice:
    """Return the lattice of a map of cells."""
    return _lattice_of(_edges_of_cells(grid) * [*4 * [grid.resolution / unit], 1.0], rows, columns, reach)


def _edges_of_cells(grid: GridMap) -> Floats:
    """Return the edges between free and blocked cells as capsules, (m, 5), in cells with y upwards."""
    blocked = grid.blocked[::-1] if grid.y_up else grid.blocked
    found = []
    for is_turned in (False, True):
        cells = blocked.T if is_turned else blocked
        change = np.diff(np.pad(cells[1:] != cells[:-1], ((0, 0), (1, 1))).astype(np.int8), axis=1)
        lines, begins = np.nonzero(change == 1)
        _, ends = np.nonzero(change == -1)
        across, along, onward = lines + 0.5, begins - 0.5, ends - 0.5
        order = (across, along, across, onward) if is_turned else (along, across, onward, across)
        found.append(np.stack([*order, np.zeros(len(lines))], axis=1))
    return np.vstack(found)


def _lattice_of(capsules: Floats, rows: int, columns: int, reach: float) -> Lattice:
    """Return the lattice of capsules in its own coordinates, (m, 5)."""
    from scipy import ndimage

    first, entries, exact = entries_of(capsules, rows, columns, reach)
    near = exact <= 1.0
    if not near.any():  # no obstacle is on the lattice
        far = np.full((rows, columns), reach)
        return Lattice(capsules, first, entries, np.minimum(exact, far), np.minimum(exact, far))
    far, (there_rows, there_columns) = ndimage.distance_transform_edt(~near, return_indices=True)
    is_known = exact < reach
    apart = np.where(is_known, exact, np.maximum(far - 1.0, reach))
    about = np.where(is_known, exact, far + exact[there_rows, there_columns])
    return Lattice(capsules, first, entries, apart, about)
