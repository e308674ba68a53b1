"""The paired reward: the difference of two controllers' own runs from the same starts."""

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from agents import SizeLimits, make_controller
from agents.evaluation.rollout import run_episodes
from agents.runs.seeds import VALIDATION
from agents.training.learners.environments import make_reference, reference_controller
from agents.training.paired_reward import Reference
from agents.training.sb3_vec_env import SB3VecEnv
from helpers.trainings import STEPS, tiny_config, train
from swarm_gym.controllers.registry import load_learned
from swarm_gym.env import SwarmEnv
from swarm_gym.vector_env import SwarmVectorEnv

LIMITS = SizeLimits(2, 12)
SIZES = {"max_population_size": 12, "iterations": 9}
PAID = {"scenario": ["case1", "case3"], "reward": "final-gap", **SIZES}


def paired_env(num, **options):
    """Swarms that are compared with the schedule; both begin with 12 members."""
    own = {**PAID, "initial_population_size": 12, "autoreset_mode": AutoresetMode.SAME_STEP, "price": 3.0}
    controller = make_controller("spsfa-tip", LIMITS)
    twin = SwarmVectorEnv(num, **{**own, "price": 0.0, **controller.env_options()})
    return SB3VecEnv(SwarmVectorEnv(num, **{**own, **options}), None, Reference(controller, twin))


def run_to_end(controller, env, observation):
    controller.reset(1)
    total, ended = 0.0, False
    while not ended:
        observation, reward, ended, _, _ = env.step(controller.act(observation[None])[0])
        total += reward
    return total


def test_a_paired_return_is_the_difference_of_two_runs():
    env = paired_env(6)
    env.seed(40)
    env.reset()
    earned = np.zeros(6)
    for step in range(9):
        _, rewards, dones, infos = env.step(np.tile([12.0, 0.0], (6, 1)))
        assert dones.all() == (step == 8)
        earned += rewards
    assert [info["episode"]["r"] for info in infos] == pytest.approx(earned.tolist())
    options = {**PAID, "initial_population_size": 12}
    scenario = options.pop("scenario")
    for row in range(6):  # one by one, since the scenario is drawn by the seed
        seeds = range(40 + row, 41 + row)
        own, theirs = (
            run_episodes(make_controller(name, LIMITS), scenario, seeds, price=price, **options).returns[0]
            for name, price in (("fixed:12", 3.0), ("spsfa-tip", 0.0))
        )
        assert earned[row] == pytest.approx(own - theirs, abs=1e-12)


def test_episodes_of_other_lengths_meet_the_reference_of_the_same_start():
    # The budget ends an episode at the third iteration; the reference always takes nine.
    env = paired_env(3, max_evaluations=12 + 3 * 12 * 12)
    env.seed(40)
    env.reset()
    singles = [SwarmEnv(**{**PAID, "initial_population_size": 12}, price=0.0) for _ in range(3)]
    ours = [
        SwarmEnv(**{**PAID, "initial_population_size": 12}, price=3.0, max_evaluations=444) for _ in range(3)
    ]
    found = [[], [], []]
    while min(map(len, found)) < 3:
        _, _, dones, infos = env.step(np.tile([12.0, 0.0], (3, 1)))
        for row in np.flatnonzero(dones):
            found[row].append(infos[row]["episode"]["r"])
            assert infos[row]["episode"]["l"] < 9
    for row in range(3):
        for episode in range(3):
            seed = 40 + row if episode == 0 else None
            theirs = run_to_end(
                make_controller("spsfa-tip", LIMITS), singles[row], singles[row].reset(seed=seed)[0]
            )
            own = run_to_end(make_controller("fixed:12", LIMITS), ours[row], ours[row].reset(seed=seed)[0])
            assert found[row][episode] == pytest.approx(own - theirs, abs=1e-12)


@pytest.mark.usefixtures("plain_pictures")
def test_validation_is_paired_too(tmp_path):
    run = train(tmp_path, reward="paired", warm_start="none", total_steps=STEPS)
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
