"""The option `clearance`: paths keep a distance from obstacles, measured by shapely on the map as it is."""

import numpy as np
import pytest
import shapely

from helpers.plans import obstacles_of
from helpers.slow import slow_but
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import NoPathError, ScenarioError, SettingError
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario

# Scenario, clearance, and options of the encoding.
TASKS = [
    ("case1", 4.0, {"num_waypoints": 31}),
    ("case3", 10.0, {"num_waypoints": 31}),
    ("rooms:0", 0.5, {"encoding": "bezier", "num_control_points": 8}),
    ("caves:3", 0.3, {"encoding": "bezier", "num_control_points": 8}),
    ("rooms:0", 0.5, {"encoding": "waypoints"}),
]


@pytest.mark.parametrize(("name", "clearance", "options"), slow_but([*TASKS[:2], TASKS[-1]], TASKS))
def test_free_paths_keep_the_clearance_from_the_map_as_it_is(name, clearance, options):
    scenario = make_scenario(name)
    env = SwarmEnv(
        "particle-swarm", scenario=name, clearance=clearance, source="guided", iterations=20,
        initial_population_size=40, final_repair=True, **options,
    )  # fmt: skip
    env.reset(seed=2)
    ended = False
    while not ended:
        _, _, ended, _, info = env.step(np.array([40.0, 0.5]))
    area = obstacles_of(scenario)
    for path in (info["repaired_path"], *([info["feasible_path"]] if "feasible_path" in info else [])):
        assert np.isfinite(path).all()
        assert shapely.LineString(path).distance(area) >= clearance * (1.0 - 1e-6)
    problem = env.simulation.problems[0]
    assert shortest_path(problem.scenario)[0] >= shortest_path(scenario)[0] - 1e-9


@pytest.mark.parametrize("name", ["case2", "block:50"])
def test_no_random_path_is_free_that_is_closer_than_the_clearance(name):
    scenario, clearance = make_scenario(name), 5.0 if name == "case2" else 1.5
    options = {} if name == "case2" else {"encoding": "bezier"}
    env = SwarmEnv("firefly", scenario=name, clearance=clearance, source="guided", **options)
    env.reset(seed=1)
    problem, area = env.simulation.problems[0], obstacles_of(scenario)
    free = 0
    for vector in env.simulation.positions(0):
        fitness, collision = problem.evaluate(vector)
        distance = shapely.LineString(problem.points(vector)).distance(area)
        if collision == 0.0:
            free += 1
            assert distance >= clearance * (1.0 - 1e-6)
        assert fitness > 0.0
        if distance < 0.9 * clearance:
            assert collision > 0.0
    assert free > 0


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"scenario": "case1", "clearance": -1.0}, SettingError, "clearance.*-1"),
        ({"scenario": "case1", "clearance": float("nan")}, SettingError, "clearance.*nan"),
        ({"scenario": "function:rastrigin-5", "clearance": 1.0}, SettingError, "'clearance' has no effect"),
        ({"scenario": "rooms:0", "clearance": 30.0}, ScenarioError, "grown by 30"),
        (
            {"scenario": "dynamic:case3-drive@1,every=1,distance=80", "clearance": 1.0},
            SettingError,
            "clearance 1 cannot hold for a robot",
        ),
    ],
)
def test_a_clearance_that_cannot_hold_is_refused(options, error, message):
    with pytest.raises(error, match=message):
        SwarmEnv("firefly", **options)


def test_obstacles_that_leave_no_path_when_they_grow_are_refused():
    narrow = np.zeros((9, 21), dtype=np.bool_)
    narrow[:, 10] = True
    narrow[4, 10] = False
    scenario = GridScenario("narrow", GridMap("narrow", narrow), (2.0, 4.0), (18.0, 4.0))
    SwarmEnv("firefly", scenario=scenario, encoding="bezier", clearance=0.1)
    with pytest.raises(NoPathError, match=r"grown by 0.6"):
        SwarmEnv("firefly", scenario=scenario, encoding="bezier", clearance=0.6)
