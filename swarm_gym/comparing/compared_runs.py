"""The runs of controllers on the same scenarios and seeds, their optima and their table."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from swarm_gym.comparing.bootstrap import Interval, draw, interval, means
from swarm_gym.errors import ScenarioError
from swarm_gym.reference import gap_to_optimum, known_optimum, quick_optima
from swarm_gym.reference.onemax.optima import COUNTINGS, least_evaluations
from swarm_gym.scenarios import GridScenario, OneMaxScenario, make_scenario
from swarm_gym.settings import Settings
from swarm_gym.worlds import make_problem

Floats = NDArray[np.float64]

MOST_COLUMNS = 6  # sets of scenarios that have a column each in the table
COLUMNS = ("controller", "scenario", "seed", "fitness", "gap", "collision", "evaluations")


@dataclass(frozen=True)
class ComparedRuns:
    """Numbers of the runs of controllers, arrays (controllers, scenarios, seeds).

    Attributes:
        controllers: names of the controllers, in the order of the first axis.
        sets: names of the scenarios of each set, by the name of the set; sets follow each other along the
            second axis.
        seeds: seeds of each scenario.
        fitness: best fitness of the run, in map units.
        collision: degree of collision of the best path; 0 is feasible.
        feasible: True where the best path is feasible.
        evaluations: number of calls of the cost function.
        optima: fitness of the optimum of each scenario, (scenarios,), NaN where it is unknown.
        least_evaluations: expected evaluations of the optimal control of each scenario, (scenarios,), NaN
            where unknown, if runs are measured by their evaluations until a target, as on bit strings. None
            if they are measured by their fitness.
    """

    controllers: tuple[str, ...]
    sets: dict[str, tuple[str, ...]]
    seeds: tuple[int, ...]
    fitness: Floats
    collision: Floats
    feasible: NDArray[np.bool_]
    evaluations: Floats
    optima: Floats
    least_evaluations: Floats | None = None

    @property
    def scenarios(self) -> tuple[str, ...]:
        """Names of the scenarios, in the order of the second axis."""
        return tuple(name for names in self.sets.values() for name in names)

    @cached_property
    def gap(self) -> Floats:
        """Optimality gap, (fitness - optimum) / optimum; NaN where the optimum is unknown.

        Where runs are measured by their evaluations, these are compared, and the gap of an unsolved run is
        infinite.
        """
        if self.least_evaluations is not None:
            above = gap_to_optimum(self.evaluations, self.least_evaluations[:, None])
            return np.where(self.solved | np.isnan(above), above, np.inf)
        return gap_to_optimum(self.fitness, self.optima[:, None])

    @property
    def solved(self) -> NDArray[np.bool_]:
        """True for runs whose fitness is 0, which is the target of bit strings."""
        return self.fitness == 0.0

    def objective(self, price: float = 1.0) -> Floats:
        """Return the gap in per cent plus the price times evaluations / 100,000 of every run.

        Raises:
            ScenarioError: if the optimum of a scenario is unknown.
        """
        refuse_unknown_optima(self.scenarios, self.optima)
        return 100.0 * self.gap + price * self.evaluations / 100_000.0

    def mean(self, values: Floats) -> list[tuple[float, Interval]]:
        """Return the mean of each controller and its 95 % bootstrap interval over scenarios and seeds.

        Args:
            values: a number of every run, e.g. `objective()`.
        """
        return [_mean(of_one, self._set_sizes) for of_one in values]

    def difference(self, values: Floats) -> list[tuple[float, Interval]]:
        """Return the mean of each controller minus the mean of the first, paired by scenario and seed.

        Args:
            values: a number of every run, e.g. `objective()`.
        """
        return self.mean(values - values[0])

    def table(self, price: float = 1.0) -> str:
        """Return a table as text, a row for each controller.

        Scenarios whose optimum is unknown have no gap, so that fitness takes the place of the objective. On
        bit strings, evaluations do, and no price is needed.

        Args:
            price: price of 100,000 evaluations, in per cent of the optimum.
        """
        if self.least_evaluations is not None:
            return "\n".join(aligned(self._rows_of_evaluations()))
        known = not np.isnan(self.optima).any()
        judged = self.objective(price) if known else self.fitness
        said = f"objective at price {price:g}" if known else "best fitness"
        names = list(self.sets) if 1 < len(self.sets) <= MOST_COLUMNS else []
        rows = [("controller", said, f"minus {self.controllers[0]}", "feasible", "evaluations", *names)]
        means_and_differences = zip(self.mean(judged), self.difference(judged), strict=True)
        for k, (mean, difference) in enumerate(means_and_differences):
            rows.append(
                (
                    self.controllers[k],
                    _in_interval(*mean, ".3f"),
                    _in_interval(*difference, "+.3f") if k else "",
                    f"{100.0 * self.feasible[k].mean():.0f} %",
                    f"{self.evaluations[k].mean():,.0f}",
                    *(self._of_set(k, name, known) for name in names),
                )
            )
        return "\n".join(aligned(rows))

    def _rows_of_evaluations(self) -> list[tuple[str, ...]]:
        """Return the rows of a table of evaluations until the target, the head first."""
        names = list(self.sets) if 1 < len(self.sets) <= MOST_COLUMNS else []
        heads = ("evaluations", f"minus {self.controllers[0]}", "above the optimum", "solved")
        rows: list[tuple[str, ...]] = [("controller", *heads, *names)]
        means_and_differences = zip(
            self.mean(self.evaluations), self.difference(self.evaluations), strict=True
        )
        for k, (mean, difference) in enumerate(means_and_differences):
            above = "unknown"
            if np.isfinite(self.gap[k]).all():
                above = f"{_in_interval(*_mean(100.0 * self.gap[k], self._set_sizes), '+.2f')} %"
            rows.append(
                (
                    self.controllers[k],
                    _in_interval(*mean, ",.1f"),
                    _in_interval(*difference, "+,.1f") if k else "",
                    above,
                    f"{100.0 * self.solved[k].mean():.0f} %",
                    *(f"{self.evaluations[k, self._places(name)].mean():,.1f}" for name in names),
                )
            )
        return rows

    def as_csv(self) -> str:
        """Return all runs as CSV, one in each line, with the columns `COLUMNS`."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(COLUMNS)
        for k, j, i in np.ndindex(*self.fitness.shape):
            numbers = (array[k, j, i] for array in (self.fitness, self.gap, self.collision, self.evaluations))
            names = self.controllers[k], self.scenarios[j], self.seeds[i]
            writer.writerow((*names, *(repr(float(number)) for number in numbers)))
        return text.getvalue()

    @property
    def _set_sizes(self) -> tuple[int, ...]:
        return tuple(map(len, self.sets.values()))

    def _places(self, name: str) -> list[int]:
        """Return the positions of the scenarios of a set along the second axis."""
        return [self.scenarios.index(scenario) for scenario in self.sets[name]]

    def _of_set(self, controller: int, name: str, known: bool) -> str:
        """Return the mean gap, or fitness, of a controller on a set of scenarios, and its evaluations."""
        places = self._places(name)
        cost = f"at {self.evaluations[controller, places].mean() / 1000.0:.0f}k"
        if known:
            return f"{100.0 * self.gap[controller, places].mean():.2f} % {cost}"
        return f"{self.fitness[controller, places].mean():.2f} {cost}"

    def __str__(self) -> str:
        return self.table()


def optima_of(scenarios: Sequence[str], options: Mapping[str, object]) -> Floats:
    """Return the fitness of the optimum of each scenario, (scenarios,), nan where it is unknown.

    Unknown ones of grid maps are computed if that is quick.

    Args:
        scenarios: names of the scenarios.
        options: options of their environments.
    """
    # Without parameters of optimizers. An entrant may have episodes of its own length, and whether a budget
    # holds the first population depends on the controller.
    names = {one.name for one in fields(Settings)} - {"max_evaluations", "iterations"}
    known = {name: value for name, value in options.items() if name in names}
    problems = [make_problem(name, **known) for name in scenarios]
    found = np.array([known_optimum(problem) for problem in problems])
    on_grids = [isinstance(problem.scenario, GridScenario) for problem in problems]
    unknown = np.flatnonzero(np.isnan(found) & on_grids)
    if unknown.size:
        found[unknown] = quick_optima([problems[number] for number in unknown])
    return found


def least_evaluations_of(scenarios: Sequence[str], options: Mapping[str, object]) -> Floats | None:
    """Return the expected evaluations of the optimal control of lambda, (scenarios,), for bit strings.

    The entry of a length whose optimum does not ship is NaN.

    Args:
        scenarios: names of the scenarios.
        options: options of their environments; `counting` says which evaluations count.

    Returns:
        The evaluations, or None if the scenarios are no bit strings.
    """
    made = [make_scenario(name) for name in scenarios]
    strings = [one for one in made if isinstance(one, OneMaxScenario)]
    if len(strings) < len(made):
        return None
    counting = str(options.get("counting", COUNTINGS[0]))
    return np.array([least_evaluations(one, counting) for one in strings])


def refuse_unknown_optima(scenarios: Sequence[str], optima: Floats) -> None:
    """Raise an error if an optimum is unknown.

    Raises:
        ScenarioError: naming the first of these scenarios.
    """
    unknown = [name for name, optimum in zip(scenarios, optima, strict=True) if np.isnan(optimum)]
    if unknown:
        raise ScenarioError(
            f"gaps need the optimum, which is not known for {len(unknown)} of {len(optima)} scenarios, "
            f"the first of them {unknown[0]}"
        )


def _mean(values: Floats, set_sizes: tuple[int, ...]) -> tuple[float, Interval]:
    """Return the mean of values (scenarios, seeds) and its interval; each set of scenarios is a stratum."""
    return float(values.mean()), interval(means(values[None], draw(1, set_sizes, values.shape[1])))


def _in_interval(mean: float, ends: Interval, form: str) -> str:
    low, high = ends
    return f"{mean:{form}} [{low:{form}}, {high:{form}}]"


def aligned(rows: Sequence[Sequence[str]]) -> Iterable[str]:
    """Yield the rows of a table as lines; the first column is aligned to the left, others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for first, *others in rows:
        cells = [first.ljust(widths[0])]
        cells += [cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True)]
        yield "  ".join(cells)
