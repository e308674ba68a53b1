"""The planner: the exact shortest path where it is quickly known, else the best free path of a swarm."""

import math
import time
from dataclasses import replace
from pathlib import Path

from numpy.typing import ArrayLike

from swarm_gym.checks import require_integer, require_number
from swarm_gym.errors import NoPathError, SettingError
from swarm_gym.planning.certificate import certified
from swarm_gym.planning.previous import require_previous
from swarm_gym.planning.result import Plan
from swarm_gym.planning.search import EPISODES, Search, improvement_of
from swarm_gym.planning.tasks import read_task
from swarm_gym.problem.geometry.clearance import clearance_of
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import AnyScenario, Point

PLANNERS = ("auto", "swarm")


def plan(
    where: str | Path | AnyScenario,
    start: Point | None = None,
    goal: Point | None = None,
    *,
    robot_radius: float = 0.0,
    clearance: float = 0.0,
    planner: str = "auto",
    optimizer: str | None = None,
    controller: str | None = None,
    max_evaluations: int | None = None,
    max_seconds: float | None = None,
    seed: int = 0,
    previous: ArrayLike | None = None,
    workspace: str | Path | ArrayLike | None = None,
    coordinates: str | None = None,
) -> Plan:
    """Return a short free path from start to goal.

    Where the exact shortest path is quickly known, it is the result, since no path is shorter; a swarm plans
    after it only if an optimizer or a controller is named. Elsewhere, and with `planner="swarm"`, a swarm
    looks for paths. Its episodes run until a budget is spent, each from another seed; without a budget,
    `EPISODES` do. The best path of each is made free, see `swarm_gym.final_repair`, and the shortest is kept.
    With a longer budget the path is never longer. On grid maps, swarms begin around a path of A*: the first
    around the shortest one, the others around paths that a block somewhere on the best path so far leaves.
    A swarm goes on from a previous path: its repair is kept first, and on grid maps the first swarm begins
    around it. Where the exact path is the result, a previous path changes nothing.

    Args:
        where: a file (`.yaml` of ROS's map_server, `.map` of Moving AI, GeoJSON), a scenario, or its name.
        start: (x, y) in the coordinates of the map; a scenario has its own.
        goal: (x, y) in the coordinates of the map; a scenario has its own.
        robot_radius: radius of the robot, in map units.
        clearance: distance that the robot keeps from obstacles besides, in map units.
        planner: "auto", or "swarm" to let the swarm plan alone, also where the exact planner is quick.
        optimizer: name of the optimizer; by default one that suits the kind of map.
        controller: name of the controller; by default one that suits the optimizer and the kind of map.
        max_evaluations: evaluations after which no further episode begins, and at least one does.
        max_seconds: seconds after which planning ends.
        seed: seed of the first episode.
        previous: points of a path from start to goal, (k, 2), in the coordinates of the map: the path that
            was valid before the map changed.
        workspace: area that the robot stays in, with all of its radius, on maps of obstacles:
            (x_min, y_min, x_max, y_max), corners of a polygon, (k, 2), or a GeoJSON file with one polygon.
        coordinates: "plane" for x and y in one unit, or "longitude-latitude": planning is in metres then, and
            radius, clearance and length are; by default what a GeoJSON file names, else "plane".

    Raises:
        ScenarioError: for a map, start or goal that is invalid.
        SettingError: for another value that is invalid.
        NoPathError: if there is no path, or none was found within the budget.
        MissingExtraError: if the map needs a library that is missing.
    """
    require_number("robot_radius", robot_radius, 0.0, 1e9)
    require_number("clearance", clearance, 0.0, 1e9)
    require_integer("seed", seed, 0, 2**31)
    if planner not in PLANNERS:
        raise SettingError(f"planner: expected {' or '.join(PLANNERS)}, got {planner!r:.80}")
    if max_seconds is not None:
        require_number("max_seconds", max_seconds, 1e-3, 1e9)
    if max_evaluations is not None:
        require_integer("max_evaluations", max_evaluations, 1)
    began = time.monotonic()
    task = read_task(where, start, goal, robot_radius + clearance, workspace, coordinates)
    before = None if previous is None else require_previous(previous, task)
    exact = task.shortest if planner == "auto" else None
    improvements = [] if exact is None else [improvement_of(task, exact[1], "exact planner", began)]
    evaluations, stopped = 0, False
    if exact is None or optimizer is not None or controller is not None:
        search = Search(task, optimizer, controller, seed, began, improvements)
        if before is not None:
            search.begin_with(task.frame.to_frame(before))
        stopped = search.run_until(
            math.inf if max_evaluations is None else max_evaluations,
            math.inf if max_seconds is None else began + max_seconds,
            math.inf if max_evaluations or max_seconds else EPISODES,
        )
        evaluations = search.evaluations
    if not improvements and planner == "auto":
        stand_in = certified(task, shortest_path(task.grown)[1])
        if stand_in is not None:
            improvements.append(improvement_of(task, stand_in, "exact planner", began))
    seconds = time.monotonic() - began
    known = task.shortest  # says so where there is no path at all
    if not improvements:
        raise NoPathError(
            f"no free path found on {task.given.name!r} with {evaluations:,} evaluations in {seconds:.2f} "
            "seconds; a larger budget, or `planner='auto'`, may help"
        )
    best = improvements[-1]
    gap = None if known is None else task.frame.factor * best.length / known[0] - 1.0
    least = clearance_of(task.bare, task.frame.to_frame(best.path)) / task.frame.factor
    return Plan(
        task.given,
        task.for_user(best.path),
        best.length,
        least,
        evaluations,
        seconds,
        gap,
        best.found_by,
        stopped,
        tuple(replace(one, path=task.for_user(one.path)) for one in improvements),
        task.projection,
    )
