"""The table of controllers: policies, what they are without their eyes, and rivals that were not learned.

The objective is the mean of the logarithm of the cost, times 100, so that a difference of 1 is about one per
cent of the cost. Trainings maximise a logarithm, too. The rival is chosen on terrains for validation.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from experiments.studies.terrain.measured_costs import Asked, Floats
from experiments.studies.terrain.rows import ControlledRow, Row
from experiments.studies.terrain.tables_of_costs import excess_of
from experiments.tables import Table
from experiments.tables.cell import MISSING, Entry, number, number_in
from swarm_gym.comparing.bootstrap import draw, interval, means

MOST_GROUPS = 4  # of terrains with equally many threats that have columns of their own
# Rows of docs/terrain.md; its appendix has all.
IN_SHORT = (
    "L-SHADE, SPSFA-TIP, tuned", "L-SHADE, blind schedule, with sources", "L-SHADE, learned, size and phi",
    "L-SHADE, learned, with sources",
    "L-SHADE, SPSFA-TIP, tuned, shifted", "L-SHADE, blind schedule, with sources, shifted",
    "L-SHADE, learned, with sources, shifted", "L-SHADE, learned, blinded, with sources, shifted",
    "fireflies, constants, with sources", "fireflies, learned, with sources",
)  # fmt: skip


# Rows of docs/terrain-budgets.md after 20,000 evaluations; its appendix has all.
CONTROL_AFTER_20_000 = (
    "L-SHADE, linear reduction", "L-SHADE, SPSFA-TIP, tuned", "L-SHADE, learned, with sources",
    "L-SHADE, linear reduction, shifted", "L-SHADE, SPSFA-TIP, tuned, shifted",
    "L-SHADE, blind schedule, with sources, shifted", "L-SHADE, learned, with sources, shifted",
    "L-SHADE, learned, blinded, with sources, shifted",
    "fireflies, constants, with sources", "fireflies, learned, with sources",
)  # fmt: skip


def objective(costs: Floats) -> float:
    """Return the objective of costs of any shape."""
    return float(100.0 * np.log(costs).mean())


def table_of_control(
    rows: Sequence[ControlledRow | Row],
    measured: Mapping[str, Floats],
    rivals: Mapping[tuple[str, str], str],
    asked: Asked,
    best: Floats,
    threats: Sequence[int],
    terrains: str = "test terrains",
) -> Table:
    """Return the table.

    Args:
        rows: rows that have a line, those of one group together, if their group has a rival.
        measured: costs, (terrains, budgets, training seeds * runs), of these rows by name.
        rivals: name of the row of each group, an optimizer and an encoding, that others are compared with.
        asked: runs of each row; the controllers are compared after the first budget.
        best: (terrains,) costs that the excess is measured from.
        threats: (terrains,) number of threats; resamples keep how many terrains have equally many.
        terrains: words for them.
    """
    counts = sorted({*threats})
    strata = {f"excess, {count} threats": np.flatnonzero(np.equal(threats, count)) for count in counts}
    if len(counts) > MOST_GROUPS:
        strata = {"excess": np.arange(len(best))}
    lines = []
    for row in rows:
        costs = measured[row.name][:, 0]
        if row.group not in rivals:
            continue
        excess = excess_of(costs, best)
        rival = rivals[row.group]
        line: dict[str, Entry] = {
            "controller": row.controlled_name,
            "policies": number(len(row.controllers), ".0f") if row.is_learned else MISSING,
            **{name: number(excess[own].mean(), ".1f") for name, own in strata.items()},
            "median": number(np.median(excess), ".1f"),
            "objective minus that of the rival": MISSING,
        }
        if row.name != rival:
            policies = costs.reshape(len(costs), len(row.controllers), -1)
            line["objective minus that of the rival"] = _difference(
                policies, measured[rival][:, 0], [*strata.values()]
            )
        lines.append(line)
    named = "; ".join(dict.fromkeys(rivals.values()))
    which = "the rule or blind controller"
    groups = "optimizer and encoding" if len({encoding for _, encoding in rivals}) > 1 else "optimizer"
    which = which if len(rivals) == 1 else f"of each {groups} {which}"
    runs = asked.policy_runs or asked.runs
    caption = (
        f"Controllers with guided members after {asked.evaluations[0]:,} evaluations, cost `{asked.cost}`, "
        f"over {len(best)} {terrains} and {runs} runs of each policy. Excess over the best known flight "
        f"in per cent, mean and median. Objective: 100 times the mean logarithm of the cost, minus that "
        f"of {named}, {which} with the least objective on terrains for validation [95 % interval over "
        "policies, terrains and runs]. Below 0 is a smaller cost"
    )
    return Table.of(f"{asked.cost}-control", caption, lines)


def _difference(policies: Floats, rival: Floats, groups: Sequence[NDArray[np.int64]]) -> Entry:
    """Return the difference of two objectives with its interval; runs of equal seeds are compared.

    Args:
        policies: (terrains, policies, runs) costs of one row.
        rival: (terrains, at least as many runs) costs of the other.
        groups: numbers of the terrains of each group, from which resamples draw equally many.
    """
    runs = policies.shape[2]
    mine, theirs = np.log(policies).swapaxes(0, 1), np.log(rival[:, :runs])
    differences = 100.0 * (mine - theirs)  # (policies, terrains, runs)
    draws = draw(len(differences), tuple(map(len, groups)), runs)
    ends = interval(means(differences[:, np.concatenate(groups)], draws))
    return number_in(float(differences.mean()), ends, "+.2f")
