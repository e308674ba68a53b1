"""Actions that correct a controller: zeros are that controller, bit for bit."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from swarm_gym.action import make_action
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.fixed import Fixed
from swarm_gym.controllers.learned.residual import Base
from swarm_gym.corrected_batch import make_batch
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ActionError, SettingError, UnknownNameError
from swarm_gym.history import HISTORY
from swarm_gym.simulation import Simulation
from swarm_gym.training.sb3_vec_env import SB3VecEnv
from swarm_gym.vector_env import SwarmVectorEnv

SHORT = {"scenario": ["case1", "case3"], "iterations": 12}
DRIVES = "dynamic:case1-drive@4,every=5,distance=60"
# Without a memory, with one, and with decisions on parameters and sources of new members.
BASES = ["fixed:20", "open-loop:three-cases", "spsfa-tip", "learned:three-cases/0", "random"]


def course_of(name, num_swarms, seed, **options):
    """Return the rewards (T, B) and the record of the swarms of a controller, by itself."""
    controller = make_controller(name)
    envs = SwarmVectorEnv(
        num_swarms, **{**options, **controller.env_options()}, autoreset_mode=AutoresetMode.DISABLED
    )
    controller.reset(num_swarms, seed)
    observations, _ = envs.reset(seed=seed)
    rewards = []
    for _ in range(envs.settings.iterations):
        observations, reward, _, _, _ = envs.step(controller.act(observations))
        rewards.append(reward)
    return np.array(rewards), envs


def zeros(envs):
    """Return the actions that leave the decisions of the base as they are."""
    return np.zeros(envs.action_space.shape, dtype=np.float32)


def test_a_controller_that_is_given_is_copied_for_each_environment():
    controller = make_controller("spsfa-tip")
    envs = [SwarmVectorEnv(number, base=controller, **SHORT) for number in (3, 2)]
    alone = SwarmVectorEnv(3, base="spsfa-tip", **SHORT)
    for each in (*envs, alone):
        each.reset(seed=5)
    for _ in range(9):
        found = [each.step(zeros(each))[0] for each in envs]
        np.testing.assert_array_equal(found[0], alone.step(zeros(alone))[0])


@pytest.mark.parametrize("action", [None, "sourced-normalised"])
@pytest.mark.parametrize("name", BASES)
def test_the_action_of_zeros_is_the_base(name, action):
    own, alone = course_of(name, 3, 5, **SHORT)
    options = {} if action is None else {"action": action}
    envs = SwarmVectorEnv(3, base=name, **SHORT, **options, autoreset_mode=AutoresetMode.DISABLED)
    envs.reset(seed=5)
    earned = np.array([envs.step(zeros(envs))[1] for _ in range(12)])
    assert np.array_equal(earned, own)
    mine, theirs = envs.simulation.swarms, alone.simulation.swarms
    assert np.array_equal(mine.size, theirs.size)
    assert np.array_equal(mine.evaluations, theirs.evaluations)
    for row, size in enumerate(mine.size):
        assert np.array_equal(mine.positions[row, :size], theirs.positions[row, :size])
    shared = len(HISTORY)
    assert np.array_equal(
        envs.simulation.history[..., :shared], alone.simulation.history[..., :shared], equal_nan=True
    )


def test_a_vector_equals_single_environments_through_several_episodes():
    envs = SwarmVectorEnv(2, base="spsfa-tip", **SHORT, autoreset_mode=AutoresetMode.NEXT_STEP)
    single = gymnasium.make("swarm_gym/Firefly-v0", base="spsfa-tip", **SHORT)
    rng = np.random.default_rng(0)
    seen, _ = envs.reset(seed=8)
    alone, _ = single.reset(seed=9)
    for _ in range(3):
        assert np.array_equal(seen[1], alone)
        for _ in range(12):
            actions = rng.uniform(-0.3, 0.3, envs.action_space.shape).astype(np.float32)
            seen, rewards, ended, _, _ = envs.step(actions)
            alone, reward, stopped, _, _ = single.step(actions[1])
            assert np.array_equal(seen[1], alone)
            assert (rewards[1], ended[1]) == (reward, stopped)
        assert stopped
        assert not alone[-2:].any()  # an episode that has ended has no proposal
        seen = envs.step(zeros(envs))[0]  # begins the next one
        alone, _ = single.reset()


@pytest.mark.parametrize("name", ["open-loop:three-cases", "spsfa-tip"])
def test_corrections_are_those_of_residual_policies(name):
    layouts = {"action": "normalised", "observation": "scaled"}
    mine = SwarmVectorEnv(3, base=name, **SHORT, **layouts, autoreset_mode=AutoresetMode.SAME_STEP)
    base = make_controller(name)
    joined = f"{base.observation}+scaled"
    first = base.first_source.options() if base.first_source else {}
    options = {"initial_population_size": base.initial_population_size, **first}
    theirs = SwarmVectorEnv(
        3,
        **{**SHORT, **layouts, **options, "observation": joined},
        autoreset_mode=AutoresetMode.SAME_STEP,
    )
    trained = SB3VecEnv(theirs, Base(base, make_action(theirs.settings, theirs.simulation.optimizer)))
    trained.seed(3)
    expected, (found, _) = trained.reset(), mine.reset(seed=3)
    rng = np.random.default_rng(1)
    for _ in range(30):
        assert np.array_equal(found, expected)
        actions = rng.normal(0.0, 0.5, (3, 2)).clip(-1.0, 1.0).astype(np.float32)
        expected, paid, dones, infos = trained.step(actions)
        found, rewards, ended, _, further = mine.step(actions)
        assert np.array_equal(rewards, paid)
        assert np.array_equal(ended, dones)
        for row in np.flatnonzero(dones):
            assert np.array_equal(further["final_obs"][row], infos[row]["terminal_observation"])
    assert mine.single_observation_space == trained.observation_space


@pytest.mark.parametrize("name", ["spsfa-tip", "restart:patience=3"])
def test_a_base_remembers_where_swarms_are_copied_or_wait(name):
    options = {**SHORT, "autoreset_mode": AutoresetMode.DISABLED}
    together = SwarmVectorEnv(4, base=name, **options)
    leaders, once = np.array([0, 0, 2, 2]), np.array([True, False, True, False])
    together.reset(seed=[30, 31, 31, 31])
    for _ in range(3):
        together.step_running(zeros(together))  # the past of another episode
    together.reset(seed=[20, 0, 21, 0], options={"reset_mask": once})
    together.copy_swarms(leaders)
    for _ in range(5):
        together.step_running(zeros(together), once)
    together.copy_swarms(leaders)
    for _ in range(7):
        together.step_running(zeros(together))
    alone = SwarmVectorEnv(2, base=name, **options)
    alone.reset(seed=20)
    for _ in range(12):
        alone.step_running(zeros(alone))
    expected = alone.simulation.history[[0, 0, 1, 1]]
    assert np.array_equal(together.simulation.history, expected, equal_nan=True)


def test_swarms_that_begin_later_leave_the_others_as_they_are():
    options = {**SHORT, "autoreset_mode": AutoresetMode.DISABLED}
    late = SwarmVectorEnv(2, base="restart:patience=3", **options)
    late.reset(seed=4)
    for iteration in range(12):
        if iteration == 5:
            late.reset(seed=[0, 50], options={"reset_mask": np.array([False, True])})
        late.step_running(zeros(late))
    for row, seed, length in ((0, 4, 12), (1, 50, 7)):
        alone = SwarmEnv(base="restart:patience=3", **SHORT)
        alone.reset(seed=seed)
        for _ in range(length):
            alone.step(zeros(late)[0])
        found, expected = late.simulation.history[row], alone.simulation.history[0]
        assert np.array_equal(found[: length + 1], expected[: length + 1], equal_nan=True)


def test_a_controller_may_be_given_itself_and_options_override_what_it_needs():
    env = SwarmEnv(base=make_controller("spsfa-tip"), initial_population_size=33, **SHORT)
    assert env.settings.initial_population_size == 33
    assert env.settings.action == "normalised"
    env.reset(seed=0)
    assert env.step(np.zeros(2, dtype=np.float32))[-1]["population_size"] == 80


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"base": "spsfa-tip", "action": "natural"}, "'natural'.*cannot correct.*choose one of normalised"),
        (
            {"base": "open-loop:three-cases-sourced/0@1", "action": "normalised"},
            "decides population size, .*smooth share.*choose one of sourced-normalised",
        ),
        ({"base": "spsfa-tip", "action": "paced", "max_evaluations": 900}, "not paced"),
        ({"base": 7}, "base must be a controller, or the name of one"),
        ({"base": "learned:three-cases/0", "max_population_size": 90}, "trained for population sizes"),
        (
            {"base": "spsfa-tip", "reward": "optimality", "scenario": DRIVES},
            "reward 'optimality' needs optima, which are unknown for robots that drive",
        ),
    ],
)
def test_what_cannot_be_corrected_is_refused_by_name(options, message):
    with pytest.raises(ValueError, match=message):
        SwarmEnv(**options)


def test_a_base_for_other_episodes_is_refused():
    base = make_controller("fixed:20")
    base.max_evaluations = 500
    with pytest.raises(SettingError, match="max_evaluations 500, got 600"):
        SwarmEnv(base=base, max_evaluations=600)
    assert SwarmEnv(base=base).settings.max_evaluations == 500
    with pytest.raises(UnknownNameError, match="controller"):
        SwarmEnv(base="nobody")


def test_a_base_decides_on_the_host_only():
    class Elsewhere(Simulation):
        xp = object()

    with pytest.raises(SettingError, match="base 'spsfa-tip' decides in the memory of the host"):
        make_batch("spsfa-tip", "firefly", {}, 2, None, Elsewhere)


def test_a_base_that_decides_what_no_action_is_is_named():
    class TooFew(Fixed):
        def act(self, observations):
            return np.zeros((len(observations), 2))

    env = SwarmEnv(base=TooFew(20), **SHORT)
    with pytest.raises(ActionError, match=r"base .*TooFew.*population size must lie in"):
        env.reset(seed=0)
