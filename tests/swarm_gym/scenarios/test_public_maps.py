"""Public maps, if they are in the data folder: they load, paths are planned on them, and they are drawn."""

import gymnasium
import numpy as np
import pytest

import swarm_gym  # noqa: F401
from helpers.public_maps import needed
from helpers.slow import slow_but
from swarm_gym.reference import shortest_grid_path, shortest_path
from swarm_gym.scenarios import make_scenario
from swarm_gym.scenarios.formats.moving_ai import read_map, read_scenarios

# Map and problem file; those of arena and den400d are in test_grid_planners.py.
BENCHMARKS = (
    ("maze-128-128-10.map", "maze-128-128-10-random-1.scen"),
    ("random-64-64-20.map", "random-64-64-20-random-1.scen"),
    ("room-64-64-8.map", "room-64-64-8-random-1.scen"),
)
TASKS = (
    "moving-ai:arena#100",
    "moving-ai:room-64-64-8?start=1,1&goal=60,60",
    "moving-ai:random-64-64-20?start=1,1&goal=60,60",
    "moving-ai:maze-128-128-10?start=1,1&goal=100,100",
    "ros:turtlebot3_world?start=-2,-0.5&goal=2,0.5",
    "ros:turtlebot3_world?start=-2,-0.5&goal=2,0.5&inflate=0.1",
    "ros:playground?start=0,0&goal=3,0",
    "moving-ai:Berlin_1_256?start=0,0&goal=255,255",
    "moving-ai:Paris_1_256?start=0,0&goal=255,250",
    "moving-ai:warehouse-20-40-10-2-2?start=1,1&goal=338,162",
    "ros:willow-2010-02-18-0.10?start=10.15,56.55&goal=35.15,3.25",
)


@pytest.mark.parametrize(("map_file", "problem_file"), BENCHMARKS)
def test_published_lengths_are_those_of_paths_on_the_grid(map_file, problem_file):
    grid, problems = read_map(needed(map_file)), read_scenarios(needed(problem_file))
    for problem in problems[:: len(problems) // 40]:
        length = 0.0
        if problem.start != problem.goal:
            length = shortest_grid_path(grid.blocked, problem.start, problem.goal).length
        assert length == pytest.approx(problem.length, abs=1e-3)


@pytest.mark.parametrize("name", slow_but([TASKS[0], TASKS[2], TASKS[5], *TASKS[7:]], TASKS))
def test_a_public_map_is_planned_on_and_drawn(name):
    kind, _, rest = name.partition(":")
    needed(rest.replace("#", "?").partition("?")[0] + (".map" if kind == "moving-ai" else ".yaml"))
    scenario = make_scenario(name)
    length, points = shortest_path(scenario)
    assert scenario.straight_line <= length + 1e-9
    np.testing.assert_allclose(points[[0, -1]], [scenario.start, scenario.target], atol=1e-9)
    options = {"encoding": "bezier", "initial_population_size": 20, "render_mode": "rgb_array"}
    env = gymnasium.make("swarm_gym/ParticleSwarm-v0", scenario=name, **options)
    env.reset(seed=0)
    for _ in range(3):
        _, _, _, _, info = env.step(np.array([20.0, 0.5]))
    assert info["best_fitness"] >= length - 1e-6
    frame = env.render()
    assert len(np.unique(frame.reshape(-1, 3), axis=0)) > 10
    env.close()
