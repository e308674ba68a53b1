"""Rollouts: whole episodes of a controller on many seeds at once."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller
from swarm_gym.history import HISTORY
from swarm_gym.scenarios import Scenario
from swarm_gym.simulation import Simulation
from swarm_gym.vector_env import SwarmVectorEnv

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Episodes:
    """Results of B episodes of T iterations.

    Attributes:
        final_fitness: (B,) best fitness of each episode.
        evaluations: (B,) number of calls of the cost function.
        returns: (B,) sum of the rewards.
        sizes: (B, T) population size of each iteration; NaN after an episode has ended early.
        repair_degrees: (B, T) phi of each iteration; NaN after an episode has ended early.
    """

    final_fitness: Floats
    evaluations: Floats
    returns: Floats
    sizes: Floats
    repair_degrees: Floats


def look_away(_: Simulation) -> None:
    """Do nothing; the default observer of a simulation."""


def run_episodes(
    controller: Controller,
    scenario: str | Scenario,
    seeds: range,
    optimizer: str = "firefly",
    look: Callable[[Simulation], None] = look_away,
    **options: object,
) -> Episodes:
    """Run one episode per seed, all side by side, on one scenario.

    Args:
        controller: controller that decides, with its own observation layout.
        scenario: a scenario or its name.
        seeds: consecutive seeds, one per episode.
        optimizer: name of the optimizer.
        look: function that is called with the simulation before every iteration, and after the last one.
        options: further options of the environment.
    """
    swarms = swarms_for(controller, len(seeds), optimizer, scenario=scenario, **options)
    returns = run_swarms(controller, swarms, seeds, lambda: look(swarms.simulation))
    look(swarms.simulation)
    history = swarms.simulation.history[:, 1:]
    sizes, repair_degrees = (
        history[..., HISTORY.index(name)] for name in ("population_size", "repair_degree")
    )
    final = swarms.simulation.swarms
    return Episodes(
        final.best_fitness.copy(), final.evaluations.astype(np.float64), returns, sizes, repair_degrees
    )


def swarms_for(controller: Controller, num_swarms: int, optimizer: str, **options: object) -> SwarmVectorEnv:
    """Return swarms with the options that a controller needs, for one episode each."""
    chosen: dict[str, Any] = controller.options_with(options)
    return SwarmVectorEnv(num_swarms, optimizer, autoreset_mode=AutoresetMode.DISABLED, **chosen)


def run_swarms(
    controller: Controller, swarms: SwarmVectorEnv, seeds: range, look: Callable[[], None] = lambda: None
) -> Floats:
    """Run one episode per swarm, side by side, and return the (B,) sums of rewards.

    Args:
        controller: controller that decides.
        swarms: B swarms, made for the controller.
        seeds: consecutive seeds, one per swarm.
        look: function that is called before every iteration.
    """
    controller.reset(len(seeds), seeds.start)
    observations, _ = swarms.reset(seed=seeds.start)
    returns = np.zeros(len(seeds))
    ended = np.zeros(len(seeds), dtype=np.bool_)
    while not ended.all():
        look()
        observations, rewards, ended = swarms.step_running(controller.act(observations))
        returns += rewards
    return returns
