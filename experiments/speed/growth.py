"""Growth of time and memory with waypoints, obstacles, members and swarms: exponents of fitted powers."""

import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from experiments.speed.measurement import Measurement, Quantity, derived, medians, seconds_of
from swarm_gym.scenarios import Polygon, Scenario
from swarm_gym.simulation import Decisions
from swarm_gym.vector_env import SwarmVectorEnv

START, TARGET = (20.0, 300.0), (980.0, 300.0)


@dataclass(frozen=True)
class GrowthAxis:
    """Something that grows.

    Attributes:
        name: name of what grows.
        values: sizes to measure, so large that all that does not grow is small beside it.
        measured: "move" or "iteration", whose time is measured.
        options: function that returns the options of an environment for a value.
    """

    name: str
    values: tuple[int, ...]
    measured: str
    options: Callable[[int], dict[str, Any]]

    def name_of_time(self, value: int) -> str:
        """Return the name of the time at a value."""
        return f"time of {'a move' if self.measured == 'move' else 'an iteration'}, {value} {self.name}"

    def name_of_memory(self, value: int) -> str:
        """Return the name of the memory at a value."""
        return f"memory, {value} {self.name}"


def bars(number: int) -> Scenario:
    """Return a map with this number of obstacles near every segment: bars above each other."""
    heights = np.linspace(20.0, 270.0, number + 1)
    obstacles = tuple(
        Polygon.rectangle(0.0, float(low), 1000.0, float(low + high) / 2) for low, high in pairwise(heights)
    )
    workspace = (0.0, 0.0, 1000.0, 600.0)
    return Scenario(f"bars-{number}", START, TARGET, obstacles, workspace, (-250.0, 250.0))


def _options(**changes: Any) -> dict[str, Any]:
    return {"num_envs": 1, "scenario": "case1", "initial_population_size": 60, "num_threads": 1, **changes}


AXES = (
    GrowthAxis("waypoints", (127, 255, 511, 1023, 2047), "move", lambda n: _options(num_waypoints=n)),
    GrowthAxis(
        "obstacles near a segment", (32, 64, 128, 256, 512), "move", lambda k: _options(scenario=bars(k))
    ),
    GrowthAxis(
        "members",
        (192, 384, 768, 1536, 3072),
        "iteration",
        lambda m: _options(initial_population_size=m, max_population_size=m),
    ),
    GrowthAxis(
        "swarms",
        (16, 64, 256, 1024, 4096),
        "iteration",
        lambda b: _options(num_envs=b, initial_population_size=30),
    ),
)


def quantities() -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    for axis in AXES:
        for value in axis.values:
            yield Quantity(axis.name_of_time(value), "us", microseconds(axis, value))
        for value in axis.values:
            yield Quantity(axis.name_of_memory(value), "MB", megabytes(axis, value), repeats=1)


def summary(measurements: list[Measurement]) -> list[Measurement]:
    """Return the exponents of time and memory on each axis."""
    found = medians(measurements)
    return [
        derived(
            f"exponent of {kind} in {axis.name}",
            "",
            exponent(axis.values, [found[name(value)] for value in axis.values]),
        )
        for axis in AXES
        for kind, name in (("time", axis.name_of_time), ("memory", axis.name_of_memory))
    ]


def exponent(values: tuple[int, ...], results: list[float]) -> float:
    """Return the slope of a least-squares line through the logarithms."""
    return float(_fit(values, results)[0])


def fitted_line(values: tuple[int, ...], results: list[float]) -> list[float]:
    """Return the values of the power with this exponent that fits best, see `exponent`."""
    return np.exp(np.polyval(_fit(values, results), np.log(values))).tolist()


def _fit(values: tuple[int, ...], results: list[float]) -> np.ndarray:
    return np.polyfit(np.log(values), np.log(results), 1)


def microseconds(axis: GrowthAxis, value: int) -> Callable[[], float]:
    """Return a function that measures the compiled part of a second iteration, or one of its moves."""
    options = axis.options(value)
    rows = options["num_envs"]

    def once() -> float:
        env = SwarmVectorEnv(**options)
        env.reset(seed=0)
        simulation = env.simulation
        constant = (
            np.ones(rows, dtype=np.bool_),
            Decisions(
                np.full(rows, options["initial_population_size"]),
                np.zeros(rows),
                simulation.parameters,
                simulation.sources,
            ),
        )
        simulation.advance(*constant)
        before = simulation.swarms.evaluations.sum()
        spent = seconds_of(lambda: simulation.advance(*constant)) * 1e6
        moves = simulation.swarms.evaluations.sum() - before
        return spent / float(moves) if axis.measured == "move" else spent

    return once


def megabytes(axis: GrowthAxis, value: int) -> Callable[[], float]:
    """Return a function that measures the memory that an environment holds after its reset."""

    def once() -> float:
        tracemalloc.start()
        try:
            env = SwarmVectorEnv(**axis.options(value))
            env.reset(seed=0)
            held, _ = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        return held / 1e6

    return once
