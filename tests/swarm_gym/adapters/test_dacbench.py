"""The benchmark of DACBench: what DACBench asks of each of its own, and instances that are scenarios."""

import json
import warnings
from functools import partial

import numpy as np
import pytest

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # benchmarks of DACBench whose libraries are missing
    pytest.importorskip("dacbench", reason="needs the extra `dacbench`")
    from dacbench.agents import RandomAgent, StaticAgent
    from dacbench.logger import Logger
    from dacbench.runner import run_benchmark
    from dacbench.wrappers import ActionFrequencyWrapper, PerformanceTrackingWrapper, RewardNoiseWrapper

from gymnasium.utils.env_checker import check_env

from swarm_gym.adapters.dacbench import OneMaxBenchmark, SwarmBenchmark, SwarmDACEnv
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError, UnknownNameError

FEW = {
    "cutoff": 4,
    "test_scenarios": ["random-fields:test:0-2"],
    "options": {"initial_population_size": 6, "max_population_size": 9},
}


def make(**config):
    return SwarmBenchmark(config={**FEW, **config})


def episode(env, action=(6.0, 0.3), **options):
    """Return the first observation, the rewards and the last info of an episode."""
    first, _ = env.reset(**options)
    rewards, ended = [], False
    while not ended:
        _, reward, terminated, truncated, info = env.step(np.array(action))
        rewards.append(reward)
        ended = terminated or truncated
    return first.tolist(), rewards, info


def scenario_after(reset, env):
    """Return the name of the scenario that the swarm is on after a reset."""
    reset()
    found = env.swarm_env.simulation.problem_of(0).scenario.name
    assert found == env.get_instance().scenario
    return found


def test_the_environment_of_a_benchmark_is_one_of_dacbench_and_of_gymnasium():
    env = make(scenarios=["case1"]).get_environment()  # with several, a seed does not choose the instance
    assert isinstance(env, SwarmDACEnv)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # recommendations about spaces
        check_env(env, skip_render_check=True)


def test_two_benchmarks_of_a_seed_are_the_same():
    # As tests/envs/test_deterministic.py of DACBench asks of its benchmarks.
    found = []
    for _ in range(2):
        env = SwarmBenchmark().get_benchmark(seed=42)
        state, info = env.reset()
        found.append((state.tolist(), info, env.step(np.array([20.0, 0.5]))[1:]))
    assert found[0] == found[1]
    other = SwarmBenchmark().get_benchmark(seed=43)
    assert other.reset()[0].tolist() != found[0][0]


def test_a_configuration_is_written_and_read(tmp_path):
    bench = make(seed=3)
    bench.save_config(tmp_path / "config.json")
    stored = json.loads((tmp_path / "config.json").read_text())
    assert set(bench.config) <= set(stored)
    again = [SwarmBenchmark(tmp_path / "config.json"), SwarmBenchmark.from_json(bench.to_json())]
    assert again == [bench, bench]
    expected = episode(bench.get_environment())
    for one in again:
        assert one.config.options == bench.config.options
        assert episode(one.get_environment()) == expected


def test_a_configuration_that_is_written_after_use_is_read(tmp_path):
    bench = make()
    expected = episode(bench.get_environment())
    bench.save_config(tmp_path / "config.json")
    assert episode(SwarmBenchmark(tmp_path / "config.json").get_environment()) == expected


def test_instances_are_scenarios_in_turn():
    env = make().get_environment()
    names = {number: instance.scenario for number, instance in env.get_instance_set().items()}
    assert names == {0: "case1", 1: "case2", 2: "case3"}
    names = [scenario_after(env.reset, env) for _ in range(4)]
    assert names == ["case2", "case3", "case1", "case2"]  # DACBench goes on before each episode
    assert scenario_after(partial(env.reset, options={"instance_id": 2}), env) == "case3"
    env.use_test_set()
    assert len(env.get_instance_set()) == 3
    assert scenario_after(env.reset, env).startswith("random-fields:test:")
    env.use_training_set()
    assert scenario_after(env.reset, env).startswith("case")


def test_an_episode_is_that_of_the_environment():
    bench = make(optimizer="particle-swarm")
    env = bench.get_environment()
    first, rewards, info = episode(env, seed=5, options={"instance_id": 0})
    seed = int(np.random.Generator(np.random.PCG64(np.random.SeedSequence(5))).integers(2**31))
    ours = SwarmEnv("particle-swarm", scenario=["case1", "case2"], iterations=4, **FEW["options"])
    expected, expected_rewards, expected_info = episode(ours, seed=seed, options={"scenario": "case1"})
    assert (first, rewards) == (expected, expected_rewards)
    assert {name: expected_info[name] for name in info} == info
    assert info["optimality_gap"] > 0.0
    assert env.c_step == 4


def test_options_of_reset_go_on_to_the_swarm_and_wrong_ones_are_refused():
    env = make().get_environment()
    assert env.reset(options={"initial_population_size": 3})[1]["population_size"] == 3
    with pytest.raises(UnknownNameError, match="reset option 'size'"):
        env.reset(options={"size": 3})
    with pytest.raises(SettingError, match="the instance decides the scenario, got 'case2'"):
        env.reset(options={"scenario": "case2"})
    with pytest.raises(SettingError, match=r"instance_id must be one of \[0, 1, 2\], got 7"):
        env.reset(options={"instance_id": 7})
    for name in ("scenarios", "test_scenarios"):
        with pytest.raises(SettingError, match=f"{name} must name at least one scenario"):
            make(**{name: []}).get_environment()
    with pytest.raises(UnknownNameError, match="optimizer 'fireflies'"):
        make(optimizer="fireflies").get_environment()


def test_wrappers_loggers_and_agents_of_dacbench_run_it(tmp_path):
    bench = make()
    bench.register_wrapper(partial(RewardNoiseWrapper, noise_dist="normal", dist_args=[0, 0.1]))
    env = PerformanceTrackingWrapper(bench.get_environment())
    logger = Logger(experiment_name="swarm", output_path=tmp_path)
    logger.add_benchmark(bench)
    logger.set_env(env)
    assert np.isfinite(run_benchmark(env, StaticAgent(env, np.array([6.0, 0.3])), 3, logger))
    logger.close()
    assert len(env.get_performance()[0]) == 3
    tracked = ActionFrequencyWrapper(make().get_environment())
    run_benchmark(tracked, RandomAgent(tracked), 2)
    assert len(tracked.overall_actions) == 2 * 4


def test_the_benchmark_with_a_known_optimum_ends_terminated_at_the_optimum():
    env = OneMaxBenchmark(config={"scenarios": ["onemax:20"], "cutoff": 2000}).get_environment()
    observation, _ = env.reset()
    assert observation.tolist() == [20.0, 10.0]
    terminated = truncated = False
    while not (terminated or truncated):
        observation, reward, terminated, truncated, info = env.step(np.array([2.0, 0.0]))
        assert reward <= 0.0
    assert (terminated, truncated, observation.tolist()) == (True, False, [20.0, 20.0])
    assert info["best_fitness"] == 0.0
