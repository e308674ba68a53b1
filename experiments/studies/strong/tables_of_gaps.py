"""Tables of this study: all rows in short, and rows beside the published table by function."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from experiments.studies.strong.beside_published import beside_published, is_level
from experiments.studies.strong.entrants import TOGETHER, WITHOUT_SIGHT
from experiments.studies.strong.measured_gaps import Floats, Measured
from experiments.studies.strong.published import EVALUATIONS, FUNCTIONS, Gap, average_ranks
from experiments.tables import Table
from experiments.tables.cell import MISSING, Entry, number, number_in
from experiments.tables.reshape import select
from swarm_gym.comparing.bootstrap import draw, interval, means
from swarm_gym.reward import LEAST_GAP

# Rows that stand beside the published table by function, where they are there.
SHOWN = (
    "CMA-ES, lambda 10", "CMA-ES, lambda 40", "CMA-ES, lambda 80", "CMA-ES, BIPOP", "CMA-ES, early restarts",
    "CMA-ES, learned from early restarts", "CMA-ES, learned from early restarts, together",
    "L-SHADE, constant tuned", "L-SHADE, learned, evolution",
)  # fmt: skip
# Rows that run with other seeds, too.
REPEATED_ROWS = (
    "CMA-ES, lambda 20", "CMA-ES, BIPOP", "CMA-ES, constant tuned", "CMA-ES, schedule tuned",
    "CMA-ES, early restarts", "CMA-ES, learned from early restarts, together",
    "CMA-ES, learned from early restarts, together, blinded",
)  # fmt: skip


def tables(measured: Mapping[str, Measured]) -> list[Table]:
    """Return all tables of these rows, by their names."""
    published = {name: gaps_of(row) for name, row in measured.items()}
    shown = {name: published[name] for name in SHOWN if name in published}
    return [_in_short(measured, published), beside_published(shown)]


def repeated(measured: Mapping[str, Measured], first_seed: int) -> Table:
    """Return the table of rows on other seeds than those of the other tables.

    Args:
        measured: gaps by name of the row.
        first_seed: number of the test seed of the first run.
    """
    table = _in_short(measured, {name: gaps_of(row) for name, row in measured.items()})
    caption = table.caption.replace(" average rank among these methods and all rows;", "")
    others = f"Some of these rows with other seeds, from test seed {first_seed} on. {caption}"
    columns = tuple(name for name in table.columns if name not in ("training seeds", "average rank"))
    return replace(select(table, columns), name="repeated", caption=others)


def gaps_of(row: Measured) -> dict[int, Gap]:
    """Return mean and standard deviation of the gaps over all runs, by number of the function."""
    return {
        function: Gap(float(gaps.mean()), float(gaps.std()))
        for function, gaps in zip(FUNCTIONS, row.final.swapaxes(0, 1), strict=True)
    }


def _in_short(measured: Mapping[str, Measured], published: Mapping[str, Mapping[int, Gap]]) -> Table:
    ranks = average_ranks(published)
    final = {name: np.log10(np.maximum(row.final, LEAST_GAP)) for name, row in measured.items()}
    runs = sorted({row.final.shape[2] for row in measured.values()})
    rows: list[dict[str, Entry]] = [
        {
            "row": name,
            "training seeds": _training_seeds(measured, name),
            "functions level or ahead": number(
                sum(is_level(f, published[name][f]) for f in FUNCTIONS), ".0f"
            ),
            "average rank": number(ranks[name], ".2f"),
            "log10 gap at the end": mean(final[name]),
            "minus the tuned constant": difference(final, name, f"{_optimizer(name)}, constant tuned"),
            "minus the tuned schedule": difference(final, name, f"{_optimizer(name)}, schedule tuned"),
            "minus itself blinded": difference(final, name, f"{name}{WITHOUT_SIGHT}"),
            "log10 gap, anytime": mean(row.anytime),
        }
        for name, row in measured.items()
    ]
    caption = (
        f"The 16 functions for tests of MetaBox, 10 dimensions, {EVALUATIONS:,} evaluations, "
        f"{' or '.join(map(str, runs))} runs on each function. Functions on which the mean gap is level with "
        "or ahead of the best of the 20 published methods, where gaps below 1e-8 are level; average rank "
        "among these methods and all rows; mean log10 of the gap, at least 1e-8, at the end, its differences "
        "to rivals of the same optimizer that see nothing, and its mean over all evaluations (anytime), with "
        "95 % intervals over runs and training seeds. Of functions, a high count is good; in the other "
        "columns, a low number"
    )
    return Table.of("in-short", caption, rows)


def _training_seeds(measured: Mapping[str, Measured], name: str) -> Entry:
    """Return the number of policies of a row of policies, also if they decide together."""
    one_by_one = measured.get(name.removesuffix(WITHOUT_SIGHT).removesuffix(TOGETHER))
    if "learned" not in name or one_by_one is None:
        return MISSING
    return number(len(one_by_one.final), ".0f")


def _optimizer(name: str) -> str:
    return name.partition(",")[0]


def difference(values: Mapping[str, Floats], name: str, rival: str, instances: int = 1) -> Entry:
    """Return the difference to a rival of one or as many training seeds, between runs of equal seeds.

    Args:
        values: (training seeds, scenarios, runs) of each row, with all instances of a function side by side.
        name: name of a row.
        rival: name of its rival.
        instances: number of instances of each function.
    """
    if name == rival or rival not in values:
        return MISSING
    return mean(values[name] - values[rival], instances, "+.2f")


def mean(values: Floats, instances: int = 1, spec: str = ".2f") -> Entry:
    """Return the mean of values with its interval; functions are given.

    Args:
        values: (training seeds, scenarios, runs), with all instances of a function side by side.
        instances: number of instances of each function.
        spec: format of the numbers.
    """
    seeds, scenarios, runs = values.shape
    sets = (instances,) * (scenarios // instances)
    return number_in(float(values.mean()), interval(means(values, draw(seeds, sets, runs))), spec)
