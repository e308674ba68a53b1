"""The planner as a function: the best free path on a map, and others through other corridors."""

import time
from collections.abc import Callable, Mapping
from pathlib import Path

from numpy.typing import ArrayLike

from swarm_gym.checks import require_number
from swarm_gym.planning.drive_run import DriveRun
from swarm_gym.planning.maps import AnyMap
from swarm_gym.planning.planning_run import PlanningRun
from swarm_gym.planning.request import Request
from swarm_gym.planning.result import Plan
from swarm_gym.planning.steady import SWITCH_MARGIN
from swarm_gym.planning.tasks import Task, read_task
from swarm_gym.scenarios import Point
from swarm_gym.scenarios.graded_map import Grading


def plan(
    where: AnyMap,
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
    unknown: str = "blocked",
    lethal: int | None = None,
    terrain: Mapping[str, float] | None = None,
    wishes: Mapping[str, float] | None = None,
    alternatives: int = 1,
    switch_margin: float = SWITCH_MARGIN,
    turning_radius: float | None = None,
    start_heading: float | None = None,
    goal_heading: float | None = None,
    reverse: bool = False,
    curvature_rate: float | None = None,
) -> Plan:
    """Return a short free path from start to goal.

    Where the exact shortest path is quickly known, it is the result, since no path is shorter; a swarm plans
    after it only if an optimizer or a controller is named. Elsewhere, and with `planner="swarm"`, a swarm
    looks for paths. Its episodes run until a budget is spent, each from another seed; without a budget,
    `EPISODES` do. The best path of each is made free, see `swarm_gym.final_repair`, and the shortest is kept.
    With a longer budget the path is never longer. On grid maps, swarms begin around a path of A*: the first
    around the shortest one, the others around paths that a block somewhere on the best path so far leaves.
    A swarm goes on from a previous path: its repair is kept first, and on grid maps the first swarm begins
    around it. Another corridor is one on another side of an obstacle. A path in another corridor than the
    previous one is taken only if it is better by `switch_margin`.

    Grades of a map and wishes make the least sum of wishes the aim, see `swarm_gym.planning.wishes`. The
    exact planner and swarms know the length only: a search over cells, improved locally, plans then.

    Args:
        where: a file (`.yaml` of ROS's map_server, `.map` of Moving AI, GeoJSON), a scenario, its name, a
            `GridMap` or a `GradedMap`.
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
        unknown: meaning of cells that a map of ROS does not know: "blocked", "free", or "dear", free at a
            cost of ground of 1.
        lethal: value from which cells of a map of ROS are blocked, in its scale: 100 by default, and 253,
            that of inscribed cells, on cost maps.
        terrain: cost of ground by letter on maps of Moving AI, such as {"S": 2.0}; infinite for blocked.
        wishes: weights by name of what the path shall keep low besides its length: "ground", the cost of
            ground, "distance", a cost of nearness to obstacles, and "curvature" with a turning radius; by
            default {"ground": 1.0} on graded maps, and with a turning radius
            `swarm_gym.planning.drive_costs.USUAL`.
        alternatives: number of paths to return in `Plan.alternatives`, at most; no two lead through the same
            corridor.
        switch_margin: share of its cost by which a path in another corridor must be better than the best one
            in the corridor of `previous`; 0 takes the best path anyway.
        turning_radius: radius of the smallest circle that the robot can drive, in map units; the result is
            then a curve, see `Plan.curve`. None for a robot that turns on the spot.
        start_heading: heading at the start in degrees, from the x axis of the map towards its y axis; None
            for any.
        goal_heading: heading at the goal in degrees; None for any.
        reverse: whether the robot may also drive backwards.
        curvature_rate: greatest change of the curve's curvature over its length, in 1 / map unit squared;
            None if curvature may jump between arcs.

    Raises:
        ScenarioError: for a map, start or goal that is invalid.
        SettingError: for another value that is invalid, or that the map cannot have, and for a turning
            radius with which the robot cannot leave start or goal.
        UnknownNameError: for a wish of another name.
        NoPathError: if there is no path, or none was found within the budget.
        MissingExtraError: if the map needs a library that is missing.
    """
    require_number("robot_radius", robot_radius, 0.0, 1e9)
    require_number("clearance", clearance, 0.0, 1e9)
    request = Request(
        planner,
        optimizer,
        controller,
        max_evaluations,
        max_seconds,
        seed,
        previous,
        switch_margin,
        alternatives,
        wishes,
        turning_radius,
        start_heading,
        goal_heading,
        reverse,
        curvature_rate,
    )
    grading = Grading(unknown, lethal, terrain)
    began = time.monotonic()
    task = read_task(where, start, goal, robot_radius + clearance, workspace, coordinates, grading)
    return run_of(task, request, began, lambda: False).run()


def run_of(
    task: Task, request: Request, began: float, is_stopped: Callable[[], bool]
) -> PlanningRun | DriveRun:
    """Return the run of a request on a task; both classes describe arguments and errors."""
    kind = PlanningRun if request.turning_radius is None else DriveRun
    return kind(task, request, began, is_stopped)
