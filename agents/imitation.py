"""Behaviour cloning: a policy learns a controller's decisions, and the value of following them."""

from typing import Any

import numpy as np
import torch
from gymnasium.vector import VectorEnv
from numpy.typing import NDArray
from stable_baselines3 import PPO
from tqdm import trange

from agents.controller import Controller
from agents.seeds import TRAINING_START
from swarm_gym.action import Normalised
from swarm_gym.observation import make_observation

ROLLOUTS = 4
GRADIENT_STEPS = 3000
BATCH_SIZE = 512
LEARNING_RATE = 1e-3


def imitate(model: PPO, controller: Controller, env: VectorEnv) -> None:
    """Fit actor and critic of `model` to what a controller decides in `env` and earns by it.

    Seeded by the model's own seed. The critic is fitted too: PPO that starts with an ignorant one
    unlearns the actor first.
    """
    observations, actions, returns = _demonstrate(controller, env, seed=_seed(model))
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


def _demonstrate(controller: Controller, env: VectorEnv, seed: int) -> tuple[NDArray, NDArray, NDArray]:
    """Observations, normalised actions and returns to come, over whole episodes of the controller."""
    inner: Any = env.unwrapped
    simulation, settings = inner.simulation, inner.settings
    layout, encode = make_observation(controller.observation), Normalised(settings).encode
    steps = ROLLOUTS * settings.iterations
    seen, decided, rewards, ends = [], [], [], []
    observations, _ = env.reset(seed=seed)
    controller.reset(env.num_envs, seed)
    for _ in range(steps):
        sizes, repair_degrees = controller.act(layout.observe(simulation)).T
        actions = encode(sizes, repair_degrees)
        seen.append(observations)
        decided.append(actions)
        observations, reward, terminated, _, _ = env.step(actions)
        rewards.append(reward)
        ends.append(terminated)
    to_come = np.zeros((steps + 1, env.num_envs))
    for step in reversed(range(steps)):
        to_come[step] = rewards[step] + np.where(ends[step], 0.0, to_come[step + 1])
    return (
        np.concatenate(seen),
        np.concatenate(decided),
        to_come[:-1].reshape(-1).astype(np.float32),
    )


def _seed(model: PPO) -> int:
    return TRAINING_START + int(model.seed or 0)
