"""The table of CMA-ES under control on BBOB's functions, in dimensions of the trainings and in others."""

from collections.abc import Mapping

import numpy as np

from experiments.studies.strong.entrants import WITHOUT_SIGHT
from experiments.studies.strong.grounds import (
    COMPARED,
    EVALUATIONS_PER_DIMENSION,
    INSTANCES,
    NUM_FUNCTIONS,
    OTHERS,
)
from experiments.studies.strong.measured_gaps import Floats, Measured
from experiments.studies.strong.tables_of_gaps import difference, mean
from experiments.tables import Table
from experiments.tables.cell import MISSING, Entry, number
from swarm_gym.reward import LEAST_GAP

CONSTANT, SCHEDULE = "CMA-ES, constant tuned", "CMA-ES, schedule tuned"  # blind rivals


def on_bbob(measured: Mapping[int, Mapping[str, Measured]]) -> Table:
    """Return the table; rows are in the order of the first dimension.

    Args:
        measured: gaps by dimension and by the name of the row.
    """
    names = list(measured[COMPARED[0]])
    final = {name: _logarithms([measured[d][name].final for d in COMPARED]) for name in names}
    anytime = {name: np.concatenate([measured[d][name].anytime for d in COMPARED], axis=1) for name in names}
    rows = []
    for name in names:
        row: dict[str, Entry] = {
            "row": name,
            "at the end": mean(final[name], len(INSTANCES)),
            "minus the tuned constant": difference(final, name, CONSTANT, len(INSTANCES)),
            "minus the tuned schedule": difference(final, name, SCHEDULE, len(INSTANCES)),
            "minus itself blinded": difference(final, name, f"{name}{WITHOUT_SIGHT}", len(INSTANCES)),
            "anytime": mean(anytime[name], len(INSTANCES)),
            "anytime, minus the tuned constant": difference(anytime, name, CONSTANT, len(INSTANCES)),
            "anytime, minus the tuned schedule": difference(anytime, name, SCHEDULE, len(INSTANCES)),
            "anytime, minus itself blinded": difference(
                anytime, name, f"{name}{WITHOUT_SIGHT}", len(INSTANCES)
            ),
        }
        for dimension in OTHERS:
            row[f"at the end, {dimension} dimensions"] = _in_dimension(measured[dimension].get(name))
        rows.append(row)
    runs = next(iter(measured[COMPARED[0]].values())).final.shape[2]
    dimensions = f"{', '.join(map(str, COMPARED[:-1]))} and {COMPARED[-1]} dimensions"
    caption = (
        f"CMA-ES on the {NUM_FUNCTIONS} functions of BBOB, {len(INSTANCES)} instances that nothing was "
        f"trained on, {runs} runs on each, {EVALUATIONS_PER_DIMENSION:,} evaluations for each dimension. "
        "Mean log10 of the gap, at least 1e-8, at the end and over all evaluations (anytime), over "
        f"{dimensions}, and its differences to rivals that see nothing [95 % interval over training seeds, "
        "instances and runs; functions are given]; last in other dimensions, for some rows and fewer runs. "
        "Lower is closer"
    )
    return Table.of("on-bbob", caption, rows)


def _in_dimension(row: Measured | None) -> Entry:
    return MISSING if row is None else number(_logarithms([row.final]).mean(), ".2f")


def _logarithms(gaps: list[Floats]) -> Floats:
    return np.log10(np.maximum(np.concatenate(gaps, axis=1), LEAST_GAP))
