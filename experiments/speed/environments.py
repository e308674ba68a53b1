"""Steps per second of single and vector environments, and pictures per second of single ones."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import gymnasium
import numpy as np

from experiments.speed.measurement import ALL_THREADS, CASES, Quantity, seconds_of
from swarm_gym.vector_env import SwarmVectorEnv

SIZES = (30, 60, 100)
WIDTHS = (8, 64, 512, 4096)
THREADS = tuple(sorted({1, ALL_THREADS}))
# All rates are of these steps of an episode, since the first iteration makes fewer moves than later ones.
FIRST_STEP, LAST_STEP = 10, 90
SHORT_RUN = 1e6  # approximate number of moves of a measurement
WIDTH, HEIGHT, SIZE = 640, 400, 100  # of pictures, in pixels, and number of members in them
# All members of a first population collide. Repair makes some of them feasible.
ACTION = np.array([float(SIZE), 0.5])
FIRST_FRAME, FRAMES_MADE = 10, 20
FRAMES = f"frames of {WIDTH} x {HEIGHT}, {SIZE} members"
STEP_AND_RENDER = f"{FRAMES}, env.step and env.render"


def quantities() -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    for size in SIZES:
        yield Quantity(f"single environment, {size} members", "steps/s", single(size))
        for width in WIDTHS:
            for threads in THREADS:
                yield Quantity(name(width, size, threads), "steps/s", vector(width, size, threads))


def name(width: int, size: int, threads: int) -> str:
    """Return the name of a quantity of vector environments."""
    return f"{width} swarms of {size} members, {threads} thread{'s' * (threads > 1)}"


def single(size: int) -> Callable[[], float]:
    """Return a function that measures environments of `gymnasium.make`, on the three cases in turn."""
    envs = [
        gymnasium.make("swarm_gym/Firefly-v0", scenario=case, initial_population_size=size) for case in CASES
    ]
    action = np.array([float(size), 0.0])

    def once() -> float:
        spent = 0.0
        for env in envs:
            env.reset(seed=0)
            run_steps(env, action, FIRST_STEP)
            spent += run_steps(env, action, LAST_STEP - FIRST_STEP)
        return len(envs) * (LAST_STEP - FIRST_STEP) / spent

    return once


def vector(width: int, size: int, threads: int, moves: float = SHORT_RUN) -> Callable[[], float]:
    """Return a function that measures a native vector environment over the three cases.

    Each call continues where the last one ended. It makes about `moves` moves, in at most one episode.
    """
    env: SwarmVectorEnv | None = None  # made at the first call, since some are large
    actions = np.tile([float(size), 0.0], (width, 1))
    steps = int(min(LAST_STEP - FIRST_STEP, max(2, moves / (width * size**2 / 2))))
    done = LAST_STEP

    def once() -> float:
        nonlocal env, done
        if env is None:
            env = SwarmVectorEnv(
                width, scenario=list(CASES), initial_population_size=size, num_threads=threads
            )
        if done + steps > LAST_STEP:
            env.reset(seed=0)
            run_steps(env, actions, FIRST_STEP)
            done = FIRST_STEP
        done += steps
        return steps * width / run_steps(env, actions, steps)

    return once


def run_steps(env: gymnasium.Env | SwarmVectorEnv, actions: np.ndarray, steps: int) -> float:
    """Return the wall time of some steps in seconds."""
    return seconds_of(lambda: [env.step(actions) for _ in range(steps)])


def picture_quantities() -> Iterator[Quantity]:
    """Yield the quantities of the group of pictures."""
    yield Quantity(STEP_AND_RENDER, "frames/s", frames_per_second(lambda env: env.step(ACTION)))
    yield Quantity(f"{FRAMES}, env.render alone", "frames/s", frames_per_second(lambda _: None))


def frames_per_second(advance: Callable[[Any], Any]) -> Callable[[], float]:
    """Return a function that measures frames per second on the cases; `advance` runs before each frame."""
    envs = [
        gymnasium.make(
            "swarm_gym/Firefly-v0",
            scenario=case,
            initial_population_size=SIZE,
            render_mode="rgb_array",
            render_width=WIDTH,
            render_height=HEIGHT,
        )
        for case in CASES
    ]

    def once() -> float:
        spent = 0.0
        for env in envs:
            env.reset(seed=0)
            for _ in range(FIRST_FRAME):
                env.step(ACTION)
            env.render()  # draws the map, which later frames reuse
            begin = time.perf_counter()
            for _ in range(FRAMES_MADE):
                advance(env)
                env.render()
            spent += time.perf_counter() - begin
        return len(envs) * FRAMES_MADE / spent

    return once
