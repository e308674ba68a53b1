"""Tables of the parameter studies of the SPSFA paper: its tables 12 and 13, and one for T_low.

The SPSFA paper prints running times only, and for T_low only a figure. Its times are MATLAB's on a laptop.
Ratios to the printed setting can be compared: its ratio of times beside ours of evaluations and of times.
"""

import numpy as np

from experiments.runs.outcomes import Outcomes, RunNumbers
from experiments.runs.suite import Suite
from experiments.statistics import ratio_interval, summarise
from experiments.studies.spsfa.suites import PARAMETER_STUDIES, SCENARIO, ParameterStudy
from experiments.tables.cell import MISSING, Cell, interval_cell, number, share
from experiments.tables.table import Row, Table
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
    return Table.of(
        f"table-{number}parameter-{study.parameter.replace('_', '-')}",
        f"{title}SPSFA-TIP on {SCENARIO} by {study.symbol} (`{study.parameter}`), {len(unit.fitness)} runs "
        f"each; ratios to the printed setting, {study.symbol} = {study.printed:g}{source}",
        [_row(study, value, of, unit) for value, of in runs.items()],
    )


def _row(study: ParameterStudy, value: float, runs: RunNumbers, unit: RunNumbers) -> Row:
    ours = summarise(runs.fitness)
    printed = study.seconds.get(value)
    return {
        study.symbol: Cell.of("**{value:g}**" if value == study.printed else "{value:g}", value=value),
        "mean fitness": number(ours.mean),
        "std": number(ours.deviation),
        "95 % interval of the mean": interval_cell(ours.interval),
        "median": number(ours.median),
        "feasible": share(np.mean(runs.collision <= FEASIBILITY_TOLERANCE), ".0f"),
        "median collision": number(np.median(runs.collision), ".2g"),
        "mean evaluations": number(runs.evaluations.mean(), ",.0f"),
        "evaluations ratio": number(runs.evaluations.mean() / unit.evaluations.mean(), ".2f"),
        "95 % interval of the ratio": MISSING
        if runs is unit
        else interval_cell(ratio_interval(runs.evaluations, unit.evaluations), ".2f"),
        "mean seconds": number(runs.seconds.mean(), ".4f"),
        "seconds ratio": number(runs.seconds.mean() / unit.seconds.mean(), ".2f"),
        "paper seconds": number(printed, ".4f"),
        "paper ratio": number(printed / study.seconds[study.printed] if printed else None, ".2f"),
    }
