"""Episodes of one controller, and what others would have decided in the states that it visits."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.evaluation.rollout import drive, swarms_for
from swarm_gym.action import make_action
from swarm_gym.controllers.controller import Controller
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings
from swarm_gym.simulation import Simulation

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Watched:
    """B episodes of T iterations at most.

    Attributes:
        seen: (T, B, k) what was seen before each iteration, in the layout that was asked for.
        decided: one (T, B, d) per watcher: population size, phi, and further decisions in natural units, as
            they are carried out, before rounding.
        running: (T, B) whether the episode was under way; entries of others mean nothing.
        gap: (B,) final optimality gap, (fitness - optimum) / optimum; NaN where the optimum is unknown.
        evaluations: (B,) calls of the cost function.
        returns: (B,) sum of the rewards.
    """

    seen: NDArray
    decided: tuple[Floats, ...]
    running: NDArray[np.bool_]
    gap: Floats
    evaluations: Floats
    returns: Floats


def watch(
    driver: Controller,
    watchers: Sequence[Controller],
    scenarios: Sequence[str],
    seeds: range,
    observation: str = "rich",
    optimizer: str = "firefly",
    num_threads: int = 1,
    **options: Any,
) -> Watched:
    """Run one episode per seed, side by side, as `driver` decides.

    Args:
        driver: its decisions are carried out.
        watchers: asked in every state, each with its own observation layout. An evaluation budget that they
            need has to be the driver's too.
        scenarios: names that each episode draws from.
        seeds: consecutive seeds, one per episode.
        observation: layout of what is kept of the states.
        optimizer: name of the optimizer.
        num_threads: that swarms are spread over; results do not depend on it.
        options: further options of the environment.
    """
    options = {**options, "scenario": list(scenarios), "num_threads": num_threads}
    swarms = swarms_for(driver, len(seeds), optimizer, **options)
    simulation = swarms.simulation
    eyes = [_Eye(controller, simulation) for controller in watchers]
    keeper = _View(observation, simulation)
    for controller in watchers:
        controller.reset(len(seeds), seeds.start)
    seen, running, decided = [], [], []

    def look() -> None:
        seen.append(keeper.observe())
        running.append(simulation.running.copy())
        decided.append([eye.decide() for eye in eyes])

    returns = drive(driver, swarms, seeds, look)
    return Watched(
        np.array(seen),
        tuple(np.array(of_one) for of_one in zip(*decided, strict=True)),
        np.array(running),
        simulation.optimality_gap(),
        simulation.swarms.evaluations.astype(np.float64),
        returns,
    )


class _Eye:
    """A controller that watches a simulation."""

    def __init__(self, controller: Controller, simulation: Simulation):
        settings = simulation.settings
        self._controller = controller
        self._simulation = simulation
        self._view = _View(controller.observation, simulation)
        self._action = make_action(replace(settings, action=controller.action), simulation.optimizer)
        self._limits = settings.min_population_size, settings.max_population_size

    def decide(self) -> Floats:
        """(B, d) decisions in natural units."""
        simulation = self._simulation
        actions = self._controller.act(self._view.observe()).astype(np.float64)
        decided = np.stack(
            [
                scale.decode(numbers, simulation)
                for scale, numbers in zip(self._action.scales, actions.T, strict=True)
            ],
            axis=1,
        )
        decided[:, 0] = np.clip(decided[:, 0], *self._limits)
        decided[:, 1] = np.clip(decided[:, 1], 0.0, 1.0)
        return decided


def decision_names(controller: Controller, optimizer: str) -> tuple[str, ...]:
    """What a controller decides, in the order of its actions."""
    # Paced layouts want a budget; the names do not depend on it.
    settings = Settings(action=controller.action, max_evaluations=Settings.initial_population_size)
    return make_action(settings, get_optimizer(optimizer)).labels


class _View:
    """An observation layout on a simulation, as environments show it: inside its bounds."""

    def __init__(self, layout: str, simulation: Simulation):
        self._layout = make_observation(layout)
        self._simulation = simulation
        self._space = self._layout.space(simulation)

    def observe(self) -> NDArray:
        """(B, k)."""
        seen = self._layout.observe(self._simulation)
        return np.minimum(np.maximum(seen, self._space.low), self._space.high)
