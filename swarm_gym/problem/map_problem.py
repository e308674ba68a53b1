"""What problems on maps offer besides: they can begin where a robot has driven to."""

from abc import abstractmethod

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem.problem import Problem
from swarm_gym.scenarios import MapScenario, Point

Floats = NDArray[np.float64]


class MapProblem(Problem):
    """Find a path of least fitness on a map, given by a whole decision vector.

    Attributes:
        scenario: the map and the task.
    """

    scenario: MapScenario

    @property
    @abstractmethod
    def collision_bound_anywhere(self) -> float:
        """A degree of collision that no path can exceed, wherever on the map it begins, in map units."""

    @abstractmethod
    def begun_at(self, start: Point) -> "MapProblem":
        """The same problem from another start.

        Raises:
            ScenarioError: if that lies in an obstacle or a blocked cell, or is the target.
        """

    @abstractmethod
    def carried_over(self, vectors: Floats, before: Problem) -> Floats:
        """What stands here for decision vectors, (m, dimension), of the same problem from another start."""

    @abstractmethod
    def is_clear(self, path: Floats) -> bool:
        """Whether a polyline, (k, 2) in map coordinates, enters nothing that is in the way, exactly."""
