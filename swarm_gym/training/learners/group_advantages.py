"""Advantages relative to a group of swarms that began alike, as a rollout buffer of stable-baselines3.

`swarm_gym.wrappers.groups` says why advantages are relative to a group.
"""

from collections.abc import Callable, Generator

import numpy as np
import torch
from gymnasium import Space
from numpy.typing import NDArray
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.type_aliases import RolloutBufferSamples

from swarm_gym.wrappers.groups import relative_to_group

# Arrays of the library's buffer, by step and swarm.
COLUMNS = ("observations", "actions", "values", "log_probs", "advantages", "returns")
SMALLEST_DEVIATION = 1e-8  # of advantages, where all swarms of an optimizer end alike


class GroupBuffer(RolloutBuffer):
    """A rollout buffer of whole episodes in groups.

    Args:
        buffer_size: number of steps; the library's buffer has this and the following arguments.
        observation_space: space of observations.
        action_space: space of actions.
        device: device of the tensors of minibatches.
        gae_lambda: parameter lambda of generalised advantage estimation.
        gamma: discount factor of rewards.
        n_envs: number of swarms.
        group_size: number of swarms in a group, neighbours; advantages of a step are those beyond their mean.
        critic: whether the values of the critic are used; otherwise they count as zero.
        noise_steps: number of steps that share their noise; 0 is a whole episode.
        num_optimizers: number of optimizers, each with the same number of neighbours. The advantages of each
            are divided by their standard deviation, since gaps of optimizers differ by decades.
        ran: function that returns (B,) which swarms the last step has advanced; steps of the others are left
            out of minibatches. By default all count.
    """

    def __init__(
        self,
        buffer_size: int,
        observation_space: Space,
        action_space: Space,
        device: torch.device | str = "auto",
        gae_lambda: float = 1.0,
        gamma: float = 0.99,
        n_envs: int = 1,
        *,
        group_size: int,
        critic: bool,
        noise_steps: int,
        num_optimizers: int = 1,
        ran: Callable[[], NDArray[np.bool_]] | None = None,
    ):
        self._ran = ran
        super().__init__(buffer_size, observation_space, action_space, device, gae_lambda, gamma, n_envs)
        self.noise_steps = noise_steps
        self.num_optimizers = num_optimizers
        self.group_size = group_size
        self.critic = critic

    def reset(self) -> None:
        """Forget all steps."""
        super().reset()
        self.there = np.ones((self.buffer_size, self.n_envs), dtype=np.bool_)

    def add(
        self,
        obs: NDArray,
        action: NDArray,
        reward: NDArray,
        episode_start: NDArray,
        value: torch.Tensor,
        log_prob: torch.Tensor,
    ) -> None:
        """Keep a step of all swarms, and which of them it has advanced."""
        if self._ran is not None:
            self.there[self.pos] = self._ran()
        super().add(obs, action, reward, episode_start, value, log_prob)

    def get(self, batch_size: int | None = None) -> Generator[RolloutBufferSamples, None, None]:
        """Yield minibatches of all steps that count, in random order."""
        if not self.generator_ready:
            there = self.swap_and_flatten(self.there)[:, 0]
            for name in COLUMNS:
                setattr(self, name, self.swap_and_flatten(getattr(self, name))[there])
            self.generator_ready = True
        order = np.random.permutation(len(self.advantages))  # noqa: NPY002 - the library's generator
        for begin in range(0, len(order), batch_size or len(order)):
            yield self._get_samples(order[begin : begin + (batch_size or len(order))])

    def compute_returns_and_advantage(self, last_values: torch.Tensor, dones: NDArray[np.bool_]) -> None:
        """Compute returns, and advantages (steps, B) minus their mean over the group."""
        if not self.critic:
            self.values[:] = 0.0
            last_values = torch.zeros_like(last_values)
        super().compute_returns_and_advantage(last_values, dones)
        self.advantages = relative_to_group(self.advantages, self.group_size, self.noise_steps)
        if self.num_optimizers > 1:
            parts = self.advantages.reshape(len(self.advantages), self.num_optimizers, -1)
            deviations = parts.std(axis=(0, 2), keepdims=True) + SMALLEST_DEVIATION
            self.advantages = (parts / deviations).reshape(self.advantages.shape)


def advantages_and_returns(
    rewards: torch.Tensor,
    values: torch.Tensor | None,
    *,
    discount: float,
    gae_lambda: float,
    group_size: int,
    noise_steps: int,
) -> tuple[torch.Tensor, torch.Tensor]:
    """Return advantages beyond the mean of their group, and returns, of whole episodes on any device.

    `GroupBuffer` has the definitions. Sums over a group may round differently, since torch adds in
    another order than NumPy.

    Args:
        rewards: (steps, B) rewards; the episodes of all swarms end with the last step.
        values: (steps, B) values of the critic; None counts them as zero.
        discount: discount factor of rewards.
        gae_lambda: parameter lambda of generalised advantage estimation.
        group_size: number of swarms in a group, neighbours.
        noise_steps: number of steps that share their noise; 0 is a whole episode.

    Returns:
        Advantages and returns, both (steps, B).
    """
    values = torch.zeros_like(rewards) if values is None else values
    advantages = torch.empty_like(rewards)
    next_value = next_advantage = torch.zeros_like(rewards[0])
    for step in reversed(range(len(rewards))):
        surprise = rewards[step] + discount * next_value - values[step]
        next_advantage = advantages[step] = surprise + discount * gae_lambda * next_advantage
        next_value = values[step]
    returns = advantages + values
    return relative_to_group(advantages, group_size, noise_steps), returns
