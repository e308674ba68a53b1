"""Runs of the planner of any kind: of polylines, or of curves for a robot with a turning circle."""

from collections.abc import Callable

from swarm_gym.planning.drive_run import DriveRun
from swarm_gym.planning.planning_run import PlanningRun
from swarm_gym.planning.request import Request
from swarm_gym.planning.tasks import Task


def run_of(
    task: Task, request: Request, began: float, is_stopped: Callable[[], bool]
) -> PlanningRun | DriveRun:
    """Return the run of a request on a task; both classes describe arguments and errors."""
    kind = PlanningRun if request.turning_radius is None else DriveRun
    return kind(task, request, began, is_stopped)
