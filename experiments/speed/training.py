"""Shares of the time of PPO training: kernels, the environment around them, the adapter, the network."""

import time
from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import Any

import numpy as np

from experiments.speed.measurement import Quantity

PARTS = (
    "kernels",
    "environment around the kernels",
    "adapter to stable-baselines3",
    "network while playing",
    "network while learning",
)
PACE = "PPO training as agents.train begins it, 64 swarms"
ENVIRONMENT = "share of the time in the environment, kernels included"
ROLLOUTS = 5


def quantities() -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    yield Quantity(PACE, "steps/s", lambda: _shares()[0], 1)
    for number, part in enumerate(PARTS):
        yield Quantity(f"share of the time in: {part}", "%", partial(_share, number), 1)
    yield Quantity(ENVIRONMENT, "%", lambda: _share(0) + _share(1), 1)


def _share(number: int) -> float:
    return _shares()[1][number]


class Stopwatch:
    """A stand-in for a function that adds up the time that its calls take."""

    def __init__(self, function: Callable) -> None:
        self.function = function
        self.seconds = 0.0

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """Call the function and add the time that it takes."""
        begin = time.perf_counter()
        try:
            return self.function(*arguments, **options)
        finally:
            self.seconds += time.perf_counter() - begin


@cache
def _shares() -> tuple[float, tuple[float, ...]]:
    """Return steps per second, and the share of each of `PARTS` in per cent, over a few rollouts."""
    import torch

    from swarm_gym.training.algorithms import PPO
    from swarm_gym.training.learners.ppo import PPOLearner
    from swarm_gym.training.presets import load_preset

    torch.set_num_threads(1)
    config = load_preset("three-cases")
    assert isinstance(config.algorithm, PPO)
    learner = PPOLearner(config, config.algorithm)
    env: Any = learner.env
    model = learner.model
    learner.begin()
    steps = model.n_steps * config.num_swarms
    model.learn(steps)  # everything compiled and allocated
    vector: Any = env.env
    watches = []
    for owner, method in (
        (vector.unwrapped.simulation, "advance"),
        (vector, "step"),
        (env, "step_wait"),
        (model, "collect_rollouts"),
    ):
        watches.append(Stopwatch(getattr(owner, method)))
        setattr(owner, method, watches[-1])
    begin = time.perf_counter()
    model.learn(ROLLOUTS * steps)
    spent = time.perf_counter() - begin
    kernels, environment, adapter, playing = (watch.seconds for watch in watches)
    inner = np.array([0.0, kernels, environment, adapter, playing, spent])
    return ROLLOUTS * steps / spent, tuple((100.0 * np.diff(inner) / spent).tolist())
