"""The tables of docs/planners.md and docs/curves.md: the rows and columns that tell most.

docs/planners-tables.md has all.
"""

from collections.abc import Mapping, Sequence
from functools import partial

from experiments.planners.figure import draw_planners
from experiments.plots.style import render, settings
from experiments.tables.block_contents import texts
from experiments.tables.document import Block, ResultsFolder
from experiments.tables.reshape import pick, select
from experiments.tables.table import Table

COLUMNS = (
    "planner", "found", "above exact, 0.1 s", "above exact, 0.5 s", "near, 0.5 s", "seconds to near",
    "clearance", "by a swarm",
)  # fmt: skip
FIGURE = "planners.svg"
EXACT, REPAIRED = "exact, any angle, map prepared anew", "A*, final repair"
PLANNING = (
    "swarm, fixed size", "swarm, SPSFA-TIP's rules", "swarm, learned", "OMPL RRTConnect", "OMPL RRTstar",
    "OMPL InformedRRTstar", "OMPL BITstar", "A*, smoothed", REPAIRED, EXACT,
)  # fmt: skip
REPLANNING = (
    "swarm, fixed size", "swarm, fixed size, from the previous path", "OMPL InformedRRTstar", "OMPL BITstar",
    REPAIRED, "previous path, final repair", EXACT,
)  # fmt: skip


def _chosen(name: str, planners: Sequence[str], results: ResultsFolder) -> Table:
    """Return some rows of a table.

    Raises:
        ValueError: if the table lacks a planner or a column.
    """
    rows = pick(results.table(name), ("planner",), [(planner,) for planner in planners])
    return select(rows, COLUMNS)


def _short(name: str, planners: Sequence[str], results: ResultsFolder) -> str:
    return _chosen(name, planners, results).markdown()


def _drawn(results: ResultsFolder) -> str:
    """Return the table of planning, and show its figure."""
    table = _chosen("planners", PLANNING, results)
    with settings():
        results.shown[FIGURE] = render(draw_planners(table), "svg")
    return table.markdown()


SHORT_TABLES: Mapping[str, Block] = {
    "planners": _drawn,
    "replanning": partial(_short, "replanning", REPLANNING),
    **texts(("streams",)),
}
# Those of docs/curves.md, and of its appendix in docs/planners-tables.md.
CURVE_TABLES: Mapping[str, Block] = texts(("curves", "curves-differences"))
