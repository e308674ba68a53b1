"""Equal seeds give equal bits: alone, in a vector of any width, with any threads, after copying."""

import copy
import hashlib
import os
import pickle
import platform
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from helpers.builders import options_for
from helpers.newcomers import PATH_OPTIMIZERS
from helpers.slow import slow_but
from swarm_gym.env import SwarmEnv
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.vector_env import SwarmVectorEnv

OPTIONS = {
    "scenario": ["case1", "case2", "case3"],
    "initial_population_size": 12,
    "max_population_size": 30,
    "iterations": 8,
}
TESTS = Path(__file__).parents[1]
SEED = 40
WIDEST = 64


def actions(seed, optimizer="firefly"):
    """Return eight decisions for the swarm of a seed, with sizes that the optimizer can have."""
    generator = np.random.default_rng(seed)
    sizes = np.maximum(generator.integers(2, 31, 8), get_optimizer(optimizer).smallest_population)
    return np.stack([sizes, generator.random(8).round(1)], axis=1)


def alone(seed, optimizer="firefly", **options):
    env = SwarmEnv(optimizer, **OPTIONS, **options)
    env.reset(seed=seed)
    return [env.step(action) for action in actions(seed, optimizer)]


def assert_same_in_a_vector(of_seed, width, optimizer="firefly", **options):
    """Assert that swarms of a vector go on as alone, whose steps `of_seed` returns."""
    env = SwarmVectorEnv(width, optimizer, autoreset_mode=AutoresetMode.DISABLED, **options, **OPTIONS)
    env.reset(seed=SEED)
    decisions = np.stack([actions(SEED + row, optimizer) for row in range(width)], axis=1)
    steps = [env.step(decision) for decision in decisions]
    for row in range(width):
        for one, many in zip(of_seed(SEED + row), steps, strict=True):
            np.testing.assert_array_equal(one[0], many[0][row])
            assert one[1] == many[1][row]
            assert one[2] == many[2][row]
            np.testing.assert_array_equal(one[4]["best_path"], many[4]["best_path"][row])
            assert one[4]["best_fitness"] == many[4]["best_fitness"][row]


@pytest.fixture(scope="module")
def singles():
    return {seed: alone(seed) for seed in range(SEED, SEED + WIDEST)}


@pytest.mark.parametrize("width", [1, 2, WIDEST])
@pytest.mark.parametrize("threads", [1, 2])
def test_episodes_are_the_same_in_any_vector_width_with_any_number_of_threads(
    singles, width, threads, numba_threads
):
    if threads > numba_threads:
        pytest.skip(f"this machine has {numba_threads} thread(s)")
    assert_same_in_a_vector(singles.get, width, num_threads=threads)


@pytest.mark.parametrize(
    "optimizer", slow_but([name for name in OPTIMIZERS if name != "ant-colony"], OPTIMIZERS)
)
def test_every_optimizer_has_the_same_episodes_in_a_vector_as_alone(optimizer):
    assert_same_in_a_vector(lambda seed: alone(seed, optimizer), 5, optimizer=optimizer)


@pytest.mark.parametrize("optimizer", PATH_OPTIMIZERS)
def test_members_from_every_source_are_the_same_in_a_vector_as_alone(optimizer):
    options = {"source": "mixed", "smooth_share": 0.4, "bends": "stomp"}
    assert_same_in_a_vector(lambda seed: alone(seed, optimizer, **options), 5, optimizer=optimizer, **options)


DUPLICATIONS = copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))
ON_CELLS = {"scenario": ["rooms:0-1"], "encoding": "bezier"}
duplications = pytest.mark.parametrize("duplicate", DUPLICATIONS, ids=["deep", "pickle"])


@pytest.mark.parametrize(
    ("duplicate", "optimizer", "maps"),
    # Each optimizer on a map of its own kind, and one on maps of cells; both ways to copy.
    slow_but(
        [
            *((DUPLICATIONS[0], name, {}) for name in OPTIMIZERS),
            (DUPLICATIONS[1], "firefly", {}),
            (DUPLICATIONS[1], "particle-swarm", ON_CELLS),
        ],
        [
            (duplicate, name, maps)
            for duplicate in DUPLICATIONS
            for name in OPTIMIZERS
            for maps in ({}, ON_CELLS)
        ],
    ),
)
def test_a_copy_made_in_mid_episode_goes_on_alike(duplicate, optimizer, maps):
    env = SwarmEnv(optimizer, **{**OPTIONS, **options_for(optimizer, **maps)})
    decisions = actions(SEED, optimizer)
    assert_same_after_copying(env, decisions[:4], decisions[4:], duplicate)


@duplications
def test_a_copy_of_a_vector_made_in_mid_episode_goes_on_alike(duplicate):
    decision = np.tile([9, 0.5], (3, 1))
    assert_same_after_copying(SwarmVectorEnv(3, **OPTIONS), [decision], [decision] * 12, duplicate)


def assert_same_after_copying(env, before, after, duplicate):
    env.reset(seed=SEED)
    for action in before:
        env.step(action)
    twin = duplicate(env)
    rest = [env.step(action) for action in after]
    for one, action in zip(rest, after, strict=True):
        other = twin.step(action)
        np.testing.assert_array_equal(one[0], other[0])
        np.testing.assert_array_equal(one[1], other[1])
    # The next episode follows from the same seed too.
    np.testing.assert_array_equal(env.reset()[0], twin.reset()[0])


def fingerprint():
    digest = hashlib.sha256()
    for observation, reward, *_, info in alone(SEED):
        digest.update(observation.tobytes())
        digest.update(np.float64(reward).tobytes())
        digest.update(info["best_path"].tobytes())
    return digest.hexdigest()


def fingerprint_elsewhere(**environment):
    code = "from test_determinism import fingerprint; print(fingerprint())"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=Path(__file__).parent,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (TESTS.parent, TESTS))), **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


def test_results_are_the_same_in_a_subprocess():
    assert fingerprint_elsewhere() == fingerprint()


@pytest.mark.slow
@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="needs an x86-64 processor")
@pytest.mark.parametrize("processor", ["x86-64", "haswell"])
def test_results_are_the_same_compiled_for_a_processor_with_shorter_vectors(processor, tmp_path):
    # Two and four lanes at a time instead of, perhaps, eight, whatever the name of the processor.
    found = fingerprint_elsewhere(
        NUMBA_CPU_NAME=processor, NUMBA_CPU_FEATURES="", SWARM_GYM_CACHE=str(tmp_path)
    )
    assert found == fingerprint()


@pytest.mark.slow
def test_compiled_anew_and_read_from_the_cache(tmp_path):
    found = [fingerprint_elsewhere(SWARM_GYM_CACHE=str(tmp_path)) for _ in range(2)]
    assert any(tmp_path.rglob("*.nbi"))
    assert found == [fingerprint()] * 2


def test_different_seeds_differ(singles):
    first = {tuple(steps[0][0]) for steps in singles.values()}
    assert len(first) == WIDEST
