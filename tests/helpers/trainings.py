"""Trainings that take a second, and policies that were never trained."""

import numpy as np
import torch
from gymnasium.spaces import Box

from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.distilled import DistilledRule, Formula, save_rule
from swarm_gym.controllers.learned.policy_file import load_policy, save_policy
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.learners.group_advantages import GroupBuffer
from swarm_gym.training.run import TrainingRun

TINY = {
    "num_swarms": 4, "scenarios": ("case3",), "initial_population_size": 4, "max_population_size": 12,
    "batch_size": 100, "epochs": 2, "rollouts_per_chunk": 1, "validation_seeds": 2, "hidden_layers": (8,),
}  # fmt: skip
STEPS = 4 * 100  # one rollout of one episode per swarm
# Evolution costs next to nothing: four candidates.
EVOLUTION = {"algorithm": "evolution", "warm_start": "none", "candidates": 4}
# DQN begins to learn after one rollout, and forgets what is older than two.
DQN = {
    "algorithm": "dqn", "warm_start": "none", "replay_size": 2 * STEPS, "gradient_steps": 1,
    "return_steps": 3, "target_steps": 120, "exploration_steps": 2 * STEPS,
    "size_choices": (-0.5, 0.0, 0.5),
}  # fmt: skip


def tiny_config(folder, **options):
    return TrainConfig(runs=folder).changed(**{**TINY, "name": "ppo", "total_steps": 3 * STEPS, **options})


def train(folder, **options):
    return TrainingRun(tiny_config(folder, **options))


def assert_same_weights(one, other):
    """Two policy files hold the same numbers."""
    ours, theirs = (load_policy(path)[0] for path in (one, other))
    assert ours.keys() == theirs.keys()
    assert all((ours[key] == theirs[key]).all() for key in ours)


def run_whole_and_stopped(folder, stop, total, **options):
    """Return a training and one that was stopped and resumed, which have stored the same policies."""
    whole = train(folder, name="whole", total_steps=total, **options)
    whole.run()
    train(folder, name="stopped", total_steps=stop, **options).run()
    resumed = train(folder, name="stopped", total_steps=total, resume=True, **options)
    resumed.run()
    assert resumed.learner.num_steps == whole.learner.num_steps >= total
    for name in ("latest", "best"):
        assert_same_weights(*(folder / run / f"{name}.safetensors" for run in ("whole", "stopped")))
    return whole, resumed


def untrained_manifest(observation, **changes):
    """Return the manifest of a policy file."""
    return {
        "action": "normalised", "base": "none", "config": {}, "corrected_from": 0, "hidden_layers": [8],
        "initial_population_size": 80, "max_population_size": 200, "min_population_size": 2,
        "lstm_size": None, "max_evaluations": None, "network": "feedforward", "num_decisions": 2,
        "observation": observation, "optimizer": "firefly", "price": None, **changes,
    }  # fmt: skip


def make_policy(path, rng, observation="extended", extra_features=0, **changes):
    """Write a policy file with random weights and return its path."""
    features = [feature.name for feature in OBSERVATIONS[observation].features]
    sizes = [len(features) + extra_features, 8, 2]
    weights = {}
    for number, (out, into) in enumerate(zip(sizes[1:], sizes, strict=False)):
        weights[f"{number}.weight"] = rng.normal(size=(out, into)).astype(np.float32)
        weights[f"{number}.bias"] = rng.normal(size=out).astype(np.float32)
    manifest = untrained_manifest(observation, **{"features": features, **changes})
    save_policy(path, weights, manifest)
    return path


def make_correction(path, rng, base, **changes):
    """Write a policy file with random weights that corrects the decisions of a base."""
    features = [feature.name for feature in OBSERVATIONS["extended"].features]
    features += ["proposed population size", "proposed repair degree"]
    return make_policy(path, rng, extra_features=2, features=features, base=base, **changes)


def add_memory(path, rng, size):
    """Add an LSTM of that size with random weights to the policy of a file."""
    weights, manifest = load_policy(path)
    weights["0.weight"] = rng.normal(size=(8, size)).astype(np.float32)
    weights["lstm.weight"] = rng.normal(size=(4 * size, len(manifest["features"]) + size)).astype(np.float32)
    weights["lstm.bias"] = rng.normal(size=4 * size).astype(np.float32)
    save_policy(path, weights, {**manifest, "network": "lstm", "lstm_size": size})
    return path


def add_choices(path, rng, number):
    """Make the policy of a file choose from that many random actions."""
    weights, manifest = load_policy(path)
    last = len(manifest["hidden_layers"])
    weights[f"{last}.weight"] = rng.normal(size=(number, 8)).astype(np.float32)
    weights[f"{last}.bias"] = rng.normal(size=number).astype(np.float32)
    weights["choices"] = rng.uniform(-1.5, 1.5, (number, manifest["num_decisions"])).astype(np.float32)
    save_policy(path, weights, {**manifest, "network": "choices", "num_choices": number})
    return path


def change_policy(path, weights=None, **changes):
    """Replace some weights and entries of the manifest of a policy file."""
    stored, manifest = load_policy(path)
    save_policy(path, {**stored, **(weights or {})}, {**manifest, **changes})


def make_rule(path, max_evaluations):
    """Write a distilled rule in natural units, perhaps with an evaluation budget, and return its name."""
    formulas = Formula("population size", 1.5, {}), Formula("repair degree", 0.1, {})
    limits = SizeLimits(2, 12)
    save_rule(path, DistilledRule(4, formulas, "firefly", max_evaluations, limits), limits, {})
    return f"distilled:{path}"


def random_observations(layout, rng, count):
    """Draw plausible observations of a layout."""
    if "+" in layout:
        parts = [random_observations(part, rng, count) for part in layout.split("+")]
        return np.concatenate(parts, axis=1)
    width = len(OBSERVATIONS[layout].features)
    is_unscaled = layout in ("paper", "restarts")
    observations = rng.random((count, width)) * (100.0 if is_unscaled else 1.0)
    observations[:, 3] = rng.integers(1, 100, count) if is_unscaled else rng.random(count)
    return observations.astype(OBSERVATIONS[layout].dtype)


def assert_decides_alike_at_any_width(make, rng, seed):
    """Check that decisions do not depend on how many swarms are decided for."""
    wide = make()
    observations = [random_observations(wide.observation, rng, 64) for _ in range(4)]
    observations[0][:, 3] = 0
    wide.reset(64, seed=seed)
    together = [wide.act(step) for step in observations]
    for rows in ([0], [63], [5, 6], [17, 18, 19]):
        narrow = make()
        narrow.reset(len(rows), seed=seed + rows[0])
        for step, decided in zip(observations, together, strict=True):
            np.testing.assert_array_equal(narrow.act(step[rows]), decided[rows])


def filled_buffer(rewards, values, **options):
    """A buffer of an episode with these rewards and values, (steps, swarms), its advantages and returns."""
    steps, swarms = rewards.shape
    buffer = GroupBuffer(steps, Box(-1, 1, (1,)), Box(-1, 1, (1,)), n_envs=swarms, **options)
    for step in range(steps):
        buffer.add(
            np.zeros((swarms, 1)), np.zeros((swarms, 1)), rewards[step], np.full(swarms, step == 0),
            torch.as_tensor(values[step]), torch.zeros(swarms),
        )  # fmt: skip
    buffer.compute_returns_and_advantage(torch.full((swarms,), 9.0), np.ones(swarms, dtype=bool))
    return buffer
