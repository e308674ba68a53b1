"""The result of planning: a free path, and the paths that were the shortest one before it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios import MapScenario
from swarm_gym.scenarios.formats.geographic import Projection

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Improvement:
    """A free path that was the shortest one when it was found.

    Attributes:
        seconds: time since planning began.
        path: (k, 2) points from start to goal, in the coordinates of the map's file.
        length: length of the path, in map units.
        found_by: origin of the path, see `Plan`.
    """

    seconds: float
    path: Floats
    length: float
    found_by: str


@dataclass(frozen=True)
class Plan:
    """A free path.

    Attributes:
        map: the map as it was given, with start and goal; in metres for longitude and latitude.
        path: (k, 2) points from start to goal, in the coordinates of the map's file.
        length: length of the path, in map units: those of the file, or metres for longitude and latitude.
        clearance: least distance of the path from an obstacle, in map units; infinite without obstacles.
        evaluations: evaluations of the optimizer, and those of final repairs.
        seconds: time that planning took, without that of `gap`.
        gap: length above the exact shortest path with the same distance from obstacles, as a share of that;
            None where it is unknown.
        found_by: "exact planner"; "swarm"; "guide" if nothing was shorter than the path of A*, pulled tight,
            around which a swarm begins on a grid map; "previous path" if nothing was shorter than that path
            after its repair; the last three with " and planner" if pieces of the path were planned anew.
        stopped: whether Ctrl-C ended planning.
        improvements: the paths that were the shortest one in turn, the last of which is `path`.
        projection: projection from longitude and latitude to metres; None for coordinates in a plane.
    """

    map: MapScenario
    path: Floats
    length: float
    clearance: float
    evaluations: int
    seconds: float
    gap: float | None
    found_by: str
    stopped: bool = False
    improvements: tuple[Improvement, ...] = ()
    projection: Projection | None = None

    @property
    def path_on_map(self) -> Floats:
        """The path in map units, (k, 2): that of `path`, or in metres for longitude and latitude."""
        return self.path if self.projection is None else self.projection.to_metres(self.path)
