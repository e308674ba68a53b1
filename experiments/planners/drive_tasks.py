"""Tasks of driving: start and goal with drawn headings on the maps of `tasks`, for a small robot."""

import math
from dataclasses import dataclass

import numpy as np

from experiments.planners.tasks import PlannerTask, draw_tasks
from swarm_gym.errors import ScenarioError
from swarm_gym.problem.geometry.clearance import keeps_distance
from swarm_gym.reference import shortest_robot_path
from swarm_gym.scenarios import GridMap, GridScenario

# Radius and turning radius of the robot: metres on maps of ROS, cells on others.
ON_ROS, ON_CELLS = (0.1, 0.2), (0.3, 1.0)
HEADINGS = 16  # drawn ones are multiples of a full turn over this number
AHEAD = 1.5  # turning radii that are free straight ahead of the start, and straight before the goal
DRAWS = 40  # of headings, before other ends are drawn


@dataclass(frozen=True)
class DriveTask:
    """A task of driving.

    Attributes:
        kind: kind of the map.
        number: number of the task on it.
        scenario: map, start and target.
        headings: headings at start and goal, in degrees.
        radius: radius of the robot, in map units.
        turning_radius: radius of the smallest circle that the robot drives, in map units.
        shortest: length of the exact shortest path of a robot that turns on the spot, in map units.
    """

    kind: str
    number: int
    scenario: GridScenario
    headings: tuple[float, float]
    radius: float
    turning_radius: float
    shortest: float


def draw_drive_tasks(kind: str, count: int, seed: int) -> list[DriveTask]:
    """Return tasks on the map of a kind of `tasks.MAPS`.

    Raises:
        ScenarioError: if the file of the map is missing.
    """
    radius, turning_radius = ON_ROS if kind.startswith(("ROS", "office")) else ON_CELLS
    headings: list[tuple[float, float]] = []

    def make(kind: str, scenario: GridScenario, rng: np.random.Generator) -> PlannerTask | None:
        try:
            length = shortest_robot_path(scenario, radius)[0]
        except ScenarioError:
            return None
        start = _heading(scenario.map, scenario.start, 1.0, radius, turning_radius, rng)
        goal = _heading(scenario.map, scenario.target, -1.0, radius, turning_radius, rng)
        if start is None or goal is None:
            return None
        headings.append((start, goal))
        return PlannerTask(kind, scenario, length)

    drawn = draw_tasks(kind, count, seed, make)
    return [
        DriveTask(kind, number, one.scenario, ends, radius, turning_radius, one.optimum)
        for number, (one, ends) in enumerate(zip(drawn, headings, strict=True))
    ]


def _heading(
    grid: GridMap,
    point: tuple[float, float],
    sign: float,
    radius: float,
    turning_radius: float,
    rng: np.random.Generator,
) -> float | None:
    """Return a drawn heading in degrees with free room ahead, or behind for a negative sign; None without."""
    for _ in range(DRAWS):
        heading = 360.0 / HEADINGS * int(rng.integers(HEADINGS))
        angle, reach = math.radians(heading), sign * AHEAD * turning_radius
        end = (point[0] + reach * math.cos(angle), point[1] + reach * math.sin(angle))
        cells = grid.to_cells([point, end])
        x_min, y_min, x_max, y_max = grid.extent
        is_on_map = x_min <= end[0] <= x_max and y_min <= end[1] <= y_max
        if is_on_map and keeps_distance(grid.blocked, cells, 1.05 * radius / grid.resolution):
            return heading
    return None
