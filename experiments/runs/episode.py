"""Runs in a single environment, one iteration at a time."""

from collections.abc import Iterator
from functools import cache
from typing import Any

from agents import Controller, make_controller
from experiments.runs.blinded import load_blinded
from experiments.runs.run import RunKey
from experiments.runs.suite import Suite
from swarm_gym.comparing.entrants import entrant
from swarm_gym.comparing.episode import environment_of, iterate
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.simulation import Simulation
from swarm_gym.warm_up import warm_up_single


class Episode:
    """A run of a suite that has not begun. Its kernels are ready, so that its time excludes compilation.

    Args:
        key: controller, scenario and seed of the run.
        suite: suite that gives the optimizer and the options.

    Attributes:
        simulation: simulation of the environment, a batch of one.
        info: last info of the environment; empty before the run.
    """

    def __init__(self, key: RunKey, suite: Suite):
        name, scenario, self._seed = key
        runs = entrant(name, suite.optimizer)
        warm_up(runs.optimizer, suite)
        self._controller = controller_of(runs.controller)
        self._env = environment_of(runs, self._controller, scenario, suite.options)
        self.simulation: Simulation = self._env.unwrapped.simulation  # type: ignore[attr-defined]
        self.info: dict[str, Any] = {}

    def __iter__(self) -> Iterator[Simulation]:
        """Yield the simulation with its first population, then after every iteration."""
        for info in iterate(self._env, self._controller, self._seed):
            self.info = info
            yield self.simulation


@cache
def controller_of(name: str) -> Controller:
    """Return the controller of that name, which is made once per process; suites may blind policies."""
    parts = ControllerName.parse(name)
    return load_blinded(parts.argument) if parts.family == BLINDED else make_controller(name)


def warm_up(optimizer: str, suite: Suite) -> None:
    """Compile or load the kernels that the runs of a suite need with an optimizer, once per process."""
    _warm_up(optimizer, tuple({"scenario": suite.scenarios[0], **suite.options}.items()))


@cache
def _warm_up(optimizer: str, options: tuple[tuple[str, Any], ...]) -> None:
    warm_up_single(optimizer, **dict(options))
