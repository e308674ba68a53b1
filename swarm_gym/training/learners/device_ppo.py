"""Proximal policy optimization whose rollouts, advantages and updates stay on one device.

Policies, initial weights and the meaning of options are as in `PPOLearner`. The differences: a rollout
always is one new episode of all swarms, which begins after the update before it; and torch draws minibatches.
"""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.utils import set_random_seed

from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.runs.seeds import TRAINING_START
from swarm_gym.training.algorithms import DevicePPO
from swarm_gym.training.config import ENV_REWARD, PAIRED, TrainConfig
from swarm_gym.training.imitation import ROLLOUTS, Demonstration, imitate
from swarm_gym.training.learners.checks import has_groups
from swarm_gym.training.learners.clipped_update import Steps, update
from swarm_gym.training.learners.device_base import TensorBase
from swarm_gym.training.learners.device_rollout import DeviceSwarms, Rollout, run_episode
from swarm_gym.training.learners.environments import feature_names, make_swarms
from swarm_gym.training.learners.group_advantages import advantages_and_returns
from swarm_gym.training.learners.learner import Learner
from swarm_gym.training.learners.ppo import actor_layers, policy_options, step_size
from swarm_gym.training.learners.stopped_chunk import State


class DevicePPOLearner(Learner):
    """PPO on tensors of the device that the option `device` names.

    Raises:
        ValueError: for an option that this algorithm does not have, or a device that cannot be used.
    """

    def __init__(self, config: TrainConfig, options: DevicePPO):
        super().__init__()
        self.config, self.options = config, options
        _refuse(config)
        self._device = usable_device(options.device)
        # One thread, as in `PPOLearner`.
        torch.set_num_threads(1)
        set_random_seed(config.seed)
        env, self._base = make_swarms(config, config.num_swarms, AutoresetMode.DISABLED)
        firsts = options.branches or ((config.corrected_from,) if has_groups(config) else (0,))
        base = None if self._base is None else TensorBase(self._base, self._device)
        self.swarms = DeviceSwarms(env, base, options.group_size, firsts, self._device)
        self.features = feature_names(config, self._base)
        self.num_decisions = int(np.prod(env.single_action_space.shape or ()))
        self.num_steps = 0
        self._passes = 0  # over rollouts, in all updates so far
        self._stopped: State | None = None  # where the present chunk can go on from
        self._mean_layers: dict[str, torch.Tensor] = {}
        observed: Any = env.single_observation_space
        space = observed if self._base is None else self._base.observation_space(observed)
        acted: Any = env.single_action_space
        set_random_seed(config.seed)
        self.policy = ActorCriticPolicy(
            space,
            acted,
            lambda _: options.learning_rate,
            use_sde=options.noise_steps != 1,
            **policy_options(config, options),
        ).to(self._device)

    @property
    def in_chunk(self) -> bool:
        """True if some rollouts of the chunk are done."""
        return self._stopped is not None

    def begin(self) -> None:
        """With a base, begin with corrections of zero; a critic then learns the returns of the base."""
        if self._base is None:
            return
        with torch.no_grad():
            for parameter in self.policy.action_net.parameters():
                parameter.zero_()
        if self.options.critic:
            seed = TRAINING_START + self.config.seed
            set_random_seed(seed)
            generator = np.random.default_rng(seed)
            shown = [self._as_lesson(self._roll(generator)) for _ in range(ROLLOUTS)]
            columns = [np.concatenate(parts) for parts in zip(*shown, strict=True)]
            imitate(self.policy, Demonstration(*columns), self._predict, seed)

    def learn(self, seed: int) -> dict[str, float]:
        """Run `rollouts_per_chunk` rollouts with an update after each; return scalars of the updates."""
        config, options = self.config, self.options
        set_random_seed(seed)
        generator = np.random.default_rng(seed)
        scalars: dict[str, float] = {}
        earned: list[torch.Tensor] = []
        if self._stopped is not None:
            scalars, earned = self._go_on(self._stopped, generator)
        rate = step_size(options, self.num_steps) if earned else options.learning_rate
        for _ in range(len(earned), config.rollouts_per_chunk):
            rollout = self._roll(generator)
            self.num_steps += rollout.num_steps
            earned.append(rollout.returns.mean())
            rate = step_size(options, self.num_steps)
            for group in self.policy.optimizer.param_groups:
                group["lr"] = rate
            scalars = update(self.policy, self._steps(rollout), options)
            self._passes += int(scalars["train/epochs"])
            self._average_weights()
            self._stopped = self._stopped_state(scalars, earned, generator)
            self.after_rollout()
        self._stopped = None
        return {
            **scalars,
            "train/learning_rate": rate,
            "train/n_updates": float(self._passes),
            "rollout/ep_rew_mean": torch.stack(earned).mean().item(),
        }

    def weights(self) -> Weights:
        """Return the layers that compute the mean action, or their running mean where there is one."""
        layers = self._mean_layers or actor_layers(self.policy)
        return {name: tensor.cpu().numpy() for name, tensor in layers.items()}

    def state(self) -> dict[str, object]:
        """Return networks, optimizer and counters, with all tensors on the CPU."""
        return {
            "mean_layers": _on_cpu(self._mean_layers),
            "policy": _on_cpu(self.policy.state_dict()),
            "optimizer": _on_cpu(self.policy.optimizer.state_dict()),
            "num_steps": self.num_steps,
            "passes": self._passes,
            **({} if self._stopped is None else {"stopped": self._stopped}),
        }

    def load(self, state: Mapping[str, object]) -> None:
        """Continue from a state."""
        stored: Any = state
        self._mean_layers = {name: tensor.to(self._device) for name, tensor in stored["mean_layers"].items()}
        self.policy.load_state_dict(stored["policy"])
        self.policy.optimizer.load_state_dict(stored["optimizer"])
        self.num_steps = stored["num_steps"]
        self._passes = stored["passes"]
        self._stopped = stored.get("stopped")

    def _stopped_state(
        self, scalars: dict[str, float], earned: list[torch.Tensor], generator: np.random.Generator
    ) -> State:
        """Return what the rest of the chunk needs besides the networks: random generators and results."""
        on_gpu = self._device.type == "cuda" and torch.cuda.is_available()
        return {
            "scalars": dict(scalars),
            "earned": [one.cpu() for one in earned],
            "episodes": json.dumps(generator.bit_generator.state),
            "torch": torch.get_rng_state(),
            "torch_on_gpu": torch.cuda.get_rng_state(self._device) if on_gpu else None,
        }

    def _go_on(
        self, state: State, generator: np.random.Generator
    ) -> tuple[dict[str, float], list[torch.Tensor]]:
        """Bring the random generators to where a chunk was stopped; return its scalars and returns so far."""
        stored: Any = state
        generator.bit_generator.state = json.loads(stored["episodes"])
        torch.set_rng_state(stored["torch"])
        if stored["torch_on_gpu"] is not None:
            torch.cuda.set_rng_state(stored["torch_on_gpu"], self._device)
        return dict(stored["scalars"]), [one.to(self._device) for one in stored["earned"]]

    def _roll(self, generator: np.random.Generator) -> Rollout:
        options = self.options
        return run_episode(
            self.policy, self.swarms, generator, critic=options.critic, noise_steps=options.noise_steps
        )

    def _steps(self, rollout: Rollout) -> Steps:
        """Return the steps of a rollout with their advantages and returns."""
        options = self.options
        advantages, returns = advantages_and_returns(
            rollout.rewards,
            rollout.values,
            discount=options.discount,
            gae_lambda=options.gae_lambda,
            group_size=options.group_size,
            noise_steps=options.noise_steps,
        )
        columns = rollout.observations, rollout.actions, rollout.log_probs, advantages, returns
        return Steps(*(column.flatten(0, 1) for column in columns))

    def _as_lesson(self, rollout: Rollout) -> Demonstration:
        """Return the steps of a rollout as sequences of one step, with actions of zero, on the host."""
        _, returns = advantages_and_returns(
            rollout.rewards, None, discount=self.options.discount, gae_lambda=1.0, group_size=1, noise_steps=1
        )
        there = torch.ones_like(returns)
        columns = rollout.observations, torch.zeros_like(rollout.actions), returns, there
        return Demonstration(*(column.flatten(0, 1)[:, None].cpu().numpy() for column in columns))

    def _predict(self, seen: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Return mean actions (N, k) and values (N,) of observations (N, 1, features)."""
        flat = seen.flatten(0, 1)
        return self.policy.get_distribution(flat).mode(), self.policy.predict_values(flat).flatten()

    def _average_weights(self) -> None:
        """Move the running mean of the weights towards the last ones."""
        if share := self.options.averaging:
            last = actor_layers(self.policy)
            mean = self._mean_layers or last
            self._mean_layers = {name: share * mean[name] + (1.0 - share) * last[name] for name in last}


def usable_device(name: str) -> torch.device:
    """Return the device of a name; with the simulator of numba-cuda, "cuda" is the memory of the host.

    Raises:
        ValueError: if torch or the kernels of the swarms cannot compute there, with the reason.
    """
    if name == "cpu":
        return torch.device("cpu")
    try:
        from swarm_gym.gpu.state import torch_device
    except ImportError as error:
        raise ValueError(f"device {name!r}: {error}") from error
    return torch_device()


def _refuse(config: TrainConfig) -> None:
    """Raise an error for options that this algorithm does not have.

    Raises:
        ValueError: naming the option and its value.
    """
    if config.reward == PAIRED:
        raise ValueError(f"device-ppo has no reward {PAIRED!r}; choose {ENV_REWARD!r}, or algorithm 'ppo'")
    if config.max_evaluations:
        raise ValueError(
            f"device-ppo needs episodes of one length: max_evaluations must be 0, got "
            f"{config.max_evaluations}; algorithm 'ppo' has budgets"
        )


def _on_cpu(state: Any) -> Any:
    """Return a state whose tensors, in nested dictionaries and lists, are on the CPU."""
    if isinstance(state, torch.Tensor):
        return state.detach().cpu()
    if isinstance(state, dict):
        return {name: _on_cpu(value) for name, value in state.items()}
    return [_on_cpu(value) for value in state] if isinstance(state, list) else state
