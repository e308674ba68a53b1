"""Environments on maps that change, with every optimizer."""

import copy
import pickle
import sys

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from helpers.builders import is_walker, slow_if_alike
from helpers.refusals import refused
from helpers.slow import slow_but
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.problem.geometry.traversal import blocked_length
from swarm_gym.reference.waypoint_optimum import main
from swarm_gym.rendering import Scene
from swarm_gym.scenarios import (
    Appear,
    Circle,
    Disappear,
    DynamicScenario,
    GridMap,
    GridScenario,
    Move,
    Polygon,
    Scenario,
    make_scenario,
    rasterised,
)
from swarm_gym.settings import Settings
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.worlds import make_problem

ITERATIONS = 6
BLOCK = Polygon.rectangle(560, 150, 640, 330)
COMING = Appear(1, BLOCK), Move(2, 14, (-60, 30)), Appear(3, Circle(250, 300, 60))
GOING = Disappear(3, 4), Disappear(4, 14), Disappear(5, 15)
BUSY = DynamicScenario("busy", make_scenario("case1"), [*COMING, *GOING])
OPEN = GridScenario("open", GridMap("open", np.zeros((20, 30), dtype=np.bool_)), (2, 9), (27, 11))
BUSY_GRID = DynamicScenario(
    "busy-grid",
    OPEN,
    [
        Appear(1, Polygon.rectangle(10, 4, 14, 13)),
        Appear(2, Circle(20, 12, 3)),
        Move(3, 0, (3, -2)),
        Disappear(4, 1),
        Move(5, 0, (2, 5)),
    ],
)
SMALL = {"initial_population_size": 8, "max_population_size": 20, "iterations": ITERATIONS}
SEED = 11

# Kernels that evaluate again on cells take seconds to compile; other tests need this one, too.
ON_CELLS = ("firefly",)

all_optimizers = pytest.mark.parametrize("optimizer", [slow_if_alike(name) for name in OPTIMIZERS])


def small(optimizer="firefly", **options):
    return SwarmEnv(optimizer, **{**SMALL, "scenario": BUSY, **options})


def maps_of(optimizer):
    """Return the dynamic maps that an optimizer supports."""
    return [BUSY_GRID] if is_walker(optimizer) else [BUSY, BUSY_GRID]


def actions(seed, number=ITERATIONS, optimizer="firefly"):
    """Return decisions of sizes that the optimizer can have, and of phi."""
    generator = np.random.default_rng(seed)
    sizes = np.maximum(generator.integers(2, 21, number), get_optimizer(optimizer).smallest_population)
    return np.stack([sizes, generator.random(number).round(1)], axis=1)


def episode(env, seed=SEED, decisions=None):
    """Return observations, rewards and infos of an episode, from its reset on."""
    observation, info = env.reset(seed=seed)
    steps = [(observation, 0.0, info)]
    if decisions is None:
        decisions = actions(seed, optimizer=env.simulation.optimizer.name)
    for action in decisions:
        observation, reward, terminated, _, info = env.step(action)
        steps.append((observation, reward, info))
        if terminated:
            break
    return steps


def assert_same_steps(steps, others):
    assert len(steps) == len(others)
    for (observation, reward, info), (other, other_reward, other_info) in zip(steps, others, strict=True):
        np.testing.assert_array_equal(observation, other)
        assert reward == other_reward
        assert info["best_fitness"] == other_info["best_fitness"]
        assert info["evaluations"] == other_info["evaluations"]
        np.testing.assert_array_equal(info["best_path"], other_info["best_path"])


def spent_on(optimizer, size):
    """Return the number of evaluations that re-evaluate a swarm of that size."""
    return (2 * size if optimizer == "particle-swarm" else size) + 1


def as_the_optimizer_has_it(optimizer, world):
    """Return a map that changed; it consists of cells if the optimizer walks over them."""
    if is_walker(optimizer) and isinstance(world, Scenario):
        return rasterised(world, Settings.cell_size)
    return world


def has_fitness(optimizer, stored, of_position):
    """Return True if a member's fitness is that of its position, or of its own path if it walked there."""
    return stored == of_position if get_optimizer(optimizer).adopts else stored > of_position


def walk_cost(problem, path):
    """Return fitness and degree of collision of a complete walk to the target."""
    grid = problem.scenario.map
    length = np.hypot(*np.diff(path, axis=0).T).sum()
    blocked = blocked_length(grid.blocked, grid.to_cells(path))
    return length + problem.penalty * blocked, blocked * grid.resolution


def assert_what_is_stored_is_true(optimizer, simulation):
    """Check members and the best so far on the map in force, from where the robot is.

    A best walk costs its way, blocked parts included; the part that a robot has walked before an obstacle
    appears does not count.
    """
    problem, swarms, n = simulation.problem_of(0), simulation.swarms, simulation.dimension
    members = range(swarms.size[0])
    assert len(members) >= 1
    for i in members:
        found = problem.evaluate(swarms.positions[0, i, :n])
        assert swarms.collision[0, i] == found[1]
        assert has_fitness(optimizer, swarms.fitness[0, i], found[0])
        if optimizer == "particle-swarm":
            width = swarms.positions.shape[2]
            own_best = swarms.memory[0, i, width : width + n]
            assert swarms.memory[0, i, 2 * width] == problem.evaluate(own_best)[0] <= found[0]
    best = swarms.best_fitness[0], swarms.best_collision[0]
    if not is_walker(optimizer):
        assert best == problem.evaluate(swarms.best_position[0, :n])
        assert best[0] <= swarms.fitness[0, members].min()
        return
    path = simulation.paths.best()[0]
    assert best[0] >= np.hypot(*np.diff(path, axis=0).T).sum() * (1 - 1e-12)
    if not get_optimizer(optimizer).adopts:
        assert best == pytest.approx(walk_cost(problem, path), rel=1e-9, abs=1e-9)
        assert best[0] <= swarms.fitness[0, members].min() * (1 + 1e-9)


def assert_goes_on_alike(env, twin, decisions):
    """Check that two environments do the same from here to the end."""
    for action in decisions:
        one, other = env.step(action), twin.step(action)
        np.testing.assert_array_equal(one[0], other[0])
        np.testing.assert_array_equal(one[4].get("robot"), other[4].get("robot"))
        assert one[1:3] == other[1:3]
        if one[2]:
            break
    np.testing.assert_array_equal(env.reset()[0], twin.reset()[0])


def on_every_map():
    """Yield each optimizer on its first map, and on maps of cells; most of these are slow."""
    for name in OPTIMIZERS:
        first, *cells = maps_of(name)
        yield slow_if_alike(name, first)
        for scenario in cells:
            yield pytest.param(name, scenario, marks=() if name in ON_CELLS else pytest.mark.slow)


every_map = pytest.mark.parametrize(
    ("optimizer", "scenario"), list(on_every_map()), ids=lambda one: getattr(one, "name", one)
)

copied = pytest.mark.parametrize(
    "duplicate", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))], ids=["deep", "pickle"]
)


# No stale fitness.


@every_map
def test_what_is_stored_is_true_on_the_map_in_force_after_every_step(optimizer, scenario):
    env = small(optimizer, scenario=scenario)
    env.reset(seed=SEED)
    swarms, worlds = env.simulation.swarms, scenario.worlds
    for iteration, action in enumerate(actions(SEED, optimizer=optimizer), 1):
        env.step(action)
        world = worlds[min(iteration, len(worlds) - 1)].scenario
        assert env.simulation.problem_of(0).scenario == as_the_optimizer_has_it(optimizer, world)
        assert_what_is_stored_is_true(optimizer, env.simulation)
        assert swarms.summary[0, 1] == pytest.approx(swarms.collision[0, : swarms.size[0]].mean())


@every_map
def test_an_event_costs_as_many_evaluations_as_there_is_remembered_and_shows_at_once(optimizer, scenario):
    base = scenario.base
    once = DynamicScenario("once", base, scenario.events[:1])
    changing, still = (small(optimizer, scenario=one) for one in (once, base))
    (_, after), (_, unchanged) = (episode(env, decisions=[[9, 0.0]]) for env in (changing, still))
    size = unchanged[2]["population_size"]
    spent = after[2]["evaluations"] - unchanged[2]["evaluations"]
    assert spent == spent_on(optimizer, size)
    # The lists of MOA are cut where their heads get worse.
    assert after[2]["population_size"] == size or optimizer == "multivariate"
    # Ants that arrive do not collide, whichever path they take.
    swarms, others = changing.simulation.swarms, still.simulation.swarms
    assert after[0][1] != unchanged[0][1] or not get_optimizer(optimizer).adopts
    assert (swarms.fitness[0, :size] != others.fitness[0, :size]).any()
    assert changing.simulation.history[0, 1, 0] == after[0][0]


@every_map
def test_without_an_event_all_is_as_on_the_base(optimizer, scenario):
    base = scenario.base
    expected = episode(small(optimizer, scenario=base))
    assert_same_steps(episode(small(optimizer, scenario=DynamicScenario("quiet", base, []))), expected)


def test_an_event_that_no_iteration_follows_is_refused():
    last = DynamicScenario("late", make_scenario("case1"), [Appear(ITERATIONS - 1, Circle(640, 160, 25))])
    assert len(small(scenario=last).simulation.problems) == 2
    for iteration in (ITERATIONS, ITERATIONS + 30):
        late = DynamicScenario("late", last.base, [Appear(iteration, Circle(640, 160, 25))])
        words = ("'late'", f"after iteration {iteration}", f"1 to {ITERATIONS - 1}")
        refused(lambda late=late: small(scenario=late), *words, error=SettingError)


@pytest.mark.parametrize("optimizer", slow_but(("firefly", "ant-colony"), OPTIMIZERS))
def test_a_budget_may_end_anywhere_in_what_is_remembered(optimizer):
    scenario = maps_of(optimizer)[0]
    first = [event for event in scenario.events if event.iteration == 1]
    once = DynamicScenario("once", scenario.base, first)
    plan = [[8, 0.0], [8, 0.0]]
    steps = episode(small(optimizer, scenario=scenario.base), decisions=plan)
    before, size = (steps[1][2][name] for name in ("evaluations", "population_size"))
    for left in range(spent_on(optimizer, size) + 2):
        env = small(optimizer, scenario=once, max_evaluations=before + left)
        observation, reward, info = episode(env, decisions=plan)[-1]
        assert info["evaluations"] == before + left
        assert np.isfinite(observation).all()
        assert np.isfinite(reward)
        assert not env.simulation.running[0]
        # An episode that ends with the iteration ends before the event.
        happened = left > 0
        assert env.simulation.swarms.problem[0] == int(happened)
        assert env.simulation.iteration[0] == (2 if left > spent_on(optimizer, size) else 1)
        if env.simulation.iteration[0] == 1:
            assert env.simulation.swarms.size[0] <= (min(left, size) if happened else size)
            assert_what_is_stored_is_true(optimizer, env.simulation)


# Same seed, same bits.


@all_optimizers
def test_episodes_are_the_same_in_a_vector_with_threads_as_alone(optimizer, numba_threads):
    scenario = maps_of(optimizer)[0]
    scenarios = [scenario, scenario.base]
    alone = [episode(small(optimizer, scenario=scenarios), SEED + row) for row in range(5)]
    for threads in range(1, min(numba_threads, 2) + 1):
        envs = SwarmVectorEnv(
            5,
            optimizer,
            scenario=scenarios,
            num_threads=threads,
            autoreset_mode=AutoresetMode.DISABLED,
            **SMALL,
        )
        envs.reset(seed=SEED)
        decisions = np.stack([actions(SEED + row, optimizer=optimizer) for row in range(5)], axis=1)
        for k, decision in enumerate(decisions, 1):
            observations, rewards, _, _, infos = envs.step(decision)
            for row in range(5):
                np.testing.assert_array_equal(observations[row], alone[row][k][0])
                assert rewards[row] == alone[row][k][1]
                assert infos["evaluations"][row] == alone[row][k][2]["evaluations"]
                assert infos["scenario"][row] == alone[row][k][2]["scenario"]
    assert {steps[0][2]["scenario"] for steps in alone} == {scenario.name for scenario in scenarios}


@copied
def test_a_copy_made_between_two_events_goes_on_alike(duplicate):
    env = small("particle-swarm")
    env.reset(seed=SEED)
    decisions = actions(SEED)
    for action in decisions[:2]:
        env.step(action)
    assert_goes_on_alike(env, duplicate(env), decisions[2:])


def test_copied_swarms_go_on_in_the_world_of_the_original():
    envs = SwarmVectorEnv(3, scenario=[BUSY, BUSY.base], autoreset_mode=AutoresetMode.DISABLED, **SMALL)
    envs.reset(seed=[0, 1, 2])
    for _ in range(2):
        envs.step(np.tile([8, 0.5], (3, 1)))
    numbers = envs.simulation.swarms.problem.copy()
    source = int(np.argmax(numbers == 2))
    assert numbers[source] == 2
    envs.copy_swarms(np.full(3, source))
    assert envs.simulation.swarms.problem.tolist() == [2, 2, 2]
    observations, rewards, *_ = envs.step(np.tile([8, 0.5], (3, 1)))
    assert (observations == observations[0]).all()
    assert (rewards == rewards[0]).all()


# Episodes.


def test_an_episode_begins_on_the_first_map_again():
    env = small()
    first = episode(env)
    assert env.simulation.swarms.problem[0] == len(BUSY.worlds) - 1
    assert_same_steps(episode(env), first)


def test_episodes_draw_scenarios_and_not_their_worlds():
    env = small(scenario=[BUSY, "case2"])
    names = [env.reset(seed=seed)[1]["scenario"] for seed in range(60)]
    assert 15 < names.count("busy") < 45
    static = small(scenario=["case1", "case2"])
    assert [static.reset(seed=seed)[1]["scenario"] == "case2" for seed in range(60)] == [
        name == "case2" for name in names
    ]


def test_a_scenario_is_chosen_by_its_name_and_told_by_it():
    env = small(scenario=["case2", BUSY, "case3"])
    for name in ("case3", "busy", "case2"):
        _, info = env.reset(seed=0, options={"scenario": name})
        assert info["scenario"] == name
        for action in actions(SEED):
            _, _, _, _, info = env.step(action)
            assert info["scenario"] == name
    with pytest.raises(UnknownNameError, match=r"'case1'.*busy, case2, case3"):
        env.reset(options={"scenario": "case1"})


def test_swarms_beside_each_other_are_each_on_their_own_map():
    envs = SwarmVectorEnv(6, scenario=["case2", BUSY], autoreset_mode=AutoresetMode.DISABLED, **SMALL)
    _, infos = envs.reset(seed=3)
    is_busy = infos["scenario"] == "busy"
    assert 0 < is_busy.sum() < 6
    for iteration in range(1, ITERATIONS + 1):
        envs.step(np.tile([8, 0.0], (6, 1)))
        expected = np.where(is_busy, 1 + min(iteration, len(BUSY.worlds) - 1), 0)
        assert envs.simulation.swarms.problem.tolist() == expected.tolist()


def test_worlds_of_different_kinds_are_refused():
    with pytest.raises(SettingError, match=r"'busy' and 'busy-grid'.*analytic maps and grid maps"):
        small(scenario=[BUSY, BUSY_GRID])
    with pytest.raises(SettingError, match="penalty"):
        small(penalty=3.0)


# Rewards, and the info at the end.


def test_a_controller_is_paid_for_its_progress_and_not_for_what_happens():
    once = DynamicScenario("once", BUSY.base, BUSY.events[:1])
    changing, still = (
        small(scenario=scenario, price=1.0, reference_evaluations=1000) for scenario in (once, BUSY.base)
    )
    action = np.array([8.0, 0.0])
    for env in (changing, still):
        env.reset(seed=SEED)
    (_, reward, *_, info), (_, plain, *_, plain_info) = changing.step(action), still.step(action)
    # The same iteration, and then the event, whose evaluations are paid for.
    assert reward == pytest.approx(plain - (info["evaluations"] - plain_info["evaluations"]) / 1000)
    before, spent = changing.simulation.gaps.now()[0], info["evaluations"]
    assert before != still.simulation.gaps.now()[0]
    _, reward, *_, info = changing.step(action)
    expected = np.log(before / changing.simulation.gaps.now()[0]) - (info["evaluations"] - spent) / 1000
    assert reward == pytest.approx(expected, rel=1e-12)


def test_the_final_reward_is_the_sum_of_all_progress():
    rewards = {}
    for name in ("progress", "final"):
        env = small(reward=name)
        rewards[name] = sum(reward for _, reward, _ in episode(env))
    assert rewards["final"] == pytest.approx(rewards["progress"], rel=1e-9)


def test_the_gap_at_the_end_is_to_the_optimum_of_the_last_map(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_CACHE", str(tmp_path))
    name, few = "dynamic:case1-block@2", {"num_waypoints": 9}
    monkeypatch.setattr(sys, "argv", ["waypoint_optimum", name, "--num-waypoints", "9"])
    main()
    env = small(scenario=name, **few)
    first, last = env.simulation.worlds.optima
    assert first < last
    *_, (_, _, info) = episode(env)
    assert info["optimality_gap"] == (info["best_fitness"] - last) / last
    assert make_problem(name, iterations=ITERATIONS, **few) == env.simulation.problems[1]
    refused(lambda: make_problem(name, iterations=2, **few), "an event after iteration 2", error=SettingError)


def test_pictures_show_the_map_in_force():
    env = small(render_mode="rgb_array")
    env.reset(seed=SEED)
    for world in (*BUSY.worlds[1:], BUSY.worlds[-1]):
        before = env.render()
        env.step(np.array([8, 0.0]))
        assert Scene.of(env.simulation).scenario == world.scenario
        assert (env.render() != before).any()
