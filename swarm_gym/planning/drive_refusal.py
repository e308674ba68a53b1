"""Reasons why there is no drivable curve: an end that a robot cannot leave, or limits that are too tight."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from swarm_gym.errors import NoPathError, SettingError, SwarmGymError, shown
from swarm_gym.planning.curves.search import BEST_NODE, found
from swarm_gym.planning.drive_map import DriveMap
from swarm_gym.planning.drive_search import QUICK, DriveSearch, Driving
from swarm_gym.planning.tasks import Task

NEAR = 1.0  # turning radii; a robot that gets no farther from an end cannot leave it
SMALLER = (0.5, 0.25, 0.125)  # turning radii that are tried, over the one that is asked for


def refusal_of(
    drive_map: DriveMap,
    driving: Driving,
    rate: float | None,
    evaluations: int,
    is_over: Callable[[], bool],
) -> SwarmGymError:
    """Return the error that says why no curve was found.

    Args:
        drive_map: the task.
        driving: limits of the robot.
        rate: greatest change of curvature over length; None if it may jump.
        evaluations: work of the searches that have found nothing.
        is_over: whether time is up; then nothing more is tried.
    """
    task = drive_map.task
    what = f"no curve with {_described(driving)} was found on {shown(task.given.name)}"
    if is_over():
        return NoPathError(f"{what} in the time; a longer time may help")
    if rate is not None:
        length = _length(drive_map, driving, is_over)
        if math.isfinite(length):
            return NoPathError(
                f"{what} that obeys the curvature rate {rate:g}; without it there is a curve of length "
                f"{length:.6g}; expected a larger curvature_rate, or none"
            )
    for is_goal in (False, True):
        error = _trapped(drive_map, driving, is_goal, is_over)
        if error is not None:
            return error
    return NoPathError(f"{what} among {evaluations:,} poses; {_possible(drive_map, driving, is_over)}")


def _described(driving: Driving) -> str:
    limits = [f"turning_radius {driving.radius:g}"]
    for name, heading in (("start_heading", driving.start_heading), ("goal_heading", driving.goal_heading)):
        if heading is not None:
            limits.append(f"{name} {math.degrees(heading):g}")
    return ", ".join(limits)


def _trapped(
    drive_map: DriveMap, driving: Driving, is_goal: bool, is_over: Callable[[], bool]
) -> SettingError | None:
    """Return an error if the robot cannot leave the start, or cannot come to the goal; else None."""
    towards = _backwards(drive_map, driving) if is_goal else (drive_map, driving)
    reach = DriveSearch(*towards, 0.0).reach(is_over)
    if reach > NEAR * driving.radius:
        return None
    task, heading = drive_map.task, driving.goal_heading if is_goal else driving.start_heading
    verb, end = ("reach goal", task.goal) if is_goal else ("leave start", task.start)
    with_heading = "any heading" if heading is None else f"heading {math.degrees(heading):g}"
    better = "a smaller one"
    for share in SMALLER:
        radius = share * driving.radius
        smaller = DriveMap(towards[0].task, radius, drive_map.weights)
        if (
            DriveSearch(smaller, replace(towards[1], radius=radius), 0.0).reach(is_over)
            > NEAR * driving.radius
        ):
            better = f"a smaller one, such as {radius:g}"
            break
    other = "" if heading is None else ", or another heading"
    back = "" if driving.reverses else ", or reverse=True"
    return SettingError(
        f"turning_radius {driving.radius:g}: the robot cannot {verb} {end} with {with_heading}; farther than "
        f"{reach:.3g} from it, all arcs of that radius meet obstacles; expected {better}{other}{back}"
    )


def _possible(drive_map: DriveMap, driving: Driving, is_over: Callable[[], bool]) -> str:
    """Return what is possible with other limits, as the end of a message."""
    others: list[tuple[str, Driving]] = []
    if driving.start_heading is not None or driving.goal_heading is not None:
        others.append(("any headings", replace(driving, start_heading=None, goal_heading=None)))
    if not driving.reverses:
        others.append(("reverse=True", replace(driving, reverses=True)))
    others.append((f"turning_radius {driving.radius / 2.0:g}", replace(driving, radius=driving.radius / 2.0)))
    known = []
    for name, other in others:
        if is_over():
            break
        length = _length(drive_map, other, is_over)
        if math.isfinite(length):
            known.append(f"with {name} there is a curve of length {length:.6g}")
    shortest = drive_map.task.shortest
    if shortest is not None:
        length = shortest[0] / drive_map.task.frame.factor
        known.append(f"without a turning radius there is a path of length {length:.6g}")
    return "; ".join(known) if known else "nothing is known of other limits"


def _length(drive_map: DriveMap, driving: Driving, is_over: Callable[[], bool]) -> float:
    """Return the length of the first curve within other limits; infinite without one."""
    plain = DriveMap(drive_map.task, driving.radius, dict.fromkeys(drive_map.weights, 0.0))
    search = DriveSearch(plain, driving, 0.0).search(QUICK, is_over)
    if search.counts[BEST_NODE] < 0:
        return math.inf
    _, pieces = found(search)
    return float(np.abs(pieces[:, 1]).sum()) * plain.unit


def _backwards(drive_map: DriveMap, driving: Driving) -> tuple[DriveMap, Driving]:
    """Return the task from goal to start: a robot that drives it the other way comes to the goal."""
    task: Task = drive_map.task
    given = replace(task.given, start=task.given.target, target=task.given.start)
    turned = [
        None if heading is None else heading + math.pi
        for heading in (driving.goal_heading, driving.start_heading)
    ]
    back = replace(driving, start_heading=turned[0], goal_heading=turned[1])
    return DriveMap(replace(task, given=given), drive_map.radius, drive_map.weights), back
