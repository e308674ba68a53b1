"""Tables of the parameter studies, from stored runs: the paper's tables 12 and 13, and one of T_low.

The paper prints running times only, and of T_low only a figure. Its times are MATLAB's on a laptop, so what
can be compared are ratios to the printed setting: its ratio of times beside ours of evaluations and of times.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from experiments.parameter_study import SCENARIO, STUDIES, Study
from experiments.results import Results, ResultsError, Run
from experiments.statistics import CONFIDENCE, RESAMPLES, summarise
from experiments.suites import Suite
from experiments.tables import Table
from swarm_gym.problem.cost import FEASIBILITY_TOLERANCE

Floats = NDArray[np.float64]


def parameter_tables(suite: Suite, results: Results) -> list[Table]:
    """One table for each parameter of which the suite has the printed setting and another value.

    Raises:
        ResultsError: if a run of the suite is missing, or there is nothing to compare.
    """
    tables = []
    for study in STUDIES:
        runs = study.load(suite.controllers, results, suite.num_seeds)
        asked = [value for value in study.values if study.controller(value) in suite.controllers]
        for value in asked:
            number = len(runs.get(value, ()))
            if number < suite.num_seeds:
                raise ResultsError(
                    f"{results.path}: {study.controller(value)} on {SCENARIO} has {number} of "
                    f"{suite.num_seeds} runs"
                )
        if study.printed in asked and len(asked) > 1:
            tables.append(_table(study, runs, suite.num_seeds))
    if not tables:
        raise ResultsError(f"suite {suite.name} has no parameter with the printed setting and another value")
    return tables


def ratio_interval(values: Floats, unit: Floats) -> tuple[float, float]:
    """95 % bootstrap interval (percentile) of the ratio of two means over the same seeds; seeded."""
    if np.array_equal(values, unit):
        return 1.0, 1.0
    found = stats.bootstrap(
        (values, unit),
        lambda x, y, axis: x.mean(axis=axis) / y.mean(axis=axis),
        paired=True,
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(0),
        batch=1000,
    )
    return float(found.confidence_interval.low), float(found.confidence_interval.high)


def evaluations(runs: list[Run]) -> Floats:
    """Shape (runs,)."""
    return np.array([run.evaluations for run in runs], dtype=np.float64)


def seconds(runs: list[Run]) -> Floats:
    """Shape (runs,): processor time."""
    return np.array([run.seconds for run in runs])


def fitness(runs: list[Run]) -> Floats:
    """Shape (runs,): best of each run."""
    return np.array([run.final_fitness for run in runs])


def _table(study: Study, runs: dict[float, list[Run]], num_seeds: int) -> Table:
    unit = runs[study.printed]
    rows = [(_value(study, value), *_cells(study, value, group, unit)) for value, group in runs.items()]
    number = f"{study.table:02}-" if study.table else ""
    title = f"Table {study.table}. " if study.table else ""
    source = "" if study.seconds else "; the paper prints no numbers"
    return Table(
        f"table-{number}parameter-{study.parameter.replace('_', '-')}",
        f"{title}SPSFA-TIP on {SCENARIO} by {study.symbol} (`{study.parameter}`), {num_seeds} runs each; "
        f"ratios to the printed setting, {study.symbol} = {study.printed:g}{source}",
        (
            study.symbol, "mean fitness", "std", "95 % interval of the mean", "median", "feasible",
            "median collision", "mean evaluations", "evaluations ratio", "95 % interval of the ratio",
            "mean seconds", "seconds ratio", "paper seconds", "paper ratio",
        ),
        rows,
    )  # fmt: skip


def _value(study: Study, value: float) -> str:
    return f"**{value:g}**" if value == study.printed else f"{value:g}"


def _cells(study: Study, value: float, runs: list[Run], unit: list[Run]) -> tuple[str, ...]:
    ours = summarise(fitness(runs))
    feasible = np.mean([run.final_collision <= FEASIBILITY_TOLERANCE for run in runs])
    low, high = ratio_interval(evaluations(runs), evaluations(unit))
    printed = study.seconds.get(value)
    return (
        f"{ours.mean:.1f}",
        f"{ours.deviation:.1f}",
        f"{ours.interval[0]:.1f} to {ours.interval[1]:.1f}",
        f"{ours.median:.1f}",
        f"{100 * feasible:.0f} %",
        f"{np.median([run.final_collision for run in runs]):.2g}",
        f"{evaluations(runs).mean():,.0f}",
        f"{evaluations(runs).mean() / evaluations(unit).mean():.2f}",
        "–" if runs is unit else f"{low:.2f} to {high:.2f}",
        f"{seconds(runs).mean():.4f}",
        f"{seconds(runs).mean() / seconds(unit).mean():.2f}",
        f"{printed:.4f}" if printed else "–",
        f"{printed / study.seconds[study.printed]:.2f}" if printed else "–",
    )
