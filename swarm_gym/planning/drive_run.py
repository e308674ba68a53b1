"""One run of the planner of drivable curves: the curves found so far, and the plan of the best one."""

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.planning.alternatives import Alternative
from swarm_gym.planning.curve import Curve
from swarm_gym.planning.curves.field import room_at
from swarm_gym.planning.drive_corridors import DriveCorridors, Others
from swarm_gym.planning.drive_costs import costs_of, drive_weights
from swarm_gym.planning.drive_map import DriveMap
from swarm_gym.planning.drive_refusal import refusal_of
from swarm_gym.planning.drive_search import Driving
from swarm_gym.planning.drive_searches import DriveSearches
from swarm_gym.planning.request import Request
from swarm_gym.planning.result import Improvement, Plan
from swarm_gym.planning.tasks import Task
from swarm_gym.problem.geometry.clearance import clearance_of

Floats = NDArray[np.float64]

FOUND_BY, KEPT = "curve search", "previous corridor"
FIRST_SHARE = 0.5  # of the time for the best curve, where other corridors are looked at, too
FINE = 0.01  # spacing of the points whose distance from obstacles is measured, in turning radii
MOST_POINTS = 20_000


class DriveRun:
    """One run of the planner of drivable curves on a task.

    Attributes:
        improvements: the curves that were the best one in turn, as paths; others may read it during the run.
        evaluations: poses that were expanded and parts that were tried.
    """

    def __init__(self, task: Task, request: Request, began: float, is_stopped: Callable[[], bool]):
        """Check what is asked for against the task.

        Args:
            task: the task.
            request: the wishes of the caller, with a turning radius.
            began: time of the monotonic clock when planning began.
            is_stopped: whether planning shall end; asked again and again.

        Raises:
            SettingError: for a previous path or wishes that do not fit the task.
            ScenarioError: for an end without room for curves.
        """
        assert request.turning_radius is not None
        self._task, self._request, self._began, self._is_stopped = task, request, began, is_stopped
        self._weights = drive_weights(task, request.wishes)
        self._map = DriveMap(task, request.turning_radius, self._weights)
        self._driving = Driving(
            request.turning_radius,
            request.reverse,
            *(
                None if heading is None else math.radians(heading)
                for heading in (request.start_heading, request.goal_heading)
            ),
        )
        self._searches = DriveSearches(
            self._map, self._driving, self._weights, request.seed, request.curvature_rate
        )
        self._corridors = DriveCorridors(self._searches, request.max_evaluations)
        self._before = request.before(task)
        self._limit = math.inf if request.max_seconds is None else began + request.max_seconds
        self._best: Curve | None = None
        self.improvements: list[Improvement] = []
        self._require_room()

    @property
    def evaluations(self) -> int:
        """Poses that were expanded and parts that were tried, so far."""
        return self._searches.evaluations

    def run(self) -> Plan:
        """Plan, and return the best curve.

        Raises:
            NoPathError: if none was found.
            SettingError: for a turning radius that start or goal cannot leave.
        """
        stopped, others = False, Others([], [])
        try:
            for curve in self._searches.curves(None, self._is_enough, self._request.max_seconds is not None):
                self._keep(curve, FOUND_BY)
            if self._best is not None:
                others = self._others()
        except KeyboardInterrupt:
            stopped = True
        if self._best is None:
            raise refusal_of(
                self._map, self._driving, self._request.curvature_rate, self.evaluations, self._is_over
            )
        if stopped or self._is_stopped():
            found = self.best_so_far()
            assert found is not None
            return found
        return self._complete(self._plan(self._best, False), others)

    def best_so_far(self) -> Plan | None:
        """Return the best curve so far; None without one. Gap, clearance and costs are unknown."""
        return None if self._best is None else self._plan(self._best, True)

    def _others(self) -> Others:
        """Return curves through other corridors than the best one, which may be replaced."""
        request, corridors = self._request, self._corridors
        assert self._best is not None
        others = Others([], [])
        if request.alternatives > 1:
            others = corridors.others(self._best, request.alternatives - 1, self._is_over)
            curves = others.curves
            if curves and self._searches.cost_of(curves[0]) < self._searches.cost_of(self._best):
                curves[0], best = self._best, curves[0]
                self._keep(best, FOUND_BY)
                curves.sort(key=self._searches.cost_of)
        if self._before is not None and not self._is_over():
            kept = corridors.kept(self._before, self._best, request.switch_margin, self._is_over)
            if kept is not None:
                curves = [one for one in (self._best, *others.curves) if corridors.differ(one, kept)]
                others = others._replace(curves=curves[: request.alternatives - 1])
                self._keep(kept, KEPT)
        return others

    def _complete(self, plan: Plan, others: Others) -> Plan:
        """Return a plan with what takes some time to measure."""
        curve, known, task = self._best, self._task.shortest, self._task
        assert curve is not None
        first = self._alternative(curve)
        is_asked = self._request.alternatives > 1
        return replace(
            plan,
            clearance=first.clearance,
            gap=None if known is None else task.frame.factor * curve.length / known[0] - 1.0,
            costs=first.costs,
            switched=None
            if self._before is None
            else self._corridors.corridors.differ(self._before, self._corridors.path_of(curve)),
            alternatives=(first, *map(self._alternative, others.curves)) if is_asked else (),
            undrivable=tuple(task.for_user(task.frame.to_map(path)) for path in others.shut),
        )

    def _alternative(self, curve: Curve) -> Alternative:
        """Return a curve with what is measured of it."""
        fine = curve.sampled(max(FINE * curve.turning_radius, curve.length / MOST_POINTS))[:, :2]
        return Alternative(
            self._task.for_user(self._map.path_of(curve)),
            curve.length,
            clearance_of(self._task.given, fine),
            costs_of(self._map, curve, self._weights),
            curve,
        )

    def _plan(self, curve: Curve, stopped: bool) -> Plan:
        task, improvements = self._task, tuple(self.improvements)
        return Plan(
            task.given,
            task.for_user(improvements[-1].path),
            curve.length,
            math.nan,
            self.evaluations,
            time.monotonic() - self._began,
            None,
            improvements[-1].found_by,
            stopped,
            tuple(replace(one, path=task.for_user(one.path)) for one in improvements),
            task.projection,
            {"length": curve.length},
            curve=curve,
            reference=task.reference,
        )

    def _keep(self, curve: Curve, found_by: str) -> None:
        path = self._map.path_of(curve)
        self.improvements.append(Improvement(time.monotonic() - self._began, path, curve.length, found_by))
        self._best = curve

    def _is_over(self) -> bool:
        return time.monotonic() >= self._limit or self._is_stopped()

    def _is_enough(self) -> bool:
        """Return whether the search for the best curve shall end."""
        request = self._request
        most = request.max_evaluations
        is_spent = most is not None and self._best is not None and self.evaluations >= most
        if request.max_seconds is not None and (request.alternatives > 1 or self._before is not None):
            is_spent |= time.monotonic() >= self._began + FIRST_SHARE * request.max_seconds
        return is_spent or self._is_over()

    def _require_room(self) -> None:
        """Raise an error if an end is closer to an obstacle than curves may be."""
        task = self._task
        for name, end, given in (
            ("start", task.given.start, task.start),
            ("goal", task.given.target, task.goal),
        ):
            x, y = self._map.to_nodes(end).tolist()
            room = room_at(self._map.field, x, y) * self._map.unit
            if room < 0.0:
                least = task.margin + self._map.slack
                raise ScenarioError(
                    f"map {shown(task.given.name)}: {name} {given} is {least + room:.6g} from an obstacle; "
                    f"with a turning radius expected at least {least:.6g}, the robot's radius with clearance "
                    "and a slack of the collision test"
                )
