"""Swarms for plain stable-baselines3: wrapped, trained in, and the same as the native vector."""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3", reason="needs the extra `study`")

from gymnasium.vector import AutoresetMode
from stable_baselines3 import DQN, PPO
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.vec_env import SubprocVecEnv, VecMonitor, VecNormalize

from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.rollout import run_episodes, run_swarms, swarms_for
from swarm_gym.sb3 import NativeVecEnv, make_vec
from swarm_gym.vector_env import SwarmVectorEnv

OPTIONS = {"iterations": 5, "initial_population_size": 6, "max_population_size": 12}


def test_make_vec_is_the_native_vector_with_the_layouts_of_networks():
    made = make_vec("particle-swarm", 3, seed=7, **OPTIONS)
    native = SwarmVectorEnv(
        3,
        "particle-swarm",
        autoreset_mode=AutoresetMode.SAME_STEP,
        observation="extended",
        action="centred",
        reward="progress",
        price=0.1,
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
    with pytest.warns(UserWarning, match="natural units") as warned:
        made = make_vec(num_envs=2, observation="paper", action="natural", **OPTIONS)
    said = [str(one.message) for one in warned]
    assert ["choose observation='scaled'" in one for one in said] == [True, False]
    assert ["choose action='centred'" in one for one in said] == [False, True]
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


@pytest.mark.parametrize(
    ("scenario", "expected"),
    [
        ("case1", ("extended", "progress", 0.1)),
        ("function:bbob-1-3-1", ("extended", "progress", 0.1)),
        ("dynamic:case1-gate@3-drive@2,every=1,distance=60", ("extended", "detour", 1.0)),
    ],
)
def test_defaults_fit_the_kind_of_scenario(scenario, expected):
    settings = make_vec(num_envs=1, scenario=scenario, **OPTIONS).env.settings
    assert (settings.observation, settings.reward, settings.price) == expected
    assert settings.action == "centred"


def test_defaults_on_bit_strings_are_those_of_runtimes():
    settings = make_vec("one-plus-lambda-lambda", 1, scenario="onemax:20").env.settings
    assert (settings.observation, settings.reward, settings.action) == ("theory-scaled", "runtime", "centred")


def test_infos_of_ended_episodes_have_the_optimality_gap():
    paid_at_the_end = {"reward": "optimality", "price": 1.0}
    made = make_vec(num_envs=3, seed=0, scenario=["case1", "case3"], **paid_at_the_end, **OPTIONS)
    made.reset()
    for _ in range(4):
        infos = made.step(np.zeros((3, 2)))[3]
        assert infos == [{}] * 3
    infos = made.step(np.zeros((3, 2)))[3]
    # The first population is given: nothing decided its size.
    costs = [(info["evaluations"] - OPTIONS["initial_population_size"]) / 100_000 for info in infos]
    paid = [info["episode"]["r"] for info in infos]
    expected = [-100 * info["optimality_gap"] - cost for info, cost in zip(infos, costs, strict=True)]
    np.testing.assert_allclose(paid, expected, rtol=1e-12)


def test_learners_that_choose_have_all_combinations():
    made = make_vec(num_envs=2, seed=1, choices=(3, 2), **OPTIONS)
    assert made.action_space.n == 6
    plain = make_vec(num_envs=2, seed=1, **OPTIONS)
    np.testing.assert_array_equal(made.reset(), plain.reset())
    chosen = made.step(np.array([2, 5]))[0]
    np.testing.assert_array_equal(chosen, plain.step(np.array([[0.0, -1.0], [1.0, 1.0]]))[0])
    model = DQN("MlpPolicy", made, learning_starts=4, buffer_size=100, seed=0, device="cpu")
    assert model.learn(24).num_timesteps == 24


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"choices": (3,)}, "choices needs 2 numbers, one for each decision"),
        ({"choices": (3, 1)}, "choices must .*1"),
        ({"choices": (3, 3), "action": "natural"}, "scaled to .*'centred'"),
    ],
)
@pytest.mark.filterwarnings("ignore:action='natural'")
def test_choices_that_cannot_be_are_refused(options, error):
    with pytest.raises(SettingError, match=error):
        make_vec(num_envs=2, **options, **OPTIONS)


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


SCENARIOS = ["case1", "case2", "case3"]


def begun(env):
    """Begin episodes and return the names of the scenarios in their infos."""
    env.reset()
    return [info["scenario"] for info in env.reset_infos]


def test_options_are_those_of_the_next_reset():
    made = make_vec(num_envs=6, seed=1, scenario=SCENARIOS, **OPTIONS)
    drawn = begun(make_vec(num_envs=6, seed=1, scenario=SCENARIOS, **OPTIONS))
    assert len(set(drawn)) > 1
    made.set_options({"scenario": "case2"})
    assert begun(made) == ["case2"] * 6
    assert len(set(begun(made))) > 1  # options count once
    made.set_options([{"scenario": name} for name in SCENARIOS * 2])
    assert begun(VecMonitor(made).venv) == SCENARIOS * 2
    made.seed(1)
    made.set_options([{}, {"initial_population_size": 4}] * 3)
    assert begun(made) == drawn
    assert [info["population_size"] for info in made.reset_infos] == [6, 4] * 3
    made.set_options({"scenario": "case2"})
    made.set_options()
    made.seed(1)
    assert begun(made) == drawn


def test_options_of_groups_of_swarms_do_not_change_what_seeds_draw():
    population = np.zeros((3, 31))
    made, all_alike = (make_vec(num_envs=4, seed=5, **OPTIONS) for _ in range(2))
    made.set_options([{"initial_population": population.copy()}, {"initial_population_size": 3}] * 2)
    all_alike.set_options({"initial_population_size": 3})
    found, expected = made.reset(), all_alike.reset()
    np.testing.assert_array_equal(found[1::2], expected[1::2])
    assert not (found[::2] == expected[::2]).all()


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"scenari": "case1"}, "unknown reset option 'scenari'; valid: amplitude"),
        ({"scenario": "case2"}, "unknown scenario of this environment 'case2'; valid: case1"),
        ([{}, {"initial_population_size": 0}], "initial_population_size must lie in"),
        ([{}], "options must be a mapping, or a list of 2, one for each swarm"),
        ({"reset_mask": [True, False]}, "unknown reset option 'reset_mask'"),
    ],
)
def test_options_that_cannot_be_are_refused_when_they_are_given(options, error):
    made = make_vec(num_envs=2, **OPTIONS)
    with pytest.raises(ValueError, match=error):
        made.set_options(options)
    native = SwarmVectorEnv(2, **OPTIONS)
    if isinstance(options, dict) and "reset_mask" not in options:
        with pytest.raises(ValueError, match=error):
            native.reset(options=options)


def test_infos_of_resets_are_those_of_the_library():
    made = make_vec(num_envs=3, seed=2, scenario=SCENARIOS, **OPTIONS)
    single = make_vec_env(
        SwarmEnv,
        3,
        seed=2,
        env_kwargs={"scenario": SCENARIOS, "observation": "extended", "action": "centred", **OPTIONS},
    )
    assert made.reset_infos == [{}] * 3
    made.reset(), single.reset()
    for step in range(12):
        if step in (0, 5, 7):
            for ours, its in zip(made.reset_infos, single.reset_infos, strict=True):
                np.testing.assert_equal(ours, its)
        actions = np.full((3, 2), 0.1 * step - 0.5, dtype=np.float32)
        made.step(actions), single.step(actions)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["forkserver", "spawn"])
def test_workers_that_start_anew_make_environments_by_an_id_with_its_package(method):
    workers = {"vec_env_cls": SubprocVecEnv, "vec_env_kwargs": {"start_method": method}}
    made = make_vec_env("swarm_gym:swarm_gym/Firefly-v0", 2, seed=3, env_kwargs=OPTIONS, **workers)
    try:
        seen = made.reset()
    finally:
        made.close()
    np.testing.assert_array_equal(seen, SwarmVectorEnv(2, **OPTIONS).reset(seed=3)[0])


def test_corrections_are_in_the_layout_that_the_decisions_of_the_base_need():
    made = make_vec("firefly", 1, base="open-loop:three-cases-sourced/0@1", iterations=5)
    assert made.env.settings.action == "sourced-normalised"
    made = make_vec("firefly", 1, base="open-loop:three-cases", action="normalised", iterations=5)
    assert made.env.settings.action == "normalised"


def test_learners_of_sources_begin_with_smooth_members_unless_a_source_is_named():
    settings = make_vec("firefly", 1, action="sourced-centred", iterations=5).env.settings
    assert (settings.source, settings.amplitude) == ("smooth", 0.2)
    settings = make_vec("firefly", 1, action="sourced-centred", source="uniform", iterations=5).env.settings
    assert (settings.source, settings.amplitude) == ("uniform", None)


@pytest.mark.parametrize(
    ("base", "options"),
    [
        ("fixed:9,smooth_share=1,amplitude=0.05", {"action": "sourced-centred"}),
        ("fixed:9", {"action": "sourced-centred"}),
        ("fixed:9", {"max_evaluations": 40}),
        ("learned:three-cases/0", {}),
    ],
)
def test_defaults_for_learners_stand_behind_what_a_base_needs(base, options):
    episodes = {"iterations": 6, "scenario": "case1", **options}
    envs = make_vec(num_envs=3, base=base, seed=4, **episodes)
    envs.reset()
    ended = {}
    for _ in range(6):
        _, _, dones, infos = envs.step(np.zeros((3, *envs.action_space.shape), dtype=np.float32))
        for row in np.flatnonzero(dones):
            ended.setdefault(row, infos[row]["best_fitness"])
    budget = {name: value for name, value in options.items() if name == "max_evaluations"}
    runs = run_episodes(make_controller(base), "case1", range(4, 7), iterations=6, **budget)
    np.testing.assert_array_equal(runs.final_fitness, [ended[row] for row in range(3)])


def test_a_policy_whose_output_is_zero_is_its_base():
    made = make_vec("firefly", 2, base="open-loop:three-cases", seed=3, iterations=5)
    assert made.observation_space.shape == (11,)  # the layout `extended`, and two proposals
    assert made.action_space.shape == (2,)
    assert made.env.settings.action == "centred"  # small corrections of phi = 0 change next to nothing
    made.reset()
    for _ in range(5):
        _, _, dones, infos = made.step(np.zeros((2, 2), dtype=np.float32))
    assert dones.all()
    alone = make_controller("open-loop:three-cases")
    swarms = swarms_for(alone, 2, "firefly", iterations=5, reward="progress", price=0.1)
    earned = run_swarms(alone, swarms, range(3, 5))
    assert [info["episode"]["r"] for info in infos] == earned.tolist()
    assert [info["best_fitness"] for info in infos] == swarms.simulation.swarms.best_fitness.tolist()


def test_infos_of_beginnings_are_there_with_choices_too():
    swarms = make_vec("firefly", 3, scenario=["case1", "case2"], choices=(7, 5), iterations=3)
    swarms.set_options({"scenario": "case2"})
    swarms.reset()
    assert [info["scenario"] for info in swarms.reset_infos] == ["case2"] * 3
