"""Environments whose new members come from other sources: options, actions, resets, equal bits."""

import copy
import pickle

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from helpers.builders import is_walker
from helpers.loops import looped
from helpers.newcomers import PATH_OPTIMIZERS, action_of
from helpers.slow import slow_but
from swarm_gym.action import ACTIONS, make_action
from swarm_gym.env import SwarmEnv
from swarm_gym.history import HISTORY
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.settings import Settings
from swarm_gym.vector_env import SwarmVectorEnv

SMALL = {"initial_population_size": 8, "max_population_size": 14, "iterations": 6, "num_waypoints": 9}
LAYOUTS = [name for name in ACTIONS if "sourced" in name]
all_optimizers = pytest.mark.parametrize("optimizer", PATH_OPTIMIZERS)


def small(optimizer="firefly", **options):
    return SwarmEnv(optimizer, **{**SMALL, **options})


def members(env):
    swarms = env.simulation.swarms
    return swarms.positions[0, : swarms.size[0]].copy()


def course(env, actions, seed=5, **options):
    """Return members and record of every step of an episode."""
    env.reset(seed=seed, options=options or None)
    found = [members(env)]
    for action in actions:
        env.step(action)
        found.append(members(env))
    return [*found, env.simulation.history[0, :, : len(HISTORY)].copy()]


def assert_same_courses(one, other):
    for first, second in zip(one, other, strict=True):
        np.testing.assert_array_equal(first, second)


NATURAL = [np.array(action) for action in ([8, 0.5], [14, 0.0], [5, 1.0], [11, 0.0])]


# Equal bits.


@pytest.mark.parametrize("optimizer", OPTIMIZERS)
def test_the_source_uniform_is_the_same_as_none(optimizer):
    encoding = {} if is_walker(optimizer) else {"num_waypoints": 9}
    options = {name: value for name, value in SMALL.items() if name != "num_waypoints"} | encoding
    plain = course(SwarmEnv(optimizer, **options), NATURAL)
    assert_same_courses(course(SwarmEnv(optimizer, **options, source="uniform"), NATURAL), plain)
    if not is_walker(optimizer):
        mixed = {"source": "mixed", "smooth_share": 0.0, "amplitude": 0.3, "bends": "stomp"}
        assert_same_courses(course(SwarmEnv(optimizer, **options, **mixed), NATURAL), plain)


@all_optimizers
def test_a_sourced_action_without_smooth_members_and_immigrants_is_an_extended_one(optimizer):
    actions = [action_of(optimizer, *action) for action in NATURAL]
    sourced = [action_of(optimizer, *action, 0.0, 0.7, 0.0) for action in NATURAL]
    plain = course(small(optimizer, action="extended"), actions)
    assert_same_courses(course(small(optimizer, action="sourced"), sourced), plain)


@pytest.mark.parametrize("bends", ["harmonics", "stomp"])
@all_optimizers
def test_a_sourced_action_that_asks_for_the_options_source_gives_the_same_bits(optimizer, bends):
    options = {"source": "mixed", "smooth_share": 0.6, "amplitude": 0.3, "bends": bends}
    sourced = [action_of(optimizer, *action, 0.6, 0.3, 0.0) for action in NATURAL]
    plain = course(small(optimizer, **options), NATURAL)
    assert_same_courses(course(small(optimizer, **options, action="sourced"), sourced), plain)


def sampled(space, seed, count=SMALL["iterations"]):
    generator = np.random.default_rng(seed)
    return [generator.uniform(-1, 1, space.shape).astype(np.float32) for _ in range(count)]


def seen(env, actions):
    """Return what an environment says at every step."""
    return [
        (step[0], step[1], step[4]["best_fitness"], step[4]["evaluations"]) for step in map(env.step, actions)
    ]


@pytest.mark.parametrize(
    ("bends", "width", "threads"),
    slow_but(
        [("harmonics", 1, 1), ("harmonics", 2, 2), ("stomp", 7, 2)],
        [(bends, *rest) for bends in ("harmonics", "stomp") for rest in ((1, 1), (2, 2), (7, 1), (7, 2))],
    ),
)
def test_same_seed_same_bits_in_any_vector_width_with_any_number_of_threads(
    width, threads, bends, numba_threads
):
    if threads > numba_threads:
        pytest.skip(f"this machine has {numba_threads} thread(s)")
    options = {**SMALL, "scenario": ["case1", "case2"], "action": "sourced-normalised", "bends": bends}
    vector = SwarmVectorEnv(width, num_threads=threads, autoreset_mode=AutoresetMode.DISABLED, **options)
    begun, _ = vector.reset(seed=3, options={"smooth_share": 0.5})
    plans = [sampled(vector.single_action_space, row) for row in range(width)]
    together = seen(vector, map(np.stack, zip(*plans, strict=True)))
    for row, plan in enumerate(plans):
        env = SwarmEnv(**options)
        np.testing.assert_array_equal(env.reset(seed=3 + row, options={"smooth_share": 0.5})[0], begun[row])
        for one, many in zip(seen(env, plan), together, strict=True):
            for part, parts in zip(one, many, strict=True):
                np.testing.assert_array_equal(part, parts[row])


@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
@pytest.mark.parametrize(
    "scenario", [{}, {"scenario": "rooms:0", "encoding": "bezier", "num_waypoints": None}]
)
@pytest.mark.parametrize(
    "optimizer", slow_but(["firefly"], ["firefly", "multivariate", "improved-fish-swarm"])
)
def test_copies_in_mid_episode_go_on_as_the_original(duplicate, scenario, optimizer):
    options = {name: value for name, value in {**SMALL, **scenario}.items() if value is not None}
    env = SwarmEnv(optimizer, **options, action="sourced-normalised", source="smooth")
    env.reset(seed=1)
    actions = sampled(env.action_space, 4)
    seen(env, actions[:3])
    twin = duplicate(env)
    for one, other in zip(seen(env, actions[3:]), seen(twin, actions[3:]), strict=True):
        for first, second in zip(one, other, strict=True):
            np.testing.assert_array_equal(first, second)
    np.testing.assert_array_equal(env.reset()[0], twin.reset()[0])
    np.testing.assert_array_equal(members(env), members(twin))


# Budgets.


@looped("budget", [16, 17, 23, 40])
@pytest.mark.parametrize(
    ("optimizer", "size", "immigrants"),
    slow_but(
        [("firefly", 8, 0.5), ("multivariate", 2, 1.0), ("cma-es", 8, 1.0)],
        [(name, *rest) for name in PATH_OPTIMIZERS for rest in ((8, 0.5), (8, 1.0), (2, 1.0))],
    ),
)
def test_immigrants_never_exceed_the_budget(optimizer, size, immigrants, budget):
    least = max(get_optimizer(optimizer).smallest_population, 2)
    env = small(optimizer, action="sourced", max_evaluations=budget, min_population_size=least, iterations=60)
    env.reset(seed=2)
    ended = False
    while not ended:
        action = action_of(optimizer, max(size, least), 0.0, 1.0, 0.3, immigrants)
        _, _, ended, _, info = env.step(action)
        assert info["evaluations"] <= budget
        assert 1 <= info["population_size"] <= max(size, least)
    assert info["evaluations"] == budget


# Options and actions.


def roughness(positions):
    """Return second differences relative to offsets, member by member."""
    whole = np.pad(positions[:, :9], ((0, 0), (1, 1)))
    return np.abs(np.diff(whole, 2, axis=1)).max(axis=1) / np.abs(positions).max(axis=1)


def test_reset_options_decide_the_first_population_only():
    env = small()
    env.reset(seed=4, options={"smooth_share": 1.0, "amplitude": 0.2})
    first = members(env)
    smooth = small(source="smooth", amplitude=0.2)
    smooth.reset(seed=4)
    np.testing.assert_array_equal(first, members(smooth))
    env.step(np.array([14.0, 0.0]))
    assert env.simulation.swarms.source[0, 0] == 0.0  # newcomers are uniform again
    env.reset(seed=4)
    plain = small()
    plain.reset(seed=4)
    np.testing.assert_array_equal(members(env), members(plain))


def test_each_reset_option_changes_its_part_of_the_source():
    env = small(source="mixed", smooth_share=0.4, amplitude=0.3)
    for options, expected in (
        ({}, [0.4, 0.3]),
        ({"smooth_share": 0}, [0.0, 0.3]),
        ({"amplitude": 1}, [0.4, 1.0]),
        ({"smooth_share": np.float64(1.0), "amplitude": 0.01}, [1.0, 0.01]),
    ):
        env.reset(seed=1, options=options)
        assert env.simulation.swarms.source[0, :2].tolist() == expected


def test_decisions_and_their_record_are_those_of_the_action():
    env = small(action="sourced", bends="stomp")
    env.reset(seed=1)
    decided = [(1.0, 0.2, 0.5), (0.3, 1.0, 0.0), (0.0, 0.01, 1.0)]
    for numbers in decided:
        env.step(action_of("firefly", 9, 0.5, *numbers))
    columns = env.simulation.columns
    assert columns[-3:] == ("smooth_share", "amplitude", "immigrants")
    np.testing.assert_array_equal(env.simulation.history[0, 1:4, -3:], decided)
    assert len(small(action="extended").simulation.columns) == len(columns) - 3


def test_newcomers_of_a_smooth_action_are_smooth():
    env = small(action="sourced", max_evaluations=14)
    env.reset(seed=1)
    first = members(env)
    env.step(action_of("firefly", 14, 0.0, 1.0, 0.5, 0.0))  # the budget ends with the growth
    assert roughness(members(env)[8:]).max() < 0.5 * roughness(first).min()


@pytest.mark.parametrize(
    "options",
    [
        {"scenario": "dynamic:case3-drive@1,every=1,distance=80", "num_waypoints": 9},
        {"scenario": "dynamic:rooms:0-drive@1,every=1,distance=8", "encoding": "bezier"},
    ],
    ids=["analytic", "curve"],
)
def test_bends_lie_beside_the_line_from_the_robot_to_the_target(options):
    own = {name: value for name, value in SMALL.items() if name != "num_waypoints"}
    env = SwarmEnv(**{**own, "iterations": 12, **options}, action="sourced")
    env.reset(seed=5, options={"smooth_share": 1.0})
    moved = False
    for _ in range(11):
        env.step(action_of("firefly", 9, 1.0, 1.0, 0.3, 0.5))
        worlds, number = env.simulation.worlds, env.simulation.swarms.problem[0]
        problem, begun = worlds.problems[number], worlds.problems[0]
        for name in ("width", "middles", "across", "modes"):
            np.testing.assert_array_equal(getattr(worlds.tables, name)[number], getattr(problem.table, name))
        low, high = problem.bounds
        positions = members(env)[:, : problem.dimension]
        assert (low <= positions).all()
        assert (positions <= high).all()
        moved |= problem.scenario.start != begun.scenario.start
    assert moved


@pytest.mark.parametrize("layout", LAYOUTS)
def test_scaled_actions_ask_for_the_same_as_natural_ones(layout):
    """Each end of a range, and the default where an extended or natural decision lacks a number."""
    options = {"max_evaluations": 500, "source": "mixed", "smooth_share": 0.25, "amplitude": 0.3}
    env = small(action=layout, **options)
    env.reset(seed=1)
    chosen = np.array([True])
    action = make_action(Settings.from_options(Firefly, {**SMALL, **options, "action": layout}), Firefly)
    for sources in ((0.0, 0.01, 0.0), (1.0, 1.0, 1.0), (0.5, 0.1, 0.3)):
        decided = action_of("firefly", 9, 0.5, *sources)[None]
        read = action.decode(action.encode(decided, env.simulation), chosen, env.simulation)
        np.testing.assert_allclose(read.sources[0], sources, rtol=1e-5, atol=1e-7)
        assert (read.sources >= [0.0, 0.01, 0.0]).all()
        assert (read.sources <= 1.0).all()
    for kept in (2, 4):
        decided = action_of("firefly", 9, 0.5)[None, :kept]
        read = action.decode(action.encode(decided, env.simulation), chosen, env.simulation)
        np.testing.assert_allclose(read.sources[0], [0.25, 0.3, 0.0], rtol=1e-5, atol=1e-7)
