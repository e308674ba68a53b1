"""Quantities, and their measurements: the median of repeated runs, the smallest and the largest value."""

import json
import platform
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numba
import numpy as np
from tqdm import tqdm

from swarm_gym.files import write_atomically
from swarm_gym.runs.provenance import provenance

PROCESSORS = Path("/proc/cpuinfo")  # description of the processors, on Linux
ALL_THREADS = numba.config.NUMBA_NUM_THREADS
CASES = ("case1", "case2", "case3")
IN_NUMPY = "cost in NumPy"
NUMPY_COST = f"niapy, {IN_NUMPY}"


@dataclass(frozen=True)
class Quantity:
    """A quantity to measure.

    Attributes:
        name: name of the quantity.
        unit: unit of its values.
        once: function that measures it and returns one value, or several of equal standing.
        repeats: number of runs; None for the number that the benchmark was asked for.
    """

    name: str
    unit: str
    once: Callable[[], float | list[float]]
    repeats: int | None = None


@dataclass(frozen=True)
class Measurement:
    """A measured quantity: median, smallest and largest value."""

    name: str
    unit: str
    median: float
    low: float
    high: float


@dataclass(frozen=True)
class BenchmarkGroup:
    """A group of a benchmark.

    Attributes:
        quantities: function that yields the quantities to measure.
        summary: function that computes further numbers from their measurements.
    """

    quantities: Callable[[], Iterator[Quantity]]
    summary: Callable[[list[Measurement]], list[Measurement]] = lambda _: []


def measure_all(groups: Mapping[str, BenchmarkGroup], repeats: int) -> dict[str, list[Measurement]]:
    """Return the measurements of groups and their summaries, by the names of the groups.

    Args:
        groups: groups by name.
        repeats: number of runs for each quantity that does not have its own.
    """
    plan = [(name, quantity) for name, group in groups.items() for quantity in group.quantities()]
    measured: dict[str, list[Measurement]] = {name: [] for name in groups}
    with tqdm(plan, unit="figure", desc="benchmark") as bar:
        for name, quantity in bar:
            bar.set_postfix_str(quantity.name)
            measured[name].append(measure(quantity, repeats))
    return {name: measured[name] + group.summary(measured[name]) for name, group in groups.items()}


def measure(quantity: Quantity, repeats: int) -> Measurement:
    """Return median and range over repeated runs; if there are several, one before them is thrown away."""
    repeats = quantity.repeats or repeats
    if repeats > 1:
        quantity.once()
    values = np.concatenate([np.atleast_1d(quantity.once()) for _ in range(repeats)])
    return Measurement(
        quantity.name, quantity.unit, *(float(found(values)) for found in (np.median, np.min, np.max))
    )


def derived(name: str, unit: str, value: float) -> Measurement:
    """Return a number that was computed from medians, as a measurement without spread."""
    return Measurement(name, unit, value, value, value)


def seconds_of(call: Callable[[], Any]) -> float:
    """Return the wall time of a call in seconds."""
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def run_python(code: str, environment: dict[str, str] | None = None) -> str:
    """Run a program in a fresh interpreter and return what it prints."""
    return subprocess.run(
        [sys.executable, "-c", code], check=True, env=environment, capture_output=True, text=True
    ).stdout


def machine() -> dict[str, Any]:
    """Return the machine and the versions that measurements belong to."""
    return {
        "machine": platform.machine(),
        "processor": _processor(),
        "threads": ALL_THREADS,
        "python": platform.python_version(),
        **provenance("numba", "numpy"),
    }


def _processor() -> str:
    """Return the name of the processor, or its kind where the system does not tell the name."""
    names = []
    with suppress(OSError):  # only Linux has the file, and on ARM it lacks the name
        lines = PROCESSORS.read_text(encoding="utf-8", errors="replace").splitlines()
        names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return next(filter(None, [*names, platform.processor(), platform.machine()]), "unknown")


def write_measurements(file: Path, groups: dict[str, list[Measurement]]) -> dict[str, Any]:
    """Store groups of measurements and the machine as JSON; return the machine."""
    content = {
        "machine": (found := machine()),
        "groups": {name: [vars(m) for m in measurements] for name, measurements in groups.items()},
    }
    write_atomically(file, json.dumps(content, indent=1) + "\n")
    return found


def read_measurements(file: Path) -> tuple[dict[str, Any], dict[str, list[Measurement]]]:
    """Return the machine and the groups of measurements that are stored in a file.

    Raises:
        ValueError: if the file was not written by `write_measurements`.
    """
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        return content["machine"], {
            name: [Measurement(**fields) for fields in measurements]
            for name, measurements in content["groups"].items()
        }
    except (KeyError, TypeError, AttributeError, json.JSONDecodeError) as error:
        raise ValueError(f"{file}: not a file of the benchmark ({error!r})") from error


def measured_before(file: Path) -> dict[str, list[Measurement]]:
    """Return the groups in a file if they are of this machine and version, else none."""
    if not file.exists():
        return {}
    there, groups = read_measurements(file)
    return groups if there == machine() else {}


def medians(measurements: Iterable[Measurement]) -> dict[str, float]:
    """Return medians by name.

    Raises:
        ValueError: if two measurements have the same name.
    """
    found: dict[str, float] = {}
    for measurement in measurements:
        if measurement.name in found:
            raise ValueError(f"{measurement.name!r} was measured twice")
        found[measurement.name] = measurement.median
    return found
