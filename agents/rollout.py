"""Whole episodes of a controller on many seeds at once."""

from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from agents.controller import Controller
from swarm_gym.registration import environment_id
from swarm_gym.scenarios import Scenario
from swarm_gym.simulation import HISTORY

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Episodes:
    """What happened in B episodes of T iterations.

    Attributes:
        final_fitness: (B,) best fitness of each episode.
        evaluations: (B,) calls of the cost function.
        returns: (B,) sum of the rewards.
        sizes: (B, T) population size of each iteration; NaN after an end before the last one.
        repair_degrees: (B, T) phi of each iteration, likewise.
    """

    final_fitness: Floats
    evaluations: Floats
    returns: Floats
    sizes: Floats
    repair_degrees: Floats


def run_episodes(
    controller: Controller, scenario: str | Scenario, seeds: range, optimizer: str = "firefly", **options: Any
) -> Episodes:
    """Run one episode per seed, all side by side, on one scenario.

    Args:
        controller: decides; sees its own observation layout.
        scenario: a scenario or its name.
        seeds: consecutive seeds, one per episode.
        optimizer: name of the optimizer.
        options: further options of the environment.
    """
    env = gymnasium.make_vec(
        environment_id(optimizer),
        num_envs=len(seeds),
        scenario=scenario,
        autoreset_mode=AutoresetMode.DISABLED,
        **{**options, **controller.env_options()},
    )
    controller.reset(len(seeds), seeds.start)
    observations, _ = env.reset(seed=seeds.start)
    returns = np.zeros(len(seeds))
    swarms: Any = env.unwrapped
    ended = np.zeros(len(seeds), dtype=np.bool_)
    while not ended.all():
        observations, rewards, ended = swarms.step_running(controller.act(observations))
        returns += rewards
    history = swarms.simulation.history[:, 1:]
    sizes, repair_degrees = (
        history[..., HISTORY.index(name)] for name in ("population_size", "repair_degree")
    )
    final = swarms.simulation.swarms
    return Episodes(
        final.best_fitness.copy(), final.evaluations.astype(np.float64), returns, sizes, repair_degrees
    )
