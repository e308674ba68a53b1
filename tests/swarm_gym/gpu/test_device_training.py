"""A training whose swarms live on a GPU is that whose swarms live on the CPU."""

import dataclasses

import numpy as np
import pytest

from helpers.devices import ROUNDING


@pytest.mark.slow
def test_a_training_on_the_device_learns_what_one_on_the_cpu_learns():
    from agents.training.config import TrainConfig
    from agents.training.learners import make_learner

    config = TrainConfig(
        algorithm="device-ppo", warm_start="none", scenarios=("function:rastrigin-10",),
        initial_population_size=2, min_population_size=2, max_population_size=3, num_swarms=4,
        group_size=2, branches=(2,), gae_lambda=1.0, critic=False, noise_steps=0, hidden_layers=(8,),
        batch_size=100, rollouts_per_chunk=1,
    )  # fmt: skip
    learned = []
    for device in ("cpu", "cuda"):
        learner = make_learner(dataclasses.replace(config, device=device))
        learner.begin()
        before = {name: array.copy() for name, array in learner.weights().items()}
        scalars = learner.learn(0)
        assert any((before[name] != array).any() for name, array in learner.weights().items())
        learned.append((scalars["rollout/ep_rew_mean"], learner.weights()))
    (ours, weights), (theirs, its_weights) = learned
    assert theirs == pytest.approx(ours, rel=1e-6)
    for name, array in weights.items():
        np.testing.assert_allclose(its_weights[name], array, rtol=ROUNDING["rtol"] and 1e-3)
