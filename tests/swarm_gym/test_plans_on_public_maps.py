"""Planning on public maps of games, mazes, rooms, cities, an office and a warehouse, where they are there."""

import numpy as np
import pytest

from helpers.plans import assert_free
from helpers.public_maps import needed
from swarm_gym.planning import plan
from swarm_gym.scenarios.formats.moving_ai import read_map, read_scenarios
from swarm_gym.scenarios.formats.ros_map import read_ros_map

NUM_TASKS = 10

# Map and file with tasks; None is drawn pairs of cells.
PUBLIC = {
    "movingai/maze-128-128-10.map": "maze-128-128-10-random-1.scen",
    "movingai/room-64-64-8.map": "room-64-64-8-random-1.scen",
    "movingai/random-64-64-20.map": "random-64-64-20-random-1.scen",
    "movingai/arena.map": "arena.map.scen",
    "movingai/den400d.map": "den400d.map.scen",
    "movingai/Berlin_1_256.map": None,
    "movingai/Paris_1_256.map": None,
    "movingai/warehouse-20-40-10-2-2.map": None,
    "ros/turtlebot3_world.yaml": None,
    "ros/playground.yaml": None,
    "ros/willow-2010-02-18-0.10.yaml": None,
}


def tasks_of(file, problems):
    """Return pairs of start and goal in map units, from a file or drawn in the largest free part."""
    rng = np.random.default_rng(0)
    if problems is not None:
        tasks = read_scenarios(file.parent / problems)
        chosen = rng.choice(len(tasks), NUM_TASKS, replace=False)
        return [(tasks[k].start, tasks[k].goal) for k in chosen]
    grid = read_map(file) if file.suffix == ".map" else read_ros_map(file)
    sizes = np.bincount(grid.components.ravel())
    sizes[0] = 0
    cells = np.argwhere(grid.components == sizes.argmax())[:, ::-1]
    drawn = grid.to_map(cells[rng.choice(len(cells), (NUM_TASKS, 2), replace=False)])
    return [(tuple(start), tuple(goal)) for start, goal in drawn.tolist()]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if "maze" in name else pytest.mark.slow) for name in PUBLIC]
)
def test_public_maps_have_free_paths_within_two_per_cent(name):
    file = needed(name)
    gaps = []
    for start, goal in tasks_of(file, PUBLIC[name]):
        found = plan(file, start, goal, planner="swarm")
        assert_free(found)
        gaps.append(found.gap)
    assert np.mean(np.array(gaps) <= 0.02) >= 0.9
