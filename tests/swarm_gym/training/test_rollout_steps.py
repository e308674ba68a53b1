"""Rollouts of some steps instead of whole episodes, as long episodes on bit strings need them."""

import numpy as np
import pytest
import torch

from helpers.bits import OPTIMIZER
from helpers.trainings import run_whole_and_stopped, tiny_config, train
from swarm_gym.training.learners import make_learner

NUM_SWARMS, STEPS = 4, 25
BITS = {
    "optimizer": OPTIMIZER, "scenarios": ("onemax:20",), "observation": "theory-scaled", "reward": "runtime",
    "price": (0.0,), "warm_start": "none", "iterations": 400, "initial_population_size": 1,
    "min_population_size": 1, "max_population_size": 8, "num_swarms": NUM_SWARMS, "rollout_steps": STEPS,
    "rollouts_per_chunk": 2,
}  # fmt: skip
CHUNK = 2 * NUM_SWARMS * STEPS

pytestmark = pytest.mark.usefixtures("plain_pictures")


@pytest.mark.parametrize(
    "options",
    [
        {"group_size": 2},
        {"branches": (3,)},
        {"noise_steps": 0},
        {"noise_steps": 4},
        {"base": "theory", "corrected_from": 2},
    ],
)
def test_rollout_steps_are_refused_where_whole_episodes_are_needed(tmp_path, options):
    with pytest.raises(ValueError, match=r"rollout_steps 25: .*set rollout_steps to 0"):
        train(tmp_path, **BITS, **options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("steps", [-1, 2.5])
def test_rollout_steps_are_whole_numbers_from_0(tmp_path, steps):
    with pytest.raises(ValueError, match=f"rollout_steps must .*{steps}"):
        train(tmp_path, **{**BITS, "rollout_steps": steps})


def test_a_chunk_has_as_many_steps_as_its_rollouts(tmp_path):
    learner = make_learner(tiny_config(tmp_path, **BITS))
    learner.begin()
    learner.learn(0)
    assert learner.num_steps == CHUNK


def test_a_resumed_run_equals_one_that_was_not_stopped(tmp_path):
    runs = run_whole_and_stopped(tmp_path, CHUNK, 3 * CHUNK, **BITS)
    one, other = (run.learner.model.policy.state_dict() for run in runs)
    assert all(torch.equal(one[name], other[name]) for name in one)


def test_episodes_that_are_longer_than_a_rollout_go_on_in_the_next(tmp_path):
    """Record the numbers of ones at the beginning of each step of a chunk."""
    learner = make_learner(tiny_config(tmp_path, **{**BITS, "scenarios": ("onemax:100",)}))
    learner.begin()
    learner.learn(0)
    simulation = learner.env.env.simulation
    assert simulation.iteration.tolist() == [2 * STEPS] * NUM_SWARMS
    assert np.isfinite(simulation.history[:, : 2 * STEPS + 1, 0]).all()
