"""The result of planning a flight: its waypoints, and what it passes at which distance."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios import TerrainScenario
from swarm_gym.scenarios.terrain.survey import Survey

Floats = NDArray[np.float64]


class Passed(NamedTuple):
    """A threat, and how far the flight stays away from it.

    Attributes:
        number: number of the threat, from 0 on.
        distance: least distance from the outside of its cylinder in metres, seen from above; negative where
            the flight passes over it.
    """

    number: int
    distance: float


@dataclass(frozen=True)
class FlightImprovement:
    """A flight that was the shortest one when it was found.

    Attributes:
        seconds: time since planning began.
        waypoints: (k, 3) x, y and height above sea level.
        length: length in metres.
        found_by: origin of the flight, see `Flight`.
    """

    seconds: float
    waypoints: Floats
    length: float
    found_by: str


@dataclass(frozen=True)
class Flight:
    """A flight that keeps to the altitude band, to the limits of turn and climb, and out of all threats.

    Attributes:
        task: the task, and its coordinates.
        waypoints: (k, 3) x, y and height above sea level from start to goal, in metres of the scenario.
        length: length in metres.
        above_ground: (k,) heights of the waypoints above ground.
        least_height: least height above ground anywhere on the way.
        greatest_height: greatest height above ground anywhere on the way.
        steepest_climb: largest angle of climb or descent, in degrees.
        sharpest_turn: largest turn seen from above, in degrees.
        passed: all threats, the nearest first.
        evaluations: evaluations of the optimizer.
        seconds: time that planning took.
        found_by: "straight line", "coarse graph" if no swarm found a shorter one, or "swarm".
        stopped: whether Ctrl-C ended planning.
        improvements: the flights that were the shortest one in turn, the last of which is this one.
    """

    task: Survey
    waypoints: Floats
    length: float
    above_ground: Floats
    least_height: float
    greatest_height: float
    steepest_climb: float
    sharpest_turn: float
    passed: tuple[Passed, ...]
    evaluations: int
    seconds: float
    found_by: str
    stopped: bool = False
    improvements: tuple[FlightImprovement, ...] = ()

    @property
    def map(self) -> TerrainScenario:
        """The scenario with ground, threats and limits."""
        return self.task.scenario

    @property
    def path(self) -> Floats:
        """The waypoints, (k, 3), with x and y in the user's coordinates."""
        return np.column_stack([self.task.for_user(self.waypoints[:, :2]), self.waypoints[:, 2]])

    @property
    def in_degrees(self) -> Floats | None:
        """The waypoints, (k, 3), with longitude and latitude; None for a map without a place on earth."""
        places = self.task.in_degrees(self.waypoints[:, :2])
        return None if places is None else np.column_stack([places, self.waypoints[:, 2]])
