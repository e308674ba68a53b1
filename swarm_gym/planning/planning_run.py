"""One run of the planner: the paths that it has found so far, and the plan that it makes of the best one."""

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import NoPathError
from swarm_gym.planning.alternatives import Alternative, through_other_corridors
from swarm_gym.planning.certificate import certified, is_free
from swarm_gym.planning.corridor_map import CorridorMap
from swarm_gym.planning.request import Request
from swarm_gym.planning.result import Improvement, Plan
from swarm_gym.planning.search import EPISODES, EpisodeSearch, improvement_of
from swarm_gym.planning.steady import kept_corridor
from swarm_gym.planning.tasks import Task
from swarm_gym.planning.wished_path import improved, wished_path
from swarm_gym.problem.geometry.clearance import clearance_of
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import shortest_path
from swarm_gym.reference.disc_planner import StoppedError

Floats = NDArray[np.float64]


class PlanningRun:
    """One run of the planner on a task.

    Attributes:
        improvements: the paths that were the best one in turn; others may read it during the run.
        evaluations: evaluations so far.
    """

    def __init__(self, task: Task, request: Request, began: float, is_stopped: Callable[[], bool]):
        """Check what is asked for against the task.

        Args:
            task: the task.
            request: the wishes of the caller.
            began: time of the monotonic clock when planning began.
            is_stopped: whether planning shall end; asked again and again.

        Raises:
            SettingError: for a previous path or wishes that do not fit the task.
        """
        self._task, self._request, self._began, self._is_stopped = task, request, began, is_stopped
        self._before = request.before(task)
        self._wished = request.wished(task)
        self._corridors = CorridorMap(task)
        self._limit = math.inf if request.max_seconds is None else began + request.max_seconds
        self.improvements: list[Improvement] = []
        self.evaluations = 0

    def run(self) -> Plan:
        """Plan, and return the best path.

        Raises:
            NoPathError: if there is no path, or none was found within the budget.
            StoppedError: if planning shall end, and nothing else than the best path so far is to be had.
        """
        task, request = self._task, self._request
        exact = task.shortest if request.planner == "auto" else None
        if exact is not None:
            self._keep(exact[1], "exact planner")
        stopped = False
        if (exact is None and self._wished is None) or request.names_swarm:
            stopped = self._search()
            if self._is_stopped():
                raise StoppedError
        if not self.improvements and request.planner == "auto":
            stand_in = certified(task, shortest_path(task.grown)[1])
            if stand_in is not None:
                self._keep(stand_in, "exact planner")
        if self._wished is not None:
            path = wished_path(self._wished, self._is_enough)
            if path is not None and (
                not self.improvements or self._cost_of(path) < self._cost_of(self._best)
            ):
                self._keep(path, "wishes")
        seconds = time.monotonic() - self._began
        known = task.shortest  # says so where there is no path at all
        if not self.improvements:
            raise NoPathError(
                f"no free path found on {task.given.name!r} with {self.evaluations:,} evaluations in "
                f"{seconds:.2f} seconds; a larger budget, or `planner='auto'`, may help"
            )
        others = self._others()
        if self._before is not None and not self._is_over():
            kept = kept_corridor(
                self._corridors,
                self._before,
                self._best,
                self._cost_of,
                request.switch_margin,
                self._bettered,
            )
            if kept is not None:
                others = [path for path in (self._best, *others) if self._corridors.differ(path, kept)]
                self._keep(kept, "previous corridor")
        if request.previous is not None or request.alternatives > 1:
            seconds = time.monotonic() - self._began
        alternatives = [self._best, *others[: request.alternatives - 1]] if request.alternatives > 1 else []
        stopped = stopped or self._is_stopped()
        return self._plan(seconds, stopped, known, tuple(map(self._alternative, alternatives)))

    def best_so_far(self) -> Plan | None:
        """Return the best path so far, or the previous one if it is free; None without any of these.

        Gap, clearance and corridor are unknown then, and there are no alternatives.
        """
        if not self.improvements:
            if self._before is None or not is_free(self._task, self._before):
                return None
            self._keep(self._before, "previous path")
        best = self.improvements[-1]
        return Plan(
            self._task.given,
            self._task.for_user(best.path),
            best.length,
            math.nan,
            self.evaluations,
            time.monotonic() - self._began,
            None,
            best.found_by,
            True,
            self._for_user(),
            self._task.projection,
            {"length": best.length},
            reference=self._task.reference,
        )

    @property
    def _best(self) -> Floats:
        """The best path so far in the frame of the task, (k, 2)."""
        return self._task.frame.to_frame(self.improvements[-1].path)

    def _is_over(self) -> bool:
        return time.monotonic() >= self._limit or self._is_stopped()

    def _is_enough(self) -> bool:
        """Return whether time is up; without a path, only whether planning has been stopped."""
        return self._is_stopped() or (bool(self.improvements) and self._is_over())

    def _keep(self, path: Floats, found_by: str) -> None:
        self.improvements.append(improvement_of(self._task, path, found_by, self._began))

    def _search(self) -> bool:
        """Let swarms plan; return whether Ctrl-C ended them."""
        request = self._request
        search = EpisodeSearch(
            self._task, request.optimizer, request.controller, request.seed, self._began, self.improvements
        )
        if self._before is not None:
            search.begin_with(self._before)
        stopped = search.run_until(
            math.inf if request.max_evaluations is None else request.max_evaluations,
            self._limit,
            math.inf if request.max_evaluations or request.max_seconds else EPISODES,
            self._is_stopped,
        )
        self.evaluations = search.evaluations
        return stopped

    def _others(self) -> list[Floats]:
        """Return paths through other corridors than the best one, which is replaced if one is better."""
        number = self._request.alternatives
        if number == 1:
            return []
        others = through_other_corridors(
            self._corridors, self._best, number - 1, self._cost_of, self._bettered, self._is_over
        )
        if self._wished is not None and others and self._cost_of(others[0]) < self._cost_of(self._best):
            others[0], best = self._best, others[0]
            self._keep(best, "wishes")
            others.sort(key=self._cost_of)
        return others

    def _cost_of(self, path: Floats) -> float:
        """Return the sum of wishes of a path in the frame, or its length."""
        return length_of(path) if self._wished is None else self._wished.costs_of(path)["sum"]

    def _bettered(self, path: Floats) -> Floats:
        return path if self._wished is None else improved(self._wished, path, self._is_over)

    def _costs(self, path: Floats) -> dict[str, float]:
        if self._wished is None:
            return {"length": length_of(path) / self._task.frame.factor}
        return self._wished.costs_of(path)

    def _clearance(self, path: Floats) -> float:
        return clearance_of(self._task.bare, path) / self._task.frame.factor

    def _alternative(self, path: Floats) -> Alternative:
        kept = improvement_of(self._task, path, "", self._began)
        return Alternative(
            self._task.for_user(kept.path), kept.length, self._clearance(path), self._costs(path)
        )

    def _for_user(self) -> tuple[Improvement, ...]:
        return tuple(replace(one, path=self._task.for_user(one.path)) for one in self.improvements)

    def _plan(
        self,
        seconds: float,
        stopped: bool,
        known: tuple[float, Floats] | None,
        alternatives: tuple[Alternative, ...],
    ) -> Plan:
        task, best = self._task, self.improvements[-1]
        path = task.frame.to_frame(best.path)
        gap = None if known is None else task.frame.factor * best.length / known[0] - 1.0
        return Plan(
            task.given,
            task.for_user(best.path),
            best.length,
            self._clearance(path),
            self.evaluations,
            seconds,
            gap,
            best.found_by,
            stopped,
            self._for_user(),
            task.projection,
            self._costs(path),
            None if self._before is None else self._corridors.differ(self._before, path),
            alternatives,
            reference=task.reference,
        )
