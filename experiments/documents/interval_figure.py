"""A figure of values with their intervals, a row for each row of a table, drawn from its cells as printed."""

import re
from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from experiments.plots.style import BLACK, BLUE, GREY, ORANGE, error_bars, legend_below, new_figure
from experiments.tables.cell import MISSING, printed_interval
from experiments.tables.table import Table

WIDTH, ROW_HEIGHT, OTHER_HEIGHT = 5.6, 0.2, 0.9  # in inches
MARKS = ((BLUE, "o"), (ORANGE, "s"), (BLACK, "^"))
SPACE = 0.36  # between the first and the last mark of a row, in rows
_CELL = re.compile(r"([+-]?[\d.]+) \[([+-]?[\d.]+), ([+-]?[\d.]+)\]")
_EXPECTED = "a value with its interval, as in '0.35 [0.31, 0.40]'"


def draw_intervals(
    table: Table,
    names: Sequence[str],
    values: Mapping[str, str],
    axis: str,
    scale: str = "linear",
    level: float | None = None,
) -> Figure:
    """Draw columns of a table as marks with intervals; rows without any value are left out.

    Args:
        table: table to draw.
        names: heads of the columns that name a row.
        values: labels of the columns to draw, by their heads; at most three.
        axis: label of the axis.
        scale: scale of the axis, "linear" or "log".
        level: value at which a line is drawn; None for no line.

    Raises:
        ValueError: if the table lacks a column, or a cell is no value with its interval.
    """
    if missing := [name for name in (*names, *values) if name not in table.columns]:
        raise ValueError(f"table {table.name!r} lacks the columns {', '.join(missing)}")
    named, drawn = ([table.columns.index(name) for name in chosen] for chosen in (names, values))
    shown = [row for row in table.rows if any(str(row[place]) != MISSING for place in drawn)]
    labels = [", ".join(str(row[place]).replace("`", "") for place in named) for row in shown]
    figure = new_figure(WIDTH, OTHER_HEIGHT + ROW_HEIGHT * len(shown))
    axes = figure.subplots()
    if level is not None:
        axes.axvline(level, color=GREY, linewidth=1.0, zorder=1)
    for k, (place, label, (colour, marker)) in enumerate(zip(drawn, values.values(), MARKS, strict=False)):
        shift = SPACE * (k / (len(values) - 1) - 0.5) if len(values) > 1 else 0.0
        rows = [row + shift for row in range(len(shown))]
        middles, reach = error_bars([printed_interval(row[place], _CELL, _EXPECTED) for row in shown])
        axes.errorbar(
            middles, rows, xerr=reach, color=colour, linestyle="none", marker=marker, label=label, zorder=2
        )
    axes.set_yticks(range(len(shown)), labels)
    axes.set(xscale=scale, xlabel=axis, ylim=(len(shown) - 0.5, -0.5))
    if scale == "log":
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    if len(values) > 1:
        legend_below(figure)
    return figure
