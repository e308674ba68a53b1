"""Recipes of plain learners: an algorithm, its options, and the environment that it learns in.

To add a learner, enter a recipe in `RECIPES`. Options that a recipe does not name are those of the library.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sb3_contrib
import stable_baselines3
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from experiments.studies.controllers import CASES
from swarm_gym.sb3 import make_vec

NUM_SWARMS = 16
CONTINUOUS: dict[str, type[BaseAlgorithm]] = {
    "PPO": stable_baselines3.PPO,
    "RecurrentPPO": sb3_contrib.RecurrentPPO,
    "SAC": stable_baselines3.SAC,
    "TD3": stable_baselines3.TD3,
    "TQC": sb3_contrib.TQC,
}
ALGORITHMS: dict[str, type[BaseAlgorithm]] = {**CONTINUOUS, "DQN": stable_baselines3.DQN}

# An episode is paid at its end, so nothing is discounted.
ON_POLICY: dict[str, Any] = {"n_steps": 100, "gamma": 1.0}
# Returns of whole episodes: with those of one step, the reward of the end does not reach the first decisions.
OFF_POLICY: dict[str, Any] = {
    "gamma": 1.0, "n_steps": 100, "learning_starts": 6400, "gradient_steps": 2,
    "policy_kwargs": {"net_arch": [64, 64]},
}  # fmt: skip


@dataclass(frozen=True)
class Recipe:
    """A learner and what it learns in.

    Attributes:
        algorithm: a key of `ALGORITHMS`.
        options: options of the algorithm that differ from the library's.
        env: options of `make_vec` that differ from its own.
        kind: how it learns: "from scratch", "with sources", or "residual", perhaps with its base.
        scales_rewards: whether `VecNormalize` of the library scales rewards in the training.
    """

    algorithm: str
    options: Mapping[str, Any] = field(default_factory=dict)
    env: Mapping[str, Any] = field(default_factory=dict)
    kind: str = "from scratch"
    scales_rewards: bool = False

    def swarms(self, number: int, seed: int, scenario: object = CASES) -> VecEnv:
        """Return swarms to learn in, or to evaluate on, whose seeds count up from this one."""
        return make_vec("firefly", number, seed=seed, num_threads=1, scenario=scenario, **self.env)

    def model(self, swarms: VecEnv, seed: int) -> BaseAlgorithm:
        """Return the learner before its first step."""
        if self.scales_rewards:
            swarms = VecNormalize(swarms, norm_obs=False, gamma=1.0)
        policy = "MlpLstmPolicy" if self.algorithm == "RecurrentPPO" else "MlpPolicy"
        options = dict(self.options)
        if self.algorithm == "TD3" and swarms.action_space.shape:
            # Without noise it explores nothing; the library's documentation has this kind of noise.
            numbers = swarms.action_space.shape[0]
            options["action_noise"] = NormalActionNoise(np.zeros(numbers), np.full(numbers, NOISE_OF_TD3))
        return ALGORITHMS[self.algorithm](policy, swarms, seed=seed, device="cpu", **options)


NOISE_OF_TD3 = 0.2
# Where the first policy is good already, few and large batches change it less by chance.
CALM: dict[str, Any] = {**ON_POLICY, "batch_size": 400, "n_epochs": 5}
# Corrections with the library's noise, exp(0), undo what the base has found.
SMALL_NOISE: dict[str, Any] = {"policy_kwargs": {"log_std_init": -2.0}}
# Gaps are small there, so that a logarithm tells more than the gap itself.
SOURCED = {"action": "sourced-centred", "reward": "final", "price": 0.1}
WITH_SOURCES: dict[str, Any] = {**CALM, "gae_lambda": 1.0, "policy_kwargs": {"log_std_init": -1.0}}
RESIDUAL = {"base": "open-loop:three-cases"}

RECIPES: dict[str, Recipe] = {
    "ppo": Recipe("PPO", ON_POLICY),
    "ppo-library": Recipe("PPO", {"gamma": 1.0}),
    "ppo-residual": Recipe("PPO", {**CALM, **SMALL_NOISE}, RESIDUAL, "residual"),
    "ppo-residual-rules": Recipe(
        "PPO", {**CALM, **SMALL_NOISE}, {"base": "spsfa-tip"}, "residual on SPSFA-TIP"
    ),
    "ppo-residual-library": Recipe("PPO", ON_POLICY, RESIDUAL, "residual"),
    "ppo-sourced": Recipe("PPO", WITH_SOURCES, SOURCED, "with sources"),
    "ppo-sourced-optimality": Recipe("PPO", WITH_SOURCES, {"action": SOURCED["action"]}, "with sources"),
    "ppo-sourced-normalised": Recipe(
        "PPO", ON_POLICY, {"action": "sourced-normalised", "reward": "final", "price": 0.3}, "with sources"
    ),
    "ppo-residual-sourced": Recipe(
        "PPO", {**CALM, **SMALL_NOISE}, {"base": "open-loop:three-cases-sourced/0@1"}, "residual with sources"
    ),
    "recurrent-ppo": Recipe("RecurrentPPO", ON_POLICY),
    "sac": Recipe("SAC", OFF_POLICY, scales_rewards=True),
    "sac-library": Recipe("SAC", {"gamma": 1.0}),
    "sac-residual": Recipe("SAC", OFF_POLICY, RESIDUAL, "residual", True),
    "sac-sourced": Recipe("SAC", OFF_POLICY, SOURCED, "with sources", True),
    "td3": Recipe("TD3", OFF_POLICY, scales_rewards=True),
    "tqc": Recipe("TQC", OFF_POLICY, scales_rewards=True),
    "dqn": Recipe("DQN", {**OFF_POLICY, "learning_rate": 1e-3}, {"choices": (7, 5)}, scales_rewards=True),
    "ppo-normalised": Recipe("PPO", ON_POLICY, {"action": "normalised"}),
}
