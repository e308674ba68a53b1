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

# Rewards add up to what an episode has found, so nothing is discounted.
ON_POLICY: dict[str, Any] = {"n_steps": 100, "gamma": 1.0}
# Old experience tells little of rewards that lie far ahead: returns of ten steps, and a discount.
OFF_POLICY: dict[str, Any] = {
    "gamma": 0.99, "n_steps": 10, "learning_starts": 3200, "gradient_steps": 2, "learning_rate": 1e-3,
    "policy_kwargs": {"net_arch": [64, 64]},
}  # fmt: skip


@dataclass(frozen=True)
class Recipe:
    """A learner and what it learns in.

    Attributes:
        algorithm: a key of `ALGORITHMS`.
        options: options of the algorithm that differ from the library's.
        env: options of `make_vec` that differ from its own.
        kind: how it learns: "from scratch", `DEFAULTS`, "with sources", or "residual", perhaps with its base.
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
# An LSTM is trained step by step, so few batches are fast.
WHOLE_ROLLOUTS: dict[str, Any] = {
    **ON_POLICY, "batch_size": NUM_SWARMS * ON_POLICY["n_steps"], "policy_kwargs": {"lstm_hidden_size": 64},
}  # fmt: skip
# The library's noise, exp(0), undoes what a base or the first policy does well.
SMALL_NOISE: dict[str, Any] = {"policy_kwargs": {"log_std_init": -2.0}}
LEAST_NOISE: dict[str, Any] = {"policy_kwargs": {"log_std_init": -3.0}}
# With a discount, evaluations that lie ahead weigh less than they cost.
DEARER = {"price": 0.25}
DEFAULTS = "from scratch, by defaults"  # of the library and of `make_vec`
AT_THE_END = {"reward": "optimality", "price": 1.0}
RULES = {"base": "spsfa-tip"}
# Where that base ends, one per cent of the optimum is about 0.15 of log(gap); near the optimum about 0.2.
TUNED = {"base": "open-loop:three-cases", "price": 0.15}
SOURCED = {"action": "sourced-centred", "price": 0.2}
TUNED_SOURCES = {"base": "open-loop:three-cases-sourced/0@1", "price": 0.2}

RECIPES: dict[str, Recipe] = {
    "ppo": Recipe("PPO", ON_POLICY),
    **{f"{name.lower()}-defaults": Recipe(name, kind=DEFAULTS) for name in ("PPO", "SAC", "TD3")},
    "dqn-defaults": Recipe("DQN", env={"choices": (7, 5)}, kind=DEFAULTS),
    "ppo-optimality": Recipe("PPO", ON_POLICY, AT_THE_END),
    "ppo-residual": Recipe("PPO", {**CALM, **SMALL_NOISE}, TUNED, "residual"),
    "ppo-residual-rules": Recipe("PPO", {**CALM, **SMALL_NOISE}, RULES, "residual on SPSFA-TIP"),
    "ppo-sourced": Recipe("PPO", {**CALM, **SMALL_NOISE}, SOURCED, "with sources"),
    "ppo-residual-sourced": Recipe("PPO", {**CALM, **LEAST_NOISE}, TUNED_SOURCES, "residual with sources"),
    "recurrent-ppo": Recipe("RecurrentPPO", WHOLE_ROLLOUTS),
    "sac": Recipe("SAC", OFF_POLICY, DEARER, scales_rewards=True),
    "td3": Recipe("TD3", OFF_POLICY, DEARER, scales_rewards=True),
    "tqc": Recipe("TQC", OFF_POLICY, DEARER, scales_rewards=True),
    "dqn": Recipe("DQN", OFF_POLICY, {"choices": (7, 5), **DEARER}, scales_rewards=True),
}
