"""Behaviour cloning: a policy learns a controller's decisions, and the value of following them."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from tqdm import trange

from agents.training.sb3_vec_env import SB3VecEnv
from swarm_gym.action import make_action
from swarm_gym.controllers.controller import Controller
from swarm_gym.observation import make_observation

ROLLOUTS = 4
GRADIENT_STEPS = 3000
BATCH_SIZE = 512  # steps
LEAST_SEQUENCES = 16  # in a batch, however long they are
LEARNING_RATE = 1e-3


class Demonstration(NamedTuple):
    """E sequences of at most T steps, padded by zeros."""

    observations: NDArray  # (E, T, number of features)
    actions: NDArray  # (E, T, k) without the noise
    returns: NDArray  # (E, T) rewards to come, discounted
    there: NDArray  # (E, T) 1 for steps, 0 for padding

    def one_by_one(self) -> "Demonstration":
        """The same steps as sequences of one step each."""
        rows = self.there > 0
        return Demonstration(*(array[rows][:, None] for array in self))


def imitate(
    policy: Any,
    shown: Demonstration,
    predict: Callable[[torch.Tensor], tuple[torch.Tensor, torch.Tensor]],
    seed: int,
) -> None:
    """Fit actor and critic of a policy to what was decided, and earned by it.

    The critic is fitted too: PPO that starts with an ignorant one unlearns the actor first.

    Args:
        policy: of stable-baselines3.
        shown: sequences to learn from; those of a batch are drawn by the seed.
        predict: mean actions (N, k) and values (N,) of observations (sequences, T, features), N steps in all.
        seed: of the draws.
    """
    generator = np.random.default_rng(seed)
    parameters = [p for name, p in policy.named_parameters() if name != "log_std"]
    optimizer = torch.optim.Adam(parameters, lr=LEARNING_RATE)
    data = [torch.as_tensor(array) for array in shown]
    sequences = max(BATCH_SIZE // shown.there.shape[1], LEAST_SEQUENCES)
    for _ in trange(GRADIENT_STEPS, desc="imitation", unit="step", leave=False):
        rows = torch.as_tensor(generator.integers(0, len(shown.there), sequences))
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
    """Whole episodes of a controller; without one, of correcting nothing.

    They are disturbed by the noise that the policy will explore with, since its critic meets these; and the
    discount is the one that it will be trained with, since its values are sums of rewards under it.
    """
    inner: Any = env.env.unwrapped
    simulation, settings = inner.simulation, inner.settings
    generator = np.random.default_rng(seed)
    layout = make_observation(controller.observation) if controller else None
    action = make_action(settings, simulation.optimizer)
    steps = ROLLOUTS * settings.iterations
    seen, wanted, rewards, ends = [], [], [], []
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
    to_come = np.zeros((steps + 1, env.num_envs))
    for step in reversed(range(steps)):
        to_come[step] = rewards[step] + discount * np.where(ends[step], 0.0, to_come[step + 1])
    columns = (np.stack(seen), np.stack(wanted), to_come[:-1].astype(np.float32))
    return _cut(columns, np.stack(ends), settings.iterations)


def _cut(columns: tuple[NDArray, NDArray, NDArray], ends: NDArray, longest: int) -> Demonstration:
    """Episodes from arrays (steps, B, ...) and where they end, (steps, B); those cut short are left out."""
    pieces = []
    for row, ending in enumerate(ends.T):
        begin = 0
        for end in (np.flatnonzero(ending) + 1).tolist():
            pieces.append((row, slice(begin, end)))
            begin = end
    padded = []
    for column in (*columns, np.ones(ends.shape, dtype=np.float32)):
        array = np.zeros((len(pieces), longest, *column.shape[2:]), dtype=column.dtype)
        for number, (row, part) in enumerate(pieces):
            array[number, : part.stop - part.start] = column[part, row]
        padded.append(array)
    return Demonstration(*padded)
