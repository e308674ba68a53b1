"""Evaluation of several controllers on the same episodes at once, with a loss for each."""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.controllers.controller import Controller
from swarm_gym.registration import environment_id
from swarm_gym.reward import LARGEST_DETOUR, offline_weight
from swarm_gym.simulation import Simulation
from swarm_gym.training.config import changed_options
from swarm_gym.tuning.config import TuneConfig

Floats = NDArray[np.float64]


class Outcomes(NamedTuple):
    """Results of n controllers on the same E episodes; every array has shape (n, E).

    The loss is a measure of the result (`LOSSES`) + price * evaluations / reference evaluations. For
    controllers with the same PS(0), it is the negative sum of the environment's rewards, up to a constant of
    the episode. It includes the evaluations of the first population, so that controllers with different PS(0)
    can be compared.

    Attributes:
        losses: loss of each episode.
        final_fitness: best fitness of each episode.
        evaluations: number of calls of the cost function.
        scenarios: name of the scenario.
    """

    losses: Floats
    final_fitness: Floats
    evaluations: NDArray[np.int64]
    scenarios: NDArray[np.object_]

    def by_scenario(self, row: int) -> dict[str, dict[str, float]]:
        """Return the means of controller `row` on every scenario."""
        found = {}
        for name in sorted(set(self.scenarios[row])):
            there = self.scenarios[row] == name
            found[name] = {
                "loss": float(self.losses[row, there].mean()),
                "final_fitness": float(self.final_fitness[row, there].mean()),
                "evaluations": float(self.evaluations[row, there].mean()),
            }
        return found


def _logarithmic(simulation: Simulation, _paid: Floats) -> Floats:
    gap = np.log(simulation.gaps.now() / simulation.worlds.gap_units[simulation.swarms.problem])
    return np.where(simulation.running, 0.0, gap)


def _per_cent(simulation: Simulation, _paid: Floats) -> Floats:
    return np.where(simulation.running, 0.0, 100.0 * simulation.gaps.optimality())


def _offline_error(simulation: Simulation, _paid: Floats) -> Floats:
    return 100.0 * simulation.gaps.optimality() * offline_weight(simulation)


def _detour(simulation: Simulation, _paid: Floats) -> Floats:
    return np.where(simulation.running, 0.0, 100.0 * np.minimum(simulation.detours(), LARGEST_DETOUR))


def _not_paid(_simulation: Simulation, paid: Floats) -> Floats:
    return -paid


# Measures of a result, by the name of the reward: what an iteration adds to it, (B,), given the simulation
# after the iteration and the environment's rewards of it, (B,); lower is better.
LOSSES: dict[str, Callable[[Simulation, Floats], Floats]] = {
    "final": _logarithmic,
    "optimality": _per_cent,
    "offline-error": _offline_error,
    "detour": _detour,
    "anytime": _not_paid,
    "anytime-and-end": _not_paid,
}


class SideBySide:
    """Environments for n controllers with `config.episodes` episodes each.

    Args:
        config: configuration of the tuning.
        num_controllers: number of controllers n.
        observation: observation layout of all controllers.
        action: action layout of all controllers.

    Attributes:
        steps: number of environment steps of one evaluation.
    """

    def __init__(self, config: TuneConfig, num_controllers: int, observation: str, action: str):
        self._shape = (num_controllers, config.episodes)
        self._loss = look_up("reward of a tuning", config.reward, LOSSES)
        self._env = gymnasium.make_vec(
            environment_id(config.optimizer),
            num_envs=num_controllers * config.episodes,
            scenario=list(config.scenarios),
            observation=observation,
            action=action,
            reward=config.reward,
            price=config.price,
            min_population_size=config.min_population_size,
            max_population_size=config.max_population_size,
            initial_population_size=config.first_limits.clip(config.initial_population_size),
            iterations=config.iterations,
            max_evaluations=config.max_evaluations or None,
            **changed_options(config),
            autoreset_mode=AutoresetMode.DISABLED,
            num_threads=config.threads,
        )
        swarms: Any = self._env.unwrapped
        self._swarms = swarms
        self._simulation = self._swarms.simulation
        self.steps = self._env.num_envs * self._swarms.settings.iterations

    def run(self, controllers: Sequence[Controller], seed: int) -> Outcomes:
        """Evaluate controllers; episode e of each has the seed `seed` + e and the same scenario.

        Episodes may end early, for instance when a robot has arrived.
        """
        count, episodes = self._shape
        observations = self._begin(controllers, seed)
        for controller in controllers:
            controller.reset(episodes, seed)
        ended = np.zeros(count * episodes, dtype=np.bool_)
        losses = np.zeros(count * episodes)
        while not ended.all():
            parts = observations.reshape(count, episodes, -1)
            actions = [controller.act(part) for controller, part in zip(controllers, parts, strict=True)]
            before = ended
            observations, paid, ended = self._swarms.step_running(np.concatenate(actions))
            losses += np.where(before, 0.0, self._loss(self._simulation, paid))
        simulation, swarms = self._simulation, self._simulation.swarms
        losses += simulation.prices.cost(swarms.evaluations)
        names = np.array([simulation.problem_of(row).scenario.name for row in range(len(losses))], np.object_)
        columns: tuple[Any, ...] = losses, swarms.best_fitness.copy(), swarms.evaluations.copy(), names
        return Outcomes(*(column.reshape(self._shape) for column in columns))

    def _begin(self, controllers: Sequence[Controller], seed: int) -> NDArray:
        """Reset all swarms and return their first observations."""
        count, episodes = self._shape
        names = self._simulation.worlds.scenario_names
        scenarios = np.tile(_balanced(len(names), episodes, seed), count)
        firsts = [_first_population(controller) for controller in controllers]
        numbers = np.repeat([firsts.index(first) for first in firsts], episodes)
        seeds: Any = [seed + episode for episode in range(episodes)] * count
        for scenario, number in sorted(set(zip(scenarios.tolist(), numbers.tolist(), strict=True))):
            options = {"scenario": names[scenario], **firsts[number]}
            self._swarms.begin((scenarios == scenario) & (numbers == number), seeds, options)
        return self._swarms.observe()


def _first_population(controller: Controller) -> dict[str, Any]:
    """Return the reset options of a controller's first population."""
    source = controller.first_source
    shares = {} if source is None else asdict(source)
    return {"initial_population_size": controller.initial_population_size, **shares}


def _balanced(count: int, episodes: int, seed: int) -> NDArray[np.int64]:
    """Return (episodes,) numbers of scenarios below `count`; how often each occurs differs by at most one."""
    generator = np.random.default_rng(seed)
    rounds = -(-episodes // count)
    return np.concatenate([generator.permutation(count) for _ in range(rounds)])[:episodes]
