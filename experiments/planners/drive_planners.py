"""Planners of driven curves that are measured: those of this project, and RRT* of OMPL in Dubins' space.

OMPL asks Python whether a motion is free, and Python asks the compiled test of this project. Where the sum of
wishes is its objective, OMPL asks Python for costs, too. What it asks counts as its time. All times are those
of the processor, so that other work on the machine does not matter.
"""

import math
import time
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.planners.all_planners import ompl_modules
from experiments.planners.drive_check import STEP
from experiments.planners.drive_tasks import DriveTask
from swarm_gym.planning import Curve
from swarm_gym.planning.curves.pieces import connect
from swarm_gym.planning.curves.search import Limits, cost_between
from swarm_gym.planning.drive_costs import CHANGE, USUAL
from swarm_gym.planning.drive_map import DriveMap
from swarm_gym.planning.drive_search import DriveSearch, Driving
from swarm_gym.planning.tasks import read_task

Floats = NDArray[np.float64]

WISHES = {**USUAL, "ground": 0.0}
LENGTH = dict.fromkeys(WISHES, 0.0)
SLICE = 0.01  # seconds between two looks at whether OMPL has a path
SIMPLIFYING = 0.1  # share of the time that is left for OMPL's simplifier


class Driven(NamedTuple):
    """A curve that a planner has found.

    Attributes:
        first: seconds until its first curve.
        seconds: seconds until the last one.
        poses: poses along it, at most `STEP` apart, with headings in radians, (n, 3).
        curve: the curve, for its sum of wishes.
    """

    first: float
    seconds: float
    poses: Floats
    curve: Curve


# A planner: task, seconds -> what it found, or None.
DrivePlanner = Callable[[DriveTask, float], Driven | None]


def ours(wishes: Mapping[str, float]) -> DrivePlanner:
    """Return this project's search for curves with these wishes; a map is prepared by its first task."""

    def run(task: DriveTask, seconds: float) -> Driven | None:
        _ = drive_map_of(task, wishes).field  # kept for the map
        began = time.thread_time()
        drive_map = drive_map_of(task, wishes)
        start, goal = map(math.radians, task.headings)
        search = DriveSearch(drive_map, Driving(task.turning_radius, False, start, goal), wishes["curvature"])
        first, last, best = math.inf, math.inf, None
        for curve in search.curves(lambda: time.thread_time() - began >= seconds, True):
            last = time.thread_time() - began
            first, best = min(first, last), curve
        if best is None:
            return None
        poses = best.sampled(STEP)[:, :3]
        poses[:, 2] = np.radians(poses[:, 2])
        return Driven(first, last, poses, best)

    return run


def of_ompl(wishes: Mapping[str, float]) -> DrivePlanner:
    """Return RRT* of OMPL in Dubins' space, with its simplifier, for these wishes or the length alone.

    Raises:
        MissingExtraError: if OMPL is not installed.
    """
    base, geometric = ompl_modules()

    def run(task: DriveTask, seconds: float) -> Driven | None:
        drive_map = drive_map_of(task, wishes)
        unit, field = drive_map.unit, drive_map.field
        radius = task.turning_radius / unit
        limits = Limits(radius, False, wishes["curvature"], CHANGE * radius)

        def values(state: Any) -> Floats:
            return np.array([state.getX(), state.getY(), state.getYaw()])

        def ending(at: float) -> Any:
            return base.PlannerTerminationCondition(lambda: time.thread_time() >= at)

        class Motions(base.MotionValidator):  # type: ignore[name-defined]
            def checkMotion(self, state: Any, other: Any, last: Any = None) -> bool:  # noqa: ARG002, N802
                return math.isfinite(cost_between(field, limits, values(state), values(other), True))

        class Sum(base.OptimizationObjective):  # type: ignore[name-defined]
            def stateCost(self, state: Any) -> Any:  # noqa: ARG002, N802
                return base.Cost(0.0)

            def motionCost(self, state: Any, other: Any) -> Any:  # noqa: N802
                return base.Cost(cost_between(field, limits, values(state), values(other), False))

            def motionCostHeuristic(self, state: Any, other: Any) -> Any:  # noqa: N802
                return base.Cost(space.distance(state, other))

        began = time.thread_time()
        space = base.DubinsStateSpace(radius)
        bounds = base.RealVectorBounds(2)
        for axis in range(2):
            bounds.setLow(axis, float(field.region[axis]))
            bounds.setHigh(axis, float(field.region[axis + 2]))
        space.setBounds(bounds)
        information = base.SpaceInformation(space)
        motions = Motions(information)
        information.setMotionValidator(motions)
        information.setStateValidityChecker(lambda state: motions.checkMotion(state, state))
        information.setup()
        setup = geometric.SimpleSetup(information)
        ends = []
        for point, heading in zip((task.scenario.start, task.scenario.target), task.headings, strict=True):
            state = space.allocState()
            x, y = drive_map.to_nodes(point).tolist()
            state.setX(x)
            state.setY(y)
            state.setYaw(math.remainder(math.radians(heading), math.tau))
            ends.append(state)
        setup.setStartAndGoalStates(*ends)
        objective = Sum if any(wishes.values()) else base.PathLengthOptimizationObjective
        setup.setOptimizationObjective(objective(information))
        setup.setPlanner(geometric.RRTstar(information))
        first, solving = math.inf, (1.0 - SIMPLIFYING) * seconds
        while (spent := time.thread_time() - began) < solving:
            # Until there is a path, solving ends now and then, to see when the first one is there.
            until = min(spent + SLICE, solving) if math.isinf(first) else solving
            setup.solve(ending(began + until))
            if math.isinf(first) and setup.haveExactSolutionPath():
                first = time.thread_time() - began
        if math.isinf(first):
            return None
        path = geometric.PathGeometric(setup.getSolutionPath())
        geometric.PathSimplifier(information).simplify(path, ending(began + seconds))
        spent = time.thread_time() - began
        states = list(path.getStates())
        return Driven(first, spent, *_followed(drive_map, space, states, values, task.turning_radius))

    return run


def _followed(
    drive_map: DriveMap, space: Any, states: list[Any], values: Callable[[Any], Floats], radius: float
) -> tuple[Floats, Curve]:
    """Return poses by OMPL's interpolation along states, and the same curve as pieces."""
    unit, poses, pieces = drive_map.unit, [], []
    between = space.allocState()
    for state, other in pairwise(states):
        steps = max(math.ceil(space.distance(state, other) * unit / STEP), 1)
        for k in range(steps):
            space.interpolate(state, other, k / steps, between)
            poses.append(values(between))
        part = np.zeros((3, 2))
        connect(values(state), values(other), radius / unit, False, False, part)
        pieces.append(part * [1.0 / unit, unit])
    poses.append(values(states[-1]))
    made = np.array(poses)
    made[:, :2] = drive_map.to_map(made[:, :2])
    start = np.array([*made[0, :2], math.degrees(made[0, 2])])
    return made, Curve(start, np.vstack(pieces), radius)


def drive_map_of(task: DriveTask, wishes: Mapping[str, float]) -> DriveMap:
    """Return the drive map of a task."""
    ends = task.scenario.start, task.scenario.target
    return DriveMap(read_task(task.scenario.map, *ends, task.radius), task.turning_radius, wishes)


# By the name in the tables.
DRIVE_PLANNERS: Mapping[str, Callable[[], DrivePlanner]] = {
    "curve search": lambda: ours(WISHES),
    "curve search, length alone": lambda: ours(LENGTH),
    "OMPL RRT*, sum of wishes": lambda: of_ompl(WISHES),
    "OMPL RRT*, length alone": lambda: of_ompl(LENGTH),
}
