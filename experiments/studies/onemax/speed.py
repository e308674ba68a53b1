"""Steps per second of the environment, and of the published one in the same run."""

import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import numba
import numpy as np

from experiments.tables import Table
from experiments.tables.cell import Cell
from swarm_gym.controllers.onemax_rules import OPTIMIZER, sizes_of_theory
from swarm_gym.errors import MissingExtraError
from swarm_gym.vector_env import SwarmVectorEnv

SIZE, SWARMS, SECONDS = 500, 1024, 5.0
LARGEST = 6  # exponent of the largest lambda, 64


def speed(checkout: Path) -> Table:
    """Return the table of steps per second at n = 500; lambda is that of theory, as a power of two.

    Args:
        checkout: folder of a checkout of github.com/taindp98/OneMax-MPDAC.

    Raises:
        MissingExtraError: if the checkout, or what it imports, is missing.
    """
    ours, theirs = _our_steps(), _published_steps(checkout)
    # In turns, so that both meet the same disturbances.
    rates = np.array([(_rate(ours), _rate(theirs)) for _ in range(3)])
    medians = np.median(rates, axis=0)
    ratio = float(np.median(rates[:, 0] / rates[:, 1]))
    rows = [
        (
            "swarm_gym, 1,024 side by side",
            Cell.of("{value:,.0f}", value=medians[0]),
            Cell.of("{value:,.0f}", value=ratio),
        ),
        ("OneMax-MPDAC", Cell.of("{value:,.0f}", value=medians[1]), Cell.of("{value:.0f}", value=1.0)),
    ]
    caption = (
        f"Environment steps per second at n = {SIZE} with the lambda of theory, on "
        f"{numba.config.NUMBA_NUM_THREADS} cores; median of three turns of {SECONDS:.0f} s each"
    )
    return Table("speed", caption, ("environment", "steps per second", "times the published"), rows)


def _rate(step: Callable[[], int]) -> float:
    """Return the steps per second of a function that makes some and returns how many."""
    count, begin = 0, time.perf_counter()
    while time.perf_counter() - begin < SECONDS:
        count += step()
    return count / (time.perf_counter() - begin)


def _rounded(lengths: np.ndarray, ones: np.ndarray) -> np.ndarray:
    """Return the exponents of the lambda of theory, rounded to the portfolio."""
    return np.clip(np.rint(np.log2(sizes_of_theory(lengths, ones))), 0, LARGEST)


def _our_steps() -> Callable[[], int]:
    swarms = SwarmVectorEnv(SWARMS, OPTIMIZER, scenario=f"onemax:{SIZE}", iterations=12 * SIZE)
    seen, _ = swarms.reset(seed=0)

    def step() -> int:
        nonlocal seen
        for _ in range(50):
            sizes = 2.0 ** _rounded(seen[:, 0], np.minimum(seen[:, 1], SIZE - 1))
            seen, *_ = swarms.step(np.stack([sizes, np.zeros(SWARMS)], axis=1))
        return 50 * SWARMS

    step()  # compiles
    return step


def _published_steps(checkout: Path) -> Callable[[], int]:
    sys.path.insert(0, str(checkout))
    try:
        benchmark = import_module("dacbench.benchmarks").OLLGATheoryBenchmark
    except ImportError as error:
        raise MissingExtraError(
            f"--published {checkout}", f"a checkout of OneMax-MPDAC and what it imports ({error})", "study"
        ) from error
    environment = benchmark(
        config={
            "name": "OLLGATheory",
            "discrete_action": False,
            "min_action": 1,
            "max_action": 2**LARGEST,
            "problem": "OneMax",
            "instance_set_path": f"om_ollga_{SIZE}_medium.csv",
            "observation_description": "n,f(x)",
            "reward_choice": "imp_minus_evals",
            "seed": 0,
        }
    ).get_environment()
    state, _ = environment.reset()

    def step() -> int:
        nonlocal state
        length, ones = np.array([float(state[0])]), np.array([float(state[1])])
        state, _, first, second, _ = environment.step(2 ** int(_rounded(length, ones)[0]))
        if first or second:
            state, _ = environment.reset()
        return 1

    return step
