"""The interface of problems on maps, which can begin again where a robot has arrived."""

from abc import abstractmethod
from dataclasses import replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem.geometry.traversal import path_is_free
from swarm_gym.problem.problem import Problem
from swarm_gym.scenarios import GridScenario, MapScenario, Point

Floats = NDArray[np.float64]


class MapProblem(Problem):
    """Find a path of least fitness on a map.

    Attributes:
        scenario: the map and the task.
        ways: (K, dimension) the paths that smooth new members lie next to; None is the straight line.
    """

    scenario: MapScenario
    ways: Floats | None = None

    @property
    @abstractmethod
    def collision_bound_anywhere(self) -> float:
        """An upper bound of the degree of collision for any start on the map, in map units."""

    @abstractmethod
    def begun_at(self, start: Point) -> Self:
        """Return the same problem from another start.

        Raises:
            ScenarioError: if the start lies in an obstacle or a blocked cell, or is the target.
        """

    @abstractmethod
    def carried_over(self, vectors: Floats, before: Problem) -> Floats:
        """Return decision vectors for those, (m, dimension), of the same problem from another start."""

    @abstractmethod
    def is_clear(self, path: Floats) -> bool:
        """Return, exactly, whether a polyline, (k, 2) in map coordinates, enters nothing blocked."""


class GridMapProblem(MapProblem):
    """A problem on a grid map; a dataclass."""

    scenario: GridScenario

    def begun_at(self, start: Point) -> Self:
        """Return the same problem from another start."""
        return replace(self, scenario=replace(self.scenario, start=start))  # type: ignore[type-var]

    def is_clear(self, path: Floats) -> bool:
        """Return whether a polyline enters no blocked cell and stays on the map."""
        grid = self.scenario.map
        return bool(path_is_free(grid.blocked, grid.to_cells(path)))
