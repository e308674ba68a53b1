"""The tasks that planners are compared on: maps by kind, and drawn pairs of start and target."""

from dataclasses import dataclass

import numpy as np

from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import GridScenario, make_scenario

# A scenario on each map, by kind of map. Those of Moving AI and ROS are files of the data folder.
MAPS: dict[str, str] = {
    "game (arena)": "moving-ai:arena#100",
    "game (den400d)": "moving-ai:den400d#100",
    "maze": "moving-ai:maze-128-128-10?start=34,114&goal=14,73",
    "rooms": "moving-ai:room-64-64-8?start=10,58&goal=42,14",
    "random": "moving-ai:random-64-64-20?start=63,44&goal=39,18",
    "ROS (turtlebot3_world)": "ros:turtlebot3_world?start=-2,-0.5&goal=2,0.5",
    "ROS (playground)": "ros:playground?start=0,0&goal=3,0",
    "generated rooms": "rooms:0",
    "caves": "caves:0",
}
# The straight line from start to target is at least this share of the longer side of the map's free part.
LEAST_LENGTH = 0.4


@dataclass(frozen=True)
class Task:
    """A task, with the length of the exact shortest path at any angle.

    Attributes:
        kind: kind of the map, a key of `MAPS`.
        scenario: map, start and target.
        optimum: length of that path, in map units.
    """

    kind: str
    scenario: GridScenario
    optimum: float


def draw_tasks(kind: str, count: int, seed: int) -> list[Task]:
    """Return tasks on the map of a kind, between drawn cells that are connected and far apart.

    Raises:
        ScenarioError: if the file of the map is missing.
    """
    first = make_scenario(MAPS[kind])
    assert isinstance(first, GridScenario)
    grid, rng = first.map, np.random.default_rng(seed)
    part = grid.components == grid.components[tuple(reversed(grid.cell_of(first.start)))]
    cells = np.argwhere(part)[:, ::-1]
    least = LEAST_LENGTH * np.ptp(cells, axis=0).max()
    tasks: list[Task] = []
    while len(tasks) < count:
        start, target = cells[rng.integers(len(cells), size=2)]
        if np.hypot(*(target - start)) >= least:
            ends = tuple(grid.to_map(start).tolist()), tuple(grid.to_map(target).tolist())
            scenario = GridScenario(f"{kind}, task {len(tasks)}", grid, *ends)
            tasks.append(Task(kind, scenario, shortest_path(scenario)[0]))
    return tasks
