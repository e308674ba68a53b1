"""A published repository has one address, and badges and a citation that are true."""

import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[3]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
ADDRESS = re.compile(
    r"(?:github\.com|githubusercontent\.com|readthedocs\.io)/([\w.-]+)/swarm_gym\b|([\w-]+)\.github\.io/swarm_gym"
)
PLACEHOLDER = "OWNER"
# Files that say what to do with the placeholder.
SAY_SO = {"pyproject.toml", "docs/releasing.md", ".github/workflows/release.yml", Path(__file__).name}


@cache
def texts():
    """Return the texts of all files of the repository that are no data, by their paths."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    suffixes = {".md", ".py", ".toml", ".cff", ".typ", ".bib", ".yml", ".yaml", ".js", ".css", ".html"}
    files = [ROOT / name for name in listed.stdout.splitlines() if Path(name).suffix in suffixes]
    return {
        file.relative_to(ROOT).as_posix(): file.read_text(encoding="utf-8")
        for file in files
        if file.is_file() and not file.is_symlink()
    }


def owners_in(text):
    """Return the owners of addresses of this repository in a text."""
    return {one or other for one, other in ADDRESS.findall(text)}


def test_one_table_has_the_address_of_the_repository():
    found = {name: owners for name, text in texts().items() if (owners := owners_in(text))}
    found.pop(Path(__file__).relative_to(ROOT).as_posix())
    assert found.keys() == {"pyproject.toml"}
    assert len(found["pyproject.toml"]) == 1
    assert owners_in(" ".join(PROJECT["urls"].values())) == found["pyproject.toml"]
    assert all(owners_in(address) for address in PROJECT["urls"].values())


def test_the_placeholder_stands_only_where_pages_say_what_to_do_with_it():
    names = {name for name, text in texts().items() if re.search(rf"\b{PLACEHOLDER}\b", text)}
    assert {name for name in names if Path(name).name not in {Path(one).name for one in SAY_SO}} == set()


@pytest.mark.parametrize(
    ("text", "owners"),
    [
        ("https://github.com/someone/swarm_gym/issues", {"someone"}),
        ("https://someone.github.io/swarm_gym", {"someone"}),
        ("https://github.com/Farama-Foundation/Gymnasium", set()),
    ],
)
def test_a_second_address_would_be_found(text, owners):
    assert owners_in(text) == owners


def badges_of(page):
    """Return the words of the badges of a page, by the word on their left."""
    found = re.findall(
        r"img\.shields\.io/badge/([\w.]+)-([\w.]+)-\w+\)", (ROOT / page).read_text(encoding="utf-8")
    )
    return {left: right.replace("_", " ") for left, right in found}


def test_badges_are_true():
    versions = re.findall(r"Python :: (3\.\d+)", " ".join(PROJECT["classifiers"]))
    (gymnasium,) = re.findall(r"gymnasium>=([\d.]+)", " ".join(PROJECT["dependencies"]))
    assert badges_of("README.md") == {
        "Python": f"{versions[0]} to {versions[-1]}",
        "Gymnasium": f"v{gymnasium}",
        "licence": PROJECT["license"],
    }
    assert PROJECT["requires-python"] == f">={versions[0]}"
    assert badges_of("docs/releasing.md") == {"Gymnasium": f"v{gymnasium}"}


def test_the_citation_states_the_version_and_no_doi_that_does_not_exist():
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    citation = yaml.safe_load(text)
    assert citation["version"] == PROJECT["version"]
    assert citation["license"] == PROJECT["license"]
    if "doi" in citation:
        assert re.fullmatch(r"10\.\d{4,9}/\S+", citation["doi"])
        assert citation["doi"] in (ROOT / "README.md").read_text(encoding="utf-8")
    else:
        assert "# doi: a placeholder" in text
        assert "there is no DOI yet" in (ROOT / "README.md").read_text(encoding="utf-8")
