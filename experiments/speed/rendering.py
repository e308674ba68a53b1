"""Pictures per second, with and without the iteration before each of them."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import gymnasium
import numpy as np

from experiments.speed.measurement import CASES, Quantity

WIDTH, HEIGHT, SIZE = 640, 400, 100
# All members of a first population collide. Repair makes some of them feasible.
ACTION = np.array([float(SIZE), 0.5])
FIRST_STEP, STEPS = 10, 20
FRAMES = f"frames of {WIDTH} x {HEIGHT}, {SIZE} members"
STEP_AND_RENDER = f"{FRAMES}, env.step and env.render"


def quantities() -> Iterator[Quantity]:
    """Yield the quantities of this group."""
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
            for _ in range(FIRST_STEP):
                env.step(ACTION)
            env.render()  # draws the map, which later frames reuse
            begin = time.perf_counter()
            for _ in range(STEPS):
                advance(env)
                env.render()
            spent += time.perf_counter() - begin
        return len(envs) * STEPS / spent

    return once
