"""Code that is compiled for classes of users is compiled anew when their sources change."""

import shutil
import subprocess
import sys
import types
from pathlib import Path
from typing import NamedTuple

import numba
import pytest

from swarm_gym.compiler.own_sources import UnknownSourceError, digest_of_modules, own_modules
from swarm_gym.optimizers.firefly import FireflyParameters

pytestmark = pytest.mark.skipif(
    bool(numba.config.DISABLE_JIT), reason="NUMBA_DISABLE_JIT=1 turns off the compiler"
)
ROOT = Path(__file__).parents[3]

HELPER = """
from swarm_gym.compiler.jit import kernel

@kernel
def scaled(x):
    return 2.0 * x
"""
OWN = """
from typing import NamedTuple
from swarm_gym.compiler.jit import entry, kernel, kernel_by_class
from mine.helper import scaled

class Mine(NamedTuple):
    value: float

@kernel
def taken(mine):
    return scaled(mine.value)
"""
# A function of a module that stays, as the loop over all optimizers does, called with the class of a user.
SHARED = """
from typing import NamedTuple
from swarm_gym.compiler.jit import entry, kernel, kernel_by_class

class Ours(NamedTuple):
    value: float

@kernel
def taken_ours(ours):
    return ours.value

TAKEN = {Ours: taken_ours}
take = kernel_by_class(TAKEN)

@entry
def call(parameters):
    return take(parameters) + 1.0
"""
# A module of this package, as far as its name tells.
LOAD = """
import importlib.util, sys
spec = importlib.util.spec_from_file_location("swarm_gym.shared", {file!r})
shared = sys.modules["swarm_gym.shared"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(shared)
"""
CALL_MINE = """
from mine.own import Mine, taken
shared.TAKEN[Mine] = taken
print(shared.call(Mine(5.0)), sum(shared.call.stats.cache_hits.values()))
"""
CALL_OURS = "print(shared.call(shared.Ours(5.0)), sum(shared.call.stats.cache_hits.values()))"


@pytest.fixture
def call(tmp_path):
    """Return a function that runs code in a process of its own, beside `mine`, and returns its output."""
    (tmp_path / "mine").mkdir()
    for name, text in {"__init__": "", "helper": HELPER, "own": OWN}.items():
        (tmp_path / f"mine/{name}.py").write_text(text)
    (tmp_path / "shared.py").write_text(SHARED)

    def run(code):
        environment = {
            "PYTHONPATH": f"{tmp_path}:{ROOT}", "SWARM_GYM_CACHE": str(tmp_path / "cache"), "PATH": "",
        }  # fmt: skip
        done = subprocess.run(
            [sys.executable, "-c", LOAD.format(file=str(tmp_path / "shared.py")) + code],
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr[-2000:]
        assert "damaged" not in done.stderr
        return done.stdout.split()

    return run


def test_an_edit_of_what_an_own_module_imports_is_noticed(call, tmp_path):
    assert [call(CALL_MINE), call(CALL_MINE)] == [["11.0", "0"], ["11.0", "1"]]
    (tmp_path / "mine/helper.py").write_text(HELPER.replace("2.0", "3.0"))
    assert [call(CALL_MINE), call(CALL_MINE)] == [["16.0", "0"], ["16.0", "1"]]


def test_what_was_compiled_for_an_own_class_is_not_read_without_it(call, tmp_path):
    assert [call(CALL_OURS), call(CALL_MINE)] == [["6.0", "0"], ["11.0", "0"]]
    shutil.rmtree(tmp_path / "mine")
    assert call(CALL_OURS) == ["6.0", "1"]  # and says nothing of damage


class Own(NamedTuple):
    value: float


def test_classes_of_users_are_found_inside_of_tuples():
    one, ours = numba.typeof(Own(1.0)), numba.typeof(FireflyParameters(1.0, 1.0, 1.0))
    pair = numba.types.Tuple((numba.int64, one))
    assert own_modules("swarm_gym.optimizers.loop", (numba.int64, pair)) == {__name__}
    assert own_modules("swarm_gym.optimizers.loop", (ours, numba.int64)) == frozenset()
    assert own_modules("mine.own", (ours,)) == {"mine.own"}


def test_without_a_source_file_nothing_is_kept(monkeypatch):
    monkeypatch.setitem(sys.modules, "typed_in", types.ModuleType("typed_in"))
    with pytest.raises(UnknownSourceError, match="typed_in"):
        digest_of_modules(frozenset({"typed_in"}))
