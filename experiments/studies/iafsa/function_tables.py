"""Mean final values on the test functions of the IAFSA paper, ours beside its own.

All optima are 0, so that a fitness is how far a run ends above it. Runs of two optimizers on one function are
independent and spread over many powers of ten: Mann-Whitney's U is what compares them. On shifted functions
runs are paired, by the place of the optimum: Wilcoxon's signed-rank test.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from experiments.runs.entrants import Entrant, entrant
from experiments.runs.groups import scenario_sets
from experiments.runs.labels import OPTIMIZER_LABELS
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import compare, holm, mean_interval, rank_sum
from experiments.studies.iafsa.published import DIMENSIONS, ITERATIONS, MEAN_BEST
from experiments.tables.claims import Claim, claims_table, yes
from experiments.tables.table import Table

AFSA, IAFSA = "fish-swarm", "improved-fish-swarm"
# Runs that the paper's table 2 is over; its table 3 is over more.
MEAN_RUNS = 50
# How far AFSA may be from the paper's means where nothing but settings that are not printed differs.
NEAR_PAPER = 20.0


class Function(NamedTuple):
    """A test function by the set of its scenarios, `function:booth-2`, or `function:booth-2-shifted`."""

    key: str
    dimension: int

    @classmethod
    def of(cls, scenario_set: str) -> "Function":
        """The function of a set of scenarios."""
        match = re.fullmatch(r"function:([a-z-]+)-([0-9]+)(?:-shifted)?", scenario_set)
        if not match:
            raise ValueError(f"scenarios {scenario_set!r}: expected function:<name>-<dimension>[-shifted]")
        return cls(match[1], int(match[2]))

    @property
    def label(self) -> str:
        """As tables print it."""
        return f"{self.key.replace('-', ' ').capitalize()}, {self.dimension}-D"

    @property
    def is_printed(self) -> bool:
        """Whether the paper states this dimension."""
        return DIMENSIONS.get(self.key) == self.dimension


@dataclass(frozen=True)
class Duel:
    """AFSA and IAFSA on one function, in as many iterations.

    Attributes:
        function: which one.
        iterations: T of both.
        fitness: (runs,) by optimizer.
        evaluations: mean of the runs by optimizer.
        p_value: that both are alike; not yet corrected.
    """

    function: Function
    iterations: int
    fitness: dict[str, Floats]
    evaluations: dict[str, float]
    p_value: float

    @property
    def case(self) -> str:
        """What claims call it."""
        return f"{self.function.label} at {self.iterations}"

    @property
    def improves(self) -> bool:
        """Whether IAFSA's mean is below AFSA's."""
        return bool(self.fitness[IAFSA].mean() < self.fitness[AFSA].mean())

    def against_paper(self, optimizer: str) -> float:
        """The mean over the paper's; NaN where that has none."""
        printed = MEAN_BEST.get((self.function.key, optimizer, self.iterations), np.nan)
        return float(self.fitness[optimizer].mean() / printed)


def function_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Means (table 2), and what they say about dimensions."""
    duels = find_duels(suite, outcomes, paired=False)
    adjusted = holm([duel.p_value for duel in duels])
    rows = [
        (
            *_result_cells(duel, p),
            *(_printed(duel, optimizer) for optimizer in (AFSA, IAFSA)),
            *(f"{duel.against_paper(optimizer):.2g}" for optimizer in (AFSA, IAFSA)),
        )
        for duel, p in zip(duels, adjusted, strict=True)
    ]
    return [
        claims_table(
            "iafsa-functions-claims",
            "What is said of mean final values on the paper's functions, and where it does not hold",
            _function_claims(duels),
        ),
        Table(
            "iafsa-functions",
            f"Table 2. Mean final value [95 % interval] of {_runs(duels)} runs, optimum 0; p of "
            "Mann-Whitney's U test, two-sided, Holm-corrected over the table; mean evaluations; the paper's "
            "means, and ours in units of them. The paper states 10-D for Rastrigin and Sum squares",
            (*RESULT_COLUMNS, "paper AFSA", "paper IAFSA", "AFSA / paper", "IAFSA / paper"),
            rows,
        ),
        _dimensions_table(duels),
    ]


def shifted_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """The same on functions whose optimum is elsewhere in each run."""
    duels = find_duels(suite, outcomes, paired=True)
    adjusted = holm([duel.p_value for duel in duels])
    return [
        claims_table(
            "iafsa-shifted-claims",
            "What is said of the shifted functions, and where it does not hold",
            [Claim("IAFSA's mean is below AFSA's", {duel.case: duel.improves for duel in duels})],
        ),
        Table(
            "iafsa-shifted",
            f"Mean final value [95 % interval] of {_runs(duels)} runs, each with the optimum, 0, at another "
            "place; p of Wilcoxon's signed-rank test, two-sided, Holm-corrected over the table; mean "
            "evaluations",
            RESULT_COLUMNS,
            [_result_cells(duel, p) for duel, p in zip(duels, adjusted, strict=True)],
        ),
    ]


RESULT_COLUMNS = (
    "function", "iterations", "AFSA", "IAFSA", "IAFSA below AFSA", "p", "AFSA evaluations",
    "IAFSA evaluations",
)  # fmt: skip


def find_duels(suite: Suite, outcomes: Outcomes, paired: bool) -> list[Duel]:
    """Every function and number of iterations that both optimizers have runs of, in the suite's order."""
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
            found.append(Duel(function, iterations, fitness, evaluations, p))
    return found


def find_entrants(suite: Suite) -> dict[tuple[str, int], str]:
    """Names of what the suite runs, by optimizer and number of iterations."""
    parsed: dict[str, Entrant] = {name: entrant(name, suite.optimizer) for name in suite.controllers}
    return {(c.optimizer, c.iterations): name for name, c in parsed.items() if c.iterations is not None}


def _first(samples: Iterable[Floats]) -> Floats:
    return np.concatenate(list(samples))[:MEAN_RUNS]


def _runs(duels: list[Duel]) -> int:
    return max((len(duel.fitness[AFSA]) for duel in duels), default=0)


def _result_cells(duel: Duel, p_value: float) -> tuple[str, ...]:
    return (
        duel.function.label,
        str(duel.iterations),
        *(_mean(duel.fitness[optimizer]) for optimizer in (AFSA, IAFSA)),
        yes(duel.improves),
        f"{p_value:.1g}",
        *(f"{duel.evaluations[optimizer]:,.0f}" for optimizer in (AFSA, IAFSA)),
    )


def _mean(values: Floats) -> str:
    low, high = mean_interval(values)
    return f"{values.mean():.2g} [{low:.2g}, {high:.2g}]"


def _printed(duel: Duel, optimizer: str) -> str:
    value = MEAN_BEST.get((duel.function.key, optimizer, duel.iterations))
    return "–" if value is None else f"{value:.2g}"


def _function_claims(duels: list[Duel]) -> list[Claim]:
    printed = [duel for duel in duels if duel.function.is_printed]
    plane = [duel for duel in printed if duel.function.dimension == 2]
    groups = {
        "the functions stated as 2-D": plane,
        "those stated as 10-D": [duel for duel in printed if duel not in plane],
        "these in 2-D instead": [duel for duel in duels if duel not in printed],
    }
    return [
        *(
            Claim(f"IAFSA's mean is below AFSA's, {text}", {d.case: d.improves for d in of})
            for text, of in groups.items()
        ),
        *(
            Claim(f"IAFSA's mean is no larger than the paper's, {text}", _no_larger(of))
            for text, of in groups.items()
        ),
        *(
            Claim(f"AFSA's mean is within a factor of {NEAR_PAPER:g} of the paper's, {text}", _near(of))
            for text, of in groups.items()
        ),
    ]


def _no_larger(duels: list[Duel]) -> dict[str, bool]:
    return {duel.case: duel.against_paper(IAFSA) <= 1.0 for duel in duels}


def _near(duels: list[Duel]) -> dict[str, bool]:
    return {duel.case: 1.0 / NEAR_PAPER <= duel.against_paper(AFSA) <= NEAR_PAPER for duel in duels}


def _dimensions_table(duels: list[Duel]) -> Table:
    rows = [
        (
            duel.function.label,
            str(duel.iterations),
            OPTIMIZER_LABELS[optimizer],
            f"{duel.fitness[optimizer].min():.2g}",
            f"{duel.fitness[optimizer].mean():.2g}",
            _printed(duel, optimizer),
            f"{duel.fitness[optimizer].min() / MEAN_BEST[duel.function.key, optimizer, duel.iterations]:.2g}",
            f"{duel.against_paper(optimizer):.2g}",
        )
        for optimizer in (AFSA, IAFSA)
        for duel in sorted(duels, key=lambda duel: duel.function.key)
        if DIMENSIONS[duel.function.key] > 2
    ]
    return Table(
        "iafsa-dimensions",
        "The functions that the paper states as 10-D, in 10 and in 2 dimensions: best and mean final value "
        "of our runs beside the mean that is printed",
        ("function", "iterations", "method", "best run", "mean", "paper", "best run / paper", "mean / paper"),
        rows,
    )
