"""Commands that the documents and the Makefile name exist."""

import re
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import pytest

from experiments.catalogue import SUITES
from experiments.publish import DOCUMENTS
from helpers.loops import looped

ROOT = Path(__file__).parents[2]
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
TEXTS = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
    for path in (*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), ROOT / ".ci/run")
}
TARGETS = (
    "help", "install", "browser", "study", "study-full", "test", "test-slow", "test-supply", "test-lowest",
    "test-newest", "fuzz", "check", "check-workflows", "format", "benchmark", "benchmark-gpu",
    "benchmark-peers", "benchmark-scaling",
    "docs", "paper", "docs-results", "docs-study", "docs-planners", "docs-moa", "docs-iafsa", "docs-brand-yu",
    "docs-driving", "docs-dynamic", "docs-newcomers", "docs-optimizers", "docs-adapters", "docs-scaling",
    "docs-scores",
    "docs-bbob", "docs-known-optimum", "docs-strong-optimizers", "docs-terrain", "docs-gallery", "docs-plans",
    "dist", "clean",
)  # fmt: skip


def named_targets():
    """Return the targets that a text calls as `make TARGET` in code, by the name of the text."""
    return {
        (name, target)
        for name, text in TEXTS.items()
        for target in re.findall(r"(?:`|^\s*)make ([a-z][a-z-]*)(?=[ `\n])", text, re.MULTILINE)
    }


def has_rule(target):
    made = subprocess.run(
        ["make", "--question", "--dry-run", "--no-print-directory", target],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    return made.returncode in (0, 1), made.stderr  # 1: there is something to do, 2: an error


@pytest.mark.skipif(shutil.which("make") is None, reason="needs make")
@pytest.mark.parametrize("target", TARGETS)
def test_a_target_has_a_rule(target):
    there, message = has_rule(target)
    assert there, message


@pytest.mark.skipif(shutil.which("make") is None, reason="needs make")
def test_a_target_without_a_rule_is_an_error():
    assert not has_rule("doc-moa")[0]


def test_documents_name_targets_that_exist():
    found = named_targets()
    assert {"README.md", "docs/study.md", ".ci/run"} <= {name for name, _ in found}
    assert [(name, target) for name, target in sorted(found) if target not in TARGETS] == []


def test_workflows_call_targets_that_exist():
    files = sorted((ROOT / ".github/workflows").glob("*.yml"))
    called = {
        path.stem: set(re.findall(r"run: make ([a-z-]+)", path.read_text(encoding="utf-8"))) for path in files
    }
    assert {"check", "docs", "newest", "release", "tests"} <= set(called)
    assert all(called.values())
    assert set().union(*called.values()) <= set(TARGETS)


def test_the_help_lists_every_target():
    listed = re.findall(r"^([a-z-]+%?):.*## ", MAKEFILE, re.MULTILINE)
    assert len(listed) == len(set(listed))
    by_pattern = {target for target in TARGETS if target.startswith("docs-")} - set(listed)
    assert set(listed) == {*TARGETS, "docs-%"} - by_pattern
    assert by_pattern == {f"docs-{name}" for name, (document, *_) in DOCUMENTS.items() if document.suite}


@looped("name", ["Makefile", *TEXTS])
def test_commands_are_modules_that_exist(name):
    text = MAKEFILE if name == "Makefile" else TEXTS[name]
    modules = re.findall(r"python -m ((?:swarm_gym|agents|experiments)[a-z0-9_.]*)", text)
    if name in ("Makefile", "README.md"):
        assert modules
    assert [module for module in modules if find_spec(module.rstrip(".")) is None] == []


def test_the_makefile_runs_suites_that_exist():
    (several,) = re.findall(r"^STUDY_SUITES = (.*)$", MAKEFILE, re.MULTILINE)
    named = {*several.split(), *re.findall(r"--suite ([a-z][a-z-]*)", MAKEFILE)}
    assert named <= set(SUITES)


@pytest.mark.skipif(shutil.which("make") is None, reason="needs make")
def test_the_tests_that_the_makefile_runs_exist():
    made = subprocess.run(
        ["make", "--dry-run", "test-slow", "fuzz"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    paths = {word for word in made.stdout.split() if word.startswith("tests/")}
    assert {"tests/swarm_gym/test_golden.py", "tests/reliability/fuzz.py"} <= paths
    assert [path for path in sorted(paths) if not (ROOT / path).exists()] == []
