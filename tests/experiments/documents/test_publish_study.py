"""The document of the study shows what the suites wrote, and nothing else."""

import re
from pathlib import Path

import pytest

from experiments.catalogue import SUITES
from experiments.documents.blocks import block_names
from experiments.documents.page import describe_provenance
from experiments.publish import publish
from experiments.runs.groups import group_controllers
from experiments.studies.learned.blocks import BLOCKS, PARAMETER_COLUMNS
from experiments.studies.learned.origins import origins_table
from experiments.studies.learned.suites import LOOKED_INTO
from experiments.tables.blocks import GAP_COLUMNS, decisions_name
from experiments.tables.reshape import join, select, split, spread
from experiments.tables.table import Table
from helpers.stored_runs import printed_rows

ROOT = Path(__file__).parents[3]
STUDY = Path("docs/study.md")
ROWS = [("a:x", "one", "1"), ("a:x", "two", "2"), ("all", "one", "3")]
TABLE = Table("t", "Caption", ("scenarios", "controller", "gap"), ROWS)
COLUMNS = {
    "gaps": GAP_COLUMNS,
    "differences": ("scenarios", "controller", "difference", "p"),
    "duels": ("scenarios", "controller", "rival", "difference", "p"),
    "front": ("scenarios", "controller", "mean evaluations", "mean gap", "on the front"),
    "hypervolume": ("scenarios", "family", "controllers", "hypervolume"),
    "near-optimum": ("controller", "case1"),
}
OTHERS = {
    "parameters": {
        "table-12-parameter-growth": ("ω", *PARAMETER_COLUMNS),
        "table-13-parameter-decay": ("η", *PARAMETER_COLUMNS),
        "table-parameter-low-deviation": ("T_low", *PARAMETER_COLUMNS),
    },
    "branching": {
        "branching": ("iterations", "change", "difference"),
        "foresight": ("seen", "iteration 6, case1"),
    },
    "sensitivity": {
        "sensitivity-decisions": ("without", "population size"),
        "sensitivity-performance": ("without", "mean gap"),
    },
}
STUDIES = ("headline", "generalisation", "out-of-distribution", "ablation")


def test_parts_of_a_table():
    assert select(TABLE, ("gap", "controller")).rows == [("1", "one"), ("2", "two"), ("3", "one")]
    parts = split(TABLE)
    assert list(parts) == ["a:x", "all"]
    assert parts["a:x"].columns == ("controller", "gap")
    assert parts["all"].rows == [("one", "3")]
    wide = spread(TABLE, ("controller",), "gap")
    assert wide.columns == ("controller", "x", "all")
    assert wide.rows == [("one", "1", "3"), ("two", "2", "–")]
    more = join(
        split(TABLE)["a:x"], Table("u", "", ("p", "controller"), [("5", "two")]), ("controller",), "p"
    )
    assert more.columns == ("controller", "gap", "p")
    assert more.rows == [("one", "1", "–"), ("two", "2", "5")]
    with pytest.raises(ValueError, match=r"'t' has no column 'p'"):
        select(TABLE, ("p",))


def test_the_provenance_of_runs_is_one_line():
    made_with = [
        {"commit": "0123456789abcdef", "numba": "1.0", "numpy": "2.0"},
        {"commit": "fedcba9876543210-dirty", "numba": "1.0", "numpy": "2.1"},
    ]
    assert describe_provenance(made_with) == (
        "Runs made with: commits 0123456789, fedcba9876-dirty; numba 1.0; numpy 2.0, 2.1.\n"
    )


def test_where_fitted_controllers_come_from():
    table = origins_table(("tuned:three-cases", "learned:three-cases-ppo/0", "distilled:three-cases"))
    assert [row[1] for row in printed_rows(table)] == [
        "tuned: schedule", "trained: ppo", "distilled from learned (three-cases-ppo/0)",
    ]  # fmt: skip
    assert [row[2] for row in printed_rows(table)] == ["–", "imitates SPSFA-TIP", "–"]
    assert [row[5] for row in printed_rows(table)] == ["2,000,000", "640,000", "–"]


def test_the_document_has_every_block_once():
    assert sorted(block_names((ROOT / STUDY).read_text(encoding="utf-8"))) == sorted(BLOCKS)


def test_the_document_has_no_figures_but_those_of_its_blocks():
    text = (ROOT / STUDY).read_text(encoding="utf-8")
    for name in BLOCKS:
        text = re.sub(rf"<!-- {name} -->.*?<!-- /{name} -->", "", text, flags=re.DOTALL)
    assert "![" not in text


@pytest.fixture
def results(tmp_path, monkeypatch):
    """A checkout with the document, and made-up results of all suites."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "docs").mkdir()
    (tmp_path / STUDY).write_bytes((ROOT / STUDY).read_bytes())
    folder = tmp_path / "results/study"
    for suite, tables in {**dict.fromkeys(STUDIES, COLUMNS), **OTHERS}.items():
        (folder / suite).mkdir(parents=True)
        (folder / suite / "made-with.md").write_text(f"Runs made with: {suite}.\n")
        for name, columns in tables.items():
            rows = [tuple(f"{column} {k} of {suite}" for column in columns) for k in range(2)]
            (folder / suite / f"{name}.json").write_text(Table(name, f"{name}.", columns, rows).json())
        decisions = map(decisions_name, group_controllers(SUITES["headline"].controllers))
        for name in ("front", "profiles", "sensitivity", *decisions):
            (folder / suite / f"figure-{name}.svg").write_text(f"{suite} {name}")
    return folder


def test_publishing_fills_every_block_and_copies_what_is_shown(results):
    stale = STUDY.parent / "results/study/old.svg"
    stale.parent.mkdir(parents=True)
    stale.touch()
    publish("study", results.parent)
    text = STUDY.read_text(encoding="utf-8")
    assert "make docs-study`\n<!--" not in text
    assert "Runs made with: ablation." in text
    assert "| controller 0 of headline | mean gap 0 of headline |" in text
    assert "first population size = " in text
    shown = re.findall(r"!\[[^]]+\]\(results/study/([a-z0-9-]+\.svg)\)", text)
    assert {path.name for path in stale.parent.iterdir()} == set(shown)
    assert (stale.parent / "generalisation-front.svg").read_text() == "generalisation front"
    assert len(set(shown)) == len(shown) == 6 + len(group_controllers(LOOKED_INTO))
    publish("study", results.parent)
    assert STUDY.read_text(encoding="utf-8") == text


@pytest.mark.parametrize(
    "missing",
    [
        "headline/gaps.json",
        "ablation/made-with.md",
        "parameters/table-parameter-low-deviation.json",
        "sensitivity/figure-sensitivity.svg",
        f"headline/figure-{decisions_name(next(iter(group_controllers(LOOKED_INTO))))}.svg",
    ],
)
def test_nothing_is_written_where_something_is_missing(results, missing):
    before = STUDY.read_bytes()
    (results / missing).unlink()
    with pytest.raises(OSError, match=re.escape(missing)):
        publish("study", results.parent)
    assert STUDY.read_bytes() == before
    assert not (STUDY.parent / "results").exists()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [("<!-- /rule -->", "", "'rule'"), ("<!-- /rule -->", "<!-- /rule -->\n<!-- /other -->", "other")],
)
def test_a_missing_or_an_unknown_block_is_named(results, old, new, message):
    STUDY.write_text(STUDY.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    before = STUDY.read_bytes()
    with pytest.raises(ValueError, match=message):
        publish("study", results.parent)
    assert STUDY.read_bytes() == before
    assert not (STUDY.parent / "results").exists()
