"""Evaluations of controllers on bit strings by `python -m experiments.evaluate`."""

import numpy as np
import pytest

from agents.backends import BackendOptions
from experiments.choice import Choice
from experiments.evaluate import EvaluateConfig, evaluate
from experiments.tables import Table
from helpers.bits import OPTIMIZER
from swarm_gym.comparing import compare

RULES = ("theory", "one-fifth")


def evaluated(folder, *scenarios, seeds=3, **options):
    """Return the table of an evaluation of rules on scenarios, and all files that it wrote."""
    config = EvaluateConfig(
        seeds=seeds,
        controllers=RULES,
        choice=Choice(scenarios=scenarios, optimizer=OPTIMIZER),
        output=folder,
        where=BackendOptions(jobs=1),
        **options,
    )
    page = evaluate(config)
    return Table.read(page.parent / "evaluations.json"), page


def test_the_table_has_the_evaluations_that_a_comparison_finds(tmp_path):
    table, page = evaluated(tmp_path, "onemax:50", "onemax:100")
    heads = ["scenarios", "controller", "runs", "evaluations", "minus theory", "above the optimum", "solved"]
    assert list(table.columns) == heads
    rows = {row[1]: dict(zip(table.columns, row, strict=True)) for row in table.rows}
    found = compare(RULES, ["onemax:50", "onemax:100"], range(3), OPTIMIZER)
    for k, name in enumerate(RULES):
        assert rows[name]["evaluations"].numbers["value"] == pytest.approx(found.evaluations[k].mean())
        assert rows[name]["above the optimum"].numbers["value"] == pytest.approx(found.gap[k].mean())
        assert rows[name]["solved"].numbers["value"] == 1.0
    difference = found.evaluations[1].mean() - found.evaluations[0].mean()
    assert rows["one-fifth"]["minus theory"].numbers["value"] == pytest.approx(difference)
    assert "| onemax | one-fifth | 6 |" in page.read_text()


def test_a_length_without_a_shipped_optimum_has_evaluations_only(tmp_path):
    table, _ = evaluated(tmp_path, "onemax:30", seeds=2)
    above = [row[table.columns.index("above the optimum")] for row in table.rows]
    assert above == ["–", "–"]
    assert all(np.isfinite(row[table.columns.index("evaluations")].numbers["value"]) for row in table.rows)


def test_maps_have_the_tables_that_they_had():
    choice = Choice(scenarios=("case1",))
    assert choice.suite("paper").tables == ("summary", "comparison")
    assert Choice(scenarios=("onemax:30",)).suite("paper").figures == ()
