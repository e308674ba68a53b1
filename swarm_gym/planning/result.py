"""The result of planning: a free path, and the paths that were the shortest one before it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.alternatives import Alternative
from swarm_gym.planning.curve import Curve
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
        length: length of the path, in units of the map file, or metres for longitude and latitude.
        clearance: least distance of the path from an obstacle, in map units; infinite without obstacles, and
            NaN where it is unknown, as when a `Planner` runs out of time.
        evaluations: evaluations of the optimizer and of final repairs.
        seconds: time that planning took, without the time of `gap`.
        gap: length above the exact shortest path with the same distance from obstacles, as a share of that;
            None where it is unknown.
        found_by: "exact planner"; "wishes" for the least sum of wishes that was found; "previous corridor" if
            the best path in another corridor is not better by the margin; "swarm"; "guide" if nothing was
            shorter than the path of A*, pulled tight, around which a swarm begins on a grid map; "previous
            path" if nothing was shorter than that path after its repair; the last three with " and planner"
            if pieces of the path were planned again; "curve search" for a curve with a turning radius.
        stopped: whether Ctrl-C, a `Planner`'s time limit or its cancelling ended planning.
        improvements: the paths that were the best one in turn, the last of which is `path`.
        projection: projection from longitude and latitude to metres; None for coordinates in a plane.
        costs: length, the integral of each wish and their sum, by name; the length alone without wishes.
        switched: whether an obstacle lies between the path and the previous one; None without one.
        alternatives: paths of which no two lead through the same corridor, this one first; empty unless more
            than one was asked for.
        curve: the path as a curve that can be driven; None without a turning radius.
        undrivable: paths that turn on the spot, (k, 2) each, through corridors in which no curve was found
            for `alternatives`; empty without a turning radius.
        reference: member "crs" of a GeoJSON file, which names its coordinates; None without one.
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
    costs: Mapping[str, float] = field(default_factory=dict)
    switched: bool | None = None
    alternatives: tuple[Alternative, ...] = ()
    curve: Curve | None = None
    undrivable: tuple[Floats, ...] = ()
    reference: object = None

    @property
    def path_on_map(self) -> Floats:
        """The path in map units, (k, 2): `path` itself, or in metres for longitude and latitude."""
        return self.on_map(self.path)

    def on_map(self, path: Floats) -> Floats:
        """Return a path in the coordinates of the map's file in map units, both (k, 2)."""
        return path if self.projection is None else self.projection.to_metres(path)
