"""Numbers in the documents come out of results."""

import shutil
from pathlib import Path

import pytest

from experiments import catalogue
from experiments.benchmark import GROUPS
from experiments.documents.marked_blocks import replace_block
from experiments.publish import DOCUMENTS, SHOWN, STRONGEST, main, publish
from experiments.runs.labels import label
from experiments.speed.benchmark_page import OF_PEERS, write_page
from experiments.speed.measurement import Measurement, write_measurements
from experiments.studies.strong.suites import LADDER
from experiments.tables.table import Table

ROOT = Path(__file__).parents[3]
LADDER_BLOCK = "<!-- ladder -->\n<!-- /ladder -->\n"
SPEED_BLOCK = "<!-- speed -->\n<!-- /speed -->\n"
TEXT = f"{LADDER_BLOCK}above\n<!-- results -->\nold\nlines\n<!-- /results -->\nbelow {SPEED_BLOCK}"
# The pages on speed, and their blocks.
PERFORMANCE = {
    page: "\n".join(f"<!-- {name} -->\n<!-- /{name} -->\n" for name in names)
    for page, names in {
        "performance": ("headline", *(name for name in GROUPS if name != "moves")),
        "performance-moves": ("moves",),
        "performance-libraries": OF_PEERS,
    }.items()
}


def test_a_block_is_replaced_and_the_rest_left_alone():
    found = replace_block(TEXT, "results", "new \\1 text\n")
    assert found == TEXT.replace("old\nlines", "new \\1 text")
    assert replace_block(found, "results", "new \\1 text") == found


def test_a_missing_block_is_refused():
    with pytest.raises(ValueError, match="tables"):
        replace_block(TEXT, "tables", "new")


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory):
    """The folder of a benchmark of all groups with its page and figure, which take a second to make."""
    folder = tmp_path_factory.mktemp("benchmark")
    groups = {}
    for name, group in GROUPS.items():
        measured = [Measurement(q.name, q.unit, 1.5, 1.0, 2.0) for q in group.quantities()]
        groups[name] = measured + group.summary(measured)
    write_measurements(folder / "benchmark.json", groups)
    ratios = [
        Measurement(f"case{k}: niapy, {cost} / swarm_gym", "times", 1.5, 1.0, 2.0)
        for k in (1, 2, 3)
        for cost in ("cost in NumPy", "our compiled cost")
    ]
    curves = [Measurement("elite-genetic: A, cost in NumPy / swarm_gym", "times", 1.5, 1.0, 2.0)]
    fish = [Measurement("case1: A, cost in NumPy / swarm_gym", "times", 2.5, 2.0, 3.0)]
    groups = {"peers": ratios, "bezier-peers": curves, "fish-peers": fish}
    write_measurements(folder / "peers.json", groups)
    write_page(folder)
    return folder


@pytest.fixture
def documents(tmp_path, monkeypatch, benchmark):
    """A checkout with empty blocks, a suite and a benchmark."""
    monkeypatch.chdir(tmp_path)
    for folder in ("results/docs/paper", "results/study/headline", "docs"):
        (tmp_path / folder).mkdir(parents=True)
    shutil.copytree(benchmark, tmp_path / "results/benchmark")
    (tmp_path / "README.md").write_text(TEXT)
    for page, text in PERFORMANCE.items():
        (tmp_path / f"docs/{page}.md").write_text(text)
    for name in ("README.md", "a.svg", "a.png"):
        (tmp_path / "results/docs/paper" / name).write_text(f"content of {name}")
    rows = [
        (name, *(f"{name}: {column}" for column in (*SHOWN[1:], "price")))
        for name in (*map(label, STRONGEST), "weak")
    ]
    table = Table("headline", "Objective.", (*SHOWN, "price"), rows)
    (tmp_path / "results/study/headline/headline.json").write_text(table.json())
    rows = [(name, "1") for name in (*LADDER, "weaker still")]
    table = Table("cases-at-budgets", "Gaps.", ("optimizer and controller", "2,000"), rows)
    table.write(tmp_path / "results/strong/cases-at-budgets")
    return tmp_path


def test_publishing_copies_the_page_and_fills_all_documents(documents):
    publish("results", documents / "results")
    readme = (documents / "README.md").read_text()
    assert "| SPSFA-TIP | SPSFA-TIP: seeds | SPSFA-TIP: objective |" in readme
    assert "weak" not in readme
    assert all(f"| {name} | 1 |" in readme for name in LADDER)
    assert "price" not in readme
    quantities = [line.split(" | ")[0] for line in readme.splitlines() if line.endswith(" |")]
    assert quantities[-5:] == [
        "| move with evaluation, mean of the cases",
        "| case1: niapy, cost in NumPy / swarm_gym",
        "| elite-genetic: A, cost in NumPy / swarm_gym",  # nearer than the other peer
        next(q for q in quantities if q.startswith("| 64 swarms of 60 members")),
        next(q for q in quantities if q.startswith("| PPO training")),
    ]
    performance = (documents / "docs/performance.md").read_text()
    assert "| single environment, 30 members | 1.5 | 1 to 2 |" in performance
    moves, libraries = (
        (documents / f"docs/performance-{page}.md").read_text() for page in ("moves", "libraries")
    )
    assert "| case1: move with evaluation | 1.5 | 1 to 2 |" in moves
    for text in (performance, libraries):
        assert "| case2: niapy, cost in NumPy / swarm_gym | 1.5 |" in text
        assert text.count("| elite-genetic: A, cost in NumPy / swarm_gym | 1.5 |") == 1
        assert text.count("| case1: A, cost in NumPy / swarm_gym | 2.5 |") == 1
    published = {p.name for p in (documents / "docs/results").iterdir()}
    assert published == {"README.md", "a.svg", "growth.svg"}


@pytest.mark.parametrize(
    "missing",
    [
        "study/headline/headline.json",
        "docs/paper/README.md",
        "benchmark/benchmark.json",
        "benchmark/peers.json",
        "strong/cases-at-budgets/cases-at-budgets.json",
    ],
)
def test_nothing_is_written_where_something_is_missing(documents, missing):
    (documents / "results" / missing).unlink()
    with pytest.raises((OSError, ValueError), match=r"headline|claims|README|benchmark|peers|budgets"):
        publish("results", documents / "results")
    assert (documents / "README.md").read_text() == TEXT
    for page, text in PERFORMANCE.items():
        assert (documents / f"docs/{page}.md").read_text() == text
    assert not (documents / "docs/results").exists()


def test_a_headline_table_without_a_row_of_the_readme_is_refused(documents):
    table = Table(
        "headline", "Objective.", SHOWN, [(name,) * len(SHOWN) for name in map(label, list(STRONGEST)[1:])]
    )
    (documents / "results/study/headline/headline.json").write_text(table.json())
    with pytest.raises(ValueError, match=r"has no rows of learned three-cases@1$"):
        publish("results", documents / "results")
    assert (documents / "README.md").read_text() == TEXT


def test_a_figure_that_is_no_longer_shown_is_deleted(documents):
    stale = documents / "docs/results/old.svg"
    other = documents / "docs/results/study/kept.svg"
    for file in (stale, other):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    publish("results", documents / "results")
    assert not stale.exists()
    assert other.exists()


def test_documents_are_published_by_name():
    assert {"results", "planners", "scaling", "scores"} <= set(DOCUMENTS)
    assert set(catalogue.DOCUMENTS) < set(DOCUMENTS)
    for documents in DOCUMENTS.values():
        for document in documents:
            assert (ROOT / document.path).is_file()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["moa", "mooa"], "unknown document 'mooa'; valid: moa, "),
        ([], "no document is named; name some of results.*scaling"),
    ],
)
def test_a_wrong_document_lists_the_valid_ones_and_nothing_is_written(
    documents, monkeypatch, arguments, message
):
    monkeypatch.setattr("sys.argv", ["publish", *arguments])
    with pytest.raises(SystemExit, match=f"error: .*{message}"):
        main()
    assert not (documents / "docs/results").exists()
