"""Environments of flights over terrain: options, refusals, several maps at once, pictures."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from helpers.loops import looped
from helpers.refusals import refused
from helpers.terrains import rolling_terrain
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers import ALL_OPTIMIZERS, get_optimizer
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.worlds import make_problem

SMALL = {"initial_population_size": 8, "max_population_size": 12, "iterations": 6}
ENCODINGS = ("waypoints", "shifted", "spherical")
OF_VECTORS = sorted(name for name in ALL_OPTIMIZERS if "spherical" in get_optimizer(name).encodings)


def small(optimizer="firefly", scenario=None, **options):
    return SwarmEnv(optimizer, scenario=scenario or rolling_terrain(), **{**SMALL, **options})


def last_info(env, size=10.0, degree=1.0, seed=0):
    _, info = env.reset(seed=seed)
    ended = False
    while not ended:
        _, reward, ended, _, info = env.step(np.array([size, degree]))
        assert np.isfinite(reward)
    return info


def test_gymnasium_checker_passes():
    env = gymnasium.make(
        "swarm_gym/Firefly-v0",
        scenario=rolling_terrain(),
        action="normalised",
        observation="extended",
        **SMALL,
    )
    check_env(env.unwrapped, skip_render_check=True)


@looped(
    "options",
    [{"encoding": encoding, "cost": cost} for encoding in ENCODINGS for cost in ("documented", "metabox")],
)
@pytest.mark.parametrize("source", ["uniform", "smooth"])
def test_the_best_flight_is_that_of_the_problem(options, source):
    env = small(source=source, **options)
    info = last_info(env)
    problem, swarms = env.simulation.problems[0], env.simulation.swarms
    assert problem.num_waypoints == 10
    assert (problem.encoding, problem.cost) == (env.settings.encoding, env.settings.cost)
    assert problem == make_problem(rolling_terrain(), **options)
    vector = swarms.best_position[0, : problem.dimension]
    assert problem.evaluate(vector) == (info["best_fitness"], swarms.best_collision[0])
    assert info["best_path"].shape == (12, 2)
    assert (info["best_path"][0] == env.simulation.problems[0].scenario.start[:2]).all()
    assert (info["best_path"][-1] == env.simulation.problems[0].scenario.target).all()


def test_terrains_of_several_sizes_share_an_environment():
    scenarios = [rolling_terrain(1), rolling_terrain(2, side=60, cell=15.0, threats=12)]
    scenarios.append(rolling_terrain(3, threats=0))
    envs = SwarmVectorEnv(6, "firefly", scenario=scenarios, num_waypoints=6, **SMALL)
    envs.reset(seed=1)
    for _ in range(3):
        envs.step(np.tile([10.0, 0.5], (6, 1)))
    simulation = envs.simulation
    assert len(set(simulation.swarms.problem.tolist())) > 1
    for row in range(6):
        problem = simulation.problem_of(row)
        vector = simulation.swarms.best_position[row, :12]
        found = simulation.swarms.best_fitness[row], simulation.swarms.best_collision[row]
        assert problem.evaluate(vector) == found


def test_smooth_members_begin_nearer_to_free_than_uniform_ones():
    means = {}
    for source in ("uniform", "smooth"):
        env = small(source=source, initial_population_size=12)
        means[source] = np.mean([env.reset(seed=seed)[1]["best_fitness"] for seed in range(10)])
    assert means["smooth"] < 0.5 * means["uniform"]


@looped(
    ("options", "words"),
    [
        ({"encoding": "bezier"}, ("'bezier'", "grid maps", "flights over terrain")),
        ({"clearance": 5.0}, ("'clearance'", "flights over terrain")),
        ({"final_repair": True}, ("'final_repair'", "flights over terrain")),
        ({"length_weight": 0.5}, ("'length_weight'", "flights over terrain")),
        ({"num_waypoints": 3}, ("num_waypoints", "[4, 300]")),
    ],
)
def test_options_without_effect_are_refused_by_name(options, words):
    refused(lambda: small(**options), *words, error=SettingError)


@looped("optimizer", ["ant-colony", "glowworm"])
def test_walks_are_refused_by_name(optimizer):
    refused(lambda: small(optimizer), "'walk'", "flights over terrain", error=SettingError)


def test_other_refusals():
    refused(lambda: small(cost="cheap"), "'cheap'", "documented", error=UnknownNameError)
    refused(
        lambda: SwarmEnv("firefly", scenario="case1", encoding="spherical"),
        "'spherical'",
        "flights over terrain",
        error=SettingError,
    )
    refused(
        lambda: SwarmEnv("firefly", scenario="case1", cost="metabox"),
        "'cost'",
        "analytic",
        error=SettingError,
    )
    refused(lambda: small(scenario=[rolling_terrain(), "case1"]), "different kinds", error=SettingError)
    refused(lambda: small(observation="corridors"), "corridors", "TerrainProblem", error=SettingError)


def test_a_picture_shows_ground_and_threats_from_above():
    pytest.importorskip("pygame")
    frames = []
    for threats in (0, 8):
        env = small(scenario=rolling_terrain(threats=threats), render_mode="rgb_array")
        env.reset(seed=1)
        frames.append(env.render())
    assert frames[0].shape == (520, 960, 3)
    assert len(np.unique(frames[0].reshape(-1, 3), axis=0)) > 100
    assert (frames[0] != frames[1]).any(axis=2).mean() > 0.01


def test_guided_members_lie_beside_planned_flights_which_are_better_than_smooth_ones():
    for encoding in ENCODINGS:
        means = {}
        for source in ("smooth", "guided"):
            env = small(scenario=rolling_terrain(2), source=source, encoding=encoding)
            infos = [env.reset(seed=seed)[1] for seed in range(10)]
            means[source] = np.mean([info["best_fitness"] for info in infos])
        assert means["guided"] < 0.7 * means["smooth"]


@pytest.mark.slow
@pytest.mark.parametrize("optimizer", OF_VECTORS)
def test_every_optimizer_of_vectors_flies(optimizer):
    for encoding in ENCODINGS:
        env = small(optimizer, encoding=encoding, iterations=60)
        _, begun = env.reset(seed=3)
        info = last_info(env, size=12.0, degree=0.5, seed=3)
        assert info["best_fitness"] < begun["best_fitness"]
        problem = env.simulation.problems[0]
        vector = env.simulation.swarms.best_position[0, : problem.dimension]
        assert problem.evaluate(vector)[0] == info["best_fitness"]
