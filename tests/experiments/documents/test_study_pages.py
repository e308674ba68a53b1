"""Pages of studies are short, and what they say first is in the tables of their appendices."""

import re
import shutil
from pathlib import Path

import pytest

from experiments.catalogue import SUITES
from experiments.documents.marked_blocks import block_names
from experiments.publish import DOCUMENTS
from experiments.studies.dynamic import findings as dynamic
from experiments.studies.learned import tables as learned
from experiments.studies.newcomers import findings as newcomers
from experiments.tables.block_contents import Finding, findings, shortened
from experiments.tables.document import ResultsFolder
from experiments.tables.reshape import pick
from experiments.tables.table import Table

ROOT = Path(__file__).parents[3]
PAGES = ("study", "newcomers", "dynamic", "optimizers")
# Further studies: without findings that are claims, and with several tables.
OTHERS = (
    "planners", "scores", "bbob", "learners", "terrain", "strong-optimizers", "known-optimum", "curves",
)  # fmt: skip
MOST_LINES, MOST_WORDS, MOST_ROWS = 250, 2500, 10
# By page: the block of the appendix with the rows of each stored table that findings and table are made from.
SOURCES = {
    "study": {
        "headline/headline": "headline",
        "headline/claims": "headline-claims",
        "generalisation/claims": "generalisation-claims",
    },
    "newcomers": {
        "newcomers/gaps": "newcomers-gaps",
        "newcomers/near-optimum": "newcomers-near-optimum",
        "newcomers/claims": "newcomers-claims",
        "newcomers-fields/claims": "newcomers-fields-claims",
        "newcomers-ablation/claims": "ablation-claims",
    },
    "dynamic": {
        name: name
        for name in (
            "dynamic/over-time", "dynamic/claims", "dynamic-fields/over-time", "dynamic-fields/claims",
            "dynamic-robots/robots",
        )
    },
    "optimizers": {name: name for name in ("optimizers/gains", "optimizers-cells/gains")},
    "bbob": {"bbob-groups": "bbob-groups"},
    "learners": {"reached-200000": "reached-200000"},
    "known-optimum": {"one-parameter": "one-parameter"},
    "strong-optimizers": {
        "strong-optimizers/in-short": "in-short",
        "strong-optimizers/on-bbob": "on-bbob",
        "strong/cases-at-budgets/cases-at-budgets": "cases-at-budgets",
    },
    "terrain": {
        "terrain/all/metabox-in-short": "all-rows-over-terrain",
        "terrain/all/metabox-control": "all-controllers-over-terrain",
        "terrain/longer/metabox-in-short": "longer-rows",
    },
    "terrain-budgets": {
        "terrain/longer-guided/metabox-control": "all-longer-control",
        "terrain/longer-guided/metabox-in-short": "all-longer-guided",
        "terrain/longest-guided/metabox-in-short": "all-longest-guided",
    },
}  # fmt: skip
# Blocks of a page that are made from these rows.
SHORT = {
    **dict.fromkeys(PAGES, ("findings", "strongest")),
    "bbob": ("bbob-groups",),
    "learners": ("reached-200000",),
    "known-optimum": ("one-parameter",),
    "strong-optimizers": ("in-short", "on-bbob", "cases-at-budgets"),
    "terrain": ("test-terrains", "control-over-terrain", "longer-over-terrain"),
    "terrain-budgets": ("longer-control", "longer-guided", "longest-guided"),
}
CHOSEN = {"study": learned.FINDINGS, "newcomers": newcomers.FINDINGS, "dynamic": dynamic.FINDINGS}


def page(name):
    return (ROOT / f"docs/{name}.md").read_text(encoding="utf-8")


def contents(text):
    """Return the content of each block by its name."""
    return {
        name: re.search(rf"<!-- {name} -->\n(.*?)<!-- /{name} -->", text, re.DOTALL)[1]
        for name in block_names(text)
    }


def cells(line):
    return tuple(cell.strip() for cell in line.strip()[2:-2].split(" | "))


def stored(name, block):
    """Return the table that a block shows, whole or as one table for each set of scenarios."""
    lines = block.splitlines()
    heads = [k for k, line in enumerate(lines) if line.startswith("| --- ")]
    caption = " ".join(lines[: heads[0] - 1]).strip().strip("*")
    if len(heads) == 1:
        rows = [cells(line) for line in lines[heads[0] + 1 :] if line.startswith("| ")]
        return Table(name, caption, cells(lines[heads[0] - 1]), rows)
    rows = []
    for begin in heads:
        scenario_set = lines[begin - 3].strip("*")
        for line in lines[begin + 1 :]:
            if not line.startswith("| "):
                break
            rows.append((scenario_set, *cells(line)))
    return Table(name, caption, ("scenarios", *cells(lines[heads[0] - 1])), rows)


@pytest.mark.parametrize("name", [*PAGES, *OTHERS])
def test_a_page_is_short_and_says_its_limits_and_what_others_measured(name):
    text = page(name)
    assert len(text.splitlines()) <= MOST_LINES
    assert len(text.split()) <= MOST_WORDS
    assert {"## Limits", "## Related work"} <= set(text.splitlines())


# Appendices have whole tables; the page of results grows by what is out of date; the changelog is a list.
LONG = {"results.md", "changelog.md", "contributing.md"}


def test_pages_that_are_no_appendices_are_short():
    pages = [path for path in ROOT.glob("docs/*.md") if not path.stem.endswith("-tables")]
    lines = {path.name: len(path.read_text(encoding="utf-8").splitlines()) for path in pages}
    assert len(lines) >= 50
    assert {name: number for name, number in lines.items() if number > MOST_LINES and name not in LONG} == {}


@pytest.mark.parametrize("name", SOURCES)
def test_a_page_has_figures(name):
    # Expectations of the first are exact, without intervals to draw; the other goes on from another page.
    least = 1 if name in ("known-optimum", "terrain-budgets") else 2
    assert least <= page(name).count("![") <= 4


@pytest.mark.parametrize("name", PAGES)
def test_a_page_has_one_table(name):
    text = page(name)
    generated = "".join(contents(text).values())
    assert generated.count("\n| --- ") == 1
    assert len(re.findall(r"^\| ", generated, re.MULTILINE)) - 2 <= MOST_ROWS


@pytest.mark.parametrize("name", [*PAGES, *OTHERS])
def test_no_table_of_a_page_has_more_rows_than_a_reader_takes_in(name):
    tables = re.findall(r"(?:^\|.*\n)+", "\n".join(contents(page(name)).values()), re.MULTILINE)
    assert tables
    assert [table.splitlines()[0] for table in tables if table.count("\n") - 2 > MOST_ROWS] == []


@pytest.mark.parametrize("name", [name for name in (*PAGES, *OTHERS) if name != "curves"])
def test_a_page_and_its_appendix_link_each_other(name):
    assert f"]({name}-tables.md" in page(name)
    assert f"]({name}.md" in page(f"{name}-tables")


@pytest.mark.parametrize("name", SOURCES)
def test_findings_and_table_are_made_from_the_rows_of_the_appendix(name, tmp_path):
    blocks = contents(page(f"{name}-tables"))
    for file, block in SOURCES[name].items():
        path = tmp_path / f"{file}.json"
        path.parent.mkdir(exist_ok=True, parents=True)
        path.write_text(stored(path.stem, blocks[block]).json())
    # The folder of all results, if the document has none of its own.
    folder = tmp_path if DOCUMENTS[name][0].results else tmp_path / name
    folder.mkdir(exist_ok=True)
    for figure in (ROOT / "docs/results" / name).glob("*.svg"):
        shutil.copy(figure, folder)
    makers, shown = DOCUMENTS[name][0].blocks, contents(page(name))
    chosen = set(SHORT[name]) & set(makers)
    assert chosen
    for block in chosen:
        assert makers[block](ResultsFolder(tmp_path)).strip() == shown[block].strip()


@pytest.mark.parametrize("name", CHOSEN)
def test_findings_are_claims_and_some_do_not_hold(name):
    for finding in CHOSEN[name]:
        for suite, *_ in finding.rows:
            assert finding.sentence in {claim.sentence for claim in SUITES[suite].claims}
    shown = " ".join(contents(page(name))["findings"].split())
    assert ": holds, " in shown
    assert ": does **not** hold, " in shown


# Numbers of a summary that no row of its page has: a length that another test computes, and budgets.
EXCEPTIONS = {"optimizers": {"8.1", "10,000", "50,000"}}
NUMBER = re.compile(r"(?<![\w.])\d+\.\d+(?!\w|\.\d)|(?<![\w.,])\d{1,3}(?:,\d{3})+(?![\w,])")


@pytest.mark.parametrize("name", PAGES)
def test_numbers_of_the_summary_are_in_generated_rows(name):
    summary = page(name).partition("## Findings\n")[2].partition("## The strongest")[0]
    generated = "".join(contents(page(name)).values())
    numbers = set(NUMBER.findall(summary.partition("Each sentence below")[0])) - EXCEPTIONS.get(name, set())
    assert numbers
    assert [number for number in numbers if number not in generated] == []


@pytest.mark.parametrize("name", SOURCES)
def test_page_and_appendix_have_every_block_once(name):
    for document in DOCUMENTS[name]:
        text = (ROOT / document.path).read_text(encoding="utf-8")
        assert sorted(block_names(text)) == sorted(document.blocks)


ROWS = [
    ("A is smaller.", "all", "gap", "1.0", "2.0", "-1.0 [-2.0, -0.5]", "yes"),
    ("A is smaller.", "case1", "gap", "2.0", "2.0", "+0.0 [-1.0, +1.0]", "**no**"),
]
COLUMNS = ("claim", "scenarios", "measure", "controller", "rival or limit", "difference", "holds")


def test_a_finding_says_whether_a_claim_holds_and_its_numbers(tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "one/claims.json").write_text(Table("claims", "", COLUMNS, ROWS).json())
    finding = Finding("A is smaller.", (("one", "all", "Cases"), ("one", "case1", "Case 1")))
    assert findings([finding], ResultsFolder(tmp_path)) == (
        "* A is smaller. Cases: holds, 1.0 against 2.0, difference -1.0 [-2.0, -0.5] (gap). Case 1: does\n"
        "  **not** hold, 2.0 against 2.0, difference +0.0 [-1.0, +1.0] (gap)."
    )
    with pytest.raises(ValueError, match=r"'claims' has no rows of A is smaller\., case9"):
        findings([Finding("A is smaller.", (("one", "case9", ""),))], ResultsFolder(tmp_path))


def test_rows_are_picked_in_the_order_of_their_keys():
    table = Table("t", "", ("a", "b"), [("x", "1"), ("y", "2"), ("z", "3")])
    assert pick(table, ("a",), [("z",), ("x",)]).rows == [("z", "3"), ("x", "1")]
    with pytest.raises(ValueError, match="'t' has no rows of u; v"):
        pick(table, ("a",), [("u",), ("x",), ("v",)])


def test_a_short_table_keeps_the_order_of_its_table_and_needs_every_row(tmp_path):
    rows = [("x", "1", "2"), ("y", "3", "4"), ("z", "5", "6")]
    (tmp_path / "t.json").write_text(Table("t", "Numbers, and the worst", ("a", "b", "c"), rows).json())
    results = ResultsFolder(tmp_path)
    short = shortened("t", ("z", "x"), results, ("a", "c"), ", and the worst")
    assert short.splitlines() == ["**Numbers**", "", "| a | c |", "| --- | --- |", "| x | 2 |", "| z | 6 |"]
    with pytest.raises(ValueError, match="'t' has no rows of u; v"):
        shortened("t", ("u", "x", "v"), results)
    with pytest.raises(ValueError, match="'t': expected a caption that ends in ', and the best'"):
        shortened("t", ("x",), results, left_out=", and the best")
