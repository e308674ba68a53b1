"""Numbers of a suite's runs as arrays, with their optimality gaps."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from experiments.runs.changes import offline_errors
from experiments.runs.groups import EVERY_SET, group_controllers, scenario_sets
from experiments.runs.run import Floats
from experiments.statistics import Draws, Interval, draw, interval, means
from swarm_gym.comparing.compared_runs import optima_of, refuse_unknown_optima
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import gap_to_optimum


class RunNumbers(NamedTuple):
    """Numbers of the runs of one controller on one scenario, (seeds,) each; see `Outcomes`."""

    fitness: Floats
    collision: Floats
    evaluations: Floats
    seconds: Floats


@dataclass(frozen=True)
class Sample:
    """A sample of runs of a group on sets of scenarios, arrays (training seeds, scenarios, seeds).

    Attributes:
        fitness: best fitness of the run, in map units.
        optimum: fitness of the true optimum, (1, scenarios, 1), nan where it is unknown.
        feasible: 1 if the best path of the run is feasible, else 0.
        evaluations: number of calls of the cost function.
        seconds: processor time of the run.
        scenarios: names of the scenarios.
        set_sizes: number of scenarios of each set; sets follow each other along the second axis.
        find_offline_error: function that returns the offline errors, shaped like `fitness`; it reads all
            traces.
        load: function that reads the stored runs of a controller on a scenario, with paths and traces.
        controllers: names of the controllers, one of each training seed.
    """

    fitness: Floats
    optimum: Floats
    feasible: Floats
    evaluations: Floats
    seconds: Floats
    scenarios: tuple[str, ...]
    set_sizes: tuple[int, ...]
    find_offline_error: Callable[[], Floats]
    load: Callable[[str, str], list[Any]]
    controllers: tuple[str, ...]

    @cached_property
    def gap(self) -> Floats:
        """Return optimality gaps, see `gap_to_optimum`.

        Raises:
            ScenarioError: if the optimum of a scenario is unknown.
        """
        refuse_unknown_optima(self.scenarios, self.optimum.ravel())
        return gap_to_optimum(self.fitness, self.optimum)

    @property
    def num_training_seeds(self) -> int:
        """Return the number of training seeds; 1 for controllers that are not trained."""
        return self.fitness.shape[0]

    def objective(self, price: float) -> Floats:
        """Return gap in per cent plus price times evaluations / 100,000 of every run, shaped like `gap`."""
        return 100.0 * self.gap + self.cost(price)

    def cost(self, price: float) -> Floats:
        """Return the price times evaluations / 100,000 of every run, shaped like `evaluations`."""
        return price * self.evaluations / 100_000.0

    def each(self, measure: Callable[[Any], float]) -> Floats:
        """Return a measure of every stored run (`run.Run`), shaped like `fitness`; it reads all traces."""
        return np.array(
            [
                [[measure(run) for run in self.load(controller, scenario)] for scenario in self.scenarios]
                for controller in self.controllers
            ]
        )

    def draws(self, stream: int = 0) -> Draws:
        """Return the draws of bootstrap resamples; samples that are compared need different streams."""
        return draw(self.num_training_seeds, self.set_sizes, self.fitness.shape[2], stream)

    def mean(self, values: Floats) -> tuple[float, Interval]:
        """Return the mean of values of the runs, shaped like `fitness`, and its 95 % interval."""
        return float(values.mean()), interval(means(values, self.draws()))


@dataclass(frozen=True)
class Outcomes:
    """Numbers of all runs of a suite, arrays (controllers, scenarios, seeds).

    Attributes:
        controllers: names of the controllers, in the order of the first axis.
        scenarios: names of the scenarios, in the order of the second axis.
        fitness: best fitness of the run, in map units.
        collision: degree of collision of the best path; 0 is feasible.
        evaluations: number of calls of the cost function.
        seconds: processor time of the run.
        load: function that reads the stored runs of a controller on a scenario, with paths and traces.
        options: options of all environments, on which the optima of scenarios may depend.
        alone: names of the controllers that are also groups of their own.
    """

    controllers: tuple[str, ...]
    scenarios: tuple[str, ...]
    fitness: Floats
    collision: Floats
    evaluations: Floats
    seconds: Floats
    load: Callable[[str, str], list[Any]] = lambda *_: []
    options: Mapping[str, Any] = field(default_factory=dict)
    alone: tuple[str, ...] = ()

    def runs(self, controller: str, scenario: str) -> list[Any]:
        """Return the runs of one controller on one scenario by seed, with paths and traces (`run.Run`)."""
        return self.load(controller, scenario)

    def of(self, controller: str, scenario: str) -> RunNumbers:
        """Return the numbers of the runs of one controller on one scenario, in the order of the seeds."""
        at = self.controllers.index(controller), self.scenarios.index(scenario)
        return RunNumbers(self.fitness[at], self.collision[at], self.evaluations[at], self.seconds[at])

    @cached_property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Return the controllers that differ in their training seed only, by the key of their group."""
        return group_controllers(self.controllers, self.alone)

    @cached_property
    def sets(self) -> dict[str, tuple[tuple[str, ...], ...]]:
        """Return the sets to report on, by name: every set of scenarios, and their union if several."""
        sets = scenario_sets(self.scenarios)
        each: dict[str, tuple[tuple[str, ...], ...]] = {
            name: (scenarios,) for name, scenarios in sets.items()
        }
        return each if len(sets) == 1 else {**each, EVERY_SET: tuple(sets.values())}

    @cached_property
    def optima(self) -> Floats:
        """Return the fitness of the optimum of each scenario, (scenarios,), nan where it is unknown.

        Unknown ones of grid maps are computed if that is quick.
        """
        return optima_of(self.scenarios, self.options)

    @cached_property
    def gap(self) -> Floats:
        """Return optimality gaps, (controllers, scenarios, seeds), see `gap_to_optimum`.

        Raises:
            ScenarioError: if the optimum of a scenario is unknown.
        """
        refuse_unknown_optima(self.scenarios, self.optima)
        return gap_to_optimum(self.fitness, self.optima[:, None])

    @cached_property
    def offline_error(self) -> Floats:
        """Return the mean gaps since the first event, (controllers, scenarios, seeds), see `offline_errors`.

        Raises:
            ScenarioError: if the optimum of a scenario is unknown.
        """
        refuse_unknown_optima(self.scenarios, self.optima)
        return np.array(
            [
                [offline_errors(self.runs(controller, scenario), scenario) for scenario in self.scenarios]
                for controller in self.controllers
            ]
        )

    def samples(self) -> Iterator[tuple[str, str, Sample]]:
        """Yield every set to report on, every group, and the runs of the group on the set."""
        for scenario_set in self.sets:
            for group in self.groups:
                yield scenario_set, group, self.sample(group, scenario_set)

    def sample(self, group: str, scenario_set: str) -> Sample:
        """Return the runs of a group on a set of scenarios, or on a scenario, by the keys of both."""
        strata = self.sets.get(scenario_set, ((scenario_set,),))
        rows = _places(self.groups[group], self.controllers)
        columns = _places([name for scenarios in strata for name in scenarios], self.scenarios)
        at = np.ix_(rows, columns)
        return Sample(
            self.fitness[at],
            self.optima[None, columns, None],
            (self.collision[at] <= FEASIBILITY_TOLERANCE).astype(np.float64),
            self.evaluations[at],
            self.seconds[at],
            tuple(self.scenarios[column] for column in columns),
            tuple(len(scenarios) for scenarios in strata),
            lambda: self.offline_error[at],
            self.runs,
            self.groups[group],
        )


def _places(names: Sequence[str], among: Sequence[str]) -> list[int]:
    """Return the positions of names in a sequence."""
    place = {name: k for k, name in enumerate(among)}
    return [place[name] for name in names]
