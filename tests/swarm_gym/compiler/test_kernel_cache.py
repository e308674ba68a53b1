"""Compiled kernels are kept where that can be; where not, and where they are damaged, all still works."""

import logging
import multiprocessing
import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from swarm_gym.compiler import cache
from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.compiler.simd import maximum, minimum

pytestmark = pytest.mark.skipif(
    bool(numba.config.DISABLE_JIT), reason="NUMBA_DISABLE_JIT=1 turns off the compiler"
)


def doubled(x):
    return 2 * x


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path / "kernels")
    cache._warn_once.cache_clear()
    return tmp_path / "kernels"


def compiled():
    """A compiled function as another process would have it, called once; and how often the cache had it."""
    function = entry(doubled)
    assert function(21) == 42
    return sum(function.stats.cache_hits.values())


def test_what_is_compiled_is_kept(folder, caplog):
    assert [compiled(), compiled()] == [0, 1]
    assert [path.parent.parent.name for path in folder.rglob("*.nbc")] == [__name__]
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


def test_only_entries_become_machine_code(folder):
    called = kernel(doubled)

    @entry
    def calling(x):
        return called(x) + 1

    assert calling(21) == 43
    (of_kernel,), (of_entry,) = called.inspect_asm().values(), calling.inspect_asm().values()
    assert "@function" in of_entry
    assert "@function" not in of_kernel


def test_code_of_other_options_is_not_reused(folder):
    assert compiled() == 0
    for decorate, hits in ((kernel, 0), (kernel(inline="late"), 0), (kernel, 1)):
        function = decorate(doubled)
        function.compile((numba.int64,))
        assert sum(function.stats.cache_hits.values()) == hits


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


def _compile_together(folder, barrier, hits):
    cache.cache_folder = lambda: folder
    function = entry(doubled)
    barrier.wait()
    function(21.0)
    hits.put(sum(function.stats.cache_hits.values()))


def compile_in_four_processes(folder):
    """Print how often the cache had the kernel, for each of four processes that need it at once."""
    context = multiprocessing.get_context("fork")  # each would import for seconds otherwise
    barrier, hits = context.Barrier(4), context.Queue()
    processes = [context.Process(target=_compile_together, args=(folder, barrier, hits)) for _ in range(4)]
    for process in processes:
        process.start()
    print(sorted(hits.get(timeout=60) for _ in processes))
    for process in processes:
        process.join()


def printed_by(function, folder):
    """Return what a function of this file prints in a process of its own."""
    code = f"import {__name__} as tests; tests.{function}(tests.Path({str(folder)!r}))"
    return subprocess.check_output([sys.executable, "-c", code], cwd=Path(__file__).parent, text=True)


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX: it forks")
def test_one_of_the_processes_that_need_a_kernel_compiles_it(folder):
    assert printed_by("compile_in_four_processes", folder) == "[0, 1, 1, 1]\n"


@kernel
def lower(a, b):
    return minimum(a, b)


@kernel
def upper(a, b):
    return maximum(a, b)


@entry
def low(a, b):
    return lower(a, b)


@entry
def high(a, b):
    return upper(a, b)


@entry
def low_and_high(a, b):
    return lower(a, b), upper(a, b)


def _call(folder, function, results):
    cache.cache_folder = lambda: folder
    results.put(function(1.0, 2.0))


def call_one_after_another(folder):
    """Print what three functions return, each in a process of its own."""
    context = multiprocessing.get_context("fork")
    results = context.Queue()
    for function in (low, high, low_and_high):
        process = context.Process(target=_call, args=(folder, function, results))
        process.start()
        print(results.get(timeout=60))
        process.join()


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX: it forks")
def test_kernels_that_processes_compiled_alike_are_told_apart_where_they_are_linked(folder):
    # The compiled forms of `minimum` and `maximum` have one name, `<lambda>`, and each is the same number of
    # functions after the beginning of its process, by which Numba tells functions of one name apart.
    assert printed_by("call_one_after_another", folder) == "1.0\n2.0\n(1.0, 2.0)\n"


def test_who_has_waited_long_compiles_it_too(folder, monkeypatch):
    # As another process would that compiles the same, and takes long.
    monkeypatch.setattr(cache, "COMPILE_TIMEOUT", 0.1)
    function = entry(doubled)
    assert function._cache._wait_for_others((numba.int64,))
    assert compiled() == 0
    function._cache.let_others_go_on((numba.int64,))
    assert compiled() == 1
