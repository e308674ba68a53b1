"""Compile all kernels into the cache: `python -m swarm_gym.warm_up`.

Run it when building images, on workers, and before several processes start that would compile the same
kernels.
"""

import argparse
import logging
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import active_children, get_context
from typing import Any

import gymnasium
import numba
import numpy as np

from swarm_gym.command import command
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.registration import environment_id

OPTIONS = {"initial_population_size": 4, "max_population_size": 8}
# All grid maps and encodings share their kernels. Walks have the same problem table on all maps.
GRID = {"scenario": "rooms:0", "encoding": "bezier"}


def _say_nothing(what: str) -> None:
    pass


def warm_up(num_processes: int = 1, report: Callable[[str], None] = _say_nothing) -> None:
    """Compile, or load from the cache, the kernels of all optimizers for analytic maps and grid maps.

    Args:
        num_processes: number of processes to compile in; with 1, this process compiles.
        report: function that is called with the name of each environment when it is ready.
    """
    # The optimizers with most to compile come last in the registry.
    tasks = [(name, options) for name in reversed(OPTIMIZERS) for options in _kinds_of_maps(name)]
    if num_processes == 1:
        for name, options in tasks:
            report(_warm_up_kind(name, options))
        return
    with ProcessPoolExecutor(min(num_processes, len(tasks)), get_context("spawn"), _hush) as pool:
        try:
            for future in as_completed([pool.submit(_warm_up_kind, *task) for task in tasks]):
                report(future.result())
        except BaseException:  # otherwise the pool would finish all its tasks first
            for child in active_children():
                child.terminate()
            raise


def warm_up_single(optimizer: str, **options: object) -> None:
    """Compile, or load from the cache, the kernels of single environments of one optimizer.

    Args:
        optimizer: name of the optimizer.
        options: options of the environment; by default it has an analytic map.
    """
    chosen: dict[str, Any] = {**OPTIONS, **options}
    degree = 1.0 if get_optimizer(optimizer).repairs else 0.0
    _run(gymnasium.make(environment_id(optimizer), **chosen), np.array([6.0, degree]))


def _hush() -> None:
    """Suppress the warning that compiling takes long in this process; other warnings remain."""
    logging.getLogger("swarm_gym").addFilter(lambda record: not record.getMessage().startswith("compiling "))


def _warm_up_kind(optimizer: str, options: dict[str, str]) -> str:
    """Compile the kernels of one kind of environment; return what is ready then."""
    warm_up_single(optimizer, **options)
    return f"{optimizer} on grid maps" if options else optimizer


def _kinds_of_maps(optimizer: str) -> list[dict[str, str]]:
    """Return the options of one environment for each set of kernels of an optimizer."""
    return [{}, GRID] if GRID["encoding"] in get_optimizer(optimizer).encodings else [{}]


def _run(env: Any, actions: np.ndarray) -> None:
    env.reset(seed=0)
    simulation = env.unwrapped.simulation
    if simulation.optimizer.adopts:
        env.reset(options={"initial_population": np.zeros((4, simulation.dimension))})
    env.step(actions)
    env.close()


def main() -> None:
    """Compile in as many processes as there are processors, and print how long it took."""
    parser = argparse.ArgumentParser(
        prog="python -m swarm_gym.warm_up",
        description="Compile the kernels of all optimizers into the user's cache, on all processors.",
    )
    parser.parse_args()
    begin = time.perf_counter()
    print("compiling the kernels, once per version of the sources ...", flush=True)
    with command(kept="compiled kernels are kept"):
        warm_up(numba.config.NUMBA_NUM_THREADS, lambda what: print(f"  {what}", flush=True))
    print(f"ready after {time.perf_counter() - begin:.1f} s")


if __name__ == "__main__":
    main()
