"""Rules of the population size that follow restarts, on made observations and in environments."""

import math

import numpy as np
import pytest

from agents import SizeLimits, make_controller
from helpers.refusals import refused
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.features import RESTARTS_SO_FAR
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.optimizers.firefly import Firefly

LIMITS = SizeLimits(2, 5000)
NAMES = ["ipop", "bipop"]


def seen(iteration, restarts):
    """Return observations of swarms in one iteration with so many restarts each."""
    observations = np.zeros((len(restarts), 5))
    observations[:, 3], observations[:, 4] = iteration, restarts
    return observations


def sizes_of(name, lengths, seed=0):
    """Return the sizes of one swarm whose runs have these lengths in iterations."""
    controller = make_controller(name, LIMITS)
    controller.reset(1, seed=seed)
    restarts = np.repeat(np.arange(len(lengths)), lengths)
    return [int(controller.act(seen(k, [count]))[0, 0]) for k, count in enumerate(restarts)]


def test_ipop_doubles_the_size_at_each_restart():
    assert sizes_of("ipop", [3, 1, 2, 1]) == [10, 10, 10, 20, 40, 40, 80]
    assert sizes_of("ipop:start=7,factor=1.5", [2, 1, 1, 1]) == [7, 7, 11, 16, 24]


def test_ipop_grows_up_to_the_largest_size_even_by_huge_powers():
    assert sizes_of("ipop:factor=10", [1, 1, 1, 1, 2000])[-1] == 5000
    controller = make_controller("ipop:factor=10", LIMITS)
    controller.reset(1)
    controller.act(seen(0, [0]))
    assert controller.act(seen(1, [5000]))[0].tolist() == [5000.0, 0.0]


def by_hand(lengths, start, seed):
    """Return the sizes of BIPOP's runs, and their regimes, computed run by run."""
    generator = np.random.default_rng(seed)
    spent, large, size, regime = {"small": start, "large": 0}, start, start, "small"
    sizes, regimes = [], []
    for length in lengths:
        if sizes:
            regime = "small" if spent["small"] < spent["large"] else "large"
            if regime == "large":
                size = large = 2 * large
            else:
                u = generator.random()
                size = math.floor(start * (0.5 * large / start) ** u**2)
        sizes.append(size)
        regimes.append(regime)
        spent[regime] += length * size
    return sizes, regimes


@pytest.mark.parametrize("seed", range(5))
def test_bipop_begins_the_regime_that_has_spent_less(seed):
    lengths = np.random.default_rng(seed).integers(2, 60, 25).tolist()
    found, place = sizes_of("bipop", lengths, seed), 0
    expected, regimes = by_hand(lengths, 10, seed)
    for length, size in zip(lengths, expected, strict=True):
        assert found[place : place + length] == [min(size, 5000)] * length
        place += length
    assert regimes[:2] == ["small", "large"]
    assert regimes.count("small") > 3
    assert regimes.count("large") > 3
    assert all(
        10 <= size <= max(expected) / 2 for size, of in zip(expected, regimes, strict=True) if of == "small"
    )


@pytest.mark.parametrize("name", NAMES)
def test_swarms_are_independent_and_begin_anew_at_iteration_0(name):
    generator = np.random.default_rng(1)
    together = make_controller(name, LIMITS)
    together.reset(3, seed=4)
    restarts = np.cumsum(generator.random((80, 3)) < 0.1, axis=0)
    decided = np.stack([together.act(seen(k, counts)) for k, counts in enumerate(restarts)])
    for row in range(3):
        alone = make_controller(name, LIMITS)
        alone.reset(1, seed=4 + row)
        found = np.stack([alone.act(seen(k, counts[row : row + 1]))[0] for k, counts in enumerate(restarts)])
        np.testing.assert_array_equal(decided[:, row], found)
    assert together.act(seen(0, [0, 0, 0]))[:, 0].tolist() == [10.0] * 3
    assert together.act(seen(1, [1, 0, 1]))[:, 0].tolist() == [20.0, 10.0, 20.0]


@pytest.mark.parametrize("family", NAMES)
def test_in_an_environment_the_size_follows_what_the_optimizer_counts(family, monkeypatch):
    monkeypatch.setattr(Firefly, "counts", staticmethod(lambda swarms: {"restarts": swarms.iteration // 4}))
    controller = make_controller(f"{family}:start=5,repair_degree=0.3")
    env = SwarmEnv("firefly", scenario="case1", iterations=12, **controller.env_options())
    controller.reset(1)
    observation, _ = env.reset(seed=0)
    assert OBSERVATIONS["restarts"].features[-1].name == RESTARTS_SO_FAR
    sizes, ended = [], False
    while not ended:
        assert env.observation_space.contains(observation)
        observation, _, ended, _, info = env.step(controller.act(observation[None])[0])
        sizes.append(int(info["population_size"]))
    # The second run of BIPOP has spent more than the first one; the third is drawn from 5 to 5.
    assert sizes == [5] * 4 + [10] * 4 + [20 if family == "ipop" else 5] * 4


def test_an_optimizer_that_never_begins_anew_is_refused():
    refused(
        lambda: SwarmEnv("firefly", scenario="case1", observation="restarts").reset(),
        "'restarts'", "'firefly'", "never begins anew", error=SettingError,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("ipop:factor=0.5", "factor must lie"),
        ("bipop:factor=11", "factor"),
        ("ipop:rung=2", "unknown parameter"),
    ],
)
def test_parameters_out_of_range_are_refused(name, words):
    refused(lambda: make_controller(name), words, error=SettingError)
