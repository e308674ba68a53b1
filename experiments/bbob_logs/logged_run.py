"""Runs on BBOB functions, as both formats of logs need them."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from agents import Controller, make_controller
from swarm_gym.comparing.entrants import Entrant, iterate
from swarm_gym.errors import SettingError
from swarm_gym.registration import environment_id
from swarm_gym.scenarios import BbobScenario, make_scenario
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
class LoggedExperiment:
    """One entrant with the functions, dimensions and instances that it runs on.

    Attributes:
        name: name of the algorithm in the logs, such as `particle-swarm+fixed:40`.
        entrant: optimizer and controller.
        functions: numbers of functions, 1 to 24.
        dimensions: dimensions, 2 to 100.
        instances: numbers of instances, 1 to 1000; a run for each.
        budget: evaluations for each dimension, after which a run ends.
        iterations: iterations of a run; None is as many as the budget allows at the first population size.
        seed: seed of the run on the first instance; that on the next one has the next seed.
        parameters: parameters of the optimizer that differ from its defaults, by name.
    """

    name: str
    entrant: Entrant
    functions: tuple[int, ...]
    dimensions: tuple[int, ...]
    instances: tuple[int, ...]
    budget: int
    iterations: int | None = None
    seed: int = 0
    parameters: Mapping[str, float] = field(default_factory=dict)

    def run(self) -> Iterator[list[LoggedGroup]]:
        """Yield, for each function, the groups of all dimensions, once they have run."""
        controller = make_controller(self.entrant.controller)
        for function in self.functions:
            yield [self._group(controller, function, dimension) for dimension in self.dimensions]

    @property
    def settings(self) -> str:
        """The options that decide the runs, in one line."""
        shown: dict[str, object] = {"budget": f"{self.budget} D", "seed": self.seed, **self.parameters}
        if self.iterations is not None:
            shown["iterations"] = self.iterations
        return ", ".join(f"{name} {value}" for name, value in shown.items())

    def _group(self, controller: Controller, function: int, dimension: int) -> LoggedGroup:
        names = [f"function:bbob-{function}-{dimension}-{instance}" for instance in self.instances]
        env = gymnasium.make(
            environment_id(self.entrant.optimizer), **self._options(controller, names, dimension)
        )
        first = gymnasium.make(environment_id("particle-swarm"), scenario=names, iterations=1)
        runs = []
        for k, name in enumerate(names):
            first.reset(seed=self.seed + k, options={"scenario": name})
            run = _run(env, controller, name, self.seed + k)
            runs.append(_with_first_evaluation(run, first.unwrapped.simulation))  # type: ignore[attr-defined]
        return LoggedGroup(function, dimension, tuple(runs))

    def _options(self, controller: Controller, names: Sequence[str], dimension: int) -> dict[str, Any]:
        options: dict[str, Any] = {"max_evaluations": self.budget * dimension, **controller.env_options()}
        enough = math.ceil(options["max_evaluations"] / controller.initial_population_size)
        return {
            "scenario": names,
            "iterations": enough if self.iterations is None else self.iterations,
            **options,
            **self.entrant.options,
            **self.parameters,
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
