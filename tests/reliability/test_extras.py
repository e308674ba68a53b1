"""Extras and dependency groups: every name that is used exists, and bounds are those that were tested."""

import ast
import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.version import Version

ROOT = Path(__file__).parents[2]
CONTENT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
EXTRAS = CONTENT["project"]["optional-dependencies"]
GROUPS = CONTENT["dependency-groups"]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


def extras_in(text):
    """Return the extras that a text tells pip to install, as in `swarm_gym[maps,render]`."""
    lists = re.findall(r"(?:swarm_gym|['\"]\.)\[([a-z][a-z,-]*)\]", text)
    return {extra for found in lists for extra in found.split(",")}


def extras_of_errors():
    """Return the extras that the package's error messages tell a user to install."""
    found = set()
    for package in ("swarm_gym", "agents", "experiments"):
        for path in (ROOT / package).rglob("*.py"):
            source = path.read_text(encoding="utf-8")
            found |= extras_in(source)
            for node in ast.walk(ast.parse(source)):
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "MissingExtraError":
                    found.add(ast.literal_eval(node.args[2]))
    return found


def test_errors_name_extras_that_exist():
    found = extras_of_errors()
    assert {"maps", "gpu", "render"} <= found
    assert found <= set(EXTRAS)


def test_documents_name_extras_that_exist():
    found = {path.name: extras_in(path.read_text(encoding="utf-8")) for path in DOCUMENTS}
    assert found["gpu.md"] == {"gpu"}
    assert set().union(*found.values()) <= set(EXTRAS)


def test_the_page_on_installation_lists_every_extra():
    table = read("docs/start/installation.md").split("| extra | needed for |")[1].split("\n\n")[0]
    assert set(re.findall(r"^\| `([a-z-]+)`", table, re.MULTILINE)) == set(EXTRAS)


def test_the_makefile_installs_extras_and_groups_that_exist():
    makefile = read("Makefile")
    (extras,) = re.findall(r"^EXTRAS = (.*)$", makefile, re.MULTILINE)
    assert set(extras.split(",")) <= set(EXTRAS)
    named = set(re.findall(r"--group ([a-z]+)", makefile))
    made = set(re.findall(r"\.venv-([a-z]+)/\.installed", makefile))
    assert named | made == set(GROUPS)


def test_numba_is_bounded_by_the_minor_version_that_was_tested():
    (numba,) = (
        found for found in map(Requirement, CONTENT["project"]["dependencies"]) if found.name == "numba"
    )
    (exact,) = re.findall(r"^numba==(.*)$", read("constraints.txt"), re.MULTILINE)
    tested = Version(exact)
    assert numba.specifier.contains(exact)
    assert not numba.specifier.contains(f"{tested.major}.{tested.minor + 1}.0")


@pytest.mark.parametrize(("numpy", "allowed"), [("2.4.6", True), ("2.5.0", False)])
def test_the_extra_gpu_excludes_a_numpy_that_numba_cuda_fails_with(numpy, allowed):
    (found,) = (found for found in map(Requirement, EXTRAS["gpu"]) if found.name == "numpy")
    assert found.specifier.contains(numpy) is allowed
