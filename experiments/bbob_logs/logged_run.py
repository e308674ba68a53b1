"""Runs on BBOB functions, as both formats of logs need them."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from agents import Controller, make_controller_for
from swarm_gym.comparing.entrants import Entrant, entrant, iterate
from swarm_gym.errors import SettingError
from swarm_gym.registration import environment_id
from swarm_gym.scenarios import BbobScenario, make_scenario
from swarm_gym.scenarios.bbob.scenario import FUNCTIONS
from swarm_gym.simulation import Simulation

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class LoggedRun:
    """One run on an instance of a function.

    There is a row for the first evaluation, the first population, and each iteration. cocopp and iohinspector
    need the first evaluation, since it is where they tell runs apart.

    Attributes:
        instance: number of the instance.
        least_value: f_opt of the instance.
        evaluations: (k,) evaluations until the end of each iteration, after a 1.
        precision: (k,) best value so far, minus f_opt; it never rises.
        best_vector: (D,) the best decision vector.
    """

    instance: int
    least_value: float
    evaluations: NDArray[np.int64]
    precision: Floats
    best_vector: Floats

    @property
    def first_best(self) -> int:
        """Row of the iteration that found the best vector."""
        return int(np.argmax(self.precision == self.precision[-1]))

    @property
    def improved(self) -> NDArray[np.bool_]:
        """(k,) whether an iteration improved the best value; the first and the last row always count."""
        better = np.ones(len(self.precision), dtype=np.bool_)
        better[1:-1] = self.precision[1:-1] < self.precision[:-2]
        return better


@dataclass(frozen=True)
class LoggedGroup:
    """The runs of one entrant on one function in one dimension.

    Attributes:
        function: number of the function, 1 to 24.
        dimension: D.
        runs: a run for each instance.
    """

    function: int
    dimension: int
    runs: tuple[LoggedRun, ...]


@dataclass(frozen=True)
class BbobConfig:
    """Options of runs on BBOB functions."""

    controllers: tuple[str, ...] = ("fixed:40",)
    """Controllers to run, e.g. fixed:40 random. The name of an optimizer may precede one with +, e.g.
    fish-swarm+fixed:20."""
    optimizer: str = "particle-swarm"
    """Optimizer of controllers that name none, e.g. particle-swarm."""
    functions: tuple[int, ...] = tuple(FUNCTIONS)
    """Numbers of functions, 1 to 24, e.g. 1 8 15. By default all."""
    dimensions: tuple[int, ...] = (2, 5, 10)
    """Dimensions, 2 to 100, e.g. 2 3 5 10 20, which are those that cocopp compares."""
    instances: tuple[int, ...] = tuple(range(1, 16))
    """Numbers of instances, 1 to 1000, e.g. 1 2 3; a run for each. By default 1 to 15."""
    budget: int = 1000
    """Evaluations of a run for each dimension, e.g. 1000: then runs in 5 dimensions end after 5000. A
    controller that was made for a budget of its own keeps that one."""
    iterations: int | None = None
    """Iterations of a run, e.g. 100, if the budget lasts. By default as many as the budget allows at the
    first population size."""
    parameters: dict[str, float] = field(default_factory=dict)
    """Parameters of the optimizer that differ from its defaults, in units of the components where they are
    lengths, e.g. noise 0.05."""
    output: Path = Path("results/bbob")
    """Folder for logs, by default results/bbob. Logs of another run that are there are not touched."""
    seed: int = 0
    """Seed of the run on the first instance, e.g. 0; that on the next instance has the next seed."""


@dataclass(frozen=True)
class LoggedExperiment:
    """One entrant with the options of its runs.

    Attributes:
        name: name of the algorithm in the logs, such as `particle-swarm+fixed:40`.
        entrant: optimizer and controller.
        config: options of the runs; each function, dimension and instance is run once.
    """

    name: str
    entrant: Entrant
    config: BbobConfig

    @classmethod
    def of(cls, controller: str, config: BbobConfig) -> "LoggedExperiment":
        """Return the experiment of a controller, whose name may begin with an optimizer.

        Raises:
            UnknownNameError: if there is no such controller or optimizer.
        """
        found = entrant(controller, config.optimizer)
        name = controller if controller != found.controller else f"{found.optimizer}+{controller}"
        return cls(name, found, config)

    def run(self) -> Iterator[list[LoggedGroup]]:
        """Yield, for each function, the groups of all dimensions, once they have run."""
        controller = make_controller_for(self.entrant.optimizer, self.entrant.controller)
        for function in dict.fromkeys(self.config.functions):
            dimensions = dict.fromkeys(self.config.dimensions)
            yield [self._group(controller, function, dimension) for dimension in dimensions]

    @property
    def settings(self) -> str:
        """The options that decide the runs, in one line."""
        config = self.config
        shown = {"budget": f"{config.budget} D", "seed": config.seed, **config.parameters}
        if config.iterations is not None:
            shown["iterations"] = config.iterations
        return ", ".join(f"{name} {value}" for name, value in shown.items())

    def _group(self, controller: Controller, function: int, dimension: int) -> LoggedGroup:
        instances = dict.fromkeys(self.config.instances)
        names = [f"function:bbob-{function}-{dimension}-{instance}" for instance in instances]
        env = gymnasium.make(
            environment_id(self.entrant.optimizer), **self._options(controller, names, dimension)
        )
        first = gymnasium.make(environment_id("particle-swarm"), scenario=names, iterations=1)
        runs = []
        for seed, name in enumerate(names, self.config.seed):
            first.reset(seed=seed, options={"scenario": name})
            run = _run(env, controller, name, seed)
            runs.append(_with_first_evaluation(run, first.unwrapped.simulation))  # type: ignore[attr-defined]
        return LoggedGroup(function, dimension, tuple(runs))

    def _options(self, controller: Controller, names: Sequence[str], dimension: int) -> dict[str, Any]:
        options: dict[str, Any] = controller.options_with({"max_evaluations": self.config.budget * dimension})
        enough = math.ceil(options["max_evaluations"] / controller.initial_population_size)
        return {
            "scenario": names,
            "iterations": enough if self.config.iterations is None else self.config.iterations,
            **options,
            **self.entrant.options,
            **self.config.parameters,
        }


def _run(env: Any, controller: Controller, name: str, seed: int) -> LoggedRun:
    for _ in iterate(env, controller, seed, {"scenario": name}):
        pass
    simulation: Simulation = env.unwrapped.simulation
    scenario = make_scenario(name)
    assert isinstance(scenario, BbobScenario)
    history = simulation.history[0, : simulation.iteration[0] + 1]
    return LoggedRun(
        scenario.instance,
        scenario.least_value,
        history[:, simulation.columns.index("evaluations")].astype(np.int64),
        history[:, simulation.columns.index("best_fitness")].copy(),
        simulation.best_position(0).copy(),
    )


def _with_first_evaluation(run: LoggedRun, simulation: Simulation) -> LoggedRun:
    """Return a run with a row for its first evaluation.

    For a seed, every optimizer of this package evaluates the same vector first: it is the first that the
    random stream gives. Some sort their members or replace them afterwards; particle swarms do not.

    Args:
        run: a run that begins with its first population.
        simulation: a particle swarm that has begun with the seed of the run on its scenario.

    Raises:
        SettingError: if the first population of the run has nothing as good as that vector.
    """
    if run.evaluations[0] == 1:
        return run
    value, _ = simulation.problem_of(0).evaluate(simulation.positions(0)[0])
    if value < run.precision[0]:
        raise SettingError(
            f"instance {run.instance}: the optimizer does not begin with the first vector of its random "
            f"stream, so that the value of its first evaluation is unknown; logs need it"
        )
    return replace(
        run,
        evaluations=np.append(1, run.evaluations),
        precision=np.append(value, run.precision),
    )


def folder_name(algorithm: str) -> str:
    """Return a name of a folder for an algorithm, of letters, digits, `.`, `-` and `_`."""
    return "".join(c if c.isascii() and (c.isalnum() or c in ".-") else "_" for c in algorithm)
