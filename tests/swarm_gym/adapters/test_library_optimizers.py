"""Optimizers whose iterations a library carries out: counts, growth, memory, budgets and bits."""

import copy
import pickle

import numpy as np
import pytest

from helpers.libraries import RandomSteps
from swarm_gym.adapters.library import KNOWN
from swarm_gym.adapters.swarm_view import BudgetSpentError, SwarmView
from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.testing import check_optimizer
from swarm_gym.vector_env import SwarmVectorEnv

NAME = RandomSteps.name
FEW = {"iterations": 6, "initial_population_size": 8, "max_population_size": 20}


def make(**options):
    return SwarmEnv(NAME, **{"scenario": "case3", **FEW, **options})


def advance(env, sizes, degree=0.4):
    return [env.step(np.array([size, degree]))[-1]["best_fitness"] for size in sizes]


def view(env, degree=0.0):
    simulation = env.simulation
    return SwarmView(simulation.swarms, simulation.worlds.tables, 0, 0, degree)


@pytest.mark.parametrize("scenario", ["case3", "rooms:0", "function:rastrigin-2"])
def test_an_optimizer_of_a_library_keeps_the_contract_of_optimizers(scenario):
    check_optimizer(NAME, scenario)


def test_evaluations_are_those_of_the_problem_and_count():
    env = make()
    _, info = env.reset(seed=3)
    swarm, problem = view(env), env.simulation.problem_of(0)
    vectors = np.random.default_rng(0).uniform(swarm.lower, swarm.upper, (30, problem.dimension))
    vectors[7] = swarm.best_position / 2.0
    fitness, collision = swarm.evaluate(vectors)
    expected = [problem.evaluate(vector) for vector in vectors]
    assert list(zip(fitness, collision, strict=True)) == expected
    swarms, best = env.simulation.swarms, int(np.argmin(fitness))
    assert swarms.evaluations[0] == info["evaluations"] + 30
    assert swarms.best_fitness[0] == min(fitness[best], info["best_fitness"])
    if fitness[best] < info["best_fitness"]:
        np.testing.assert_array_equal(env.simulation.best_position(0), vectors[best])
        assert swarms.best_collision[0] == collision[best]


def test_the_best_feasible_path_is_remembered_apart_from_the_best():
    env = make(scenario="open:500", num_waypoints=5)
    env.reset(seed=0)
    swarms = env.simulation.swarms
    swarms.feasible_fitness[0] = swarms.best_fitness[0] = np.inf
    view(env).evaluate(np.zeros((1, 5)))
    assert swarms.feasible_fitness[0] == swarms.best_fitness[0] < np.inf
    np.testing.assert_array_equal(swarms.feasible_position[0, :5], np.zeros(5))


def test_the_repair_is_that_of_the_problem_and_stays_inside_the_bounds():
    env = make()
    env.reset(seed=3)
    swarm, problem = view(env, 0.7), env.simulation.problem_of(0)
    outside = np.random.default_rng(0).uniform(2 * swarm.lower, 2 * swarm.upper, (5, problem.dimension))
    repaired = swarm.repaired(outside)
    for vector, given in zip(repaired, outside, strict=True):
        expected = problem.repaired(np.clip(given, swarm.lower, swarm.upper), 0.7)
        np.testing.assert_array_equal(vector, expected)
    np.testing.assert_array_equal(
        view(env, 0.0).repaired(outside), np.clip(outside, swarm.lower, swarm.upper)
    )


def test_new_members_lie_in_the_box_of_the_others_and_each_counts_once(monkeypatch):
    monkeypatch.setattr(RandomSteps, "iterate", classmethod(lambda *_: None))
    env = make()
    _, first = env.reset(seed=1)
    before = env.simulation.positions(0).copy()
    _, _, _, _, info = env.step(np.array([19.0, 0.0]))
    after = env.simulation.positions(0)
    assert info["evaluations"] == first["evaluations"] + 11
    np.testing.assert_array_equal(after[:8], before)
    assert (after[8:] >= before.min(axis=0)).all()
    assert (after[8:] <= before.max(axis=0)).all()
    assert len({row.tobytes() for row in after}) == 19


def test_shrinking_deletes_the_worst_collisions_and_costs_nothing(monkeypatch):
    monkeypatch.setattr(RandomSteps, "iterate", classmethod(lambda *_: None))
    env = make(scenario="case2")
    _, first = env.reset(seed=1)
    swarms = env.simulation.swarms
    kept = np.sort(swarms.collision[0, :8])[:3]
    _, _, _, _, info = env.step(np.array([3.0, 0.0]))
    assert info["evaluations"] == first["evaluations"]
    np.testing.assert_array_equal(np.sort(swarms.collision[0, :3]), kept)


def test_memory_stays_with_members_and_new_ones_are_unknown():
    env = make()
    env.reset(seed=0)
    advance(env, [8, 12, 5, 7])
    swarms = env.simulation.swarms
    assert swarms.registers[0, KNOWN] == 7
    # Of five members that stayed, some are from the first eight and some joined in the second iteration.
    assert set(swarms.memory[0, :5, 0]) <= {4.0, 3.0}
    np.testing.assert_array_equal(swarms.memory[0, 5:7, 0], [1.0, 1.0])
    assert swarms.field[0, 0] == 8 + 12 + 5 + 7


def test_an_episode_begins_without_memory():
    env = make()
    for seed in (0, 1):
        env.reset(seed=seed)
        advance(env, [8])
        assert set(env.simulation.swarms.memory[0, :8, 0]) == {1.0}
        assert env.simulation.swarms.field[0, 0] == 8


def test_an_event_on_the_map_lets_the_library_begin_anew():
    env = make(scenario="dynamic:case3-block@3", iterations=5)
    env.reset(seed=0)
    advance(env, [8, 8, 8])
    swarms, problem = env.simulation.swarms, env.simulation.problem_of(0)
    assert swarms.registers[0, KNOWN] == 0
    for member in range(8):
        position = swarms.positions[0, member, : problem.dimension]
        assert problem.evaluate(position) == (swarms.fitness[0, member], swarms.collision[0, member])
    advance(env, [8])
    assert set(swarms.memory[0, :8, 0]) == {1.0}


def test_immigrants_replace_members():
    env = make(action="sourced", iterations=2)
    env.reset(seed=0)
    step, smooth_share, amplitude, immigrants = 0.05, 0.0, 0.5, 0.5
    env.step(np.array([8.0, 0.0, step, smooth_share, amplitude, immigrants]))
    env.step(np.array([8.0, 0.0, step, smooth_share, amplitude, immigrants]))
    np.testing.assert_array_equal(env.simulation.swarms.memory[0, :8, 0], [2.0] * 4 + [1.0] * 4)


def test_a_budget_that_ends_inside_an_iteration_leaves_the_members_as_they_were():
    env = make(max_evaluations=21)
    env.reset(seed=0)
    advance(env, [8])  # 16 evaluations
    before = env.simulation.positions(0).copy()
    _, _, ended, _, info = env.step(np.array([8.0, 0.0]))
    assert ended
    assert info["evaluations"] == 21
    np.testing.assert_array_equal(env.simulation.positions(0), before)
    with pytest.raises(BudgetSpentError):
        view(env).evaluate(before)


def test_growth_takes_no_more_than_the_budget_has():
    env = make(max_evaluations=12)
    env.reset(seed=0)
    _, _, ended, _, info = env.step(np.array([20.0, 0.0]))
    assert ended
    assert (info["evaluations"], info["population_size"]) == (12, 12)


def test_same_seed_same_bits_alone_in_a_vector_copied_and_pickled():
    sizes = [8, 13, 4, 6, 9, 2]
    found = []
    for seed in range(5, 8):
        env = make()
        env.reset(seed=seed)
        found.append(advance(env, sizes))
    envs = SwarmVectorEnv(3, NAME, scenario="case3", num_threads=2, **FEW)
    envs.reset(seed=5)
    together = [envs.step(np.tile([size, 0.4], (3, 1)))[-1]["best_fitness"].tolist() for size in sizes]
    assert np.array(together).T.tolist() == found
    env = make()
    env.reset(seed=5)
    advance(env, sizes[:3])
    copies = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    rest = advance(env, sizes[3:])
    assert rest == found[0][3:]
    assert [advance(one, sizes[3:]) for one in copies] == [rest, rest]


def test_branches_of_a_swarm_develop_alike_until_their_actions_differ():
    envs = SwarmVectorEnv(2, NAME, scenario="case3", **FEW)
    envs.reset(seed=0)
    envs.step(np.tile([8.0, 0.4], (2, 1)))
    envs.copy_swarms(np.zeros(2, dtype=np.int64))
    swarms = envs.simulation.swarms
    envs.step(np.tile([8.0, 0.4], (2, 1)))
    np.testing.assert_array_equal(swarms.positions[0], swarms.positions[1])
    envs.step(np.array([[8.0, 0.4], [8.0, 0.0]]))
    assert not np.array_equal(swarms.positions[0], swarms.positions[1])


def test_an_extended_action_sets_parameters_of_the_library():
    env = make(action="extended")
    env.reset(seed=0)
    before = env.simulation.positions(0).copy()
    env.step(np.array([8.0, 0.0, 0.01]))
    moved = np.abs(env.simulation.positions(0) - before)
    lower, upper = env.simulation.problem_of(0).bounds
    assert 0.0 < (moved / (upper - lower)).max() <= 0.01


@pytest.mark.parametrize("name", ["fixed:60", "spsfa-tip", "linear-reduction", "status-monitor"])
def test_controllers_drive_it(name):
    controller = make_controller(name)
    env = SwarmEnv(NAME, scenario="case1", iterations=4, **controller.env_options())
    controller.reset(1, 0)
    observation, info = env.reset(seed=0)
    before, ended = info["best_fitness"], False
    while not ended:
        observation, _, ended, _, info = env.step(controller.act(observation[None])[0])
    assert info["best_fitness"] < before
    assert info["optimality_gap"] > 0.0


def test_the_observation_is_that_of_the_members():
    env = make(observation="paper")
    env.reset(seed=0)
    observation, *_ = env.step(np.array([9.0, 0.0]))
    collision = env.simulation.swarms.collision[0, :9]
    mean, deviation = collision.mean(), collision.std(ddof=1)
    np.testing.assert_allclose(observation, [0.1 * mean + 0.9 * deviation, mean, deviation, 1.0])


def test_walks_are_refused():
    with pytest.raises(ValueError, match="unknown encoding of"):
        make(encoding="walk")


def test_members_that_a_library_adds_are_refused():
    env = make()
    env.reset(seed=0)
    swarm = view(env)
    nine = [
        np.vstack([x, x[:1]]) for x in (swarm.positions, swarm.fitness[:, None], swarm.collision[:, None])
    ]
    with pytest.raises(ValueError, match="expected 1 to 8 members after an iteration, got 9"):
        swarm.replace(nine[0], nine[1][:, 0], nine[2][:, 0])


def test_vectors_that_are_not_finite_are_refused():
    env = make()
    env.reset(seed=0)
    swarm = view(env)
    swarm.positions[2, 3] = np.nan
    with pytest.raises(ValueError, match="must be finite"):
        swarm.evaluate(swarm.positions)


def test_an_optimizer_without_parameters_has_no_extended_action():
    with pytest.raises(SettingError, match="no parameters to decide"):
        SwarmEnv("swarm_gym.adapters.library:LibraryOptimizer", action="extended")
