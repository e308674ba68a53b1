"""Mean final values on the test functions of the IAFSA paper, ours beside its own.

All optima are 0, so that a fitness is how far a run ends above it. Runs of two optimizers on one function are
independent and spread over many powers of ten: Mann-Whitney's U test compares them. On shifted functions,
runs are paired by the place of the optimum: Wilcoxon's signed-rank test compares them.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from experiments.runs.groups import scenario_sets
from experiments.runs.labels import OPTIMIZER_LABELS
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import compare, holm, rank_sum
from experiments.studies.iafsa.published import AFSA, DIMENSIONS, IAFSA, ITERATIONS, MEAN_BEST, Function
from experiments.tables.cell import Entry, mean_cell, number, verdict
from experiments.tables.table import Table
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

    def over_published(self, optimizer: str) -> float:
        """Return the mean over the published one; NaN if the IAFSA paper has none."""
        published = MEAN_BEST.get((self.function.key, optimizer, self.iterations), np.nan)
        return float(self.fitness[optimizer].mean() / published)


def function_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return the means (table 2), and a table about dimensions."""
    comparisons = find_comparisons(suite, outcomes, paired=False)
    adjusted = holm([compared.p_value for compared in comparisons])
    rows = [
        (
            *_result_cells(compared, p),
            *(_published(compared, optimizer) for optimizer in (AFSA, IAFSA)),
            *(number(compared.over_published(optimizer), ".2g") for optimizer in (AFSA, IAFSA)),
        )
        for compared, p in zip(comparisons, adjusted, strict=True)
    ]
    return [
        Table(
            "iafsa-functions",
            f"Table 2. Mean final value [95 % interval] of {_runs(comparisons)} runs, optimum 0; p of "
            "Mann-Whitney's U test, two-sided, Holm-corrected over the table; mean evaluations; the paper's "
            "means, and ours in units of them. The paper states 10-D for Rastrigin and Sum squares",
            (*RESULT_COLUMNS, "paper AFSA", "paper IAFSA", "AFSA / paper", "IAFSA / paper"),
            rows,
        ),
        _dimensions_table(comparisons),
    ]


def shifted_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return means for functions whose optimum is at another place in each run."""
    comparisons = find_comparisons(suite, outcomes, paired=True)
    adjusted = holm([compared.p_value for compared in comparisons])
    return [
        Table(
            "iafsa-shifted",
            f"Mean final value [95 % interval] of {_runs(comparisons)} runs, each with the optimum, 0, at "
            "another place; p of Wilcoxon's signed-rank test, two-sided, Holm-corrected over the table; mean "
            "evaluations",
            RESULT_COLUMNS,
            [_result_cells(compared, p) for compared, p in zip(comparisons, adjusted, strict=True)],
        ),
    ]


RESULT_COLUMNS = (
    "function", "iterations", "AFSA", "IAFSA", "IAFSA below AFSA", "p", "AFSA evaluations",
    "IAFSA evaluations",
)  # fmt: skip


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


def _result_cells(compared: SwarmComparison, p_value: float) -> tuple[Entry, ...]:
    return (
        compared.function.label,
        number(compared.iterations, "d"),
        *(mean_cell(compared.fitness[optimizer], ".2g") for optimizer in (AFSA, IAFSA)),
        verdict(compared.improves),
        number(p_value, ".1g"),
        *(number(compared.evaluations[optimizer], ",.0f") for optimizer in (AFSA, IAFSA)),
    )


def _published(compared: SwarmComparison, optimizer: str) -> Entry:
    return number(MEAN_BEST.get((compared.function.key, optimizer, compared.iterations)), ".2g")


def _best_over_published(compared: SwarmComparison, optimizer: str) -> float:
    published = MEAN_BEST[compared.function.key, optimizer, compared.iterations]
    return float(compared.fitness[optimizer].min() / published)


def _dimensions_table(comparisons: list[SwarmComparison]) -> Table:
    rows = [
        (
            compared.function.label,
            number(compared.iterations, "d"),
            OPTIMIZER_LABELS[optimizer],
            number(compared.fitness[optimizer].min(), ".2g"),
            number(compared.fitness[optimizer].mean(), ".2g"),
            _published(compared, optimizer),
            number(_best_over_published(compared, optimizer), ".2g"),
            number(compared.over_published(optimizer), ".2g"),
        )
        for optimizer in (AFSA, IAFSA)
        for compared in sorted(comparisons, key=lambda compared: compared.function.key)
        if DIMENSIONS[compared.function.key] > 2
    ]
    return Table(
        "iafsa-dimensions",
        "The functions that the paper states as 10-D, in 10 and in 2 dimensions: best and mean final value "
        "of our runs beside the mean that is printed",
        ("function", "iterations", "method", "best run", "mean", "paper", "best run / paper", "mean / paper"),
        rows,
    )
