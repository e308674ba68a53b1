"""The figure of the paper's cases at equal evaluations, drawn from the cells of its table as printed."""

import re

from matplotlib.figure import Figure

from experiments.plots.style import KNOWN_STYLES, error_bars, legend_below, new_figure, styles
from experiments.studies.strong.suites import LADDER, SHOWN
from experiments.tables.cell import printed_interval
from experiments.tables.table import Table

WIDTH, HEIGHT = 5.6, 4.2  # in inches
RULES = "fireflies, SPSFA-TIP"  # has the style that it has in other figures
_CELL = re.compile(r"([\d.]+) % \[([\d.]+), ([\d.]+)\]")
_EXPECTED = "a share with its interval, as in '3.91 % [3.15, 4.86]'"


def draw_cases_at_budgets(table: Table) -> Figure:
    """Draw the mean gap of the rows that README.md shows against evaluations, with 95 % intervals.

    Raises:
        ValueError: if the table lacks a row or a column, or a cell is no share with its interval.
    """
    rows = {str(row[0]): row for row in table.rows}
    columns = [f"{budget:,}" for budget in SHOWN]
    missing = [name for name in LADDER if name not in rows] + [
        name for name in columns if name not in table.columns
    ]
    if missing:
        raise ValueError(f"table {table.name!r} lacks {', '.join(missing)}")
    places = [table.columns.index(name) for name in columns]
    figure = new_figure(WIDTH, HEIGHT)
    axes = figure.subplots()
    for name, style in {**styles(LADDER), RULES: KNOWN_STYLES["spsfa-tip"]}.items():
        values, reach = error_bars(
            [printed_interval(rows[name][place], _CELL, _EXPECTED) for place in places]
        )
        axes.errorbar(SHOWN, values, yerr=reach, capsize=2, label=name, **style.options())
    axes.set(xscale="log", yscale="log", xlabel="evaluations", ylabel="mean gap, % of the optimum")
    axes.set_xticks(SHOWN, [f"{budget:,}" for budget in SHOWN])
    axes.minorticks_off()
    axes.yaxis.set_major_formatter("{x:g}")
    legend_below(figure)
    return figure
