"""Searches for curves by turns: one, or several with larger turning circles where curvature has a rate."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.curve import Curve
from swarm_gym.planning.drive_costs import costs_of
from swarm_gym.planning.drive_map import DriveMap
from swarm_gym.planning.drive_search import FIRSTS, DriveSearch, Driving, Effort
from swarm_gym.planning.smoothing import is_free, smoothed

Floats = NDArray[np.float64]

# Radii of arcs that are smoothed, by turns: in least radii, and in square roots of 1 / rate.
WIDER = ((1.05, 0.7), (1.3, 1.0), (1.8, 1.4))
IN_VAIN = 6  # curves that cannot be smoothed, after which the next radius is tried


@dataclass
class DriveSearches:
    """Searches for curves that obey all limits.

    Attributes:
        drive_map: obstacles and costs.
        driving: limits of the robot.
        weights: weights of wishes.
        seed: seed of the draws of local improvements.
        rate: greatest change of curvature over length, in 1 / map unit squared; None if it may jump.
    """

    drive_map: DriveMap
    driving: Driving
    weights: Mapping[str, float]
    seed: int
    rate: float | None
    _searches: list[DriveSearch] = field(default_factory=list)

    @property
    def evaluations(self) -> int:
        """Poses that were expanded and parts that were tried, in all searches so far."""
        return sum(search.evaluations for search in self._searches)

    def curves(
        self,
        walls: Floats | None,
        is_over: Callable[[], bool],
        is_timed: bool,
        firsts: tuple[Effort, ...] = FIRSTS,
    ) -> Iterator[Curve]:
        """Yield curves, each of which costs less than those before.

        Args:
            walls: ends of walls that curves must not cross, (m, 4), in map units; None without any.
            is_over: whether planning shall end.
            is_timed: whether there is a limit of time.
            firsts: sizes of searches by turns, until one finds a curve.
        """
        for radius in self._radii():
            is_given = radius == self.driving.radius
            drive_map = self.drive_map if is_given else replace(self.drive_map, radius=radius)
            search = DriveSearch(
                drive_map,
                replace(self.driving, radius=radius),
                self.weights["curvature"],
                self.seed,
                None if walls is None else drive_map.walled(walls),
            )
            self._searches.append(search)
            curves = search.curves(is_over, is_timed, firsts)
            if self.rate is None:
                yield from curves
                return
            has_one = False
            for curve in self._fitting(curves):
                has_one = True
                yield curve
            if has_one or is_over():
                return

    def cost_of(self, curve: Curve) -> float:
        """Return the sum of wishes of a curve."""
        return costs_of(self.drive_map, curve, self.weights)["sum"]

    def _radii(self) -> list[float]:
        radius = self.driving.radius
        if self.rate is None:
            return [radius]
        x_min, y_min, x_max, y_max = self.drive_map.box
        most = max(radius * WIDER[0][0], x_max - x_min, y_max - y_min)
        radii = [min(max(share * radius, root / math.sqrt(self.rate)), most) for share, root in WIDER]
        return list(dict.fromkeys(radii))

    def _fitting(self, curves: Iterator[Curve]) -> Iterator[Curve]:
        """Yield the smoothed ones of curves, each of which costs less than those before."""
        least, in_vain = math.inf, 0
        for curve in curves:
            fit = self._fit(curve)
            if fit is None:
                in_vain += 1
                if in_vain >= IN_VAIN and math.isinf(least):
                    return
            elif (cost := self.cost_of(fit)) < least:
                least = cost
                yield fit

    def _fit(self, curve: Curve) -> Curve | None:
        """Return the curve with a curvature that obeys the rate; None if it would meet an obstacle."""
        assert self.rate is not None
        driving = self.driving
        heading = driving.goal_heading
        goal = np.append(self.drive_map.task.given.target, curve.end[2] if heading is None else heading)
        ends = driving.start_heading is None, heading is None
        found = smoothed(curve, goal, driving.radius, self.rate, *ends)
        return found if found is not None and is_free(self.drive_map, found) else None
