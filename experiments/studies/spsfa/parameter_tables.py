"""Tables of the parameter studies of the SPSFA paper: its tables 12 and 13, and one for T_low.

The SPSFA paper prints running times only, and for T_low only a figure. Its times are MATLAB's on a laptop.
Ratios to the printed setting can be compared: its ratio of times beside ours of evaluations and of times.
"""

import numpy as np

from experiments.runs.outcomes import Outcomes, RunNumbers
from experiments.runs.suite import Suite
from experiments.statistics import ratio_interval, summarise
from experiments.studies.spsfa.suites import PARAMETER_STUDIES, SCENARIO, ParameterStudy
from experiments.tables.cell import MISSING, Cell, Entry, interval_cell, number, share
from experiments.tables.table import Table
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE


def parameter_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table for each parameter that the suite has the printed setting and another value of."""
    return [
        _table(study, {value: outcomes.of(controller, SCENARIO) for value, controller in compared.items()})
        for study in PARAMETER_STUDIES
        if (compared := study.compared(suite.controllers))
    ]


def _table(study: ParameterStudy, runs: dict[float, RunNumbers]) -> Table:
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


def _value(study: ParameterStudy, value: float) -> Entry:
    return Cell.of("**{value:g}**" if value == study.printed else "{value:g}", value=value)


def _cells(study: ParameterStudy, value: float, runs: RunNumbers, unit: RunNumbers) -> tuple[Entry, ...]:
    ours = summarise(runs.fitness)
    feasible = np.mean(runs.collision <= FEASIBILITY_TOLERANCE)
    ratio_ends = ratio_interval(runs.evaluations, unit.evaluations)
    published = study.seconds.get(value)
    return (
        number(ours.mean),
        number(ours.deviation),
        interval_cell(ours.interval),
        number(ours.median),
        share(feasible, ".0f"),
        number(np.median(runs.collision), ".2g"),
        number(runs.evaluations.mean(), ",.0f"),
        number(runs.evaluations.mean() / unit.evaluations.mean(), ".2f"),
        MISSING if runs is unit else interval_cell(ratio_ends, ".2f"),
        number(runs.seconds.mean(), ".4f"),
        number(runs.seconds.mean() / unit.seconds.mean(), ".2f"),
        number(published, ".4f"),
        number(published / study.seconds[study.printed] if published else None, ".2f"),
    )
