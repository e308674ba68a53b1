"""The tables and the figure of docs/planners.md and docs/curves.md: the rows and columns that tell most.

docs/planners-tables.md has all.
"""

from collections.abc import Mapping, Sequence
from functools import partial

from matplotlib.figure import Figure

from experiments.plots.style import BLUE, GREY, ORANGE, legend_below, new_figure, render, settings
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

WIDTH, HEIGHT = 5.6, 3.6  # in inches
TIMES = {"above exact, 0.1 s": ("after 0.1 s", ORANGE, "o"), "above exact, 0.5 s": ("after 0.5 s", BLUE, "s")}


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


def draw_planners(table: Table) -> Figure:
    """Draw how far the paths of each planner are above the shortest one, after both times.

    The cells of the table are drawn as they are printed.

    The axis is logarithmic, so planners that are not above it at all are left out.

    Raises:
        ValueError: if the table lacks a column, or a cell is no share.
    """
    shares = {
        str(row[0]): [float(str(row[table.columns.index(column)]).removesuffix(" %")) for column in TIMES]
        for row in table.rows
    }
    drawn = {name: values for name, values in shares.items() if min(values) > 0.0}
    figure = new_figure(WIDTH, HEIGHT)
    axes = figure.subplots()
    rows = range(len(drawn))
    early, late = zip(*drawn.values(), strict=True)
    axes.hlines(rows, early, late, colors=GREY, linewidth=1.0, zorder=1)
    for k, (label, colour, marker) in enumerate(TIMES.values()):
        places = [values[k] for values in drawn.values()]
        # The later time lies on top and is smaller, so that both are seen where they are equal.
        axes.plot(places, rows, marker, color=colour, markersize=8 - 3 * k, label=label, zorder=2 + k)
    axes.set_yticks(rows, list(drawn))
    axes.invert_yaxis()
    axes.set(xscale="log", xlabel="mean length above the shortest path, %")
    axes.xaxis.set_major_formatter("{x:g}")
    legend_below(figure)
    return figure


SHORT_TABLES: Mapping[str, Block] = {
    "planners": _drawn,
    "replanning": partial(_short, "replanning", REPLANNING),
    **texts(("streams",)),
}
# Those of docs/curves.md, and of its appendix in docs/planners-tables.md.
CURVE_TABLES: Mapping[str, Block] = texts(("curves", "curves-differences"))
