"""Time of the import and of the first step, with and without cached kernels; memory of many swarms."""

import math
import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from experiments.speed.measurement import Quantity, run_python, seconds_of

FIRST_STEP = """
import time
begin = time.perf_counter()
import gymnasium, numpy as np, swarm_gym
env = gymnasium.make("swarm_gym/Firefly-v0")
env.reset(seed=0)
env.step(np.array([60.0, 0.0]))
print(time.perf_counter() - begin)
"""
FIRST_VECTOR_STEP = FIRST_STEP.replace(
    'make("swarm_gym/Firefly-v0")', 'make_vec("swarm_gym/Firefly-v0", 8)'
).replace("np.array([60.0, 0.0])", "np.tile([60.0, 0.0], (8, 1))")
HEAVY = ("torch", "stable_baselines3", "matplotlib", "pandas", "scipy", "pygame")
IMPORTED = f"import sys, swarm_gym; print(sum(name in sys.modules for name in {HEAVY!r}))"
STATUS = Path("/proc/self/status")  # of this process, on Linux
MANY_SWARMS, CAPACITY = 4096, 200
PEAK_OF_MANY = f"peak memory of {MANY_SWARMS} swarms of capacity {CAPACITY}, 31 waypoints"
PEAK_MEMORY = f"""
import numpy as np
from experiments.speed.start import peak_bytes
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.warm_up import warm_up
warm_up()
before = peak_bytes()
env = SwarmVectorEnv({MANY_SWARMS}, scenario=["case1", "case2", "case3"], max_population_size={CAPACITY},
                     initial_population_size={CAPACITY})
env.reset(seed=0)
env.step(np.tile([2.0, 0.5], ({MANY_SWARMS}, 1)))
print(peak_bytes() - before)
"""


def quantities() -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    yield Quantity("import swarm_gym", "s", import_seconds)
    yield Quantity(f"of {', '.join(HEAVY)}, imported with it", "", lambda: float(run_python(IMPORTED)), 1)
    for kind, program in (("single", FIRST_STEP), ("vector", FIRST_VECTOR_STEP)):
        begun = f"import and first step, {kind}"
        yield Quantity(f"{begun}, kernels cached", "s", first_step(program, cold=False))
        yield Quantity(f"{begun}, nothing cached", "s", first_step(program, cold=True), 1)
    yield Quantity(PEAK_OF_MANY, "MiB", peak_mebibytes, 1)


def import_seconds() -> float:
    """Return the time of `import swarm_gym` in a fresh interpreter, without the start of the interpreter."""
    return seconds_of(lambda: run_python("import swarm_gym")) - seconds_of(lambda: run_python("pass"))


def first_step(program: str, cold: bool) -> Callable[[], float]:
    """Return a function that measures the time from the first import to the end of the first step."""

    def once() -> float:
        if not cold:
            return float(run_python(program))
        with tempfile.TemporaryDirectory() as cache:
            return float(run_python(program, {**os.environ, "SWARM_GYM_CACHE": cache}))

    return once


def peak_bytes() -> float:
    """Return the peak memory of this process in bytes; NaN on Windows, where Python does not know it."""
    # On Linux, the peak in `resource` begins with that of the process which started this one.
    with suppress(OSError):
        status = STATUS.read_text(encoding="utf-8", errors="replace")
        if found := re.search(r"^VmHWM:\s*(\d+) kB", status, re.MULTILINE):
            return float(found[1]) * 1024
    try:
        import resource
    except ImportError:
        return math.nan
    unit = 1 if sys.platform == "darwin" else 1024  # macOS counts bytes, and others KiB
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss) * unit


def peak_mebibytes() -> float:
    """Return by how much a process grows, in MiB, when many large swarms are made, reset and stepped.

    It is NaN where `peak_bytes` is.
    """
    return float(run_python(PEAK_MEMORY)) / 2**20
