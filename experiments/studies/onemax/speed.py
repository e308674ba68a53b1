"""Steps per second of the environment, and of the published one in the same run.

Both take lambda from a table by the number of ones, and begin episodes again that have not ended after a
number of iterations. Our swarms are spread over an episode first, so that all its parts are timed.
"""

import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import numba
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from experiments.tables import Table
from experiments.tables.cell import Cell, Entry
from swarm_gym.controllers.onemax_rules import OPTIMIZER, sizes_of_theory
from swarm_gym.errors import MissingExtraError
from swarm_gym.vector_env import SwarmVectorEnv

SIZES = (100, 500, 2000, 10_000, 40_000)
SWARMS, SECONDS, TURNS = 2048, 2.0, 3
ITERATIONS = 6000  # of an episode; long strings are not solved by then, and begin again
LARGEST = 6  # exponent of the largest lambda, 64
_PHASES = 16  # groups of swarms that begin one after the other


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
        "without infos is the step of rollouts and training. The published environment takes one string and "
        f"one core. Episodes end after {ITERATIONS:,} iterations at the latest"
    )
    heads = ("n", "step", "step without infos", "OneMax-MPDAC", "ratio", "ratio without infos")
    return Table("speed", caption, heads, rows)


def _rate(step: Callable[[], int]) -> float:
    """Return the steps per second of a function that makes some and returns how many."""
    count, begin = 0, time.perf_counter()
    while time.perf_counter() - begin < SECONDS:
        count += step()
    return count / (time.perf_counter() - begin)


def _table_of_sizes(size: int) -> NDArray[np.float64]:
    """Return (n + 1,) the lambda of theory by the number of ones, rounded to the portfolio; 1 at the end."""
    ones = np.arange(size, dtype=np.float64)
    exponents = np.clip(np.rint(np.log2(sizes_of_theory(np.full(size, float(size)), ones))), 0, LARGEST)
    return np.append(2.0**exponents, 1.0)


def _our_steps(size: int, infos: bool) -> Callable[[], int]:
    """Return a function that makes steps of all swarms, with the infos of `step`, or by `step_running`."""
    swarms = SwarmVectorEnv(
        SWARMS,
        OPTIMIZER,
        autoreset_mode=AutoresetMode.NEXT_STEP if infos else AutoresetMode.DISABLED,
        scenario=f"onemax:{size}",
        iterations=ITERATIONS,
        max_population_size=2**LARGEST,
    )
    seen, _ = swarms.reset(seed=0)
    sizes, actions = _table_of_sizes(size), np.zeros((SWARMS, 2))

    def step(chosen: NDArray[np.bool_] | None = None) -> None:
        nonlocal seen
        actions[:, 0] = sizes[seen[:, 1].astype(np.int64)]
        if infos and chosen is None:
            seen, *_ = swarms.step(actions)
            return
        seen, _, ended = swarms.step_running(actions, chosen)
        if ended.any():
            swarms.begin(ended, None, None)

    def steps() -> int:
        for _ in range(20):
            step()
        return 20 * SWARMS

    everyone, length = np.ones(SWARMS, dtype=np.bool_), 0
    begun = swarms.simulation.iteration.copy()
    while length < ITERATIONS and (swarms.simulation.iteration == begun + length).all():
        step(everyone)  # until the first episode ends
        length += 1
    for phase in range(1, _PHASES):
        for _ in range(length // _PHASES):
            step(np.arange(SWARMS) < phase * SWARMS // _PHASES)
    return steps


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
    sizes, iterations = [int(number) for number in _table_of_sizes(size)], 0

    def step() -> int:
        nonlocal state, iterations
        state, _, first, second, _ = environment.step(sizes[int(state[1])])
        iterations += 1
        if first or second or iterations == ITERATIONS:
            state, _ = environment.reset()
            iterations = 0
        return 1

    return step
