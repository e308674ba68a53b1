"""The numbers of a suite's runs as arrays, and how far the runs end from the optimum."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.runs.groups import EVERY_SET, group_controllers, scenario_sets
from experiments.statistics import Draws, draw
from swarm_gym.errors import ScenarioError
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import gap_to_optimum, known_optimum
from swarm_gym.settings import make_problem

Floats = NDArray[np.float64]


class RunNumbers(NamedTuple):
    """Numbers of the runs of one controller on one scenario, (seeds,) each."""

    fitness: Floats
    collision: Floats
    evaluations: Floats
    seconds: Floats


@dataclass(frozen=True)
class Sample:
    """Runs of a group of controllers on sets of scenarios, (training seeds, scenarios, seeds) each.

    Attributes:
        gap: (final fitness - optimum) / optimum.
        feasible: 1 where the best path of the run is feasible, else 0.
        evaluations: calls of the cost function.
        seconds: processor time.
        set_sizes: how many scenarios, in their order, are of one set.
    """

    gap: Floats
    feasible: Floats
    evaluations: Floats
    seconds: Floats
    set_sizes: tuple[int, ...]

    @property
    def num_training_seeds(self) -> int:
        """1 for what is not trained."""
        return self.gap.shape[0]

    def draws(self, stream: int = 0) -> Draws:
        """How resamples of this sample are drawn; of what is compared, each takes a stream of its own."""
        return draw(self.num_training_seeds, self.set_sizes, self.gap.shape[2], stream)


def _nothing_stored(controller: str, scenario: str) -> list[Any]:  # noqa: ARG001
    return []


@dataclass(frozen=True)
class Outcomes:
    """All runs of a suite, without paths and traces.

    Attributes:
        controllers: their names, the first axis of the arrays.
        scenarios: their names, the second axis; the third is the seeds.
        fitness: (controllers, scenarios, seeds) best fitness of the run, in map units.
        collision: degree of collision of that path; 0 is feasible.
        evaluations: calls of the cost function.
        seconds: processor time of the run.
        load: finds the runs of a controller on a scenario where they are stored.
    """

    controllers: tuple[str, ...]
    scenarios: tuple[str, ...]
    fitness: Floats
    collision: Floats
    evaluations: Floats
    seconds: Floats
    load: Callable[[str, str], list[Any]] = _nothing_stored

    def runs(self, controller: str, scenario: str) -> list[Any]:
        """The runs of one controller on one scenario, by seed, with paths and traces (`results.Run`)."""
        return self.load(controller, scenario)

    def of(self, controller: str, scenario: str) -> RunNumbers:
        """Runs of one controller on one scenario, in the order of the seeds."""
        at = self.controllers.index(controller), self.scenarios.index(scenario)
        return RunNumbers(self.fitness[at], self.collision[at], self.evaluations[at], self.seconds[at])

    @cached_property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Controllers that differ in their training seed only, by the key of their group."""
        return group_controllers(self.controllers)

    @cached_property
    def sets(self) -> dict[str, tuple[tuple[str, ...], ...]]:
        """What is reported on, by name: the scenarios of every set, and of all sets if there are several."""
        sets = scenario_sets(self.scenarios)
        each: dict[str, tuple[tuple[str, ...], ...]] = {
            name: (scenarios,) for name, scenarios in sets.items()
        }
        return each if len(sets) == 1 else {**each, EVERY_SET: tuple(sets.values())}

    @cached_property
    def gap(self) -> Floats:
        """(controllers, scenarios, seeds) optimality gap, see `gap_to_optimum`.

        Raises:
            ScenarioError: for scenarios whose optimum is not known.
        """
        optima = np.array([known_optimum(make_problem(name)) for name in self.scenarios])
        unknown = [name for name, optimum in zip(self.scenarios, optima, strict=True) if np.isnan(optimum)]
        if unknown:
            raise ScenarioError(
                f"gaps need the optimum, which is not known for {len(unknown)} of {len(optima)} scenarios, "
                f"the first of them {unknown[0]}"
            )
        return gap_to_optimum(self.fitness, optima[:, None])

    def sample(self, group: str, scenario_set: str) -> Sample:
        """Runs of a group on a set, by their keys."""
        strata = self.sets[scenario_set]
        rows = _places(self.groups[group], self.controllers)
        columns = _places([name for scenarios in strata for name in scenarios], self.scenarios)
        at = np.ix_(rows, columns)
        return Sample(
            self.gap[at],
            (self.collision[at] <= FEASIBILITY_TOLERANCE).astype(np.float64),
            self.evaluations[at],
            self.seconds[at],
            tuple(len(scenarios) for scenarios in strata),
        )


def _places(names: Sequence[str], among: Sequence[str]) -> list[int]:
    place = {name: k for k, name in enumerate(among)}
    return [place[name] for name in names]
