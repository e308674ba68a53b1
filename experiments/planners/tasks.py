"""The tasks that planners are compared on: maps by kind, and drawn pairs of start and target.

A task of replanning has a path besides, and an obstacle that has appeared on it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario

Floats = NDArray[np.float64]

AnyTask = TypeVar("AnyTask")

# A scenario on each map, by kind of map. Those of Moving AI and ROS are files of the data folder.
MAPS: dict[str, str] = {
    "game (arena)": "moving-ai:arena#100",
    "game (den400d)": "moving-ai:den400d#100",
    "maze": "moving-ai:maze-128-128-10?start=34,114&goal=14,73",
    "rooms": "moving-ai:room-64-64-8?start=10,58&goal=42,14",
    "random": "moving-ai:random-64-64-20?start=63,44&goal=39,18",
    "city (Berlin)": "moving-ai:Berlin_1_256?start=0,0&goal=255,255",
    "city (Paris)": "moving-ai:Paris_1_256?start=0,0&goal=255,250",
    "warehouse": "moving-ai:warehouse-20-40-10-2-2?start=1,1&goal=338,162",
    "office (Willow Garage)": "ros:willow-2010-02-18-0.10?start=10.15,56.55&goal=35.15,3.25",
    "ROS (turtlebot3_world)": "ros:turtlebot3_world?start=-2,-0.5&goal=2,0.5",
    "ROS (playground)": "ros:playground?start=0,0&goal=3,0",
    "generated rooms": "rooms:0",
    "caves": "caves:0",
}
# The straight line from start to target is at least this share of the longer side of the map's free part.
LEAST_LENGTH = 0.4
# Obstacles that appear are discs: smallest and largest radius, as shares of the longer side of the map. Their
# centres are on the path, after the first and before the last of these shares of its length.
RADII = (0.02, 0.08)
PLACES = (0.2, 0.8)
MOST_DISCS = 50  # drawn for two ends before others are drawn


@dataclass(frozen=True)
class PlannerTask:
    """A task, with the length of the exact shortest path at any angle.

    Attributes:
        kind: kind of the map, a key of `MAPS`.
        scenario: map, start and target.
        optimum: length of that path, in map units.
        previous: the shortest path before an obstacle appeared, (k, 2), in map units; None where none has.
    """

    kind: str
    scenario: GridScenario
    optimum: float
    previous: Floats | None = field(default=None, compare=False)


# A function of the kind of map, the scenario and a generator that makes a task of them; None if it cannot.
MakeTask = Callable[[str, GridScenario, np.random.Generator], PlannerTask | None]


def planning_task(kind: str, scenario: GridScenario, rng: np.random.Generator) -> PlannerTask:  # noqa: ARG001
    """Return the task of a scenario as it is."""
    return PlannerTask(kind, scenario, shortest_path(scenario)[0])


def replanning_task(kind: str, scenario: GridScenario, rng: np.random.Generator) -> PlannerTask | None:
    """Return the task after an obstacle has appeared on the shortest path; None if it leaves no other."""
    _, path = shortest_path(scenario)
    blocked = _blocked(scenario, path, rng)
    return None if blocked is None else PlannerTask(kind, blocked, shortest_path(blocked)[0], path)


def draw_tasks(kind: str, count: int, seed: int, make_task: MakeTask = planning_task) -> list[PlannerTask]:
    """Return tasks on the map of a kind, between drawn cells that are connected and far apart.

    Args:
        kind: a key of `MAPS`.
        count: number of tasks.
        seed: seed of the draws.
        make_task: makes a task of a drawn scenario; where it cannot, another scenario is drawn.

    Raises:
        ScenarioError: if the file of the map is missing.
    """
    first = make_scenario(MAPS[kind])
    assert isinstance(first, GridScenario)
    grid, rng = first.map, np.random.default_rng(seed)
    part = grid.components == grid.components[tuple(reversed(grid.cell_of(first.start)))]
    cells = np.argwhere(part)[:, ::-1]
    least = LEAST_LENGTH * np.ptp(cells, axis=0).max()
    tasks: list[PlannerTask] = []
    while len(tasks) < count:
        start, target = cells[rng.integers(len(cells), size=2)]
        if np.hypot(*(target - start)) < least:
            continue
        ends = tuple(grid.to_map(start).tolist()), tuple(grid.to_map(target).tolist())
        task = make_task(kind, GridScenario(f"{kind}, task {len(tasks)}", grid, *ends), rng)
        if task is not None:
            tasks.append(task)
    return tasks


def draw_on_maps(kinds: Sequence[str], seed: int, draw: Callable[[str, int], list[AnyTask]]) -> list[AnyTask]:
    """Return tasks on maps of several kinds; maps whose files are missing are left out and named.

    Args:
        kinds: keys of `MAPS`.
        seed: seed of all tasks.
        draw: function that returns the tasks of a kind, drawn with a seed of its own.

    Raises:
        UnknownNameError: if there is no such kind of map.
        ScenarioError: if no map is left.
    """
    drawn: list[AnyTask] = []
    for kind in kinds:
        look_up("kind of map", kind, MAPS)
        try:
            drawn += draw(kind, 1000 * seed + list(MAPS).index(kind))
        except ScenarioError as error:
            print(f"left out: {kind}: {error}")
    if not drawn:
        raise ScenarioError("no map is left to compare planners on")
    return drawn


def _blocked(scenario: GridScenario, path: Floats, rng: np.random.Generator) -> GridScenario | None:
    """Return the scenario with a disc on a path that leaves another way; None if no drawn one does."""
    grid = scenario.map
    ends = np.array([grid.cell_of(scenario.start), grid.cell_of(scenario.target)])
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    for _ in range(MOST_DISCS):
        at = rng.uniform(*PLACES) * lengths[-1]
        x, y = (np.interp(at, lengths, coordinates) for coordinates in path.T)
        centre = grid.to_cells((x, y))
        radius = max(rng.uniform(*RADII) * max(grid.width, grid.height), 1.0)
        if np.hypot(*(ends - centre).T).min() <= radius + 1.0:
            continue
        changed = GridMap(
            grid.name, grid.blocked | grid.disc(centre, radius), grid.resolution, grid.origin, grid.y_up
        )
        try:
            return replace(scenario, map=changed)
        except NoPathError:
            continue
    return None
