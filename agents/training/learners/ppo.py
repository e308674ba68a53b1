"""Proximal policy optimization, by stable-baselines3.

Source: J. Schulman et al., "Proximal policy optimization algorithms", arXiv 1707.06347 (2017). One rollout is
one episode of every swarm.
"""

from typing import Any, ClassVar

import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from stable_baselines3 import PPO
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.utils import set_random_seed

from agents.runs.seeds import TRAINING_START
from agents.training.config import TrainConfig
from agents.training.imitation import Demonstration, demonstrate, imitate
from agents.training.learners.environments import feature_names, make_reference, make_swarms
from agents.training.learners.learner import Learner
from agents.training.sb3_vec_env import SB3VecEnv
from swarm_gym.action import includes
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import require_fitting
from swarm_gym.controllers.learned.policy_file import Weights


class PPOLearner(Learner):
    """PPO with separate hidden layers for actor and critic."""

    algorithm: ClassVar[type] = PPO
    policy: ClassVar[str | type] = "MlpPolicy"

    def __init__(self, config: TrainConfig):
        self.config = config
        self._teacher = None
        if config.warm_start != "none":
            self._teacher = make_controller(config.warm_start, config.limits)
        # One thread for the whole process, environments included: torch's threads spin between its parallel
        # regions, and networks of this size do not get faster with more of them.
        torch.set_num_threads(1)
        set_random_seed(config.seed)
        env, base = make_swarms(config, config.num_swarms, AutoresetMode.SAME_STEP)
        if self._teacher is not None:
            if not includes(config.action, self._teacher.action):
                raise ValueError(
                    f"warm_start {config.warm_start!r}: a controller with actions {self._teacher.action!r} "
                    f"cannot be imitated in the layout {config.action!r}"
                )
            try:
                require_fitting(self._teacher, config.max_evaluations or None)
            except ValueError as error:
                raise ValueError(f"warm_start {config.warm_start!r}: {error}") from error
        self.env = SB3VecEnv(env, base, make_reference(config, config.num_swarms))
        self.features = feature_names(config, base)
        self.num_decisions = int(np.prod(env.single_action_space.shape or ()))
        self.model = self._make_model(self.env.get_attr("settings")[0].iterations)
        self.model.set_logger(Logger(folder=None, output_formats=[]))

    @property
    def num_steps(self) -> int:  # type: ignore[override]
        """Environment steps so far."""
        return self.model.num_timesteps

    def begin(self) -> None:
        """Imitate the teacher, if any; with a base, at least the critic learns the returns of the base."""
        if self._teacher is not None or self.env.base is not None:
            noise = float(np.exp(self.model.policy.log_std.detach().numpy().mean()))
            seed = TRAINING_START + self.config.seed
            shown = demonstrate(self._teacher, self.env, noise, self.config.discount, seed)
            imitate(self.model.policy, self._lessons(shown), self._predict, seed)

    def learn(self, seed: int) -> dict[str, float]:
        """Run `rollouts_per_chunk` rollouts with an update after each; return scalars of the updates."""
        config = self.config
        set_random_seed(seed)
        self.env.seed(seed)
        # New episodes and averages, so that any chunk can be the first of a resumed run.
        self.model._last_obs = None
        self.model.ep_info_buffer = None
        steps = self.model.n_steps * config.num_swarms * config.rollouts_per_chunk
        self.model.learn(steps, reset_num_timesteps=False, log_interval=10**9)
        found = {name: float(value) for name, value in self.model.logger.name_to_value.items()}
        ended: Any = self.model.ep_info_buffer
        found["rollout/ep_rew_mean"] = float(np.mean([episode["r"] for episode in ended]))
        return found

    def weights(self) -> Weights:
        """Return the layers that compute the mean action."""
        policy = self.model.policy
        layers = [m for m in policy.mlp_extractor.policy_net if isinstance(m, torch.nn.Linear)]
        weights = {}
        for number, layer in enumerate([*layers, policy.action_net]):
            weights[f"{number}.weight"] = layer.weight.detach().numpy().copy()
            weights[f"{number}.bias"] = layer.bias.detach().numpy().copy()
        return weights

    def state(self) -> dict[str, Any]:
        """Return networks, optimizer and counters."""
        return {
            "policy": self.model.policy.state_dict(),
            "optimizer": self.model.policy.optimizer.state_dict(),
            "num_timesteps": self.model.num_timesteps,
            "updates": self.model._n_updates,
        }

    def load(self, state: dict[str, Any]) -> None:
        """Continue from a state."""
        self.model.policy.load_state_dict(state["policy"])
        self.model.policy.optimizer.load_state_dict(state["optimizer"])
        self.model.num_timesteps = state["num_timesteps"]
        self.model._n_updates = state["updates"]

    def _lessons(self, shown: Demonstration) -> Demonstration:
        """Return the sequences of an imitation: single steps."""
        return shown.one_by_one()

    def _predict(self, seen: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Return mean actions (N, k) and values (N,) of observations (sequences, length, features)."""
        flat = seen.flatten(0, 1)
        policy = self.model.policy
        return policy.get_distribution(flat).mode(), policy.predict_values(flat).flatten()

    def _policy_options(self) -> dict[str, Any]:
        return {"net_arch": list(self.config.hidden_layers), "log_std_init": self.config.log_std}

    def _make_model(self, iterations: int) -> Any:
        config = self.config
        return self.algorithm(
            self.policy,
            self.env,
            learning_rate=config.learning_rate,
            n_steps=iterations,
            batch_size=config.batch_size,
            n_epochs=config.epochs,
            gamma=config.discount,
            gae_lambda=config.gae_lambda,
            clip_range=config.clip_range,
            ent_coef=config.entropy_weight,
            target_kl=config.target_kl,
            policy_kwargs=self._policy_options(),
            seed=config.seed,
            device="cpu",
        )
