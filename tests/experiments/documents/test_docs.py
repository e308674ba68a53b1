"""Files and commands that the documents name exist; in a fresh clone that means that they are committed."""

import json
import re
import tomllib
from pathlib import Path

import pytest
import yaml

from experiments.publish import DOCUMENTS as RESULTS
from helpers.loops import looped

ROOT = Path(__file__).parents[3]
# Pages that `make docs` writes, which have a check of their own.
GENERATED = ("docs/environments/", "docs/reference/", "docs/contributing.md", "docs/changelog.md")
PAGES = [path.relative_to(ROOT).as_posix() for path in sorted(ROOT.glob("docs/**/*.md"))]
DOCUMENTS = ["README.md", "CONTRIBUTING.md", *(page for page in PAGES if not page.startswith(GENERATED))]


@looped("document", DOCUMENTS)
def test_every_relative_link_leads_to_a_file(document):
    targets = re.findall(r"\]\(([^)#\s<]+)\)", (ROOT / document).read_text(encoding="utf-8"))
    relative = [target for target in targets if "://" not in target]
    missing = [target for target in relative if not (ROOT / document).parent.joinpath(target).exists()]
    assert missing == []


def anchors_of(text):
    """Return the anchors of the headings of a page, as GitHub and the site make them."""
    headings = re.findall(
        r"^#+ (.+)$", re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL), re.M
    )
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@looped("document", DOCUMENTS)
def test_every_anchor_of_a_link_is_a_heading_of_its_page(document):
    text = (ROOT / document).read_text(encoding="utf-8")
    missing = []
    for target, anchor in re.findall(r"\]\(([^)#\s:]*)#([^)\s]+)\)", text):
        page = (ROOT / document).parent / target if target else ROOT / document
        if (
            page.suffix == ".md"
            and page.is_file()
            and anchor not in anchors_of(page.read_text(encoding="utf-8"))
        ):
            missing.append(f"{target}#{anchor}")
    assert missing == []


def test_anchors_are_made_of_headings_outside_of_code():
    text = "# A *b*, `c_d`\n```\n# no heading\n```\n## Control of λ: x\n"
    assert anchors_of(text) == {"a-b-c_d", "control-of-λ-x"}


@looped("document", DOCUMENTS)
def test_every_column_of_a_table_has_a_head(document):
    """Screen readers say the head of a column before each of its cells."""
    text = (ROOT / document).read_text(encoding="utf-8")
    heads = re.findall(r"^(\|.*\|)\n\|[-| :]+\|$", text, re.MULTILINE)
    assert [head for head in heads if "" in map(str.strip, head[1:-1].split("|"))] == []


def documents_linked_in(document):
    """Yield the paths, from the root, of the documents that a document links."""
    folder = (ROOT / document).parent
    for target in re.findall(r"\]\(([^)#\s]+\.md)\)", (ROOT / document).read_text(encoding="utf-8")):
        yield (folder / target).resolve().relative_to(ROOT.resolve()).as_posix()


def test_the_readme_links_every_document_of_results_or_a_page_that_does():
    near = {"README.md", *documents_linked_in("README.md")}
    linked = near.union(*map(documents_linked_in, near - {"CHANGELOG.md"}))
    assert {document.path.as_posix() for document, *_ in RESULTS.values()} - {"README.md"} <= linked


def test_the_results_are_among_the_documents_and_show_figures():
    assert "docs/results/README.md" in DOCUMENTS
    assert (ROOT / "docs/results/README.md").read_text(encoding="utf-8").count(".svg)")


def test_the_cluster_is_described_as_ray_wants_it():
    autoscaler = pytest.importorskip("ray.autoscaler", reason="needs the extra `ray`")
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads((Path(autoscaler.__file__).parent / "ray-schema.json").read_text())
    cluster = yaml.safe_load((ROOT / "docs/ray-cluster.yaml").read_text())
    jsonschema.validate(cluster, schema)
    (extras,) = re.findall(r"--editable '\.\[(.*)\]'", "\n".join(cluster["setup_commands"]))
    known = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    assert set(extras.split(",")) <= set(known)


def test_readings_name_files_that_exist():
    text = "\n".join(path.read_text(encoding="utf-8") for path in ROOT.glob("docs/readings*.md"))
    named = set(re.findall(r"`([\w/]+\.py)`", text))
    packages = ("swarm_gym", "agents", "experiments")
    files = [path.as_posix() for package in packages for path in (ROOT / package).rglob("*.py")]
    assert named
    assert [name for name in named if not any(file.endswith(f"/{name}") for file in files)] == []


@looped("document", ["CONTRIBUTING.md", "docs/architecture.md"])
def test_pages_for_contributors_name_files_and_folders_that_exist(document):
    text = (ROOT / document).read_text(encoding="utf-8")
    named = set(re.findall(r"`((?:swarm_gym|agents|experiments|tests)/[\w./-]+)`", text))
    assert named
    assert [name for name in sorted(named) if not (ROOT / name).exists()] == []
