"""A path-planning task on an occupancy grid; checked when it is made."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from swarm_gym.errors import NoPathError, ScenarioError, shown
from swarm_gym.scenarios.graded_map import GradedMap
from swarm_gym.scenarios.grid_map import Cell, GridMap
from swarm_gym.scenarios.obstacles import Point, require_point

# Number of cells that pictures show around the cells that can be reached.
SURROUNDINGS = 3


@dataclass(frozen=True)
class GridScenario:
    """The task to find a path from a start to a target on a grid map, both in map coordinates.

    Attributes:
        name: name under which results are filed.
        map: the grid.
        start: (x, y) where the robot is, in a free cell.
        target: (x, y) where it has to go, in a free cell; there is a path that does not cut corners.
        ground: the map with its costs of ground; None if it has none.

    Raises:
        ScenarioError: if the task is malformed; the message names the map, the point and its cell.
    """

    name: str
    map: GridMap
    start: Point
    target: Point
    ground: GradedMap | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.map, GridMap):
            raise ScenarioError(f"scenario {shown(self.name)}: map must be a GridMap, got {self.map!r}")
        if self.ground is not None and (
            not isinstance(self.ground, GradedMap) or self.ground.grid != self.map
        ):
            raise ScenarioError(
                f"{self._where()}: ground must be a GradedMap of this map, got {shown(self.ground)}"
            )
        cells = {role: self._check(role) for role in ("start", "target")}
        if self.start == self.target:
            raise ScenarioError(
                f"{self._where()}: start and target must be different points, both are {self.start}"
            )
        (from_column, from_row), (to_column, to_row) = cells.values()
        components = self.map.components
        if components[from_row, from_column] != components[to_row, to_column]:
            raise NoPathError(
                f"{self._where()}: no path leads from start {self.start} in cell {cells['start']} to target "
                f"{self.target} in cell {cells['target']}"
            )

    def on(self, grid: GridMap) -> "GridScenario":
        """Return the task on another map of the place; costs of ground stay where they are.

        Args:
            grid: the map; its cells are those of this one, or parts of them.

        Raises:
            ScenarioError: if an end is not free there.
            NoPathError: if blocked cells separate the ends.
        """
        return replace(self, map=grid, ground=self.ground and self.ground.on(grid))

    @property
    def y_up(self) -> bool:
        """True if y grows upwards in pictures."""
        return self.map.y_up

    @property
    def straight_line(self) -> float:
        """Distance from start to target in map units: no path is shorter."""
        return math.hypot(self.target[0] - self.start[0], self.target[1] - self.start[1])

    @property
    def workspace(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max) of the map, in map units."""
        return self.map.extent

    @cached_property
    def window(self) -> tuple[slice, slice]:
        """Rows and columns of the map that pictures show: all cells that can be reached, and a margin."""
        column, row = self.map.cell_of(self.start)
        reached = self.map.components == self.map.components[row, column]
        ranges = []
        for axis, length in ((1, self.map.height), (0, self.map.width)):
            found = np.flatnonzero(reached.any(axis=axis))
            ranges.append(slice(max(found[0] - SURROUNDINGS, 0), min(found[-1] + SURROUNDINGS + 1, length)))
        return ranges[0], ranges[1]

    @property
    def view(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max) of the window, in map units."""
        rows, columns = self.window
        ends = self.map.to_map(
            [(columns.start - 0.5, rows.start - 0.5), (columns.stop - 0.5, rows.stop - 0.5)]
        )
        (x_min, y_min), (x_max, y_max) = ends.min(axis=0).tolist(), ends.max(axis=0).tolist()
        return x_min, y_min, x_max, y_max

    def _check(self, role: str) -> Cell:
        """Return the cell of start or target, whose coordinates are stored as floats."""
        x, y = require_point(self._where(), role, getattr(self, role))
        object.__setattr__(self, role, (x, y))
        x_min, y_min, x_max, y_max = self.map.extent
        if not (x_min <= x <= x_max and y_min <= y <= y_max):
            raise ScenarioError(
                f"{self._where()}: {role} {(x, y)} lies outside the map, whose extent is {self.map.extent}"
            )
        cell = self.map.cell_of((x, y))
        if not self.map.is_free(cell):
            raise ScenarioError(
                f"{self._where()}: {role} {(x, y)} lies in cell {cell}, which is not free; choose a free cell"
            )
        return cell

    def _where(self) -> str:
        return f"scenario {shown(self.name)} on map {self.map.name!r}"
