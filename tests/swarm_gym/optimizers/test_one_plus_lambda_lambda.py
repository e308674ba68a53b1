"""The (1 + (lambda, lambda)) genetic algorithm by counts, against itself on bit strings."""

from collections import Counter

import numpy as np
import pytest
from scipy import stats

from helpers.bits import OPTIMIZER, as_actions, bit_env, simulated_runtimes, steps_from
from helpers.slow import slow_but
from oracles import bit_strings
from oracles.bit_strings import Choice, paired
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers import ALL_OPTIMIZERS, OPTIMIZERS, SPECIAL_OPTIMIZERS, get_optimizer

LEAST_P = 1e-4  # seeds are fixed: a test fails only if the code changes
RUNS = 300
STEPS = 5000

counted = pytest.mark.parametrize("counting", ["copies-free", "all"])


def by_thirds(ones):
    """Return other decisions at each number of ones."""
    return (Choice(5, 2, 0.6, 0.9), Choice(1, 6, 2.0, 1.7), Choice(3, 3, 1.3, 0.4))[ones % 3]


def growing(ones):
    return paired(1 + ones // 6)


def p_of_chi_square(found, expected, total):
    """Return the p-value of counts by outcome; rare outcomes are pooled."""
    keys = sorted(expected, key=expected.get)
    wanted = np.array([expected[key] * total for key in keys])
    seen = np.array([found[key] for key in keys], dtype=np.float64)
    pooled = max(int(np.searchsorted(np.cumsum(wanted), 10.0)), 1)
    wanted, seen = (np.append(each[pooled:], each[:pooled].sum()) for each in (wanted, seen))
    return stats.chisquare(seen, wanted * seen.sum() / wanted.sum()).pvalue


# One iteration.


@counted
@pytest.mark.parametrize(
    ("size", "ones", "choice"),
    slow_but(
        [(10, 5, paired(3)), (12, 11, Choice(3, 1, 0.5))],
        [
            (10, 5, paired(3)),
            (11, 0, paired(2)),
            (12, 11, Choice(3, 1, 0.5)),
            (12, 6, paired(1)),
            (10, 8, Choice(2, 3, 2.0, 1.5)),
            (10, 5, Choice(3, 3, 10.0)),  # flips every bit
            (12, 10, Choice(2, 2, 1.0, 2.0)),  # every child is the mutant
        ],
    ),
)
def test_gain_and_cost_of_an_iteration_have_the_enumerated_probabilities(size, ones, choice, counting):
    scenario = f"onemax:{size}-start:{ones}"
    gains, costs = steps_from(STEPS, scenario, choice, seed=3, counting=counting)
    expected = bit_strings.outcomes(size, ones, choice, counting == "copies-free")
    found = Counter(zip(gains.tolist(), costs.tolist(), strict=True))
    assert found.keys() <= expected.keys()
    assert sum(expected.values()) == pytest.approx(1.0)
    assert p_of_chi_square(found, expected, STEPS) > LEAST_P


@pytest.mark.parametrize(
    ("size", "ones", "choice"),
    slow_but(
        [(60, 45, Choice(8, 8))],
        [(60, 45, Choice(8, 8)), (60, 30, Choice(2, 12, 6.0, 0.5)), (100, 97, Choice(6, 20, 1.2, 1.4))],
    ),
)
def test_gain_and_cost_of_an_iteration_are_distributed_as_on_strings(size, ones, choice):
    """Compare counts of gains, and of costs, in a table of two rows."""
    gains, costs = steps_from(STEPS, f"onemax:{size}-start:{ones}", choice, seed=5, max_population_size=8)
    rng, naive = np.random.default_rng(6), []
    for _ in range(STEPS):
        string = rng.permutation(np.arange(size) < ones)
        after, cost = bit_strings.step(rng, string, choice)
        naive.append((int(after.sum()) - ones, cost))
    for ours, theirs in zip((gains, costs), np.transpose(naive), strict=True):
        most = min(int(np.quantile(theirs, 0.999)), int(ours.max()))
        table = [np.bincount(np.minimum(each, most), minlength=most + 1) for each in (ours, theirs)]
        table = np.array(table)[:, np.sum(table, axis=0) > 0]
        assert stats.chi2_contingency(table).pvalue > LEAST_P


@counted
def test_mutants_alone_cost_what_their_number_says_where_all_children_are_copies(counting):
    """Let children take all bits of the mutant: only the mutants count, or the children, too."""
    _, costs = steps_from(50, "onemax:30", Choice(4, 3, 1.0, 3.0), counting=counting)
    assert set(costs) == {4 if counting == "copies-free" else 7}


# Whole runs.


@pytest.mark.parametrize(
    ("size", "decide", "counting"),
    [
        pytest.param(30, lambda _: paired(1), "copies-free", marks=pytest.mark.slow),
        pytest.param(40, lambda _: paired(2), "copies-free", marks=pytest.mark.slow),
        (40, lambda _: paired(8), "all"),
        (20, lambda _: paired(20), "copies-free"),
        pytest.param(40, lambda _: Choice(4, 9, 0.5, 1.6), "copies-free", marks=pytest.mark.slow),
        pytest.param(30, lambda _: Choice(2, 5, 1.5, 0.5), "all", marks=pytest.mark.slow),
        (40, growing, "copies-free"),
        pytest.param(30, by_thirds, "copies-free", marks=pytest.mark.slow),
        pytest.param(30, by_thirds, "all", marks=pytest.mark.slow),
    ],
)
def test_runtimes_are_distributed_as_on_strings(size, decide, counting):
    ours = simulated_runtimes(RUNS, f"onemax:{size}", decide, seed=11, counting=counting)
    theirs = bit_strings.runtimes(12, RUNS, size, decide, counting == "copies-free")
    assert stats.ks_2samp(ours, theirs).pvalue > LEAST_P


def test_runtimes_from_another_start_are_distributed_as_on_strings():
    ours = simulated_runtimes(RUNS, "onemax:40-start:3", lambda _: paired(3), seed=13)
    theirs = bit_strings.runtimes(14, RUNS, 40, lambda _: paired(3), start=3)
    assert stats.ks_2samp(ours, theirs).pvalue > LEAST_P


def test_the_comparison_of_runtimes_notices_another_cost_model_and_another_rate():
    """Check that the limit on p-values is no empty one: small changes of the algorithm fall below it."""
    ours = simulated_runtimes(RUNS, "onemax:40", lambda _: paired(8), seed=15)
    other_cost = bit_strings.runtimes(16, RUNS, 40, lambda _: paired(8), copies_free=False)
    other_rate = bit_strings.runtimes(17, RUNS, 40, lambda _: Choice(8, 8, 1.0, 2.5))
    assert stats.ks_2samp(ours, other_cost).pvalue < LEAST_P
    assert stats.ks_2samp(ours, other_rate).pvalue < LEAST_P


# The state.


def test_zero_children_are_as_many_as_mutants():
    """Compare runs of the option `children` at its default and at the number of mutants."""
    runs = []
    for options in ({}, {"children": 5.0}):
        env = bit_env(3, "onemax:30", action="natural", iterations=40, **options)
        env.reset(seed=1)
        steps = [env.step_running(np.tile([5.0, 0.0], (3, 1)))[0] for _ in range(40)]
        runs.append((np.array(steps), env.simulation.swarms.evaluations.copy()))
    np.testing.assert_array_equal(runs[0][0], runs[1][0])
    np.testing.assert_array_equal(runs[0][1], runs[1][1])


def test_the_number_of_ones_never_falls_and_all_members_are_the_parent():
    env = bit_env(20, "onemax:50-start:10", iterations=60)
    before, _ = env.reset(seed=2)
    generator = np.random.default_rng(0)
    for _ in range(60):
        choices = [Choice(*generator.integers(1, 20, 2), *generator.uniform(0.1, 3.0, 2)) for _ in range(20)]
        after, *_ = env.step_running(as_actions(choices))
        assert (after[:, 1] >= before[:, 1]).all()
        swarms = env.simulation.swarms
        for b in range(20):
            assert set(swarms.positions[b, : swarms.size[b], 0]) == {after[b, 1]}
            assert set(swarms.fitness[b, : swarms.size[b]]) == {50.0 - after[b, 1]}
        before = after
    assert before[:, 1].min() > 10


def test_strings_of_all_lengths_end_at_all_ones_without_a_number_out_of_range():
    """Begin near the end, where weights are most uneven, with extreme decisions."""
    for size in (10, 11, 997, 100_000):
        env = bit_env(6, f"onemax:{size}-start:{size - 2}", iterations=30, max_population_size=512)
        observations, _ = env.reset(seed=0)
        choices = [
            Choice(1, 1, 0.001, 0.1), Choice(512, 256, 32.0, 4.0), Choice(512, 1, 0.001, 4.0),
            Choice(1, 256, 32.0, 0.1), Choice(1, 1, 32.0, 4.0), Choice(64, 64),
        ]  # fmt: skip
        for _ in range(30):
            observations, rewards, _ = env.step_running(as_actions(choices))
            assert np.isfinite(rewards).all()
            assert ((observations[:, 1] >= size - 2) & (observations[:, 1] <= size)).all()


# Budgets.


@pytest.mark.parametrize("budget", [2, 3, 7, 50, 51, 52])
@counted
def test_a_budget_is_never_exceeded_and_used_up(budget, counting):
    env = bit_env(40, "onemax:100", iterations=200, max_evaluations=budget, counting=counting)
    env.reset(seed=4)
    ended = np.zeros(40, dtype=np.bool_)
    while not ended.all():
        _, _, ended = env.step_running(as_actions([Choice(5, 4, 1.2, 1.3)] * 40))
        assert (env.simulation.swarms.evaluations <= budget).all()
    assert (env.simulation.swarms.evaluations == budget).all()


# Who solves what.


def test_the_optimizer_of_bits_is_none_of_paths_but_has_a_name_as_all():
    assert OPTIMIZER in SPECIAL_OPTIMIZERS
    assert OPTIMIZER not in OPTIMIZERS
    assert ALL_OPTIMIZERS.keys() == OPTIMIZERS.keys() | SPECIAL_OPTIMIZERS.keys()
    assert get_optimizer(OPTIMIZER).name == OPTIMIZER


@pytest.mark.parametrize("optimizer", OPTIMIZERS)
def test_other_optimizers_refuse_bit_strings_by_name(optimizer):
    with pytest.raises(SettingError, match="onemax:100"):
        SwarmEnv(optimizer, scenario="onemax:100")


@pytest.mark.parametrize("scenario", ["case1", "rooms:0", "function:rastrigin-2", "function:bbob-1-5-1"])
def test_the_optimizer_of_bits_refuses_maps_and_functions_by_name(scenario):
    with pytest.raises(SettingError, match=scenario):
        SwarmEnv(OPTIMIZER, scenario=scenario)


def test_an_unknown_counting_or_a_parameter_out_of_range_is_refused():
    with pytest.raises(UnknownNameError, match=r"'some'.*copies-free"):
        SwarmEnv(OPTIMIZER, counting="some")
    for name, value in (("children", -1.0), ("strength", -0.5), ("bias", np.inf), ("strength", 1e6)):
        with pytest.raises(SettingError, match=name):
            SwarmEnv(OPTIMIZER, **{name: value})
    SwarmEnv(OPTIMIZER, counting="all", children=3, strength=0.5, bias=2.0)


# The distribution that a swarm keeps.


def _course(size, decisions, change):
    """Return the record of a run on a string; `change` is called with the field before each step."""
    env = bit_env(1, f"onemax:{size}", max_population_size=100)
    env.reset(seed=4)
    for decision in decisions:
        change(env.simulation.swarms.field)
        if env.simulation.running.all():
            env.step_running(as_actions([decision]))
    simulation = env.simulation
    record = simulation.history[0, : simulation.iteration[0] + 1]
    assert len(record) > 5
    return record.tolist(), simulation.swarms.stream.tolist()


@pytest.mark.parametrize("size", [10, 1000, 100_000])
def test_a_kept_distribution_has_the_bits_of_one_that_is_computed_again(size):
    rng = np.random.default_rng(size)
    widest = Choice(100, 4, min(size / 200.0, 32.0), 2.0)  # flips half of the bits, if it can
    others = (Choice(7, 3, 0.5, 1.5), Choice(64, 20, 8.0, 3.0), Choice(1, 1, 1e-3))
    choices = (paired(1), paired(2), widest, *others)
    decisions = [choices[k] for k in np.repeat(rng.integers(len(choices), size=40), 2)]
    kept = _course(size, decisions, lambda field: None)
    assert kept == _course(size, decisions, lambda field: field.fill(0.0))
    assert kept == _course(size, decisions, lambda field: field.fill(np.nan))


def test_a_swarm_of_another_length_does_not_take_over_what_it_kept():
    names = ["onemax:20", "onemax:40"]
    together = SwarmEnv(OPTIMIZER, scenario=names)
    for seed in range(6):
        for name in names:
            together.reset(seed=seed, options={"scenario": name})
            alone = SwarmEnv(OPTIMIZER, scenario=name)
            alone.reset(seed=seed)
            for _ in range(3):
                found, expected = (env.step(np.array([2.0, 0.0]))[0].tolist() for env in (together, alone))
                assert found == expected
