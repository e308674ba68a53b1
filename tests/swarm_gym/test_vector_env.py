"""The native vector environment, compared with Gymnasium's own vector of single environments."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import swarm_gym  # noqa: F401
from helpers.layouts import OF_SWARMS
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ActionError, SettingError, StepOrderError, UnknownNameError
from swarm_gym.vector_env import SwarmVectorEnv

OPTIONS = {
    "scenario": ["case1", "case2", "case3"],
    "initial_population_size": 5,
    "max_population_size": 9,
    "iterations": 4,
}


def random_actions(generator, num_envs):
    return np.stack([generator.integers(2, 10, num_envs), generator.random(num_envs)], axis=1)


def assert_same_infos(ours, theirs):
    assert set(ours) == set(theirs)
    for key, value in theirs.items():
        if isinstance(value, dict):
            assert_same_infos(ours[key], value)
        elif key == "final_obs":
            for one, other in zip(ours[key], value, strict=True):
                np.testing.assert_array_equal(one, other)
        else:
            assert ours[key].dtype == value.dtype, key
            mask = theirs.get(f"_{key}", slice(None))
            np.testing.assert_array_equal(ours[key][mask], value[mask], err_msg=key)


@pytest.mark.parametrize("mode", list(AutoresetMode))
@pytest.mark.parametrize("extra", [{}, {"max_evaluations": 30}])
def test_equals_a_vector_of_single_environments(mode, extra):
    options = {**OPTIONS, **extra}
    native = SwarmVectorEnv(5, autoreset_mode=mode, **options)
    reference = SyncVectorEnv([lambda: SwarmEnv(**options)] * 5, autoreset_mode=mode)
    assert native.observation_space == reference.observation_space
    assert native.action_space == reference.action_space
    assert native.metadata["autoreset_mode"] == reference.metadata["autoreset_mode"]
    ours, theirs = native.reset(seed=3), reference.reset(seed=3)
    np.testing.assert_array_equal(ours[0], theirs[0])
    assert_same_infos(ours[1], theirs[1])
    generator = np.random.default_rng(0)
    for _ in range(11):
        actions = random_actions(generator, 5)
        ours, theirs = native.step(actions), reference.step(actions)
        for one, other in zip(ours[:4], theirs[:4], strict=True):
            np.testing.assert_array_equal(one, other)
            assert one.dtype == other.dtype
        assert_same_infos(ours[4], theirs[4])
        ended = ours[2] | ours[3]
        if mode == AutoresetMode.DISABLED and ended.any():
            ours = native.reset(options={"reset_mask": ended})
            theirs = reference.reset(options={"reset_mask": ended})
            np.testing.assert_array_equal(ours[0], theirs[0])
            assert_same_infos(ours[1], theirs[1])


def test_make_vec_gives_the_native_environment_without_warnings(recwarn):
    env = gymnasium.make_vec("swarm_gym/Firefly-v0", num_envs=3, **OPTIONS)
    assert isinstance(env.unwrapped, SwarmVectorEnv)
    assert [str(w.message) for w in recwarn] == []
    observations, _ = env.reset(seed=0)
    assert observations in env.observation_space


@pytest.mark.parametrize("seeds", [[7, 7, 7], [9, 2, 5], [None, 4, None]])
def test_seeds_may_be_listed(seeds):
    env = SwarmVectorEnv(3, **OPTIONS)
    observations, _ = env.reset(seed=seeds)
    for row, seed in enumerate(seeds):
        if seed is not None:
            np.testing.assert_array_equal(observations[row], SwarmEnv(**OPTIONS).reset(seed=seed)[0])


def test_reset_options_reach_every_swarm_and_are_left_alone():
    env = SwarmVectorEnv(3, **OPTIONS)
    options = {"scenario": "case2", "initial_population_size": 7, "reset_mask": np.full(3, True)}
    _, info = env.reset(seed=0, options=options)
    assert list(info["scenario"]) == ["case2"] * 3
    assert list(info["population_size"]) == [7] * 3
    assert list(options) == ["scenario", "initial_population_size", "reset_mask"]


def test_one_bad_action_stops_all_and_names_the_swarm():
    env = SwarmVectorEnv(3, **OPTIONS)
    env.reset(seed=0)
    actions = np.tile([5.0, 0.0], (3, 1))
    actions[1, 0] = np.nan
    with pytest.raises(ActionError, match="swarm 1"):
        env.step(actions)
    with pytest.raises(ActionError, match=r"3 in all; got \(2, 2\)"):
        env.step(actions[:2])
    assert env.simulation.iteration.tolist() == [0, 0, 0]


def test_step_before_reset_and_after_the_end_is_refused():
    env = SwarmVectorEnv(2, autoreset_mode="Disabled", **OPTIONS)
    actions = np.tile([5.0, 0.0], (2, 1))
    with pytest.raises(StepOrderError, match="no reset"):
        env.step(actions)
    with pytest.raises(StepOrderError, match=r"swarm 0.*no reset"):
        env.step_running(actions)
    env.reset(seed=0, options={"reset_mask": np.array([True, False])})
    with pytest.raises(StepOrderError, match=r"swarm 1.*no reset"):
        env.step_running(actions)
    env.reset(seed=0)
    for _ in range(4):
        env.step(actions)
    with pytest.raises(StepOrderError, match="ended"):
        env.step(actions)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"num_envs": 0}, SettingError, "num_envs.*0"),
        ({"num_envs": 2.0}, SettingError, "num_envs.*2.0"),
        ({"num_threads": 0}, SettingError, "num_threads.*0"),
        ({"num_threads": 100_000}, SettingError, "num_threads.*100000"),
        ({"render_mode": "rgb_array"}, SettingError, "rgb_array"),
        ({"max_episode_steps": 5}, SettingError, "iterations"),
        ({"autoreset_mode": "later"}, UnknownNameError, "later"),
        ({"colour": "red"}, UnknownNameError, "colour"),
    ],
)
def test_bad_arguments_are_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        SwarmVectorEnv(**arguments)


MASKS = [[True, False], np.array([1, 0]), np.array([True]), np.array([False, False])]


@pytest.mark.parametrize(
    ("seed", "options", "message"),
    [
        *((0, {"reset_mask": mask}, "reset_mask") for mask in MASKS),
        ([1, 2, 3], None, r"2 seeds.*3"),
    ],
)
def test_bad_arguments_of_reset_are_refused(seed, options, message):
    env = SwarmVectorEnv(2, **OPTIONS)
    env.reset(seed=0)
    with pytest.raises(SettingError, match=message):
        env.reset(seed=seed, options=options)


@pytest.mark.parametrize("layout", sorted(OF_SWARMS))
def test_swarms_that_have_not_begun_are_observed_without_warnings(layout):
    env = SwarmVectorEnv(2, observation=layout, **OPTIONS)
    first = np.array([True, False])
    seen, _ = env.reset(seed=3, options={"reset_mask": first})
    everyone, _ = env.reset(seed=3)
    np.testing.assert_array_equal(seen[0], everyone[0])
    assert env.observation_space.contains(seen)


def test_step_running_goes_on_with_episodes_that_a_step_began_anew():
    env = SwarmVectorEnv(2, autoreset_mode="SameStep", **OPTIONS)
    actions = np.tile([5.0, 0.0], (2, 1))
    env.reset(seed=0)
    for _ in range(OPTIONS["iterations"]):
        *_, terminated, _, _ = env.step(actions)
    assert terminated.all()
    assert not env.step_running(actions)[2].any()
    assert env.simulation.iteration.tolist() == [1, 1]


def test_step_running_lets_swarms_rest_whose_episode_has_ended():
    options = {"initial_population_size": 4, "max_population_size": 9, "iterations": 6, "max_evaluations": 60}
    env = SwarmVectorEnv(5, scenario=["case1", "case2"], **options)
    env.reset(seed=3)
    ended, returns = np.zeros(5, dtype=bool), np.zeros(5)
    actions = np.tile([4.0, 0.0], (5, 1))
    actions[:2, 0] = 9.0
    lengths = np.zeros(5, dtype=int)
    while not ended.all():
        lengths += ~ended
        _, rewards, ended = env.step_running(actions)
        returns += rewards
    assert lengths[:2].max() < lengths[2:].min() == 6
    for row in range(5):
        single = SwarmEnv(scenario=["case1", "case2"], **options)
        single.reset(seed=3 + row)
        total, done = 0.0, False
        while not done:
            _, reward, done, _, info = single.step(actions[row])
            total += reward
        assert total == returns[row]
        assert info["evaluations"] == env.simulation.swarms.evaluations[row]


def test_copied_swarms_go_on_as_the_swarm_they_are_copies_of():
    native, reference = (SwarmVectorEnv(6, **OPTIONS) for _ in range(2))
    native.reset(seed=3, options={"reset_mask": np.arange(6) < 2})
    reference.reset(seed=3)
    rows = np.array([0, 1, 0, 1, 1, 0])
    observations = native.copy_swarms(rows)
    generator = np.random.default_rng(0)
    for iteration in range(4):
        actions = random_actions(generator, 6)[rows]
        everyone = iteration < 2
        chosen = np.full(6, True) if everyone else np.arange(6) < 2
        observations, rewards, ended = native.step_running(actions, chosen)
        expected = reference.step_running(actions)
        if everyone:
            np.testing.assert_array_equal(observations, expected[0][rows])
            np.testing.assert_array_equal(rewards, expected[1][rows])
        else:
            np.testing.assert_array_equal(observations[:2], expected[0][:2])
            assert (rewards[2:] == 0.0).all()
    assert ended.tolist() == [True, True, False, False, False, False]
    np.testing.assert_array_equal(native.copy_swarms(rows), expected[0][rows])
    assert native.step_running(actions)[2].all()
    inside = native.simulation, reference.simulation
    for name in ("iteration", "running", "history"):
        ours, theirs = (getattr(simulation, name) for simulation in inside)
        np.testing.assert_array_equal(ours, theirs[rows], err_msg=name)
    for ours, theirs in (
        [simulation.gaps.initial for simulation in inside],
        [simulation.prices.of_reference for simulation in inside],
    ):
        np.testing.assert_array_equal(ours, theirs[rows])
    for name, ours, theirs in zip(
        reference.simulation.swarms._fields,
        native.simulation.swarms,
        reference.simulation.swarms,
        strict=True,
    ):
        np.testing.assert_array_equal(ours, theirs[rows], err_msg=name)


def test_swarms_that_are_not_chosen_rest():
    env = SwarmVectorEnv(3, **OPTIONS)
    before, _ = env.reset(seed=3)
    actions = random_actions(np.random.default_rng(0), 3)
    after, _, _ = env.step_running(actions, np.array([True, False, True]))
    np.testing.assert_array_equal(after[1], before[1])
    assert (after[[0, 2], 3] == 1).all()


def test_beginning_some_swarms_measures_no_path_of_the_others(monkeypatch):
    measured = []
    monkeypatch.setattr("swarm_gym.batch.length_of", lambda path: measured.append(len(path)) or 1.0)
    env = SwarmVectorEnv(
        3, scenario="open:40", source="guided", iterations=1, autoreset_mode=AutoresetMode.DISABLED
    )
    env.reset(seed=0)
    env.step(np.array([[5.0, 0.0]] * 3))
    assert len(measured) == 3
    env.reset(seed=9, options={"reset_mask": np.array([True, False, False])})
    assert len(measured) == 3


def test_begin_is_reset_without_observations_and_infos():
    ours, theirs = SwarmVectorEnv(3, **OPTIONS), SwarmVectorEnv(3, **OPTIONS)
    options = {"scenario": "case2", "initial_population_size": 7}
    expected, _ = theirs.reset(seed=4, options=options)
    ours.begin(np.ones(3, dtype=np.bool_), 4, options)
    np.testing.assert_array_equal(ours.observe(), expected)
    actions = random_actions(np.random.default_rng(1), 3)
    np.testing.assert_array_equal(ours.step(actions)[0], theirs.step(actions)[0])


@pytest.mark.parametrize(
    "rows", [[[0, 1, 2]], [0], [0, 1], [-1, 0, 1], [3, 0, 1], [0.0, 1.0, 2.0], [True, False, True], "012"]
)
def test_rows_to_copy_are_numbers_of_all_swarms(rows):
    envs = SwarmVectorEnv(3, scenario="case3", iterations=5, autoreset_mode="Disabled")
    before, _ = envs.reset(seed=0)
    with pytest.raises(SettingError, match="rows must be 3 numbers of swarms from 0 to 2"):
        envs.copy_swarms(np.array(rows) if isinstance(rows[0], list) else rows)
    np.testing.assert_array_equal(envs.observe(), before)
    np.testing.assert_array_equal(envs.copy_swarms([0, 0, 2]), before[[0, 0, 2]])
    np.testing.assert_array_equal(envs.reset(seed=0)[0], before)


@pytest.mark.parametrize("chosen", [np.array([True]), np.array([1, 0, 1]), np.ones((1, 3), bool)])
def test_flags_of_swarms_to_advance_are_one_for_each(chosen):
    envs = SwarmVectorEnv(3, scenario="case3", iterations=5, autoreset_mode="Disabled")
    envs.reset(seed=0)
    with pytest.raises(SettingError, match="chosen must be 3 booleans"):
        envs.step_running(np.tile([9.0, 0.0], (3, 1)), chosen)


def test_seeds_may_be_an_array():
    envs = SwarmVectorEnv(3, scenario="case3", iterations=5)
    listed, _ = envs.reset(seed=[4, 5, 6])
    np.testing.assert_array_equal(envs.reset(seed=np.arange(4, 7))[0], listed)
