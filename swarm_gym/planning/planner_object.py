"""A planner that is prepared once and plans many times, from any thread, with a time limit that holds."""

import threading
import time
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from swarm_gym.checks import require_number
from swarm_gym.errors import SettingError
from swarm_gym.planning.drive_run import DriveRun
from swarm_gym.planning.maps import AnyMap, read_cells
from swarm_gym.planning.planner import run_of
from swarm_gym.planning.planning_run import PlanningRun
from swarm_gym.planning.request import Request
from swarm_gym.planning.result import Plan
from swarm_gym.planning.steady import SWITCH_MARGIN
from swarm_gym.planning.tasks import read_task
from swarm_gym.planning.worker import Worker
from swarm_gym.reference.shortest import prepare
from swarm_gym.scenarios import Circle, GridMap, GridScenario, Point, Scenario
from swarm_gym.scenarios.graded_map import GradedMap, Grading


class Planner:
    """A planner for one map and one robot, which is prepared when it is made.

    Each call of `plan` works in a thread of its own. Several threads may call it at a time. When the time is
    up or planning is cancelled, the call returns the best path so far. A calculation that cannot be stopped
    goes on in its thread until it ends, and its result is dropped. The interpreter waits for it at its end.
    """

    def __init__(
        self,
        where: AnyMap,
        *,
        robot_radius: float = 0.0,
        clearance: float = 0.0,
        workspace: str | Path | ArrayLike | None = None,
        coordinates: str | None = None,
        unknown: str = "blocked",
        lethal: int | None = None,
        terrain: Mapping[str, float] | None = None,
        wishes: Mapping[str, float] | None = None,
        switch_margin: float = SWITCH_MARGIN,
        turning_radius: float | None = None,
        reverse: bool = False,
        curvature_rate: float | None = None,
    ):
        """Read the map, load the kernels and prepare the exact planner; arguments as in `swarm_gym.plan`.

        A GeoJSON file is read again in each call of `plan`, since its projection depends on start and goal.

        Raises:
            ScenarioError: for a map that is missing or malformed.
            SettingError: for another value that is invalid.
            MissingExtraError: if the map needs a library that is missing.
        """
        require_number("robot_radius", robot_radius, 0.0, 1e9)
        require_number("clearance", clearance, 0.0, 1e9)
        require_number("switch_margin", switch_margin, 0.0, 1.0)
        self._margin = robot_radius + clearance
        self._workspace, self._coordinates = workspace, coordinates
        self._wishes, self._switch_margin = wishes, switch_margin
        self._turning_radius, self._reverse = turning_radius, reverse
        self._curvature_rate = curvature_rate
        Request(  # checks the values
            wishes=wishes, turning_radius=turning_radius, reverse=reverse, curvature_rate=curvature_rate
        )
        self._stops: set[threading.Event] = set()
        self._lock = threading.Lock()
        self._of_files = grading = Grading(unknown, lethal, terrain)
        self._where = read_cells(where, grading)
        is_of_cells = isinstance(self._where, GridMap | GradedMap)
        self._grading = Grading() if is_of_cells else grading
        self._prepare()

    def with_map(self, where: AnyMap) -> "Planner":
        """Return the planner of the same robot on another map, as after the map has changed.

        Args:
            where: a map, as in `swarm_gym.plan`; grades in a file mean what they mean here.

        Raises:
            ScenarioError: for a map that is missing or malformed.
        """
        grading = self._of_files if isinstance(where, str | Path) else Grading()
        return Planner(
            where,
            unknown=grading.unknown,
            lethal=grading.lethal,
            terrain=grading.terrain,
            robot_radius=self._margin,
            workspace=self._workspace,
            coordinates=self._coordinates,
            wishes=self._wishes,
            switch_margin=self._switch_margin,
            turning_radius=self._turning_radius,
            reverse=self._reverse,
            curvature_rate=self._curvature_rate,
        )

    def plan(
        self,
        start: Point | None = None,
        goal: Point | None = None,
        *,
        previous: ArrayLike | None = None,
        alternatives: int = 1,
        max_seconds: float | None = None,
        cancel: threading.Event | None = None,
        planner: str = "auto",
        optimizer: str | None = None,
        controller: str | None = None,
        max_evaluations: int | None = None,
        seed: int = 0,
        start_heading: float | None = None,
        goal_heading: float | None = None,
    ) -> Plan:
        """Return the best path from start to goal; `swarm_gym.plan` describes the other arguments.

        Args:
            start: (x, y) in the coordinates of the map; a scenario has its own.
            goal: (x, y) in the coordinates of the map; a scenario has its own.
            previous: points of a former path to the goal, (k, 2). A robot that is on its way is off it:
                the rest of the path from the start counts.
            alternatives: number of paths to return, at most.
            max_seconds: seconds after which the best path so far is returned, or the previous one if it is
                free; `Plan.stopped` is True then.
            cancel: event that ends planning in the same way when it is set.
            planner: "auto", or "swarm".
            optimizer: name of the optimizer of a swarm.
            controller: name of the controller of a swarm.
            max_evaluations: evaluations after which no further episode begins.
            seed: seed of the first episode.
            start_heading: heading at the start in degrees, with a turning radius.
            goal_heading: heading at the goal in degrees, with a turning radius.

        Raises:
            ScenarioError: for a start or goal that is invalid.
            SettingError: for another value that is invalid.
            NoPathError: if there is no path, or none is known when planning ends.
            RuntimeError: if the interpreter ends.
        """
        began = time.monotonic()
        request = Request(
            planner,
            optimizer,
            controller,
            max_evaluations,
            max_seconds,
            seed,
            previous,
            self._switch_margin,
            alternatives,
            self._wishes,
            self._turning_radius,
            start_heading,
            goal_heading,
            self._reverse,
            self._curvature_rate,
            start is not None,
        )
        if cancel is not None and not isinstance(cancel, threading.Event):
            raise SettingError(f"cancel must be a threading.Event, got {cancel!r:.80}")
        work = Worker(lambda worker: self._begin(start, goal, request, worker), began)
        with self._lock:
            self._stops.add(work.stop)
        try:
            work.start()
            return work.result_by(began + max_seconds if max_seconds is not None else None, cancel)
        finally:
            work.stop.set()
            with self._lock:
                self._stops.discard(work.stop)

    def cancel(self) -> None:
        """End all calls of `plan` that are under way in other threads."""
        with self._lock:
            for stop in self._stops:
                stop.set()

    def _begin(
        self, start: Point | None, goal: Point | None, request: Request, work: Worker
    ) -> PlanningRun | DriveRun:
        task = read_task(
            self._where,
            start,
            goal,
            self._margin,
            self._workspace,
            self._coordinates,
            self._grading,
            work.stop.is_set,
        )
        return run_of(task, request, work.began, work.stop.is_set)

    def _prepare(self) -> None:
        """Load the kernels, and prepare the exact planner on the map."""
        where = self._where.grid if isinstance(self._where, GradedMap) else self._where
        is_on_cells = isinstance(where, GridMap | GridScenario)
        has_costs = isinstance(self._where, GradedMap) or bool(self._wishes)
        drives = self._turning_radius is not None
        _load_kernels(is_on_cells, self._margin > 0.0, drives, is_on_cells and has_costs and not drives)
        if isinstance(where, GridMap | GridScenario):
            grid = where if isinstance(where, GridMap) else where.map
            _ = grid.components  # kept by the map
            prepare(grid, self._margin)


@cache
def _load_kernels(is_on_cells: bool, has_margin: bool, drives: bool, weighs: bool) -> None:
    """Plan on a tiny map, once in a process, so that later calls find all kernels loaded."""
    task = read_task(_tiny_cells() if is_on_cells else _tiny_obstacles(), None, None, 0.4 * has_margin)
    kind: type[PlanningRun] | type[DriveRun] = DriveRun if drives else PlanningRun
    radius = 0.5 if drives else None
    wishes = {"distance": 1.0} if weighs else None
    request = Request(alternatives=2, turning_radius=radius, wishes=wishes)
    other = kind(task, request, time.monotonic(), lambda: False).run().alternatives[-1].path
    again = Request(previous=other, switch_margin=1.0, turning_radius=radius)
    kind(task, again, time.monotonic(), lambda: False).run()


def _tiny_cells() -> GridScenario:
    blocked = np.zeros((7, 7), dtype=np.bool_)
    blocked[3, 3] = True
    return GridScenario("tiny", GridMap("tiny", blocked), (0.0, 3.0), (6.0, 3.0))


def _tiny_obstacles() -> Scenario:
    return Scenario("tiny", (0.0, 0.0), (6.0, 0.0), (Circle(3.0, 0.0, 1.0),), (-1.0, -3.0, 7.0, 3.0))
