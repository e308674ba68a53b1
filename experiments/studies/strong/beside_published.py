"""The table of MetaBox-v2 beside gaps of ours."""

from collections.abc import Mapping

from experiments.studies.strong.published import (
    EVALUATIONS,
    FUNCTIONS,
    PUBLISHED,
    RUNS,
    YEARS,
    Gap,
    average_ranks,
    best_of,
)
from experiments.tables import Table
from experiments.tables.cell import Cell, Entry, number
from swarm_gym.reward import LEAST_GAP
from swarm_gym.scenarios.bbob.instance import FUNCTION_NAMES


def beside_published(ours: Mapping[str, Mapping[int, Gap]]) -> Table:
    """Return a table of our mean gaps beside the best published one, by function.

    A gap is marked with a star where no published one is smaller; gaps below 1e-8 count as equal. The last
    two rows have the number of stars and the average rank by MetaBox's rule.

    Args:
        ours: gaps by name of the column and by number of the function.
    """
    caption = (
        f"Mean gap on the 16 functions for tests of MetaBox, 10 dimensions, {EVALUATIONS:,} evaluations, and "
        f"the best of the {len(PUBLISHED)} methods of Table 3 of MetaBox-v2 ({RUNS} runs). *: no published "
        "gap is smaller; gaps below 1e-8 count as equal. Lower is closer"
    )
    rows = [_row(function, ours) for function in FUNCTIONS]
    ranks = average_ranks(ours)
    first = next(name for name in ranks if name in PUBLISHED)
    stars: dict[str, Entry] = {
        name: number(sum(is_level(f, gaps[f]) for f in FUNCTIONS), ".0f") for name, gaps in ours.items()
    }
    rows.append({"function": f"stars of {len(FUNCTIONS)}", "best published": "", **stars})
    rows.append(
        {
            "function": "average rank",
            "best published": Cell.of(f"{{value:.2f}} ({first})", value=ranks[first]),
            **{name: number(ranks[name], ".2f") for name in ours},
        }
    )
    return Table.of("beside-metabox", caption, rows)


def _row(function: int, ours: Mapping[str, Mapping[int, Gap]]) -> dict[str, Entry]:
    method, best = best_of(function)
    return {
        "function": f"{function} {FUNCTION_NAMES[function - 1]}",
        "best published": Cell.of(f"{{value:.3g}} ({method}, {YEARS[method]})", value=best.mean),
        **{name: _cell(function, gaps[function]) for name, gaps in ours.items()},
    }


def _cell(function: int, gap: Gap) -> Entry:
    return Cell.of("{value:.3g}" + "*" * is_level(function, gap), value=gap.mean)


def is_level(function: int, gap: Gap) -> bool:
    """Return whether a gap is level with or ahead of the best published one; those below 1e-8 are level."""
    return max(gap.mean, LEAST_GAP) <= max(best_of(function)[1].mean, LEAST_GAP)
