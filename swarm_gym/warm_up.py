"""Compile all kernels into the cache: `python -m swarm_gym.warm_up`.

For images and worker processes, and before several processes start that would all compile the same.
"""

import time
from typing import Any

import gymnasium
import numpy as np

from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.registration import environment_id

OPTIONS: dict[str, Any] = {"initial_population_size": 4, "max_population_size": 8}


def warm_up() -> None:
    """Compile, or load from the cache, what single and vector environments of all optimizers run."""
    for optimizer in OPTIMIZERS:
        warm_up_single(optimizer)
        many = gymnasium.make_vec(environment_id(optimizer), num_envs=2, **OPTIONS)
        _run(many, np.array([[6.0, 1.0], [3.0, 0.0]]))


def warm_up_single(optimizer: str) -> None:
    """The same for single environments of one optimizer."""
    _run(gymnasium.make(environment_id(optimizer), **OPTIONS), np.array([6.0, 1.0]))


def _run(env: gymnasium.Env | gymnasium.vector.VectorEnv, actions: np.ndarray) -> None:
    env.reset(seed=0)
    env.reset(options={"initial_population": np.zeros((4, 31))})
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
