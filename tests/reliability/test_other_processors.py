"""Another processor gives the same bits.

NumPy, OpenBLAS and Numba choose their code by the instructions of the processor. Their own variables make
them leave instructions out, as if the processor lacked them. Each setting runs in a process of its own.
"""

import json
import os
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from agents.backends import BackendOptions
from experiments.choice import Choice
from experiments.evaluate import EvaluateConfig, evaluate
from helpers.fingerprints import PARTS, digests

TESTS = Path(__file__).parents[1]
VARIABLES = (
    "NPY_DISABLE_CPU_FEATURES",
    "OPENBLAS_CORETYPE",
    "OPENBLAS_L2_SIZE",
    "NUMBA_CPU_NAME",
    "NUMBA_CPU_FEATURES",
)
# Whatever NumPy has special code for; it ignores what this processor lacks.
ALL_FEATURES = " ".join(np._core._multiarray_umath.__cpu_dispatch__)
NEWEST_FEATURES = "X86_V4 AVX512_ICL AVX512_SPR"
SETTINGS = {
    "without-special-code": {"NPY_DISABLE_CPU_FEATURES": ALL_FEATURES, "OPENBLAS_CORETYPE": "Nehalem"},
    "without-AVX-512": {"NPY_DISABLE_CPU_FEATURES": NEWEST_FEATURES, "OPENBLAS_CORETYPE": "Haswell"},
}
FAST_PARTS = [part for part in PARTS if part != "other_episodes"]
# Fireflies alone are for settings in which all kernels are compiled anew.
COMPILED_ANEW = ["firefly", "elementary"]
GENERIC = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}


def run(*arguments, **settings):
    """Return what Python prints in a process with these environment variables."""
    environment = {name: value for name, value in os.environ.items() if name not in VARIABLES}
    done = subprocess.run(
        [sys.executable, "-W", "ignore", *arguments],
        env={**environment, "PYTHONPATH": str(TESTS.parent), **settings},
        cwd=TESTS.parent,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


def digests_of(parts, **settings):
    """Return the digests of some parts, computed in a process with these environment variables."""
    return json.loads(run(str(TESTS / "helpers" / "fingerprints.py"), *parts, **settings))


def assert_same(found, expected):
    assert found.keys() == expected.keys()
    assert [name for name in expected if found[name] != expected[name]] == []


@pytest.fixture(scope="module")
def here():
    """Digests of the fast parts on this processor, which this process is on."""
    found = digests(FAST_PARTS)
    assert len(found) > 600
    return found


@pytest.mark.skipif(sys.platform == "darwin", reason="OpenBLAS is not what NumPy uses on macOS")
@pytest.mark.parametrize(
    "setting", ["without-special-code", pytest.param("without-AVX-512", marks=pytest.mark.slow)]
)
def test_numpy_and_openblas_with_other_instructions_give_the_same_bits(here, setting):
    assert_same(digests_of(FAST_PARTS, **SETTINGS[setting]), here)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "darwin", reason="OpenBLAS is not what NumPy uses on macOS")
@pytest.mark.parametrize("setting", SETTINGS)
def test_episodes_of_all_other_recipes_have_the_same_bits_with_other_instructions(setting):
    expected = digests_of(["other_episodes"])
    assert len(expected) > 40
    assert_same(digests_of(["other_episodes"], **SETTINGS[setting]), expected)


def test_kernels_for_any_processor_give_the_same_bits(here):
    expected = {name: found for name, found in here.items() if name.partition(":")[0] in COMPILED_ANEW}
    assert len(expected) == 10
    assert_same(digests_of(COMPILED_ANEW, **GENERIC), expected)


@pytest.mark.slow
def test_all_kernels_for_any_processor_give_the_same_bits(here):
    expected = {**here, **digests_of(["other_episodes"])}
    assert_same(digests_of([*FAST_PARTS, "other_episodes"], **GENERIC), expected)


def test_the_comparison_finds_a_function_that_depends_on_the_processor(here):
    changed = {**here, "elementary: exp": "0" * 16}
    with pytest.raises(AssertionError, match="elementary: exp"):
        assert_same(changed, here)


def test_a_results_database_is_continued_on_another_processor(tmp_path):
    database = tmp_path / "both.sqlite"
    names = ["spsfa-tip", "open-loop:three-cases", "reacting-loop:three-cases", "learned:three-cases/0@1"]

    def evaluated(seeds, path, **settings):
        if settings:
            command = ["--controllers", *names, "--scenarios", "case3", "--seeds", str(seeds), "--no-figures"]
            options = ["--jobs", "1", "--database", str(path), "--output", str(tmp_path)]
            run("-m", "experiments.evaluate", *command, *options, **settings)
        else:  # this process is on this processor, and has imported all that a further one would
            evaluate(
                EvaluateConfig(
                    seeds=seeds, controllers=tuple(names), choice=Choice(scenarios=("case3",)), figures=False,
                    where=BackendOptions(jobs=1), database=path, output=tmp_path,
                )
            )  # fmt: skip
        with closing(sqlite3.connect(path)) as connection:
            return connection.execute(
                "SELECT controller, seed, seconds, final_fitness, best_path FROM runs ORDER BY 1, 2"
            ).fetchall()

    first = evaluated(2, database)
    both = evaluated(3, database, **SETTINGS["without-special-code"])
    assert [row for row in both if row[1] < 2] == first  # none was repeated: the seconds are the same
    assert len(both) == 3 * len(names)
    alone = evaluated(3, tmp_path / "alone.sqlite")
    assert [(*row[:2], *row[3:]) for row in alone] == [(*row[:2], *row[3:]) for row in both]
