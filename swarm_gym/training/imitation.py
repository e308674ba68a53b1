"""Behaviour cloning: a policy learns a controller's decisions, and its critic the returns of these."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.policies import BasePolicy
from tqdm import trange

from swarm_gym.action import make_action
from swarm_gym.controllers.controller import Controller
from swarm_gym.observation import make_observation
from swarm_gym.training.sb3_vec_env import SB3VecEnv

ROLLOUTS = 4
GRADIENT_STEPS = 3000
BATCH_SIZE = 512  # steps
LEAST_SEQUENCES = 16  # smallest number of sequences in a batch, however long they are
LEARNING_RATE = 1e-3


class Demonstration(NamedTuple):
    """E sequences of at most T steps, padded by zeros.

    Attributes:
        observations: (E, T, number of features) observations of the policy.
        actions: (E, T, k) actions without the noise.
        returns: (E, T) discounted sums of the rewards to come.
        there: (E, T) 1 for steps, 0 for padding.
    """

    observations: NDArray
    actions: NDArray
    returns: NDArray
    there: NDArray

    def one_by_one(self) -> "Demonstration":
        """Return the same steps as sequences of one step each."""
        rows = self.there > 0
        return Demonstration(*(array[rows][:, None] for array in self))


def imitate(
    policy: BasePolicy,
    shown: Demonstration,
    predict: Callable[[torch.Tensor], tuple[torch.Tensor, torch.Tensor]],
    seed: int,
) -> None:
    """Fit actor and critic of a policy to demonstrated decisions and their returns.

    The critic is fitted too, since PPO with an untrained critic unlearns the actor first.

    Args:
        policy: policy of stable-baselines3.
        shown: sequences to learn from.
        predict: function from observations (sequences, T, features), N steps in all, to mean actions (N, k)
            and values (N,).
        seed: seed of the draws of batches.
    """
    generator = np.random.default_rng(seed)
    parameters = [p for name, p in policy.named_parameters() if name != "log_std"]
    optimizer = torch.optim.Adam(parameters, lr=LEARNING_RATE)
    data = [torch.as_tensor(array, device=policy.device) for array in shown]
    sequences = max(BATCH_SIZE // shown.there.shape[1], LEAST_SEQUENCES)
    for _ in trange(GRADIENT_STEPS, desc="imitation", unit="step", leave=False):
        rows = torch.as_tensor(generator.integers(0, len(shown.there), sequences), device=policy.device)
        seen, wanted, earned, there = (tensor[rows] for tensor in data)
        decided, value = predict(seen)
        weight = there.flatten() / there.sum()
        action_error = ((decided - wanted.flatten(0, 1)) ** 2).mean(dim=1)
        loss = (weight * (action_error + (value - earned.flatten()) ** 2)).sum()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()


def demonstrate(
    controller: Controller | None, env: SB3VecEnv, noise: float, discount: float, seed: int
) -> Demonstration:
    """Return whole episodes of a controller; without one, episodes in which the base is not corrected.

    Actions have the noise with which the policy will explore, since its critic is used in such states. The
    discount is the training's, since values are sums of discounted rewards.

    Args:
        controller: controller to imitate, if any.
        env: environments of the training.
        noise: standard deviation of the noise in actions scaled to [-1, 1].
        discount: discount factor of rewards.
        seed: seed of episodes and noise.
    """
    inner: Any = env.env.unwrapped
    simulation, settings = inner.simulation, inner.settings
    generator = np.random.default_rng(seed)
    layout = make_observation(controller.observation) if controller else None
    action = make_action(settings, simulation.optimizer)
    steps = ROLLOUTS * settings.iterations
    seen, wanted, rewards, ends, there = [], [], [], [], []
    env.seed(seed)
    observations: Any = env.reset()
    if controller:
        controller.reset(env.num_envs, seed)
    for _ in range(steps):
        decisions = np.zeros((env.num_envs, *action.space.shape), dtype=np.float32)
        if controller and layout:
            decisions = action.encode(controller.act(layout.observe(simulation)), simulation)
        seen.append(observations)
        wanted.append(decisions)
        disturbed = decisions + noise * generator.standard_normal(decisions.shape)
        observations, reward, ended, _ = env.step(np.clip(disturbed, -1.0, 1.0).astype(np.float32))
        rewards.append(reward)
        ends.append(ended)
        there.append(env.ran)
    to_come = np.zeros((steps + 1, env.num_envs))
    for step in reversed(range(steps)):
        to_come[step] = rewards[step] + discount * np.where(ends[step], 0.0, to_come[step + 1])
    columns = (np.stack(seen), np.stack(wanted), to_come[:-1].astype(np.float32))
    return _cut((*columns, np.stack(there).astype(np.float32)), np.stack(ends), settings.iterations)


def _cut(columns: tuple[NDArray, NDArray, NDArray, NDArray], ends: NDArray, longest: int) -> Demonstration:
    """Return complete episodes from arrays (steps, B, ...) and the ends of episodes (steps, B)."""
    pieces = []
    for row, ending in enumerate(ends.T):
        begin = 0
        for end in (np.flatnonzero(ending) + 1).tolist():
            pieces.append((row, slice(begin, end)))
            begin = end
    padded = []
    for column in columns:
        array = np.zeros((len(pieces), longest, *column.shape[2:]), dtype=column.dtype)
        for number, (row, part) in enumerate(pieces):
            array[number, : part.stop - part.start] = column[part, row]
        padded.append(array)
    return Demonstration(*padded)
