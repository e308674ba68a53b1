"""Runs in a single environment, one iteration at a time."""

import time
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from agents import Controller, make_controller
from agents.evaluation.masking import load_blinded
from experiments.runs.experiment import Experiment
from experiments.runs.run import Run, RunKey, Snapshot
from swarm_gym.comparing.entrants import Entrant, entrant, environment_of, iterate
from swarm_gym.controllers import CONTROLLERS
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.own_code import is_own, own
from swarm_gym.simulation import Simulation
from swarm_gym.warm_up import warm_up_single


class Episode:
    """A run of an experiment that has not begun; its kernels are ready, and its time excludes compilation.

    Args:
        key: controller, scenario and seed of the run.
        experiment: experiment that gives the optimizer, the options and the populations to keep.

    Attributes:
        key: controller, scenario and seed of the run.
        simulation: simulation of the environment, a batch of one.
        info: last info of the environment; empty before the run.
    """

    def __init__(self, key: RunKey, experiment: Experiment):
        self.key = key
        self._kept = experiment.kept_iterations(key)
        name, scenario, self._seed = key
        runs = entrant(name, experiment.optimizer)
        warm_up(runs, experiment)
        self._controller = controller_of(runs.controller)
        self._env = environment_of(runs, self._controller, scenario, experiment.options)
        self.simulation: Simulation = self._env.unwrapped.simulation  # type: ignore[attr-defined]
        self.info: dict[str, Any] = {}

    def __iter__(self) -> Iterator[Simulation]:
        """Yield the simulation with its first population, then after every iteration."""
        for info in iterate(self._env, self._controller, self._seed):
            self.info = info
            yield self.simulation

    def run(self, made_with: Mapping[str, str]) -> Run:
        """Carry out the run, measure its processor time, and return its record.

        Args:
            made_with: versions and commit that the run is made with.
        """
        begin = time.process_time()
        snapshots = []
        for simulation in self:
            if simulation.iteration[0] in self._kept:
                snapshots.append(_snapshot(simulation))
        seconds = time.process_time() - begin
        return Run(
            *self.key,
            float(self.info["best_fitness"]),
            float(self.info["best_collision"]),
            int(self.info["evaluations"]),
            seconds,
            self.info["best_path"],
            self.simulation.history[0].copy(),
            made_with,
            tuple(snapshots),
            self.simulation.columns,
            self.simulation.trajectory(0),
        )


def controller_of(name: str) -> Controller:
    """Return the controller of that name, which is made once per process; suites may blind policies.

    Own code is made again when its name stands for something else, as after an edited notebook cell.
    """
    family = ControllerName.parse(name).family
    is_code = family not in (BLINDED, *CONTROLLERS) and is_own("controller", name)
    return _controller(name, own("controller", name, callable, "a controller") if is_code else None)


@cache
def _controller(name: str, code: object) -> Controller:  # noqa: ARG001 (another controller for other code)
    parts = ControllerName.parse(name)
    return load_blinded(parts.argument) if parts.family == BLINDED else make_controller(name)


def warm_up(runs: Entrant, experiment: Experiment) -> None:
    """Compile or load the kernels that the runs of an entrant of an experiment need, once per process."""
    options = {"scenario": experiment.scenarios[0], **experiment.options, **runs.options}
    _warm_up(runs.optimizer, tuple(options.items()))


@cache
def _warm_up(optimizer: str, options: tuple[tuple[str, Any], ...]) -> None:
    warm_up_single(optimizer, **dict(options))


def _snapshot(simulation: Simulation) -> Snapshot:
    """Return a copy of the current population."""
    return Snapshot(
        int(simulation.iteration[0]),
        simulation.problem_of(0).points(simulation.positions(0)),
        simulation.swarms.collision[0, : simulation.swarms.size[0]].copy(),
    )
