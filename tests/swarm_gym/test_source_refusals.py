"""Refusals of sources of new members: options, actions and reset options that cannot be."""

import numpy as np
import pytest

from helpers.builders import is_walker
from helpers.newcomers import action_of
from helpers.refusals import refused
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ActionError, SettingError, UnknownNameError

SMALL = {"initial_population_size": 8, "max_population_size": 14, "iterations": 6, "num_waypoints": 9}
WALKING = "points of a walk"


@pytest.mark.parametrize(
    ("optimizer", "options", "words"),
    [
        ("firefly", {"source": "bends"}, ("source", "'bends'", "uniform", "smooth", "mixed")),
        ("firefly", {"source": 3}, ("source", "3", "uniform")),
        ("firefly", {"source": "smooth", "bends": "sines"}, ("bends", "'sines'", "harmonics", "stomp")),
        ("firefly", {"source": "smooth", "bends": None}, ("bends", "None", "harmonics")),
        *(
            ("firefly", {"source": "mixed", "smooth_share": value}, ("smooth_share", shown))
            for value, shown in ((-0.1, "[0, 1], got -0.1"), (1.5, "[0, 1], got 1.5"),
                                 (float("nan"), "got nan"), ("half", "number, got 'half'"))
        ),
        *(
            ("firefly", {"source": "smooth", "amplitude": value}, ("amplitude", shown))
            for value, shown in ((0, "[0.01, 1], got 0"), (-0.5, "got -0.5"), (1.5, "got 1.5"),
                                 ("wide", "number, got 'wide'"), (float("nan"), "got nan"))
        ),
        ("firefly", {"smooth_share": 0.5}, ("'smooth_share'", "'uniform'", "'mixed'")),
        ("firefly", {"source": "smooth", "smooth_share": 0.5}, ("'smooth_share'", "'smooth'", "'mixed'")),
        ("firefly", {"amplitude": 0.5}, ("'amplitude'", "'uniform'", "'smooth' or 'mixed'")),
        ("firefly", {"source": "uniform", "bends": "stomp"}, ("'bends'", "'uniform'", "'smooth' or 'mixed'")),
        ("firefly", {"source": "smooth", "encoding": "bezier"}, ("encoding", "'bezier'", "grid maps")),
        *(
            (optimizer, {given: value}, (repr(value), WALKING, "'uniform'"))
            for optimizer in ("ant-colony", "glowworm")
            for given, value in (("source", "smooth"), ("source", "mixed"), ("action", "sourced"))
        ),
        ("glowworm", {"source": "smooth", "encoding": "walk"}, (WALKING,)),
        *(
            ("firefly", {"scenario": "function:rastrigin-3", given: value}, (repr(value), "test functions"))
            for given, value in (("source", "smooth"), ("source", "mixed"), ("action", "sourced-normalised"))
        ),
    ],
)  # fmt: skip
def test_options_that_cannot_be_are_refused_by_value_with_what_is_valid(optimizer, options, words):
    refused(lambda: SwarmEnv(optimizer, **options), *words, error=(SettingError, UnknownNameError))


@pytest.mark.parametrize(
    ("optimizer", "options"),
    [
        ("firefly", {"source": "uniform"}),
        ("firefly", {"source": "mixed", "smooth_share": 0.5, "amplitude": 0.01, "bends": "stomp"}),
        ("firefly", {"source": "smooth", "amplitude": 1.0, "bends": "harmonics"}),
        ("firefly", {"source": "smooth", "encoding": "bezier", "scenario": "rooms:0"}),
        ("firefly", {"action": "sourced"}),
        ("ant-colony", {"source": "uniform"}),
    ],
)
def test_options_that_can_be_are_taken(optimizer, options):
    assert SwarmEnv(optimizer, **options).observation_space.shape


@pytest.mark.parametrize(
    ("sources", "words"),
    [
        ((1.5, 0.5, 0.0), ("smooth share must lie in [0, 1], got 1.5",)),
        ((0.5, 0.0, 0.0), ("amplitude must lie in [0.01, 1], got 0",)),
        ((0.5, 1.2, 0.0), ("amplitude must lie in [0.01, 1], got 1.2",)),
        ((0.5, 0.5, -0.1), ("immigrants must lie in [0, 1], got -0.1",)),
        ((0.5, 0.5, float("nan")), ("immigrants must lie in [0, 1], got nan",)),
        ((0.5, 0.5), ("shape", "7")),
    ],
)
def test_actions_that_cannot_be_are_refused_and_change_nothing(sources, words):
    env = SwarmEnv(**SMALL, action="sourced")
    env.reset(seed=1)
    before = [np.copy(field) for field in env.simulation.swarms]
    refused(lambda: env.step(action_of("firefly", 9, 0.5, *sources)), *words, error=ActionError)
    for one, other in zip(before, env.simulation.swarms, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("sources", [(1.0, 0.5, 0.0), (0.5, 0.01, 0.0), (0.0, 1.0, 1.0)])
def test_actions_that_can_be_are_taken(sources):
    env = SwarmEnv(**SMALL, action="sourced")
    env.reset(seed=1)
    *_, info = env.step(action_of("firefly", 9, 0.5, *sources))
    assert info["population_size"] == 9


GIVEN = {"initial_population": np.zeros((3, 9))}


@pytest.mark.parametrize(
    ("optimizer", "options", "words"),
    [
        ("firefly", {"smooth_share": 1.5}, ("smooth_share", "[0, 1]", "1.5")),
        ("firefly", {"smooth_share": float("nan")}, ("smooth_share", "nan")),
        ("firefly", {"smooth_share": "all"}, ("smooth_share", "number", "'all'")),
        ("firefly", {"smooth_share": np.array([0.5])}, ("smooth_share", "number")),
        ("firefly", {"smooth_share": 1.0, "amplitude": 0.0}, ("amplitude", "[0.01, 1]", "0")),
        ("firefly", {"smooth_share": 1.0, "amplitude": None}, ("amplitude", "number", "None")),
        ("firefly", {"amplitude": 0.5}, ("amplitude", "no effect", "smooth_share")),
        ("firefly", {**GIVEN, "smooth_share": 1.0}, ("initial_population or smooth_share", "both")),
        ("firefly", {**GIVEN, "smooth_share": 1.0, "amplitude": 0.5}, ("initial_population or", "both")),
        ("ant-colony", {"smooth_share": 1.0}, ("smooth_share", WALKING, "'uniform'")),
        ("glowworm", {"amplitude": 0.5}, ("amplitude", WALKING, "'uniform'")),
    ],
)
def test_reset_options_that_cannot_be_are_refused_and_change_nothing(optimizer, options, words):
    own = {
        name: value for name, value in SMALL.items() if not is_walker(optimizer) or name != "num_waypoints"
    }
    env = SwarmEnv(optimizer, **own)
    env.reset(seed=1)
    before = [np.copy(field) for field in env.simulation.swarms]
    refused(lambda: env.reset(seed=2, options=options), *words, error=SettingError)
    for one, other in zip(before, env.simulation.swarms, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("options", [{"smooth_share": 0.5}, {"smooth_share": 1.0, "amplitude": 0.5}, GIVEN])
def test_reset_options_that_can_be_are_taken(options):
    env = SwarmEnv(**SMALL)
    _, info = env.reset(seed=2, options=options)
    assert info["population_size"] == (3 if options is GIVEN else 8)
