"""Whole episodes of a controller on many seeds at once."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller
from swarm_gym.scenarios import Scenario
from swarm_gym.simulation import HISTORY, Simulation
from swarm_gym.vector_env import SwarmVectorEnv

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


def look_away(_: Simulation) -> None:
    """See nothing of a simulation."""


def run_episodes(
    controller: Controller,
    scenario: str | Scenario,
    seeds: range,
    optimizer: str = "firefly",
    look: Callable[[Simulation], None] = look_away,
    **options: Any,
) -> Episodes:
    """Run one episode per seed, all side by side, on one scenario.

    Args:
        controller: decides; sees its own observation layout.
        scenario: a scenario or its name.
        seeds: consecutive seeds, one per episode.
        optimizer: name of the optimizer.
        look: called with the simulation before every iteration, and after the last one.
        options: further options of the environment.
    """
    swarms = swarms_for(controller, len(seeds), optimizer, scenario=scenario, **options)
    returns = drive(controller, swarms, seeds, lambda: look(swarms.simulation))
    look(swarms.simulation)
    history = swarms.simulation.history[:, 1:]
    sizes, repair_degrees = (
        history[..., HISTORY.index(name)] for name in ("population_size", "repair_degree")
    )
    final = swarms.simulation.swarms
    return Episodes(
        final.best_fitness.copy(), final.evaluations.astype(np.float64), returns, sizes, repair_degrees
    )


def swarms_for(controller: Controller, num_swarms: int, optimizer: str, **options: Any) -> SwarmVectorEnv:
    """Swarms as a controller needs them, for an episode each."""
    return SwarmVectorEnv(
        num_swarms,
        optimizer,
        autoreset_mode=AutoresetMode.DISABLED,
        **{**options, **controller.env_options()},
    )


def drive(
    controller: Controller, swarms: SwarmVectorEnv, seeds: range, look: Callable[[], None] = lambda: None
) -> Floats:
    """(B,) sums of the rewards of one episode per swarm, side by side, as a controller decides.

    Args:
        controller: decides.
        swarms: B of them, made for the controller.
        seeds: consecutive seeds, one per swarm.
        look: called before every iteration.
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
