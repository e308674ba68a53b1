"""Planners that are measured: those of OMPL, smoothed A*, the exact planner at any angle, and our swarms.

OMPL's planners are compiled; they ask Python whether a motion is free, and Python asks the compiled traversal
of this project. Of an anytime planner the path is shortened at each checkpoint, which counts as its time.
"""

import time
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from experiments.planners.found import Floats, Found
from experiments.planners.tasks import PlannerTask
from swarm_gym.errors import MissingExtraError, NoPathError
from swarm_gym.final_repair import final_repair
from swarm_gym.planning import plan
from swarm_gym.problem import GridProblem
from swarm_gym.problem.geometry.traversal import segment_is_free
from swarm_gym.reference import shortest_path
from swarm_gym.reference.any_angle import AnyAnglePlanner
from swarm_gym.ways import shortest_way

# A planner: task, times at which its path is asked for, in seconds, and seed -> the paths that it has found.
Planner = Callable[[PlannerTask, Sequence[float], int], list[Found]]

# The share of the time up to a checkpoint after which a path is taken, so that it can be shortened.
SOLVING = 0.9
OMPL = ("RRTConnect", "RRTstar", "InformedRRTstar", "BITstar")


def without_chance(find: Callable[[PlannerTask], Floats | None]) -> Planner:
    """Return the planner of a function that returns one path, always the same, or None."""

    def plan(task: PlannerTask, checkpoints: Sequence[float], seed: int) -> list[Found]:  # noqa: ARG001
        began = time.perf_counter()
        path = find(task)
        return [] if path is None else [Found(time.perf_counter() - began, path)]

    return plan


def _repaired(task: PlannerTask, path: Floats | None) -> Floats | None:
    """Return a path after the final repair of this project; None if there is none."""
    assert path is not None
    found = final_repair(GridProblem(task.scenario), path)
    return None if found is None else found.path


def _on_map_prepared_anew(task: PlannerTask) -> Floats:
    grid = task.scenario.map
    start, target = grid.to_cells([task.scenario.start, task.scenario.target]).tolist()
    _, points = AnyAnglePlanner(grid.blocked).shortest_path(start, target)
    return grid.to_map(points)


# By the name in the tables. Swarms begin around A*'s path after final repair, or around the previous path
# after it. The time of the last one has the preparation of the map in it.
DETERMINISTIC: dict[str, Planner] = {
    "A*, smoothed": without_chance(lambda task: shortest_way(task.scenario)),
    "A*, final repair": without_chance(lambda task: _repaired(task, shortest_way(task.scenario))),
    "previous path, final repair": without_chance(lambda task: _repaired(task, task.previous)),
    "exact, any angle": without_chance(lambda task: shortest_path(task.scenario)[1]),
    "exact, any angle, map prepared anew": without_chance(_on_map_prepared_anew),
}


def of_ompl(name: str) -> Planner:
    """Return a planner of OMPL by the name of its class.

    Raises:
        MissingExtraError: if OMPL is not installed.
    """
    base, geometric = ompl_modules()

    def plan(task: PlannerTask, checkpoints: Sequence[float], seed: int) -> list[Found]:  # noqa: ARG001
        grid = task.scenario.map
        began = time.perf_counter()
        space = base.RealVectorStateSpace(2)
        bounds = base.RealVectorBounds(2)
        for axis, cells in enumerate((grid.width, grid.height)):
            bounds.setLow(axis, -0.5)
            bounds.setHigh(axis, cells - 0.5)
        space.setBounds(bounds)
        information = base.SpaceInformation(space)
        motions = _motion_validator(base, information, grid.blocked)
        information.setMotionValidator(motions)
        information.setStateValidityChecker(lambda state: motions.is_free(state, state))
        information.setup()
        setup = geometric.SimpleSetup(information)
        ends = []
        for point in (task.scenario.start, task.scenario.target):
            state = space.allocState()
            state[0], state[1] = grid.to_cells(point).tolist()
            ends.append(state)
        setup.setStartAndGoalStates(*ends)
        setup.setOptimizationObjective(base.PathLengthOptimizationObjective(information))
        setup.setPlanner(getattr(geometric, name)(information))
        found: list[Found] = []
        for checkpoint in checkpoints:
            left = SOLVING * checkpoint - (time.perf_counter() - began)
            if left <= 0.0:
                continue
            setup.solve(left)
            if setup.haveExactSolutionPath():
                path = geometric.PathGeometric(setup.getSolutionPath())
                geometric.PathSimplifier(information).simplifyMax(path)
                points = np.array([(state[0], state[1]) for state in path.getStates()])
                found.append(Found(time.perf_counter() - began, grid.to_map(points)))
                if name == "RRTConnect":  # it ends with its first path
                    break
        return found

    return plan


@cache
def ompl_modules() -> tuple[Any, Any]:
    """Return OMPL's modules; it has one stream of random numbers for the whole process, seeded once."""
    try:
        from ompl import base, geometric, util
    except ImportError as error:
        raise MissingExtraError("a comparison with planners", "OMPL", "planners") from error
    util.setLogLevel(util.LogLevel.LOG_NONE)
    util.RNG.setSeed(1)
    return base, geometric


def _motion_validator(base: Any, information: Any, blocked: np.ndarray) -> Any:
    class Motions(base.MotionValidator):
        """An exact test of the straight motion between two states."""

        def is_free(self, state: Any, other: Any) -> bool:
            return bool(segment_is_free(blocked, state[0], state[1], other[0], other[1]))

        def checkMotion(self, state: Any, other: Any, last: Any = None) -> bool:  # noqa: ARG002, N802
            return self.is_free(state, other)

    return Motions(information)


class Swarm(NamedTuple):
    """A way to plan with a swarm.

    Attributes:
        optimizer: name of the optimizer.
        controller: name of the controller.
        goes_on: whether it begins around the previous path of a task of replanning, not around that of A*.
    """

    optimizer: str
    controller: str
    goes_on: bool = False


# By the name in the tables.
SWARMS = {
    "swarm, fixed size": Swarm("multivariate", "fixed:65"),
    "swarm, SPSFA-TIP's rules": Swarm("firefly", "spsfa-tip"),
    "swarm, learned": Swarm("firefly", "learned:three-cases/0"),
    "swarm, fixed size, from the previous path": Swarm("multivariate", "fixed:65", goes_on=True),
}


def of_swarm(name: str) -> Planner:
    """Return our planner with the optimizer and the controller of a name in `SWARMS`."""
    swarm = SWARMS[name]

    def run(task: PlannerTask, checkpoints: Sequence[float], seed: int) -> list[Found]:
        try:
            found = plan(
                task.scenario,
                planner="swarm",
                optimizer=swarm.optimizer,
                controller=swarm.controller,
                max_seconds=checkpoints[-1],
                seed=seed,
                previous=task.previous if swarm.goes_on else None,
                switch_margin=0.0,  # the shortest path counts
            )
        except NoPathError:
            return []
        return [
            Found(step.seconds, step.path, step.found_by.startswith("swarm")) for step in found.improvements
        ]

    return run
