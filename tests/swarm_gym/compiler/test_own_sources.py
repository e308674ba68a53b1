"""Code that is compiled for classes of users is compiled anew when their sources change."""

import shutil
import subprocess
import sys
import types
from pathlib import Path
from typing import NamedTuple

import numba
import pytest

from helpers.slow import slow_but
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

@entry
def whole(mine):
    return taken(mine) + 1.0
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
CALL_WHOLE = """
from mine.own import Mine, whole
print(whole(Mine(5.0)), sum(whole.stats.cache_hits.values()))
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
    assert call(CALL_MINE) == ["16.0", "0"]


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


TYPED_IN = """
from typing import NamedTuple
from swarm_gym.compiler.jit import entry, kernel

class Typed(NamedTuple):
    value: float

@kernel
def doubled(typed):
    return 2.0 * typed.value

@entry
def call(typed):
    return doubled(typed) + 1.0

print(call(Typed(5.0)), sum(call.stats.cache_hits.values()))
"""
# Two cells of IPython; the second one is the first after an edit.
CELLS = """
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
for factor in ("2.0", "7.0"):
    shell.run_cell({code!r}.replace("2.0", factor)).raise_error()
"""


def run(tmp_path, arguments, code=None):
    """Run Python with kernels in a cache of their own; return what it printed and the files of own code."""
    environment = {
        "PYTHONPATH": str(ROOT),
        "SWARM_GYM_CACHE": str(tmp_path / "cache"),
        "IPYTHONDIR": str(tmp_path),
        "PATH": "",
    }
    done = subprocess.run(
        [sys.executable, *arguments],
        input=code,
        env=environment,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.split(), list((tmp_path / "cache").rglob("own-*"))


@pytest.mark.parametrize("how", slow_but(["python -i"], ["-c", "standard input", "python -i"]))
def test_kernels_that_are_typed_in_are_compiled_in_each_process(tmp_path, how):
    if how == "python -i":  # a module with a file, in which a prompt goes on
        (tmp_path / "begun.py").write_text("begun = True\n")
    arguments = {"-c": ["-c", TYPED_IN], "standard input": ["-"], "python -i": ["-i", "begun.py"]}[how]
    # At a prompt, an empty line ends a definition, and what follows it must not be one.
    for _ in range(2):
        assert run(tmp_path, arguments, TYPED_IN) == (["11.0", "0"], [])


def test_an_edited_cell_has_new_kernels(tmp_path):
    pytest.importorskip("IPython", reason="needs the group `docs`")
    assert run(tmp_path, ["-c", CELLS.format(code=TYPED_IN)]) == (["11.0", "0", "36.0", "0"], [])


EDIT = """
import importlib
from pathlib import Path
import mine.helper, mine.own
{call}
helper = Path(mine.helper.__file__)
helper.write_text(helper.read_text().replace("2.0", "{factor}"))
for module in (mine.helper, mine.own):
    importlib.reload(module)
{call}
assert whole.py_func.__qualname__ == "whole@2"  # the old code is linked, too, under the name without number
"""


@pytest.mark.slow
def test_a_module_that_is_executed_again_has_new_kernels_and_leaves_nothing_in_the_cache(call, tmp_path):
    edit = EDIT.format(call=CALL_WHOLE, factor="3.0")
    assert call(CALL_WHOLE) == ["11.0", "0"]  # kept, and linked below before the new one is compiled
    kept = sorted((tmp_path / "cache").rglob("*.nbc"))
    assert call(edit) == ["11.0", "1", "16.0", "0"]
    assert sorted((tmp_path / "cache").rglob("*.nbc")) == kept
    assert [call(CALL_WHOLE), call(CALL_WHOLE)] == [["16.0", "0"], ["16.0", "1"]]


@pytest.mark.slow
def test_a_source_counts_as_it_was_executed(call, tmp_path):
    edit = """
from pathlib import Path
import mine.own, mine.helper
Path(mine.helper.__file__).write_text(Path(mine.helper.__file__).read_text().replace("2.0", "4.00"))
"""
    assert call(edit + CALL_MINE) == ["11.0", "0"]  # compiled after the edit, from what was imported before
    assert call(CALL_MINE) == ["21.0", "0"]
