"""Compiled kernels are kept where that can be; where not, and where they are damaged, all still works."""

import logging

import numba
import pytest

from swarm_gym import jit
from swarm_gym.jit import kernel

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")


def doubled(x):
    return 2 * x


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(jit, "cache_folder", lambda: tmp_path / "kernels")
    jit._warn_once.cache_clear()
    return tmp_path / "kernels"


def compiled():
    """A kernel as another process would have it, called once; and how often the cache had it."""
    function = kernel(doubled)
    assert function(21) == 42
    return sum(function.stats.cache_hits.values())


def test_what_is_compiled_is_kept(folder, caplog):
    assert [compiled(), compiled()] == [0, 1]
    assert [path.parent.name for path in folder.rglob("*.nbc")] == [__name__]
    assert not caplog.records


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
@pytest.mark.parametrize("left", [0, 40])
def test_what_is_damaged_is_compiled_anew_and_kept(folder, caplog, suffix, left):
    compiled()
    (path,) = folder.rglob(f"*.{suffix}")
    path.write_bytes(path.read_bytes()[:left])
    assert [compiled(), compiled()] == [0, 1]
    (warning,) = caplog.records
    assert warning.levelno == logging.WARNING
    assert "are damaged" in warning.message
    assert str(folder) in warning.message


def test_without_a_folder_to_write_to_it_is_said_once(folder, caplog):
    folder.write_text("a file where the folder would be")
    assert [compiled(), compiled()] == [0, 0]
    (warning,) = caplog.records
    assert f"cannot be kept in {folder}" in warning.message
    assert "SWARM_GYM_CACHE" in warning.message


def test_a_folder_that_is_only_read_serves(folder, caplog, monkeypatch):
    compiled()

    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("os.replace", refuse)
    monkeypatch.setattr("pathlib.Path.mkdir", refuse)
    monkeypatch.setattr("tempfile.TemporaryFile", refuse)
    assert compiled() == 1
    assert not caplog.records
