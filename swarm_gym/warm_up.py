"""Compile all kernels into the cache: `python -m swarm_gym.warm_up`.

For images and worker processes, and before several processes start that would all compile the same.
"""

import time
from typing import Any

import gymnasium
import numpy as np

from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.registration import environment_id


def warm_up() -> None:
    """Compile, or load from the cache, what single and vector environments of all optimizers run."""
    options: dict[str, Any] = {"initial_population_size": 4, "max_population_size": 8}
    for optimizer in OPTIMIZERS:
        env = gymnasium.make(environment_id(optimizer), **options)
        _run(env, np.array([6.0, 1.0]))
        many = gymnasium.make_vec(environment_id(optimizer), num_envs=2, **options)
        _run(many, np.array([[6.0, 1.0], [3.0, 0.0]]))


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
