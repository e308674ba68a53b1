"""Compile all kernels into the cache: `python -m swarm_gym.warm_up`.

For images and worker processes, and before several processes start that would all compile the same.
"""

import time
from typing import Any

import gymnasium
import numpy as np

from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.registration import environment_id

OPTIONS: dict[str, Any] = {"initial_population_size": 4, "max_population_size": 8}
# The same kernels do for every grid map and encoding; walks have one kind of table on all maps.
GRID: dict[str, Any] = {"scenario": "rooms:0", "encoding": "bezier"}


def warm_up() -> None:
    """Compile, or load from the cache, what environments of all optimizers run on maps of both kinds."""
    for optimizer in OPTIMIZERS:
        warm_up_single(optimizer)
        if GRID["encoding"] in get_optimizer(optimizer).encodings:
            warm_up_single(optimizer, **GRID)


def warm_up_single(optimizer: str, **options: Any) -> None:
    """The same for single environments of one optimizer with these options, by default on an analytic map."""
    _run(gymnasium.make(environment_id(optimizer), **OPTIONS, **options), np.array([6.0, 1.0]))


def _run(env: Any, actions: np.ndarray) -> None:
    env.reset(seed=0)
    simulation = env.unwrapped.simulation
    if simulation.optimizer.adopts:
        env.reset(options={"initial_population": np.zeros((4, simulation.dimension))})
    env.step(actions)
    env.close()


def main() -> None:
    """Warm up and say how long it took."""
    begin = time.perf_counter()
    print("compiling the kernels, once per version of the sources ...", flush=True)
    warm_up()
    print(f"ready after {time.perf_counter() - begin:.1f} s")


if __name__ == "__main__":
    main()
