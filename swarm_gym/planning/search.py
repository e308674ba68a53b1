"""Episodes of a swarm on a task of planning: final repair of what they find, the shortest free path kept."""

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers import Controller, make_controller_for
from swarm_gym.env import SwarmEnv
from swarm_gym.final_repair import final_repair
from swarm_gym.optimizers import get_optimizer
from swarm_gym.planning.certificate import certified
from swarm_gym.planning.result import Improvement
from swarm_gym.planning.tasks import Task
from swarm_gym.problem import GridProblem, MapProblem
from swarm_gym.problem.geometry.curves import nearest_curves
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.scenarios import GridScenario
from swarm_gym.ways import other_way, shortest_way

Floats = NDArray[np.float64]

# Optimizers, controllers and options by kind of map, where nothing else is asked for.
ON_OBSTACLES = ("firefly", "learned:random-fields-sourced/0")
ON_GRIDS = ("multivariate", "fixed:65")
ITERATIONS = {"firefly": 100}  # of an episode; the controllers were tuned or trained for these
FEW_ITERATIONS = 40  # of the other optimizers
EPISODES = 5  # without a budget
WIDEST = 0.1  # standard deviation of the control points of the widest member, as a share of the map's width


def improvement_of(task: Task, path: Floats, found_by: str, began: float) -> Improvement:
    """Return a path in the frame of a task, (k, 2), as it is in map units, from start to goal."""
    mapped = task.frame.to_map(path)
    mapped[0], mapped[-1] = task.given.start, task.given.target
    return Improvement(time.monotonic() - began, mapped, length_of(path) / task.frame.factor, found_by)


class EpisodeSearch:
    """Episodes on a task, and the shortest free path that they have found.

    Attributes:
        improvements: the paths that were the shortest one in turn; the list that was given, in which the last
            path may already be known.
        evaluations: evaluations so far.
    """

    def __init__(
        self,
        task: Task,
        optimizer: str | None,
        controller: str | None,
        seed: int,
        began: float,
        improvements: list[Improvement],
    ):
        on_grid = isinstance(task.grown, GridScenario)
        usual, usual_controller = ON_GRIDS if on_grid else ON_OBSTACLES
        name = optimizer or usual
        known = controller or (usual_controller if name == usual else "fixed:60")
        self._controller: Controller = make_controller_for(name, known)
        options: dict[str, Any] = {"iterations": ITERATIONS.get(name, FEW_ITERATIONS)}
        if on_grid and "bezier" in get_optimizer(name).encodings:
            options["encoding"] = "bezier"
        self._env = SwarmEnv(name, scenario=task.grown, **options, **self._controller.env_options())
        self._task, self._seed = task, seed
        self._guide: Floats | None = None
        self._best: Floats | None = None  # the shortest free path so far, (k, 2), in the frame of the task
        if improvements:
            self._best = task.frame.to_frame(improvements[-1].path)
        self._began = began
        self._episodes = 0
        self.improvements = improvements
        self.evaluations = 0

    def begin_with(self, path: Floats) -> None:
        """Keep the repair of a path, (k, 2), in the frame; the first swarm begins around it."""
        self._keep(path, "previous path")

    def run_until(
        self,
        most_evaluations: float,
        limit: float,
        most_episodes: float,
        is_stopped: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Run episodes until a budget is spent; return whether Ctrl-C ended them.

        Args:
            most_evaluations: evaluations after which no further episode begins.
            limit: time of the monotonic clock at which the last episode ends.
            most_episodes: number of episodes.
            is_stopped: whether planning shall end; asked before and after each iteration.
        """
        try:
            while True:
                self._run(limit, is_stopped)
                if (
                    time.monotonic() >= limit
                    or is_stopped()
                    or self.evaluations >= most_evaluations
                    or self._episodes >= most_episodes
                ):
                    return False
        except KeyboardInterrupt:
            self._keep_best()
            return True

    def _run(self, limit: float, is_stopped: Callable[[], bool]) -> None:
        """Run an episode, at most until that time of the monotonic clock.

        Its best paths are kept at its end. If the time is limited, they are also kept after 1, 2, 4, 8, ...
        iterations, and after all of them as long as no path is known: always after the same iterations, so
        that with more time the path is never longer.

        Kernels may be compiled for seconds before the first iteration. No other one is begun after a stop.
        """
        if is_stopped():
            return
        self._guide = self._next_guide()
        self._controller.reset(1, self._seed)
        observation, info = self._env.reset(seed=self._seed, options=self._first())
        if is_stopped():
            return
        if self._guide is not None:
            self._keep(self._guide, "guide")
        self._seed += 1
        self._episodes += 1
        ended, iteration, counted = False, 0, 0
        while not ended and time.monotonic() < limit and not is_stopped():
            observation, _, ended, _, info = self._env.step(self._controller.act(observation[None])[0])
            iteration += 1
            self.evaluations += int(info["evaluations"]) - counted
            counted = int(info["evaluations"])
            is_checkpoint = self._best is None or iteration & (iteration - 1) == 0
            if ended or (is_checkpoint and limit < math.inf):
                self._keep_best()

    def _keep_best(self) -> None:
        """Make the best paths of the present population free, and keep the shortest if it is shorter."""
        paths = self._env.simulation.paths
        self._keep(paths.best_of(0), "swarm")
        feasible = paths.feasible()[0]
        if np.isfinite(feasible).all():
            self._keep(feasible, "swarm")

    def _keep(self, path: Floats, found_by: str) -> None:
        """Make a path in the frame free, and keep it if it is the shortest one."""
        problem = self._env.simulation.problems[0]
        assert isinstance(problem, MapProblem)
        found = final_repair(problem, path)
        if found is None:
            return
        self.evaluations += found.evaluations
        kept = certified(self._task, found.path)
        if kept is not None and (self._best is None or length_of(kept) < length_of(self._best)):
            self._best = kept
            by = f"{found_by} and planner" if found.planned else found_by
            self.improvements.append(improvement_of(self._task, kept, by, self._began))

    def _next_guide(self) -> Floats | None:
        """Return the way that the next episode begins around, on grid maps.

        At first it is the way of A*, or the repair of a previous path; then others.
        """
        scenario = self._task.grown
        if not isinstance(scenario, GridScenario):
            return None
        way = self._best
        if way is not None and self._episodes > 0:
            way = other_way(scenario, way, np.random.default_rng(self._seed))
        return shortest_way(scenario) if way is None else way

    def _first(self) -> dict[str, object] | None:
        """Return the reset options of an episode: on grid maps, members around a planned way."""
        problem = self._env.simulation.problems[0]
        if self._guide is None or not isinstance(problem, GridProblem) or problem.encoding != "bezier":
            return None
        size = self._env.settings.initial_population_size
        return {"initial_population": guided_population(problem, self._guide, size, self._seed)}


def guided_population(problem: GridProblem, way: Floats, size: int, seed: int) -> Floats:
    """Return decision vectors, (size, dimension), around a way from start to target, (k, 2).

    The first member is the Bezier curve nearest to the way, by least squares; the others have their control
    points moved at random, the later the farther.
    """
    low, high = problem.bounds
    (nearest,) = nearest_curves(way[None], problem.num_points)
    rng = np.random.default_rng(seed)
    widths = WIDEST * (high - low).max() * np.arange(size)[:, None] / max(size - 1, 1)
    return np.clip(nearest + widths * rng.normal(size=(size, len(nearest))), low, high)
