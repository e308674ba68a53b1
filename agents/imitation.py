"""Behaviour cloning: a policy learns a controller's decisions, and the value of following them."""

from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3 import PPO
from tqdm import trange

from agents.controller import Controller
from agents.sb3_vec_env import SB3VecEnv
from agents.seeds import TRAINING_START
from swarm_gym.action import make_action
from swarm_gym.observation import make_observation

ROLLOUTS = 4
GRADIENT_STEPS = 3000
BATCH_SIZE = 512
LEARNING_RATE = 1e-3


class Demonstration(NamedTuple):
    """N steps of episodes."""

    observations: NDArray  # (N, number of features)
    actions: NDArray  # (N, k) without the noise
    returns: NDArray  # (N,) rewards to come


def imitate(model: PPO, controller: Controller | None, env: SB3VecEnv) -> None:
    """Fit actor and critic of `model` to what a controller decides in `env` and earns by it.

    Seeded by the model's own seed. The critic is fitted too: PPO that starts with an ignorant one
    unlearns the actor first. Without a controller to imitate, the actor learns to correct nothing.
    """
    noise = 0.0 if model.use_sde else float(np.exp(model.policy.log_std.detach().numpy().mean()))
    observations, actions, returns = _demonstrate(controller, env, noise, _seed(model))
    generator = np.random.default_rng(_seed(model))
    policy = model.policy
    parameters = [p for name, p in policy.named_parameters() if name != "log_std"]
    optimizer = torch.optim.Adam(parameters, lr=LEARNING_RATE)
    data = [torch.as_tensor(array) for array in (observations, actions, returns)]
    for _ in trange(GRADIENT_STEPS, desc="imitation", unit="step", leave=False):
        rows = torch.as_tensor(generator.integers(0, len(observations), BATCH_SIZE))
        seen, wanted, earned = (tensor[rows] for tensor in data)
        decided = policy.get_distribution(seen).mode()
        loss = torch.nn.functional.mse_loss(decided, wanted) + torch.nn.functional.mse_loss(
            policy.predict_values(seen).flatten(), earned
        )
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()


def _demonstrate(controller: Controller | None, env: SB3VecEnv, noise: float, seed: int) -> Demonstration:
    """Whole episodes, disturbed by the noise that the policy will explore with: its critic meets these."""
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
        to_come[step] = rewards[step] + np.where(ends[step], 0.0, to_come[step + 1])
    return Demonstration(
        np.concatenate(seen), np.concatenate(wanted), to_come[:-1].reshape(-1).astype(np.float32)
    )


def _seed(model: PPO) -> int:
    return TRAINING_START + int(model.seed or 0)
