"""The paired reward: the difference of two controllers' own runs from the same starts."""

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from agents import SizeLimits, make_controller
from helpers.trainings import STEPS, tiny_config, train
from swarm_gym.controllers.registry import load_learned
from swarm_gym.env import SwarmEnv
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.seeds import VALIDATION
from swarm_gym.training.learners.environments import make_reference, reference_controller
from swarm_gym.training.sb3_vec_env import SB3VecEnv
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.wrappers.paired_reward import Reference

LIMITS = SizeLimits(2, 12)
SIZES = {"max_population_size": 12, "iterations": 9}
PAID = {"scenario": ["case1", "case3"], "reward": "final-gap", **SIZES}


def paired_env(num, **options):
    """Swarms that are compared with the schedule; both begin with 12 members."""
    own = {**PAID, "initial_population_size": 12, "autoreset_mode": AutoresetMode.SAME_STEP, "price": 3.0}
    controller = make_controller("spsfa-tip", LIMITS)
    twin = SwarmVectorEnv(num, **{**own, "price": 0.0, **controller.env_options()})
    return SB3VecEnv(SwarmVectorEnv(num, **{**own, **options}), None, Reference(controller, twin))


def episode_returns(env, name, seed):
    """Return what a controller earns in three episodes of a single environment, the first from that seed."""
    controller, totals = make_controller(name, LIMITS), np.zeros(3)
    for episode in range(3):
        observation, _ = env.reset(seed=seed if episode == 0 else None)
        controller.reset(1)
        ended = False
        while not ended:
            observation, reward, ended, _, _ = env.step(controller.act(observation[None])[0])
            totals[episode] += reward
    return totals


# The budget ends an episode at the third iteration; the reference always takes nine.
@pytest.mark.parametrize("budget", [{}, {"max_evaluations": 12 + 3 * 12 * 12}], ids=["no budget", "budget"])
def test_a_paired_return_is_the_difference_of_two_runs_from_the_same_start(budget):
    env = paired_env(6, **budget)
    env.seed(40)
    env.reset()
    found, earned = [[] for _ in range(6)], np.zeros(6)
    while min(map(len, found)) < 3:
        _, rewards, dones, infos = env.step(np.tile([12.0, 0.0], (6, 1)))
        earned += rewards
        for row in np.flatnonzero(dones):
            found[row].append(infos[row]["episode"]["r"])
            assert found[row][-1] == pytest.approx(earned[row])
            assert (infos[row]["episode"]["l"] < 9) if budget else (infos[row]["episode"]["l"] == 9)
        earned[dones] = 0.0
    for row in range(6):
        own, theirs = (
            episode_returns(SwarmEnv(**PAID, initial_population_size=12, **options), name, 40 + row)
            for name, options in (("fixed:12", {"price": 3.0, **budget}), ("spsfa-tip", {"price": 0.0}))
        )
        assert found[row][:3] == pytest.approx(own - theirs, abs=1e-12)


@pytest.mark.usefixtures("plain_pictures")
def test_validation_is_paired_too(tmp_path):
    run = train(
        tmp_path,
        reward="paired",
        reference="spsfa-tip:initial_population_size=4",
        warm_start="none",
        total_steps=STEPS,
    )
    assert run.learner.env.reference is not None
    best = run.run()
    policy = load_learned(best, run.config.limits)
    seeds = VALIDATION[: run.config.validation_seeds]
    own = run_episodes(policy, "case3", seeds, **run.config.env_options())
    controller, options = reference_controller(run.config)
    theirs = run_episodes(controller, "case3", seeds, **options)
    result = policy.manifest["validation"]["case3"]
    assert result["return"] == pytest.approx(own.returns.mean() - theirs.returns.mean(), abs=1e-12)


def test_other_rewards_have_no_reference(tmp_path):
    assert make_reference(tiny_config(tmp_path, reward="final-gap"), 2) is None


def test_a_reference_needs_a_seed_and_the_right_autoreset():
    env = paired_env(2)
    with pytest.raises(ValueError, match="needs a seed"):
        env.reset()
    with pytest.raises(ValueError, match="SAME_STEP"):
        Reference(make_controller("spsfa"), SwarmVectorEnv(2, **SIZES, initial_population_size=4))


def test_a_reference_that_sees_the_price_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("swarm_gym.controllers.fixed.Fixed.price", 0.3)
    with pytest.raises(ValueError, match="reference 'fixed:4'"):
        make_reference(tiny_config(tmp_path, reward="paired", reference="fixed:4"), 2)
