"""Episodes of one controller, with the decisions of other controllers, the observers, in the same states."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.action import make_action
from swarm_gym.controllers.controller import Controller
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.rollout import run_swarms, swarms_for
from swarm_gym.settings import Settings
from swarm_gym.simulation import Simulation

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Watched:
    """B episodes of at most T iterations.

    Attributes:
        seen: (T, B, k) observations before each iteration, in the requested layout.
        decided: one array (T, B, d) per observer: population size, phi and further decisions in natural
            units, clipped, before rounding.
        running: (T, B) True while an episode runs; other entries of `seen` and `decided` mean nothing.
        gap: (B,) final optimality gap, (fitness - optimum) / optimum; NaN if the optimum is unknown.
        evaluations: (B,) number of calls of the cost function.
        returns: (B,) sum of the rewards.
    """

    seen: NDArray
    decided: tuple[Floats, ...]
    running: NDArray[np.bool_]
    gap: Floats
    evaluations: Floats
    returns: Floats


def watch(
    controller: Controller,
    observers: Sequence[Controller],
    scenarios: Sequence[str],
    seeds: range,
    observation: str = "rich",
    optimizer: str = "firefly",
    num_threads: int = 1,
    **options: object,
) -> Watched:
    """Run one episode per seed, side by side, with a controller, and record what observers would decide.

    Args:
        controller: controller whose decisions are carried out.
        observers: controllers that decide in every state, each with its own observation layout. An
            evaluation budget that they need has to be that of `controller` too.
        scenarios: names of scenarios that each episode draws from.
        seeds: consecutive seeds, one per episode.
        observation: layout of the observations that are recorded.
        optimizer: name of the optimizer.
        num_threads: number of threads; results do not depend on it.
        options: further options of the environment.
    """
    given: dict[str, Any] = {**options, "scenario": list(scenarios), "num_threads": num_threads}
    swarms = swarms_for(controller, len(seeds), optimizer, **given)
    simulation = swarms.simulation
    eyes = [_Eye(observer, simulation) for observer in observers]
    recorded = _View(observation, simulation)
    for observer in observers:
        observer.reset(len(seeds), seeds.start)
    seen, running, decided = [], [], []

    def look() -> None:
        seen.append(recorded.observe())
        running.append(simulation.running.copy())
        decided.append([eye.decide() for eye in eyes])

    returns = run_swarms(controller, swarms, seeds, look)
    return Watched(
        np.array(seen),
        tuple(np.array(of_one) for of_one in zip(*decided, strict=True)),
        np.array(running),
        simulation.gaps.optimality(),
        simulation.swarms.evaluations.astype(np.float64),
        returns,
    )


class _Eye:
    """An observer of a simulation: a controller with its views of states and its action layout."""

    def __init__(self, controller: Controller, simulation: Simulation):
        settings = simulation.settings
        self._controller = controller
        self._simulation = simulation
        self._view = _View(controller.observation, simulation)
        self._action = make_action(replace(settings, action=controller.action), simulation.optimizer)
        self._limits = settings.min_population_size, settings.max_population_size

    def decide(self) -> Floats:
        """Return (B, d) decisions in natural units."""
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
    """Return the names of a controller's decisions, in the order of its actions."""
    # Paced layouts need a budget; the names do not depend on it.
    settings = Settings(action=controller.action, max_evaluations=Settings.initial_population_size)
    return make_action(settings, get_optimizer(optimizer)).labels


class _View:
    """An observation layout of a simulation, clipped to its bounds as environments do."""

    def __init__(self, layout: str, simulation: Simulation):
        self._layout = make_observation(layout)
        self._simulation = simulation
        self._space = self._layout.space(simulation)

    def observe(self) -> NDArray:
        """Return (B, k) observations."""
        seen = self._layout.observe(self._simulation)
        return np.minimum(np.maximum(seen, self._space.low), self._space.high)
