"""Swarms for plain stable-baselines3: wrapped, trained in, and the same as the native vector."""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3", reason="needs the extra `study`")

from gymnasium.vector import AutoresetMode
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from swarm_gym.errors import UnknownNameError
from swarm_gym.sb3 import NativeVecEnv, make_vec
from swarm_gym.vector_env import SwarmVectorEnv

OPTIONS = {"iterations": 5, "initial_population_size": 6, "max_population_size": 12}


def test_it_is_the_native_vector_with_the_layouts_of_networks():
    made = make_vec("particle-swarm", 3, seed=7, **OPTIONS)
    native = SwarmVectorEnv(
        3,
        "particle-swarm",
        autoreset_mode=AutoresetMode.SAME_STEP,
        observation="scaled",
        action="normalised",
        **OPTIONS,
    )
    np.testing.assert_array_equal(made.reset(), native.reset(seed=7)[0])
    rng = np.random.default_rng(0)
    for _ in range(12):
        actions = rng.uniform(-1.0, 1.0, (3, 2)).astype(np.float32)
        observations, rewards, dones, infos = made.step(actions)
        expected, expected_rewards, terminated, _, _ = native.step(actions)
        np.testing.assert_array_equal(observations, expected)
        np.testing.assert_array_equal(rewards, expected_rewards)
        assert dones.tolist() == terminated.tolist() == [bool(info) for info in infos]


def test_options_replace_the_default_layouts():
    made = make_vec(num_envs=2, observation="paper", action="natural", **OPTIONS)
    assert made.observation_space == SwarmVectorEnv(2, **OPTIONS).single_observation_space
    assert made.action_space == SwarmVectorEnv(2, **OPTIONS).single_action_space


def test_plain_ppo_trains_in_it_under_the_wrappers_of_the_library(tmp_path):
    def train():
        env = VecNormalize(VecMonitor(make_vec("firefly", 4, scenario=["case1", "case2"], **OPTIONS)))
        model = PPO("MlpPolicy", env, n_steps=10, batch_size=20, seed=3, device="cpu")
        model.learn(80)
        return model

    model = train()
    assert model.num_timesteps == 80
    episodes = model.ep_info_buffer
    assert len(episodes) == 16
    assert all(episode["l"] == 5 and np.isfinite(episode["r"]) for episode in episodes)
    weights, again = (m.policy.state_dict() for m in (model, train()))
    assert all((weights[name] == again[name]).all() for name in weights)
    model.save(tmp_path / "plain")
    assert PPO.load(tmp_path / "plain").predict(model.env.reset(), deterministic=True)[0].shape == (4, 2)


def test_what_only_single_environments_have_is_refused():
    made = make_vec(num_envs=2, **OPTIONS)
    assert made.get_attr("num_envs") == [2, 2]
    with pytest.raises(AttributeError, match="'price'"):
        made.set_attr("price", 1.0)
    with pytest.raises(AttributeError, match="'render'"):
        made.env_method("render")
    with pytest.raises(UnknownNameError, match="'fireflies'"):
        make_vec("fireflies", 2)
    with pytest.raises(ValueError, match="SAME_STEP"):
        NativeVecEnv(SwarmVectorEnv(2, **OPTIONS))
