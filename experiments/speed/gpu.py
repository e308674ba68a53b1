"""Speed on a GPU: steps and moves per second by number of swarms and members, beside all CPU cores.

A move is an evaluation after the first population. Rates are of whole steps of the environment, observations
and rewards included. The profile times one step in parts: the kernel, and all that torch does around it.
"""

from collections.abc import Iterator
from functools import cache, lru_cache, partial
from typing import Any

import numba
import numpy as np

from experiments.speed.environments import FIRST_STEP, LAST_STEP
from experiments.speed.measurement import (
    ALL_THREADS,
    CASES,
    Measurement,
    Quantity,
    derived,
    medians,
    seconds_of,
)
from swarm_gym.problem import AnalyticProblem
from swarm_gym.scenarios import Scenario, make_scenario
from swarm_gym.vector_env import SwarmVectorEnv

WIDTHS = (1, 64, 1_024, 8_192, 65_536)
SIZES = (20, 60, 100)
CPU_WIDTH = 1_024  # swarms that the CPU's cores share, in the same run
MOST_MOVES = 5e8  # approximate number of moves of a measurement on the GPU
COMPARED = (8_192, 60)
PARAMETERS = 4  # place of the parameters among the arguments of an entry, see `swarm_gym.gpu.loop.Entries`
TRAINING_STEPS = 2  # chunks of a training that are timed, after one that is not

# Operations on float64 of one lane, by counting the formulas of `swarm_gym.gpu`: of a move with its random
# number, its exponential and the sums over the warp; of the segment's length and cost; and of one obstacle.
MOVE_OPERATIONS, SEGMENT_OPERATIONS, CIRCLE_OPERATIONS, CORNER_OPERATIONS = 45, 60, 26, 6
# Operations on float64 that a multiprocessor begins in a cycle, by compute capability.
FLOAT64_PER_CYCLE = {(7, 0): 32, (8, 0): 32, (9, 0): 64, (10, 0): 64}


def quantities() -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    for size in SIZES:
        for width in WIDTHS:
            steps, moves = (partial(rate, "cuda", width, size) for rate in (_steps_per_second, _moves_before))
            yield Quantity(name_of(width, size), "steps/s", steps)
            yield Quantity(f"{name_of(width, size)}, moves", "moves/s", moves, 1)
    in_float32 = partial(_steps_per_second, "cuda", *COMPARED, precision="float32")
    yield Quantity(f"{name_of(*COMPARED)}, float32", "steps/s", in_float32)
    yield Quantity(CPU, "steps/s", partial(_steps_per_second, "cpu", CPU_WIDTH, COMPARED[1]))
    yield Quantity(f"{CPU}, moves", "moves/s", partial(_moves_before, "cpu", CPU_WIDTH, COMPARED[1]), 1)
    yield Quantity("registers of a lane, step kernel", "", _registers, 1)
    yield Quantity("warps that fit on a multiprocessor", "", _resident_warps, 1)
    yield Quantity("share of a step that the kernel takes", "%", _kernel_share)
    yield Quantity("bound of float64 arithmetic", "moves/s", roofline, 1)
    yield Quantity("training by device-ppo, 8192 swarms", "steps/s", _training_rate, 1)


def name_of(width: int, size: int, device: str = "GPU") -> str:
    """Return the name of the steps per second of so many swarms of so many members."""
    return f"{device}, {width} swarms of {size} members"


CPU = name_of(CPU_WIDTH, COMPARED[1], f"CPU, {ALL_THREADS} threads")


def summary(measured: list[Measurement]) -> list[Measurement]:
    """Return the GPU's rate over that of all cores, and over the bound of its arithmetic."""
    found = medians(measured)
    name = name_of(*COMPARED)
    bound = 100.0 * found[f"{name}, moves"] / found["bound of float64 arithmetic"]
    return [
        derived(f"{name} / all cores of the CPU", "times", found[name] / found[CPU]),
        derived("moves over the bound of float64 arithmetic", "%", bound),
    ]


@lru_cache(maxsize=1)
def _env(device: str, width: int, size: int, precision: str = "float64") -> SwarmVectorEnv:
    return SwarmVectorEnv(
        width,
        scenario=list(CASES),
        initial_population_size=size,
        max_population_size=100,
        device=device,
        precision=precision,
    )


def _steps_per_second(device: str, width: int, size: int, precision: str = "float64") -> float:
    steps, moves = _rates(device, width, size, precision)
    _measured_moves.setdefault((device, width, size, precision), []).append(moves)
    return steps


_measured_moves: dict[tuple[str, int, int, str], list[float]] = {}


def _moves_before(device: str, width: int, size: int) -> list[float]:
    """Return the moves per second of the runs whose steps per second were measured just before."""
    found = _measured_moves.pop((device, width, size, "float64"))
    return found[1:] or found  # of several, the first run is thrown away


def _rates(device: str, width: int, size: int, precision: str = "float64") -> tuple[float, float]:
    """Return steps and moves per second of swarms of a constant size, on the three cases."""
    env = _env(device, width, size, precision)
    actions: Any = np.tile([float(size), 0.0], (width, 1))
    env.reset(seed=0)
    actions = env.simulation.place(actions)
    _run(env, actions, FIRST_STEP)
    steps = int(min(LAST_STEP - FIRST_STEP, max(2, MOST_MOVES / (width * size**2 / 2))))
    before = _evaluations(env)
    seconds = seconds_of(lambda: _run(env, actions, steps))
    return steps * width / seconds, (_evaluations(env) - before) / seconds


def _run(env: SwarmVectorEnv, actions: Any, steps: int) -> None:
    for _ in range(steps):
        observations, *_ = env.step(actions)
    observations.sum().item()  # waits for the device


def _evaluations(env: SwarmVectorEnv) -> float:
    return float(env.simulation.swarms.evaluations.sum())


@cache
def _entries() -> Any:
    from swarm_gym.gpu.loop import entries_for
    from swarm_gym.problem.analytic.table import WaypointTable

    _rates("cuda", WIDTHS[0], SIZES[0])  # compiles
    return entries_for("firefly", WaypointTable)


def _registers() -> int:
    """Return the registers of the variant of the step kernel that computes in float64."""
    return registers_of(_entries().step.get_regs_per_thread(), np.float64)


def registers_of(variants: dict[tuple[Any, ...], int], number: type[np.floating]) -> int:
    """Return the registers of a lane in the variant of an entry whose parameters have this type.

    Args:
        variants: registers by the types of all arguments, as Numba lists what it has compiled.
        number: type of the floats that the kernels compute with.
    """
    wanted = numba.from_dtype(np.dtype(number))
    return max(int(found) for types, found in variants.items() if types[PARAMETERS].dtype == wanted)


def _resident_warps() -> int:
    """Return how many blocks of one warp share a multiprocessor: its registers or its blocks run out."""
    from numba import cuda

    device = cuda.get_current_device()
    by_registers = device.MAX_REGISTERS_PER_MULTIPROCESSOR // (32 * -(-_registers() // 8) * 8)
    most = device.MAX_THREADS_PER_MULTIPROCESSOR // 32
    return min(by_registers, most, device.MAX_BLOCKS_PER_MULTIPROCESSOR)


def _kernel_share() -> float:
    """Return the kernel's share of the time of a step, in per cent."""
    import torch

    width, size = COMPARED
    env = _env("cuda", width, size)
    actions = env.simulation.place(np.tile([float(size), 0.0], (width, 1)))
    env.reset(seed=0)
    _run(env, actions, FIRST_STEP)
    simulation: Any = env.simulation  # whose method is replaced
    advance, inside = simulation.advance, 0.0

    def timed(*arguments: Any) -> None:
        nonlocal inside
        torch.cuda.synchronize()  # so that the kernel alone is timed
        inside += seconds_of(lambda: advance(*arguments))  # it waits for the kernel

    simulation.advance = timed
    try:
        whole = seconds_of(lambda: _run(env, actions, 10))
    finally:
        simulation.advance = advance
    return 100.0 * inside / whole


def operations_of_a_move(case: str) -> float:
    """Return the operations on float64 of a move with evaluation on a case: 32 lanes, with the slowest block.

    The lanes of a warp take the same instructions, so that every lane waits for the block of segments with
    the most obstacles.
    """
    scenario = make_scenario(case)
    assert isinstance(scenario, Scenario)
    table = AnalyticProblem(scenario).table
    corners = np.asarray(table.num_corners)
    costs = np.where(corners > 0, CORNER_OPERATIONS * corners, CIRCLE_OPERATIONS)
    blocks = [costs[i:j].sum() for i, j in zip(table.first_tile[:-1], table.first_tile[1:], strict=True)]
    return 32.0 * (MOVE_OPERATIONS + SEGMENT_OPERATIONS + max(blocks))


def roofline() -> float:
    """Return the moves per second, mean of the cases, at which this GPU's float64 units are never idle."""
    from numba import cuda

    device = cuda.get_current_device()
    per_cycle = FLOAT64_PER_CYCLE.get(device.compute_capability, 2)
    peak = device.MULTIPROCESSOR_COUNT * per_cycle * device.CLOCK_RATE * 1e3
    return peak / float(np.mean([operations_of_a_move(case) for case in CASES]))


def _training_rate() -> float:
    """Return environment steps per second of the default preset's training, all on the device.

    Minibatches grow with the number of swarms, so that an update has as many of them as in the preset.
    """
    from swarm_gym.training.algorithms import PPO
    from swarm_gym.training.learners import make_learner
    from swarm_gym.training.presets import load_preset

    preset = load_preset("three-cases")
    assert isinstance(preset.algorithm, PPO)
    config = preset.changed(
        algorithm="device-ppo",
        device="cuda",
        num_swarms=COMPARED[0],
        batch_size=preset.algorithm.batch_size * COMPARED[0] // preset.num_swarms,
        rollouts_per_chunk=1,
    )
    learner = make_learner(config)
    learner.begin()
    learner.learn(0)
    before = learner.num_steps
    seconds = seconds_of(lambda: [learner.learn(seed) for seed in range(1, 1 + TRAINING_STEPS)])
    return (learner.num_steps - before) / seconds
