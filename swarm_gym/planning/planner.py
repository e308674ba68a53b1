"""The planner: a swarm optimizer on a task, final repair of what it finds, the shortest free path kept."""

import math
import time
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.checks import require_integer, require_number
from swarm_gym.clearance import clearance_of
from swarm_gym.controllers import Controller, make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import NoPathError
from swarm_gym.final_repair import final_repair
from swarm_gym.optimizers import get_optimizer
from swarm_gym.planning.exact import certified, exact_path, shorter_exact_path, stand_in
from swarm_gym.planning.guide import guided_population
from swarm_gym.planning.previous import require_previous
from swarm_gym.planning.scaling import scaled_to_cases
from swarm_gym.planning.tasks import Task, read_task
from swarm_gym.problem import GridProblem, MapProblem
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.scenarios import AnyScenario, GridScenario, MapScenario, Point
from swarm_gym.ways import other_way, shortest_way

Floats = NDArray[np.float64]

# Optimizers, controllers and options by kind of map, where nothing else is asked for.
ON_OBSTACLES = ("firefly", "learned:random-fields-sourced/0")
ON_GRIDS = ("multivariate", "fixed:65")
ITERATIONS = {"firefly": 100}  # of an episode; the controllers were tuned or trained for these
FEW_ITERATIONS = 40  # of the other optimizers
EPISODES = 5  # without a budget


@dataclass(frozen=True)
class Improvement:
    """A free path that was the shortest one when it was found.

    Attributes:
        seconds: time since planning began.
        path: (k, 2) points from start to goal, in map units.
        found_by: origin of the path, see `Plan`.
    """

    seconds: float
    path: Floats
    found_by: str


@dataclass(frozen=True)
class Plan:
    """A free path.

    Attributes:
        map: the map as it was given, with start and goal.
        path: (k, 2) points from start to goal, in map units.
        length: length of the path, in map units.
        clearance: least distance of the path from an obstacle, in map units; infinite without obstacles.
        evaluations: evaluations of the optimizer, and those of final repairs.
        seconds: time that planning took, without that of `gap`.
        gap: length above the exact shortest path with the same distance from obstacles, as a share of that;
            None where it is unknown. On grid maps that is the robot's path on the map as given, with arcs.
        found_by: "swarm"; "guide" if nothing was shorter than the path of A*, pulled tight, around which a
            swarm begins on a grid map; "previous path" if nothing was shorter than that path after its
            repair; each with " and planner" if pieces of the path were planned anew; or "exact planner", also
            where its path of a robot on a grid map is shorter than the swarm's.
        stopped: whether Ctrl-C ended planning.
        improvements: the paths that were the shortest one in turn, the last of which is `path`; not
            that of the exact planner.
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


def plan(
    where: str | Path | AnyScenario,
    start: Point | None = None,
    goal: Point | None = None,
    *,
    robot_radius: float = 0.0,
    clearance: float = 0.0,
    optimizer: str | None = None,
    controller: str | None = None,
    max_evaluations: int | None = None,
    max_seconds: float | None = None,
    seed: int = 0,
    previous: ArrayLike | None = None,
    fallback: bool = False,
) -> Plan:
    """Return a free path from start to goal, found by a swarm.

    Episodes run until a budget is spent, each from another seed; without a budget, `EPISODES` do. The best
    path of each is made free, see `swarm_gym.final_repair`, and the shortest is kept. On grid maps, swarms
    begin around a path of A*: the first around the shortest one, the others around paths that a block
    somewhere on the best path so far leaves. With a previous path, planning goes on from it: its repair is
    the first path, and on grid maps the first swarm begins around that. On a grid map, the exact planner's
    path of a robot with a radius is returned where it is known, and the swarm's is longer.

    Args:
        where: a file (`.yaml` of ROS's map_server, `.map` of Moving AI, GeoJSON with polygons), a scenario,
            or its name.
        start: (x, y) in map units; a scenario has its own.
        goal: (x, y) in map units; a scenario has its own.
        robot_radius: radius of the robot, in map units.
        clearance: distance that the robot keeps from obstacles besides, in map units.
        optimizer: name of the optimizer; by default one that suits the kind of map.
        controller: name of the controller; by default one that suits the optimizer and the kind of map.
        max_evaluations: evaluations after which no further episode begins, and at least one does.
        max_seconds: seconds after which planning ends.
        seed: seed of the first episode.
        previous: points of a path from start to goal, (k, 2), in map units: the path that was valid before
            the map changed.
        fallback: whether the exact planner's path is returned if the swarm finds none.

    Raises:
        ScenarioError: for a map, start or goal that is invalid.
        SettingError: for another value that is invalid.
        NoPathError: if there is no path, or none was found within the budget.
    """
    require_number("robot_radius", robot_radius, 0.0, 1e9)
    require_number("clearance", clearance, 0.0, 1e9)
    require_integer("seed", seed, 0, 2**31)
    if max_seconds is not None:
        require_number("max_seconds", max_seconds, 1e-3, 1e9)
    if max_evaluations is not None:
        require_integer("max_evaluations", max_evaluations, 1)
    began = time.monotonic()
    task = read_task(where, start, goal, robot_radius + clearance)
    search = _Search(task, optimizer, controller, seed, began)
    if previous is not None:
        search.begin_with(require_previous(previous, task.given))
    limit = math.inf if max_seconds is None else began + max_seconds
    most = math.inf if max_evaluations is None else max_evaluations
    stopped = False
    try:
        for episode in count(1):
            search.run(limit)
            if time.monotonic() >= limit or search.evaluations >= most:
                break
            if max_seconds is None and max_evaluations is None and episode == EPISODES:
                break
    except KeyboardInterrupt:
        stopped = True
        search.keep_best()
    improvements = tuple(search.improvements)
    found, found_by = search.best, improvements[-1].found_by if improvements else ""
    exact = shorter_exact_path(task, found)
    if exact is None and found is None and fallback:
        exact = stand_in(task)
    if exact is not None:
        found, found_by = exact, "exact planner"
    if found is None:
        raise NoPathError(
            f"no free path found on {task.given.name!r} with {search.evaluations:,} evaluations in "
            f"{time.monotonic() - began:.2f} seconds; a larger budget or `fallback` may help"
        )
    seconds = time.monotonic() - began
    length = length_of(found)
    gap = _gap(task, length)
    least = clearance_of(task.given, found)
    return Plan(
        task.given, found, length, least, search.evaluations, seconds, gap, found_by, stopped, improvements
    )


def _gap(task: Task, length: float) -> float | None:
    exact = exact_path(task)
    return None if exact is None else length / exact[0] - 1.0


class _Search:
    """Episodes on a task, and the shortest free path that they have found.

    Attributes:
        improvements: the paths that were the shortest one in turn.
        evaluations: evaluations so far.
    """

    def __init__(self, task: Task, optimizer: str | None, controller: str | None, seed: int, began: float):
        # Noise and steps of optimizers have units: maps of obstacles are as wide as those of the papers.
        scaled = None if isinstance(task.grown, GridScenario) else scaled_to_cases(task.grown)
        usual, usual_controller = ON_GRIDS if scaled is None else ON_OBSTACLES
        name = optimizer or usual
        known = controller or (usual_controller if name == usual else "fixed:60")
        self._controller: Controller = make_controller(known)
        self._factor = 1.0 if scaled is None else scaled.factor
        scenario = task.grown if scaled is None else scaled.scenario
        options: dict[str, Any] = {"iterations": ITERATIONS.get(name, FEW_ITERATIONS)}
        if scaled is None and "bezier" in get_optimizer(name).encodings:
            options["encoding"] = "bezier"
        self._env = SwarmEnv(name, scenario=scenario, **options, **self._controller.env_options())
        self._task, self._seed = task, seed
        self._guide: Floats | None = None
        self._began = began
        self._episodes = 0
        self.improvements: list[Improvement] = []
        self.evaluations = 0

    @property
    def best(self) -> Floats | None:
        """The shortest free path so far, (k, 2), in map units; None if there is none yet."""
        return self.improvements[-1].path if self.improvements else None

    def begin_with(self, path: Floats) -> None:
        """Keep the repair of a path, (k, 2), in map units; the first swarm begins around it."""
        self._keep(self._factor * path, "previous path")

    def run(self, limit: float) -> None:
        """Run an episode, at most until that time of the monotonic clock, and keep its path if it is best."""
        self._guide = self._next_guide()
        self._controller.reset(1, self._seed)
        observation, info = self._env.reset(seed=self._seed, options=self._first())
        if self._guide is not None:
            self._keep(self._guide, "guide")
        self._seed += 1
        self._episodes += 1
        before, ended = self.evaluations, False
        while not ended and time.monotonic() < limit:
            observation, _, ended, _, info = self._env.step(self._controller.act(observation[None])[0])
            self.evaluations = before + int(info["evaluations"])
        self.keep_best()

    def keep_best(self) -> None:
        """Make the best paths of the present population free, and keep the shortest if it is shorter."""
        paths = self._env.simulation.paths
        self._keep(paths.best_of(0), "swarm")
        feasible = paths.feasible()[0]
        if np.isfinite(feasible).all():
            self._keep(feasible, "swarm")

    def _keep(self, path: Floats, found_by: str) -> None:
        """Make a path free, and keep it if it is the shortest one."""
        problem = self._env.simulation.problems[0]
        assert isinstance(problem, MapProblem)
        found = final_repair(problem, path)
        if found is None:
            return
        self.evaluations += found.evaluations
        mapped = found.path / self._factor
        mapped[0], mapped[-1] = self._task.grown.start, self._task.grown.target
        kept = certified(self._task, mapped)
        if kept is not None and (self.best is None or length_of(kept) < length_of(self.best)):
            found_by = f"{found_by} and planner" if found.planned else found_by
            self.improvements.append(Improvement(time.monotonic() - self._began, kept, found_by))

    def _next_guide(self) -> Floats | None:
        """Return the way that the next episode begins around, on grid maps.

        At first it is that of A*, or the repair of a previous path; then others.
        """
        scenario = self._task.grown
        if not isinstance(scenario, GridScenario):
            return None
        way = self.best
        if way is not None and self._episodes > 0:
            way = other_way(scenario, way, np.random.default_rng(self._seed))
        return shortest_way(scenario) if way is None else way

    def _first(self) -> dict[str, Any] | None:
        """Return the reset options of an episode: on grid maps, members around a planned way."""
        problem = self._env.simulation.problems[0]
        if self._guide is None or not isinstance(problem, GridProblem) or problem.encoding != "bezier":
            return None
        size = self._env.settings.initial_population_size
        return {"initial_population": guided_population(problem, self._guide, size, self._seed)}
