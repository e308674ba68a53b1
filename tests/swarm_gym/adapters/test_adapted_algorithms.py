"""Algorithms of pymoo and niapy under control: contracts, memory, and the bits of a seed."""

import copy
import importlib
import pickle
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from helpers.adapted import ADAPTED, adapted, episode_of, missing
from helpers.slow import slow_but
from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import MissingExtraError
from swarm_gym.own_code import OwnCodeError, find
from swarm_gym.registration import environment_id
from swarm_gym.testing import check_optimizer
from swarm_gym.vector_env import SwarmVectorEnv

OPTIONS = {"scenario": "case3", "iterations": 6, "initial_population_size": 9}
SIZES = [9, 14, 5, 2, 8, 8]
SWARMS = [pytest.param(library, marks=missing(library)) for library in ADAPTED]

every_algorithm = pytest.mark.parametrize("name", adapted())


def contracts():
    """Return scenarios and algorithms; the first algorithm is checked on every scenario without `slow`.

    All algorithms meet scenarios through the same class.
    """
    (first, *others, last), (path, *more) = adapted(), ["case1", "rooms:0", "function:rastrigin-2"]
    return [
        *(pytest.param(scenario, *first.values, marks=first.marks) for scenario in (path, *more)),
        *(pytest.param(path, *one.values, marks=one.marks) for one in others),
        *(
            pytest.param(scenario, *one.values, marks=[*one.marks, pytest.mark.slow])
            for one in (*others, last)
            for scenario in more
        ),
        pytest.param(path, *last.values, marks=[*last.marks, pytest.mark.slow]),  # it takes ten times as long
    ]


def advance(env, sizes=SIZES, degree=0.4):
    return [env.step(np.array([size, degree]))[-1]["best_fitness"] for size in sizes]


@every_algorithm
def test_gymnasium_accepts_it(name):
    env = gymnasium.make(environment_id(name), observation="scaled", action="normalised", **OPTIONS)
    check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize(("scenario", "name"), contracts())
def test_an_adapted_algorithm_keeps_the_contract_of_optimizers(name, scenario):
    check_optimizer(name, scenario)


@every_algorithm
def test_fitness_and_collision_are_those_of_the_members(name):
    env = SwarmEnv(name, **OPTIONS)
    env.reset(seed=2)
    for size in SIZES:
        _, _, _, _, info = env.step(np.array([size, 0.4]))
        swarms, problem = env.simulation.swarms, env.simulation.problem_of(0)
        assert info["population_size"] == size
        for member, position in enumerate(env.simulation.positions(0)):
            found = swarms.fitness[0, member], swarms.collision[0, member]
            assert found == problem.evaluate(position)
        best = env.simulation.best_position(0)
        assert problem.evaluate(best) == (swarms.best_fitness[0], swarms.best_collision[0])


@every_algorithm
def test_same_seed_same_bits_alone_in_a_vector_copied_and_pickled(name):
    env = SwarmEnv(name, **OPTIONS)
    found = []
    for seed in (5, 6):
        env.reset(seed=seed)
        found.append(advance(env))
    assert found[0] != found[1]
    envs = SwarmVectorEnv(2, name, **OPTIONS)
    envs.reset(seed=5)
    together = [envs.step(np.tile([size, 0.4], (2, 1)))[-1]["best_fitness"].tolist() for size in SIZES]
    assert np.array(together).T.tolist() == found
    env.reset(seed=5)
    advance(env, SIZES[:3])
    copies = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    for one in (env, *copies):
        assert advance(one, SIZES[3:]) == found[0][3:]


@every_algorithm
def test_the_repair_degree_frees_members(name):
    shares = []
    for degree in (0.0, 1.0):
        env = SwarmEnv(name, **{**OPTIONS, "scenario": "case1", "initial_population_size": 30})
        env.reset(seed=0)
        advance(env, [30, 30, 30], degree)
        shares.append(env.simulation.swarms.summary[0, 1])
    assert shares[1] < shares[0]


@every_algorithm
@pytest.mark.parametrize("controller", slow_but(["spsfa-tip"], ["fixed:60", "spsfa-tip"]))
def test_controllers_of_the_project_drive_it(name, controller):
    made = make_controller(controller)
    env = SwarmEnv(name, scenario="case2", iterations=3, **made.env_options())
    first, info = episode_of(env, made)
    assert info["best_fitness"] < first
    assert info["evaluations"] > 60
    assert info["optimality_gap"] > 0.0


@every_algorithm
def test_maps_may_change_and_numbers_of_the_library_may_be_decided(name):
    env = SwarmEnv(name, **{**OPTIONS, "scenario": "dynamic:case3-block@3"}, action="extended")
    env.reset(seed=1)
    for _ in range(6):
        middle = (env.action_space.low + env.action_space.high) / 2.0
        middle[0] = 7.0
        _, _, ended, _, info = env.step(middle)
    assert ended
    assert info["scenario"].startswith("dynamic:case3-block")
    problem = env.simulation.problem_of(0)
    assert problem.evaluate(env.simulation.best_position(0))[0] == info["best_fitness"]


@pytest.mark.parametrize("library", SWARMS)
def test_particles_keep_their_velocity_and_best_position_when_others_are_deleted(library, monkeypatch):
    env = SwarmEnv(f"swarm_gym.adapters.{library}:ParticleSwarm", **OPTIONS)
    env.reset(seed=0)
    advance(env, [9, 9])
    swarms, problem = env.simulation.swarms, env.simulation.problem_of(0)
    positions = [position.tobytes() for position in env.simulation.positions(0)]
    before = dict(zip(positions, swarms.memory[0, :9].copy(), strict=True))
    with monkeypatch.context() as patch:
        patch.setattr(env.simulation.optimizer, "iterate", lambda *_: None)
        advance(env, [4])
    for position, row in zip(env.simulation.positions(0), swarms.memory[0, :4], strict=True):
        np.testing.assert_array_equal(row, before[position.tobytes()])
    advance(env, [6])
    velocity, best, fitness = np.split(swarms.memory[0, :6, :63], [31, 62], axis=1)
    assert velocity.any()
    for position, known, now in zip(best, fitness[:, 0], swarms.fitness[0, :6], strict=True):
        assert problem.evaluate(position)[0] == known <= now


@pytest.mark.parametrize("library", list(ADAPTED))
def test_a_library_that_is_missing_is_named_with_its_extra(library, monkeypatch):
    module = f"swarm_gym.adapters.{library}"
    for name in [name for name in sys.modules if name == module or name.split(".")[0] == library]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(MissingExtraError, match=rf"{module} needs {library}.*swarm_gym\[adapters\]"):
        importlib.import_module(module)
    with pytest.raises(OwnCodeError, match=rf"needs {library}.*swarm_gym\[adapters\]"):
        find("optimizer", f"{module}:Missing", {}, callable, "an optimizer")
