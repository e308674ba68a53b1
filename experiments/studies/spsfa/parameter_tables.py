"""Tables of the parameter studies, from stored runs: the paper's tables 12 and 13, and one of T_low.

The paper prints running times only, and of T_low only a figure. Its times are MATLAB's on a laptop, so what
can be compared are ratios to the printed setting: its ratio of times beside ours of evaluations and of times.
"""

import numpy as np

from experiments.runs.outcomes import Outcomes, RunNumbers
from experiments.runs.suite import Suite
from experiments.statistics import ratio_interval, summarise
from experiments.studies.spsfa.parameters import SCENARIO, STUDIES, Study
from experiments.tables.table import Table
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE


def parameter_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """One table for each parameter of which the suite has the printed setting and another value."""
    return [
        _table(study, {value: outcomes.of(controller, SCENARIO) for value, controller in compared.items()})
        for study in STUDIES
        if (compared := study.compared(suite.controllers))
    ]


def _table(study: Study, runs: dict[float, RunNumbers]) -> Table:
    unit = runs[study.printed]
    number = f"{study.table:02}-" if study.table else ""
    title = f"Table {study.table}. " if study.table else ""
    source = "" if study.seconds else "; the paper prints no numbers"
    return Table(
        f"table-{number}parameter-{study.parameter.replace('_', '-')}",
        f"{title}SPSFA-TIP on {SCENARIO} by {study.symbol} (`{study.parameter}`), {len(unit.fitness)} runs "
        f"each; ratios to the printed setting, {study.symbol} = {study.printed:g}{source}",
        (
            study.symbol, "mean fitness", "std", "95 % interval of the mean", "median", "feasible",
            "median collision", "mean evaluations", "evaluations ratio", "95 % interval of the ratio",
            "mean seconds", "seconds ratio", "paper seconds", "paper ratio",
        ),
        [(_value(study, value), *_cells(study, value, of, unit)) for value, of in runs.items()],
    )  # fmt: skip


def _value(study: Study, value: float) -> str:
    return f"**{value:g}**" if value == study.printed else f"{value:g}"


def _cells(study: Study, value: float, runs: RunNumbers, unit: RunNumbers) -> tuple[str, ...]:
    ours = summarise(runs.fitness)
    feasible = np.mean(runs.collision <= FEASIBILITY_TOLERANCE)
    low, high = ratio_interval(runs.evaluations, unit.evaluations)
    printed = study.seconds.get(value)
    return (
        f"{ours.mean:.1f}",
        f"{ours.deviation:.1f}",
        f"{ours.interval[0]:.1f} to {ours.interval[1]:.1f}",
        f"{ours.median:.1f}",
        f"{100 * feasible:.0f} %",
        f"{np.median(runs.collision):.2g}",
        f"{runs.evaluations.mean():,.0f}",
        f"{runs.evaluations.mean() / unit.evaluations.mean():.2f}",
        "–" if runs is unit else f"{low:.2f} to {high:.2f}",
        f"{runs.seconds.mean():.4f}",
        f"{runs.seconds.mean() / unit.seconds.mean():.2f}",
        f"{printed:.4f}" if printed else "–",
        f"{printed / study.seconds[study.printed]:.2f}" if printed else "–",
    )
