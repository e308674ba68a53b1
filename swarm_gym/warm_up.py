"""Compile all kernels into the cache: `python -m swarm_gym.warm_up`.

For images and worker processes, and before several processes start that would all compile the same.
"""

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

OPTIONS: dict[str, Any] = {"initial_population_size": 4, "max_population_size": 8}
# The same kernels do for every grid map and encoding; walks have one kind of table on all maps.
GRID: dict[str, Any] = {"scenario": "rooms:0", "encoding": "bezier"}


def _say_nothing(what: str) -> None:
    pass


def warm_up(num_processes: int = 1, report: Callable[[str], None] = _say_nothing) -> None:
    """Compile, or load from the cache, what environments of all optimizers run on maps of both kinds.

    Args:
        num_processes: in how many processes; with one, in this one.
        report: is called with what is ready, again and again.
    """
    # Those with most to compile are the last.
    tasks = [(name, options) for name in reversed(OPTIMIZERS) for options in _kinds_of_maps(name)]
    if num_processes == 1:
        for name, options in tasks:
            report(_warm_up_kind(name, options))
        return
    with ProcessPoolExecutor(min(num_processes, len(tasks)), get_context("spawn"), _hush) as pool:
        try:
            for future in as_completed([pool.submit(_warm_up_kind, *task) for task in tasks]):
                report(future.result())
        except BaseException:  # else all that is not compiled yet would be, first
            for child in active_children():
                child.terminate()
            raise


def warm_up_single(optimizer: str, **options: Any) -> None:
    """The same for single environments of one optimizer with these options, by default on an analytic map."""
    _run(gymnasium.make(environment_id(optimizer), **OPTIONS, **options), np.array([6.0, 1.0]))


def _hush() -> None:
    """Let this process not warn that compiling takes long; other warnings come."""
    logging.getLogger("swarm_gym").addFilter(lambda record: not record.getMessage().startswith("compiling "))


def _warm_up_kind(optimizer: str, options: dict[str, Any]) -> str:
    """The same; what is ready then."""
    warm_up_single(optimizer, **options)
    return f"{optimizer} on grid maps" if options else optimizer


def _kinds_of_maps(optimizer: str) -> list[dict[str, Any]]:
    """Options of environments that have kernels of their own each."""
    return [{}, GRID] if GRID["encoding"] in get_optimizer(optimizer).encodings else [{}]


def _run(env: Any, actions: np.ndarray) -> None:
    env.reset(seed=0)
    simulation = env.unwrapped.simulation
    if simulation.optimizer.adopts:
        env.reset(options={"initial_population": np.zeros((4, simulation.dimension))})
    env.step(actions)
    env.close()


def main() -> None:
    """Warm up, in as many processes as there are processors, and say how long it took."""
    begin = time.perf_counter()
    print("compiling the kernels, once per version of the sources ...", flush=True)
    with command(kept="what was compiled is kept"):
        warm_up(numba.config.NUMBA_NUM_THREADS, lambda what: print(f"  {what}", flush=True))
    print(f"ready after {time.perf_counter() - begin:.1f} s")


if __name__ == "__main__":
    main()
