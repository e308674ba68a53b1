"""Rules by which immigrants come: after stagnation, every so often, after a jump of E(P)."""

import numpy as np
import pytest

from swarm_gym.comparing import compare
from swarm_gym.controllers import SizeLimits, make_controller
from swarm_gym.errors import SettingError
from swarm_gym.observation import make_observation
from swarm_gym.vector_env import SwarmVectorEnv

NAMES = [feature.name for feature in make_observation("extended").features]
BEST = NAMES.index("log(best fitness / lower bound)")
IMMIGRANTS = 6


def seen(share_done, *best):
    """Return observations of swarms with these best fitnesses."""
    observations = np.zeros((len(best), len(NAMES)))
    observations[:, 3], observations[:, BEST] = share_done, best
    return observations


def test_immigrants_come_after_patience_iterations_without_progress_and_only_once():
    rule = make_controller("restart:patience=3,immigrants=0.4")
    rule.reset(2)
    rule.act(seen(0.0, 1.0, 1.0))
    coming = [rule.act(seen(0.01 * k, 1.0, 1.0 - 0.01 * k))[:, IMMIGRANTS] for k in range(1, 8)]
    np.testing.assert_array_equal(np.array(coming)[:, 0], [0, 0, 0.4, 0, 0, 0.4, 0])
    np.testing.assert_array_equal(np.array(coming)[:, 1], np.zeros(7))  # this swarm improves


def test_an_episode_that_begins_forgets_the_stagnation_of_the_last_one():
    rule = make_controller("restart:patience=2,immigrants=0.4")
    rule.reset(1)
    for share in (0.0, 0.01, 0.0, 0.01):
        assert rule.act(seen(share, 1.0))[0, IMMIGRANTS] == 0.0
    assert rule.act(seen(0.02, 1.0))[0, IMMIGRANTS] == 0.4


def test_other_decisions_are_constant_and_the_first_population_is_smooth():
    rule = make_controller("restart:start=90,size=20,noise=3,amplitude=0.3", SizeLimits(2, 120))
    rule.reset(1)
    np.testing.assert_array_equal(rule.act(seen(0.0, 1.0)), [[20, 0, 3, 0.1, 1, 0.3, 0]])
    options = rule.env_options()
    assert (options["initial_population_size"], options["source"], options["amplitude"]) == (
        90,
        "smooth",
        0.3,
    )


@pytest.mark.parametrize("argument", ["patience=0", "immigrants=1.5", "amplitude=0", "courage=1", "size=300"])
def test_parameters_outside_their_range_are_refused(argument):
    with pytest.raises(SettingError, match=f"{argument.partition('=')[0]}.*valid: start integer in"):
        make_controller(f"restart:{argument}")


def jumps(*values, share_done=0.1):
    """Return observations of swarms whose log(1 + E(P)) rose by these values in the last iteration."""
    names = [feature.name for feature in make_observation("jumps").features]
    observations = np.zeros((len(values), len(names)))
    observations[:, 3] = share_done
    observations[:, names.index("log(E(P) / E(P) one iteration before) / 8")] = np.array(values) / 8.0
    return observations


def test_periodic_immigrants_come_by_the_clock():
    rule = make_controller("periodic:period=4,phase=3,immigrants=0.7")
    rule.reset(1)
    coming = [rule.act(np.array([[0.0, 0.0, 0.0, k]]))[0, IMMIGRANTS] for k in range(13)]
    assert [k for k, share in enumerate(coming) if share] == [3, 7, 11]
    assert set(coming) == {0.0, 0.7}


def test_a_jump_of_the_collision_starts_a_reaction_of_its_duration():
    rule = make_controller("reaction:jump=0.4,duration=2,immigrants=0.6,noise=3,hypermutation=4")
    rule.reset(2)
    seen = [(0.3, 0.0), (0.5, 0.0), (0.9, -2.0), (0.9, 0.0), (0.0, 0.0), (0.41, 0.0)]
    decided = np.array([rule.act(jumps(*pair)) for pair in seen])
    # The reaction itself raises E(P) in its iterations and the one after.
    np.testing.assert_array_equal(decided[:, 0, IMMIGRANTS], [0, 0.6, 0.6, 0, 0, 0.6])
    np.testing.assert_array_equal(decided[:, 0, 2], [3, 12, 12, 3, 3, 12])
    np.testing.assert_array_equal(decided[:, 1, IMMIGRANTS], np.zeros(6))


def test_hypermutation_keeps_the_noise_in_its_range():
    rule = make_controller("reaction:jump=0.4,noise=50,hypermutation=100")
    rule.reset(1)
    assert rule.act(jumps(1.0))[0, 2] == 100.0


def test_an_episode_that_begins_ends_a_reaction():
    rule = make_controller("reaction:jump=0.4,duration=5")
    rule.reset(1)
    assert rule.act(jumps(1.0))[0, IMMIGRANTS] > 0.0
    assert rule.act(jumps(1.0, share_done=0.0))[0, IMMIGRANTS] == 0.0
    assert rule.act(jumps(0.0))[0, IMMIGRANTS] == 0.0


def test_a_reaction_answers_an_event_on_the_map_and_nothing_else():
    """Driven through an environment: the corridor of the best path closes after iteration 50."""
    controller = make_controller("reaction:jump=0.5,duration=3,immigrants=0.5")
    envs = SwarmVectorEnv(num_envs=8, scenario="dynamic:case2-block@50", **controller.env_options())
    controller.reset(8)
    observations, _ = envs.reset(seed=1)
    coming = []
    for _ in range(70):
        actions = controller.act(observations)
        coming.append(actions[:, IMMIGRANTS] > 0)
        observations, *_ = envs.step(actions)
    coming = np.array(coming)
    assert coming[50:53].mean() > 0.8  # the decisions on iterations 51 to 53
    assert coming[10:50].mean() < 0.05
    assert coming[54:].mean() < 0.05


@pytest.mark.parametrize(
    ("name", "parameter"),
    [
        ("periodic:period=0", "period"),
        ("periodic:phase=-1", "phase"),
        ("reaction:hypermutation=0.5", "hypermutation"),
    ],
)
def test_parameters_of_the_other_rules_are_refused_likewise(name, parameter):
    with pytest.raises(SettingError, match=f"{parameter}.*valid: start integer in"):
        make_controller(name)


@pytest.mark.parametrize("name", ["restart", "periodic", "reaction"])
def test_rules_of_fireflies_are_refused_by_other_optimizers(name):
    for optimizer in ("cma-es", "differential-evolution"):
        with pytest.raises(SettingError, match=r"made for firefly, whose decisions are .*"):
            compare([name], ["case1"], range(2), optimizer, iterations=4)
    assert (compare([name], ["case1"], range(2), iterations=4).fitness > 0.0).all()
