"""The document of the study shows what the suites wrote, and nothing else."""

import re
from pathlib import Path

import pytest

from experiments.catalogue import SUITES
from experiments.documents.marked_blocks import block_names
from experiments.documents.suite_page import describe_provenance
from experiments.publish import publish
from experiments.runs.groups import group_controllers
from experiments.runs.labels import label
from experiments.studies.learned import tables as learned
from experiments.studies.learned.origins import origins_table
from experiments.studies.learned.suites import LOOKED_INTO
from experiments.studies.learned.tables import BLOCKS, PARAMETER_COLUMNS, PARAMETER_FIGURES, TABLE_BLOCKS
from experiments.tables.block_contents import CLAIM_COLUMNS, GAP_COLUMNS, decisions_name
from experiments.tables.reshape import join, select, split, spread
from experiments.tables.table import Table
from helpers.stored_runs import printed_rows

ROOT = Path(__file__).parents[3]
STUDY, APPENDIX = Path("docs/study.md"), Path("docs/study-tables.md")
DOCUMENTS = {"study": (STUDY, BLOCKS), "study-tables": (APPENDIX, TABLE_BLOCKS)}
ROWS = [("a:x", "one", "1"), ("a:x", "two", "2"), ("all", "one", "3")]
TABLE = Table("t", "Caption", ("scenarios", "controller", "gap"), ROWS)
COLUMNS = {
    "headline": ("controller", "price", "objective"),
    "claims": ("claim", "scenarios", *CLAIM_COLUMNS),
    "gaps": GAP_COLUMNS,
    "differences": ("scenarios", "controller", "difference", "p"),
    "front": ("scenarios", "controller", "mean evaluations", "mean gap", "on the front"),
    "hypervolume": ("scenarios", "family", "controllers", "hypervolume"),
    "near-optimum": ("controller", "case1"),
    "free-paths": ("scenarios", "controller", "strictly free"),
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
# Rows that the page picks from tables, by the name of the table.
SHOWN_ROWS = {
    "headline": lambda _: [(label(group), "1", f"{group}: 3.5") for group in learned.STRONGEST],
    "claims": lambda suite: [
        (finding.sentence, scenario_set, "gap", "1", "2", "-1", "yes")
        for finding in learned.FINDINGS
        for of, scenario_set, _ in finding.rows
        if of == suite
    ],
}
STUDIES = ("headline", "generalisation", "out-of-distribution", "single-cases", "ablation")


def test_rows_are_selected_split_and_spread_by_column():
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


@pytest.mark.parametrize("document", DOCUMENTS)
def test_a_document_has_every_block_once(document):
    path, blocks = DOCUMENTS[document]
    assert sorted(block_names((ROOT / path).read_text(encoding="utf-8"))) == sorted(blocks)


@pytest.mark.parametrize("document", DOCUMENTS)
def test_a_document_has_no_figures_but_those_of_its_blocks(document):
    path, blocks = DOCUMENTS[document]
    text = (ROOT / path).read_text(encoding="utf-8")
    for name in blocks:
        text = re.sub(rf"<!-- {name} -->.*?<!-- /{name} -->", "", text, flags=re.DOTALL)
    assert "![" not in text


@pytest.fixture
def results(tmp_path, monkeypatch):
    """A checkout with the documents, and made-up results of all suites."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "docs").mkdir()
    for path, _ in DOCUMENTS.values():
        (tmp_path / path).write_bytes((ROOT / path).read_bytes())
    folder = tmp_path / "results/study"
    for suite, tables in {**dict.fromkeys(STUDIES, COLUMNS), **OTHERS}.items():
        (folder / suite).mkdir(parents=True)
        (folder / suite / "made-with.md").write_text(f"Runs made with: {suite}.\n")
        for name, columns in tables.items():
            rows = [tuple(f"{column} {k} of {suite}" for column in columns) for k in range(2)]
            rows += SHOWN_ROWS[name](suite) if name in SHOWN_ROWS else []
            (folder / suite / f"{name}.json").write_text(Table(name, f"{name}.", columns, rows).json())
        decisions = map(decisions_name, group_controllers(SUITES["headline"].controllers))
        parameters = (f"parameter-{name}-{kind}" for name, _, kind in PARAMETER_FIGURES)
        for name in ("front", "profiles", *decisions, *parameters):
            (folder / suite / f"figure-{name}.svg").write_text(f"{suite} {name}")
    return folder


def test_publishing_fills_every_block_and_copies_what_is_shown(results):
    stale = STUDY.parent / "results/study/old.svg"
    stale.parent.mkdir(parents=True)
    stale.touch()
    for document in DOCUMENTS:
        publish(document, results.parent)
    text, tables = (path.read_text(encoding="utf-8") for path in (STUDY, APPENDIX))
    assert "| SPSFA-TIP | 1 | spsfa-tip: 3.5 |" in text
    assert "* Policies by PPO have a smaller objective than themselves blinded. All cases: holds, 1" in text
    assert "controller 0 of headline" not in text
    assert "Runs made with: headline." in tables
    assert "| controller 0 of headline | price 0 of headline |" in tables
    assert "| claim 1 of generalisation |" in tables
    assert "Runs made with: parameters." in tables
    assert "first population size = " in tables
    shown = re.findall(r"!\[[^]]+\]\(results/study/([a-z0-9-]+\.svg)\)", text)
    assert {path.name for path in stale.parent.iterdir()} == set(shown)
    assert (stale.parent / "generalisation-front.svg").read_text() == "generalisation front"
    assert len(set(shown)) == len(shown) == 4
    drawn = re.findall(r"!\[[^]]+\]\(results/study-tables/([a-z0-9-]+\.svg)\)", tables)
    assert {path.name for path in (STUDY.parent / "results/study-tables").iterdir()} == set(drawn)
    assert len(drawn) == 6 + len(LOOKED_INTO) - 1
    for document in DOCUMENTS:
        publish(document, results.parent)
    assert [path.read_text(encoding="utf-8") for path in (STUDY, APPENDIX)] == [text, tables]


@pytest.mark.parametrize(
    ("document", "missing"),
    [
        ("study", "headline/headline.json"),
        ("study", "headline/claims.json"),
        ("study-tables", "headline/made-with.md"),
        ("study", f"headline/figure-{decisions_name(LOOKED_INTO[0])}.svg"),
        ("study-tables", "headline/gaps.json"),
        ("study-tables", "parameters/table-parameter-low-deviation.json"),
        ("study-tables", "sensitivity/sensitivity-decisions.json"),
    ],
)
def test_nothing_is_written_where_something_is_missing(results, document, missing):
    path, _ = DOCUMENTS[document]
    before = path.read_bytes()
    (results / missing).unlink()
    with pytest.raises(OSError, match=re.escape(missing)):
        publish(document, results.parent)
    assert path.read_bytes() == before
    assert not (STUDY.parent / "results").exists()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [("<!-- /rule -->", "", "'rule'"), ("<!-- /rule -->", "<!-- /rule -->\n<!-- /other -->", "other")],
)
def test_a_missing_or_an_unknown_block_is_named(results, old, new, message):
    APPENDIX.write_text(APPENDIX.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    before = APPENDIX.read_bytes()
    with pytest.raises(ValueError, match=message):
        publish("study-tables", results.parent)
    assert APPENDIX.read_bytes() == before
    assert not (STUDY.parent / "results").exists()
