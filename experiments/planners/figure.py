"""The figure of planners at two times, drawn from the cells of their table as they are printed."""

from matplotlib.figure import Figure

from experiments.plots.style import BLUE, GREY, ORANGE, legend_below, new_figure
from experiments.tables.table import Table

WIDTH, HEIGHT = 5.6, 3.6  # in inches
TIMES = {"above exact, 0.1 s": ("after 0.1 s", ORANGE, "o"), "above exact, 0.5 s": ("after 0.5 s", BLUE, "s")}


def draw_planners(table: Table) -> Figure:
    """Draw how far the paths of each planner are above the shortest one, after both times.

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
