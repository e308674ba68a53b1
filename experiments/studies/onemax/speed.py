"""Steps per second of the environment, and of the published one in the same run."""

import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import numba
import numpy as np
from gymnasium.vector import AutoresetMode

from experiments.tables import Table
from experiments.tables.cell import Cell, Entry
from swarm_gym.controllers.onemax_rules import OPTIMIZER, sizes_of_theory
from swarm_gym.errors import MissingExtraError
from swarm_gym.vector_env import SwarmVectorEnv

SIZES = (100, 500, 2000, 10_000)
SWARMS, SECONDS, TURNS = 1024, 2.0, 3
ITERATIONS = 6000  # of an episode; long strings are not solved by then, and begin again
LARGEST = 6  # exponent of the largest lambda, 64


def speed(checkout: Path) -> Table:
    """Return the table of steps per second by length; lambda is that of theory, as a power of two.

    Args:
        checkout: folder of a checkout of github.com/taindp98/OneMax-MPDAC.

    Raises:
        MissingExtraError: if the checkout, or what it imports, is missing.
    """
    rows: list[tuple[Entry, ...]] = []
    for size in SIZES:
        steps = _our_steps(size, infos=True), _our_steps(size, infos=False), _published_steps(checkout, size)
        # In turns, so that all meet the same disturbances.
        rates = np.array([[_rate(step) for step in steps] for _ in range(TURNS)])
        whole, bare, theirs = np.median(rates, axis=0)
        ratios = np.median(rates[:, :2] / rates[:, 2:], axis=0)
        numbers = (Cell.of("{value:,.0f}", value=value) for value in (whole, bare, theirs, *ratios))
        rows.append((f"{size:,}", *numbers))
    caption = (
        f"Environment steps per second with the lambda of theory, on {numba.config.NUMBA_NUM_THREADS} cores; "
        f"medians of {TURNS} turns of {SECONDS:.0f} s each. swarm_gym has {SWARMS:,} swarms side by side; "
        "without infos is the step of rollouts and training"
    )
    heads = ("n", "step", "step without infos", "OneMax-MPDAC", "ratio", "ratio without infos")
    return Table("speed", caption, heads, rows)


def _rate(step: Callable[[], int]) -> float:
    """Return the steps per second of a function that makes some and returns how many."""
    count, begin = 0, time.perf_counter()
    while time.perf_counter() - begin < SECONDS:
        count += step()
    return count / (time.perf_counter() - begin)


def _rounded(lengths: np.ndarray, ones: np.ndarray) -> np.ndarray:
    """Return the exponents of the lambda of theory, rounded to the portfolio."""
    return np.clip(np.rint(np.log2(sizes_of_theory(lengths, ones))), 0, LARGEST)


def _our_steps(size: int, infos: bool) -> Callable[[], int]:
    """Return a function that makes steps of all swarms, with the infos of `step`, or by `step_running`."""
    mode = AutoresetMode.NEXT_STEP if infos else AutoresetMode.DISABLED
    scenario = f"onemax:{size}"
    swarms = SwarmVectorEnv(SWARMS, OPTIMIZER, autoreset_mode=mode, scenario=scenario, iterations=ITERATIONS)
    seen, _ = swarms.reset(seed=0)

    def step() -> int:
        nonlocal seen
        for _ in range(20):
            sizes = 2.0 ** _rounded(seen[:, 0], np.minimum(seen[:, 1], size - 1))
            actions = np.stack([sizes, np.zeros(SWARMS)], axis=1)
            if infos:
                seen, *_ = swarms.step(actions)
                continue
            seen, _, ended = swarms.step_running(actions)
            if ended.any():
                swarms.begin(ended, None, None)
        return 20 * SWARMS

    step()  # compiles
    return step


def _published_steps(checkout: Path, size: int) -> Callable[[], int]:
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
            "instance_set_path": f"om_ollga_{size}_medium.csv",
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
