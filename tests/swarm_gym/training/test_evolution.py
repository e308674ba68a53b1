"""Evolution of policies: it learns, and candidates earn what their policies earn."""

import numpy as np
import pytest

from helpers import trainings
from helpers.slow import slow_but
from helpers.trainings import tiny_config, train
from swarm_gym.controllers.learned.policy_file import load_policy
from swarm_gym.controllers.registry import load_learned
from swarm_gym.rollout import run_episodes
from swarm_gym.training.learners import make_learner

pytestmark = pytest.mark.usefixtures("plain_pictures")

EVOLUTION = {**trainings.EVOLUTION, "num_swarms": 8}


def test_evolution_learns_to_save_evaluations_that_cost_much(tmp_path):
    options = {"price": (500.0,), "hidden_layers": (), "candidates": 8, "sigma": 0.5, "rollouts_per_chunk": 4}
    run = train(tmp_path, **{**EVOLUTION, **options}, total_steps=3 * 4 * 8 * 100)
    first = run.learner.weights()
    assert not any(array.any() for array in first.values())
    best = run.run()
    after = load_policy(best)[1]["validation"]["case3"]
    middle = run_episodes(_policy(run, tmp_path, first), "case3", range(4), **run.config.env_options())
    assert after["evaluations"] < 0.7 * middle.evaluations.mean()
    assert after["return"] > middle.returns.mean() + 0.5


def _policy(run, folder, weights):
    run.learner.weights = lambda: weights
    run._save_policy(folder / "one.safetensors", {})
    return load_learned(folder / "one.safetensors", run.config.limits)


@pytest.mark.parametrize(("base", "begin"), [("none", 0), ("spsfa-tip", 0), ("spsfa-tip", 40)])
@pytest.mark.parametrize("width", slow_but([8], [8, 64]))
def test_candidates_earn_what_their_policies_earn(tmp_path, base, begin, width):
    options = {"base": base, "corrected_from": begin, "hidden_layers": (width,), "observation": "rich"}
    run = train(tmp_path, **EVOLUTION, **options)
    learner = run.learner
    candidates = np.random.default_rng(0).normal(size=(4, len(learner._strategy.mean))) * 0.3
    earned = learner._earn(candidates, 1_000_000)
    for candidate, mean in zip(candidates, earned, strict=True):
        learner._strategy._mean = candidate
        policy = _policy(run, tmp_path, type(learner).weights(learner))
        episodes = run_episodes(policy, "case3", range(1_000_000, 1_000_002), **run.config.env_options())
        assert mean == episodes.returns.mean()
    assert len(set(earned)) == 4
    # What the base alone decides is simulated once for all candidates.
    assert learner.num_steps == 8 * (100 - begin) + 2 * begin


def test_a_policy_with_a_base_begins_as_the_base(tmp_path):
    learner = make_learner(tiny_config(tmp_path, **EVOLUTION, base="spsfa"))
    weights = learner.weights()
    assert weights["0.weight"].any()
    assert not weights["1.weight"].any()
    assert not weights["1.bias"].any()
