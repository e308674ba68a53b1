"""A training whose swarms live on a GPU is that whose swarms live on the CPU."""

import numba
import numpy as np
import pytest


@pytest.mark.slow
def test_a_training_on_the_device_learns_what_one_on_the_cpu_learns():
    from swarm_gym.training.config import TrainConfig
    from swarm_gym.training.learners import make_learner

    config = TrainConfig().changed(
        algorithm="device-ppo", warm_start="none", scenarios=("function:rastrigin-10",),
        initial_population_size=3, min_population_size=2, max_population_size=6, num_swarms=4, log_std=0.0,
        group_size=2, branches=(2,), gae_lambda=1.0, critic=False, noise_steps=0, hidden_layers=(8,),
        batch_size=100, rollouts_per_chunk=1,
    )  # fmt: skip
    learned = []
    for device in ("cpu", "cuda"):
        learner = make_learner(config.changed(device=device))
        learner.begin()
        before = {name: array.copy() for name, array in learner.weights().items()}
        scalars = learner.learn(0)
        assert all(np.isfinite(array).all() for array in learner.weights().values())
        assert any((before[name] != array).any() for name, array in learner.weights().items())
        learned.append((scalars["rollout/ep_rew_mean"], learner.weights()))
    if not numba.config.ENABLE_CUDASIM:
        return  # the noise comes from the generator of the GPU there, so that these are two trainings
    (ours, weights), (theirs, its_weights) = learned
    assert theirs == pytest.approx(ours, rel=1e-6)
    for name, array in weights.items():
        np.testing.assert_array_equal(its_weights[name], array)
