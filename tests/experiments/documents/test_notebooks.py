"""The start pages and tutorials are notebooks that run from top to bottom, and name only what exists."""

import os
import re
import sys
from pathlib import Path

import pytest
import yaml
from pygments.token import Error

ROOT = Path(__file__).parents[3]
FOLDERS = ("docs/start", "docs/tutorials")
INDEXES = [f"{folder}/index.md" for folder in FOLDERS]
PAGES = [
    str(path.relative_to(ROOT))
    for folder in FOLDERS
    for path in sorted((ROOT / folder).glob("*.md"))
    if path.name != "index.md"
]
LONGEST = 300  # seconds of a cell
ANNOUNCED = "compiling the kernels"  # what the first run of all says, and no other


def text_of(page):
    return (ROOT / page).read_text(encoding="utf-8")


def without_code(text):
    """Return the prose of a page: fences are left out, since a # in them is no heading."""
    return re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)


def anchors_of(path):
    """Return the anchors of the headings of a document, in the manner of GitHub and MyST."""
    headings = re.findall(r"^#+ (.*)$", without_code(path.read_text(encoding="utf-8")), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(page):
    """Return the relative links of a page whose file or heading does not exist."""
    broken = []
    for target in re.findall(r"\]\(([^)\s]+)\)", text_of(page)):
        if "://" in target:
            continue
        name, _, anchor = target.partition("#")
        path = (ROOT / page).parent / name if name else ROOT / page
        if not path.is_file() or (anchor and anchor not in anchors_of(path)):
            broken.append(target)
    return broken


def notebook_of(page):
    read = pytest.importorskip("myst_nb.core.read", reason="needs the dependency group `docs`")
    return read.read_myst_markdown_notebook(text_of(page))


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def test_there_are_start_pages_and_tutorials():
    assert {page.rpartition("/")[0] for page in PAGES} == set(FOLDERS)


@pytest.mark.parametrize("page", PAGES)
def test_a_page_has_the_header_of_a_notebook(page):
    _, header, _ = text_of(page).split("---\n", 2)
    found = yaml.safe_load(header)
    assert found["jupytext"]["text_representation"]["format_name"] == "myst"
    assert found["kernelspec"]["name"] == "python3"


@pytest.mark.parametrize("page", PAGES)
def test_a_page_begins_with_what_it_is_for_and_ends_with_where_to_go_next(page):
    prose = without_code(text_of(page))
    assert re.search(r"^# .*\n+After this page you ", prose, re.MULTILINE)
    assert re.findall(r"^## (.*)$", prose, re.MULTILINE)[-1] == "Where to go next"


@pytest.mark.parametrize("page", [*INDEXES, *PAGES])
def test_every_link_leads_to_a_file_and_a_heading(page):
    assert broken_links(page) == []


def test_a_link_to_a_missing_heading_is_found(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("# Here\n[a](#here) [b](#there) [c](page.md#here) [d](other.md) [e](https://e.org/x)\n")
    assert broken_links(str(page)) == ["#there", "other.md"]


@pytest.mark.parametrize("index", INDEXES)
def test_an_index_lists_every_page_of_its_folder(index):
    (listed,) = re.findall(r"^```\{toctree\}\n(.*?)^```$", text_of(index), re.MULTILINE | re.DOTALL)
    names = [line for line in listed.splitlines() if line and not line.startswith(":")]
    folder = index.rpartition("/")[0]
    assert sorted(f"{folder}/{name}.md" for name in names) == [
        page for page in PAGES if page.startswith(f"{folder}/")
    ]


@pytest.mark.parametrize("page", PAGES)
def test_every_picture_has_words_for_those_who_do_not_see_it(page):
    for cell in code_cells(notebook_of(page)):
        if re.search(r"^(plt\.show\(\)|Image\(.*)$", cell.source, re.MULTILINE):
            assert len(cell.metadata["mystnb"]["image"]["alt"]) > 20, cell.source


@pytest.mark.parametrize("page", PAGES)
def test_the_site_can_highlight_every_cell(page):
    lexers = pytest.importorskip("ipython_pygments_lexers", reason="needs the dependency group `docs`")
    for cell in code_cells(notebook_of(page)):
        wrong = [text for kind, text in lexers.IPython3Lexer().get_tokens(cell.source) if kind is Error]
        assert wrong == [], cell.source


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_a_page_runs_from_top_to_bottom(page, tmp_path, monkeypatch):
    nbclient = pytest.importorskip("nbclient", reason="needs the dependency group `docs`")
    nbformat = pytest.importorskip("nbformat", reason="needs the dependency group `docs`")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    monkeypatch.delenv("SWARM_GYM_DATA", raising=False)
    notebook = notebook_of(page)
    # A command that fails stops no notebook by itself.
    checked = []
    for cell in notebook.cells:
        checked.append(cell)
        if cell.cell_type == "code" and re.search("^!", cell.source, re.MULTILINE):
            checked.append(nbformat.v4.new_code_cell("assert _exit_code == 0"))
    notebook.cells = checked
    where = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=LONGEST, resources=where).execute()
    for cell in code_cells(notebook):
        said = [output.text for output in cell.outputs if output.get("name") == "stderr"]
        assert [text for text in said if ANNOUNCED not in text] == [], cell.source
