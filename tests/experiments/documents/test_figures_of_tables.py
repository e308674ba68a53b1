"""Figures that are drawn from printed tables: the shipped ones are those of the tables of their pages."""

import re
from pathlib import Path

import numpy as np
import pytest

from helpers.slow import slow_but

pytest.importorskip("tyro", reason="needs the extra `study`")

from experiments.documents.interval_figure import draw_intervals
from experiments.documents.marked_blocks import content_of
from experiments.documents.study_documents import draw_control, draw_gaps, draw_objectives, draw_sizes
from experiments.planners.short_tables import draw_planners
from experiments.plots.style import render, settings
from experiments.studies.strong.figure import draw_cases_at_budgets
from experiments.tables.table import Table

ROOT = Path(__file__).parents[3]
# Figures by name: the function that draws it, the page of its table, the block, and the file.
FIGURES = {
    "planners": (draw_planners, "planners", "planners", "planners/planners.svg"),
    "cases": (
        draw_cases_at_budgets,
        "strong-optimizers-tables",
        "cases-at-budgets",
        "strong-optimizers/cases-at-budgets.svg",
    ),
    "gaps": (draw_gaps, "strong-optimizers-tables", "in-short", "strong-optimizers/gaps.svg"),
    "sizes": (draw_sizes, "bbob-tables", "bbob-groups", "bbob/sizes.svg"),
    "objectives": (draw_objectives, "learners-tables", "reached-200000", "learners/objectives.svg"),
    "control": (draw_control, "terrain-tables", "all-controllers-over-terrain", "terrain/control.svg"),
}


def printed(page, block):
    """Return the table that a page shows in a block."""
    lines = content_of((ROOT / f"docs/{page}.md").read_text(encoding="utf-8"), block).splitlines()
    columns, _, *rows = [tuple(line[2:-2].split(" | ")) for line in lines if line.startswith("| ")]
    return Table(block, "", columns, rows)


def drawn(draw, table):
    with settings():
        return render(draw(table), "svg").decode()


def labels(picture):
    return re.findall(r"<!-- (.*) -->", picture)


def ends(picture):
    """Return the ends of all lines inside the axes, in points."""
    lines = "".join(re.findall(r'<path d="([^"]*)" clip-path', picture))
    return np.array(re.findall(r"[ML] ([\d.]+) ([\d.]+)", lines), dtype=float)


def same(one, other):
    """Say whether two pictures are the same, up to what versions of Matplotlib and of fonts change."""
    return labels(one) == labels(other) and np.allclose(ends(one), ends(other), atol=4.0)


@pytest.mark.parametrize("name", FIGURES)
def test_a_shipped_figure_is_drawn_from_the_table(name):
    draw, page, block, file = FIGURES[name]
    found = drawn(draw, printed(page, block))
    assert len(labels(found)) > 5
    assert len(ends(found)) > 5
    assert same(found, (ROOT / "docs/results" / file).read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", slow_but([*FIGURES][:2], FIGURES))
def test_other_numbers_are_another_figure(name):
    draw, page, block, file = FIGURES[name]
    table = printed(page, block)
    first, second, *others = table.rows
    exchanged = [first[:1] + second[1:], second[:1] + first[1:], *others]
    found = drawn(draw, Table(block, "", table.columns, exchanged))
    assert not same(found, (ROOT / "docs/results" / file).read_text(encoding="utf-8"))


def test_tables_that_cannot_be_drawn_are_refused():
    table = printed("strong-optimizers", "cases-at-budgets")
    with pytest.raises(ValueError, match="lacks fireflies, learned with sources, 2,000"):
        draw_cases_at_budgets(
            Table("t", "", ("name", *table.columns[2:]), [row[:1] + row[2:] for row in table.rows[1:]])
        )
    bare = [(row[0], *("3 %" for _ in row[1:])) for row in table.rows]
    with pytest.raises(ValueError, match="cell '3 %': expected a share with its interval"):
        draw_cases_at_budgets(Table("t", "", table.columns, bare))


def test_intervals_of_a_table_without_the_column_or_an_interval_are_refused():
    table = printed("bbob-tables", "bbob-groups")
    with pytest.raises(ValueError, match="'bbob-groups' lacks the columns nothing"):
        draw_intervals(table, ("optimizer", "size"), {"nothing": ""}, "axis")
    with pytest.raises(ValueError, match="cell '20 members': expected a value with its interval"):
        draw_intervals(table, ("optimizer",), {"size": ""}, "axis")
