"""Mean final values on the test functions of the IAFSA paper, ours beside its own.

All optima are 0, so that a fitness is how far a run ends above it. Runs of two optimizers on one function are
independent and spread over many powers of ten: Mann-Whitney's U test compares them. On shifted functions,
runs are paired by the place of the optimum: Wilcoxon's signed-rank test compares them.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from experiments.runs.groups import scenario_sets
from experiments.runs.labels import OPTIMIZER_LABELS
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import compare, holm, rank_sum
from experiments.studies.iafsa.published import AFSA, DIMENSIONS, IAFSA, ITERATIONS, MEAN_BEST, Function
from experiments.tables.cell import Entry, mean_cell, number, verdict
from experiments.tables.table import Row, Table
from swarm_gym.comparing.entrants import Entrant, entrant

# Number of runs in table 2 of the IAFSA paper; its table 3 has more.
MEAN_RUNS = 50


@dataclass(frozen=True)
class SwarmComparison:
    """AFSA and IAFSA on one function, in equally many iterations.

    Attributes:
        function: test function.
        iterations: iterations T of both.
        fitness: (runs,) final fitness by optimizer.
        evaluations: mean evaluations of the runs by optimizer.
        p_value: p of the hypothesis that both are alike; not yet corrected.
    """

    function: Function
    iterations: int
    fitness: dict[str, Floats]
    evaluations: dict[str, float]
    p_value: float

    @property
    def improves(self) -> bool:
        """True if IAFSA's mean is below AFSA's."""
        return bool(self.fitness[IAFSA].mean() < self.fitness[AFSA].mean())

    def over_published(self, optimizer: str, of: Callable[[Floats], float] = np.mean) -> float:
        """Return the mean, or another value of the runs, over the published mean; NaN if there is none."""
        published = MEAN_BEST.get((self.function.key, optimizer, self.iterations), np.nan)
        return float(of(self.fitness[optimizer]) / published)


def function_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return the means (table 2), and a table about dimensions."""
    comparisons = find_comparisons(suite, outcomes, paired=False)
    adjusted = holm([compared.p_value for compared in comparisons])
    rows = [
        {
            **_result_row(compared, p),
            "paper AFSA": _published(compared, AFSA),
            "paper IAFSA": _published(compared, IAFSA),
            "AFSA / paper": number(compared.over_published(AFSA), ".2g"),
            "IAFSA / paper": number(compared.over_published(IAFSA), ".2g"),
        }
        for compared, p in zip(comparisons, adjusted, strict=True)
    ]
    caption = (
        f"Table 2. Mean final value [95 % interval] of {_runs(comparisons)} runs, optimum 0; p of "
        "Mann-Whitney's U test, two-sided, Holm-corrected over the table; mean evaluations; the paper's "
        "means, and ours in units of them. The paper states 10-D for Rastrigin and Sum squares"
    )
    return [*Table.if_any("iafsa-functions", caption, rows), *_dimension_tables(comparisons)]


def shifted_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return means for functions whose optimum is at another place in each run."""
    comparisons = find_comparisons(suite, outcomes, paired=True)
    adjusted = holm([compared.p_value for compared in comparisons])
    caption = (
        f"Mean final value [95 % interval] of {_runs(comparisons)} runs, each with the optimum, 0, at "
        "another place; p of Wilcoxon's signed-rank test, two-sided, Holm-corrected over the table; mean "
        "evaluations"
    )
    rows = [_result_row(compared, p) for compared, p in zip(comparisons, adjusted, strict=True)]
    return Table.if_any("iafsa-shifted", caption, rows)


def find_comparisons(suite: Suite, outcomes: Outcomes, paired: bool) -> list[SwarmComparison]:
    """Return a comparison for each function and number of iterations that both optimizers have runs of.

    The order is that of the suite.
    """
    names = find_entrants(suite)
    found = []
    for scenario_set, scenarios in scenario_sets(suite.scenarios).items():
        function = Function.of(scenario_set)
        for iterations in ITERATIONS:
            both = {o: names[o, iterations] for o in (AFSA, IAFSA) if (o, iterations) in names}
            if len(both) < 2:
                continue
            fitness, evaluations = {}, {}
            for optimizer, name in both.items():
                runs = [outcomes.of(name, scenario) for scenario in scenarios]
                fitness[optimizer] = _first(run.fitness for run in runs)
                evaluations[optimizer] = float(_first(run.evaluations for run in runs).mean())
            p = (
                compare(fitness[IAFSA], fitness[AFSA]).p_value
                if paired
                else rank_sum(fitness[IAFSA], fitness[AFSA])
            )
            found.append(SwarmComparison(function, iterations, fitness, evaluations, p))
    return found


def find_entrants(suite: Suite) -> dict[tuple[str, int], str]:
    """Return the names of the entrants of a suite, by optimizer and number of iterations."""
    parsed: dict[str, Entrant] = {name: entrant(name, suite.optimizer) for name in suite.controllers}
    return {(c.optimizer, c.iterations): name for name, c in parsed.items() if c.iterations is not None}


def _first(samples: Iterable[Floats]) -> Floats:
    return np.concatenate(list(samples))[:MEAN_RUNS]


def _runs(comparisons: list[SwarmComparison]) -> int:
    return max((len(compared.fitness[AFSA]) for compared in comparisons), default=0)


def _result_row(compared: SwarmComparison, p_value: float) -> Row:
    return {
        "function": compared.function.label,
        "iterations": number(compared.iterations, "d"),
        "AFSA": mean_cell(compared.fitness[AFSA], ".2g"),
        "IAFSA": mean_cell(compared.fitness[IAFSA], ".2g"),
        "IAFSA below AFSA": verdict(compared.improves),
        "p": number(p_value, ".1g"),
        "AFSA evaluations": number(compared.evaluations[AFSA], ",.0f"),
        "IAFSA evaluations": number(compared.evaluations[IAFSA], ",.0f"),
    }


def _published(compared: SwarmComparison, optimizer: str) -> Entry:
    return number(MEAN_BEST.get((compared.function.key, optimizer, compared.iterations)), ".2g")


def _dimension_tables(comparisons: list[SwarmComparison]) -> list[Table]:
    rows: list[Row] = [
        {
            "function": compared.function.label,
            "iterations": number(compared.iterations, "d"),
            "method": OPTIMIZER_LABELS[optimizer],
            "best run": number(compared.fitness[optimizer].min(), ".2g"),
            "mean": number(compared.fitness[optimizer].mean(), ".2g"),
            "paper": _published(compared, optimizer),
            "best run / paper": number(compared.over_published(optimizer, np.min), ".2g"),
            "mean / paper": number(compared.over_published(optimizer), ".2g"),
        }
        for optimizer in (AFSA, IAFSA)
        for compared in sorted(comparisons, key=lambda compared: compared.function.key)
        if DIMENSIONS[compared.function.key] > 2
    ]
    caption = (
        "The functions that the paper states as 10-D, in 10 and in 2 dimensions: best and mean final value "
        "of our runs beside the mean that is printed"
    )
    return Table.if_any("iafsa-dimensions", caption, rows)
