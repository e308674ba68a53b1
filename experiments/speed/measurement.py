"""Quantities and their measurement: the median of repeated runs, with the smallest and the largest."""

import json
import platform
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numba
import numpy as np

from agents.runs.provenance import provenance
from swarm_gym.files import write_atomically

ALL_THREADS = numba.config.NUMBA_NUM_THREADS
CASES = ("case1", "case2", "case3")
IN_NUMPY = "cost in NumPy"
NUMPY_COST = f"niapy, {IN_NUMPY}"


@dataclass(frozen=True)
class Quantity:
    """Something to be measured: each call of `once` returns a value, or several of equal standing."""

    name: str
    unit: str
    once: Callable[[], float | list[float]]
    repeats: int | None = None  # None: as often as the benchmark was asked to


@dataclass(frozen=True)
class Measurement:
    """A measured quantity."""

    name: str
    unit: str
    median: float
    low: float
    high: float


def measure(quantity: Quantity, repeats: int) -> Measurement:
    """Median and spread over repeated runs, after one that is thrown away where there is more than one."""
    repeats = quantity.repeats or repeats
    if repeats > 1:
        quantity.once()
    values = np.concatenate([np.atleast_1d(quantity.once()) for _ in range(repeats)])
    return Measurement(
        quantity.name, quantity.unit, *(float(found(values)) for found in (np.median, np.min, np.max))
    )


def derived(name: str, unit: str, value: float) -> Measurement:
    """A number computed from medians of the same run of the benchmark."""
    return Measurement(name, unit, value, value, value)


def seconds_of(call: Callable[[], Any]) -> float:
    """Wall time of a call."""
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def run_python(code: str, environment: dict[str, str] | None = None) -> str:
    """What a program prints in a fresh interpreter."""
    return subprocess.run(
        [sys.executable, "-c", code], check=True, env=environment, capture_output=True, text=True
    ).stdout


def machine() -> dict[str, Any]:
    """What the figures belong to."""
    return {
        "machine": platform.machine(),
        "processor": _processor(),
        "threads": ALL_THREADS,
        "python": platform.python_version(),
        **provenance("numba", "numpy"),
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def write_measurements(file: Path, groups: dict[str, list[Measurement]]) -> None:
    """Store groups of measurements, with the machine, as JSON."""
    content = {
        "machine": machine(),
        "groups": {name: [vars(m) for m in measurements] for name, measurements in groups.items()},
    }
    write_atomically(file, json.dumps(content, indent=1) + "\n")


def read_measurements(file: Path) -> tuple[dict[str, Any], dict[str, list[Measurement]]]:
    """The machine and the groups that were stored.

    Raises:
        ValueError: if the file is not one of `write_measurements`.
    """
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        return content["machine"], {
            name: [Measurement(**fields) for fields in measurements]
            for name, measurements in content["groups"].items()
        }
    except (KeyError, TypeError, AttributeError, json.JSONDecodeError) as error:
        raise ValueError(f"{file}: not a file of the benchmark ({error!r})") from error


def medians(measurements: Iterable[Measurement]) -> dict[str, float]:
    """Medians by name.

    Raises:
        ValueError: if two have the same name.
    """
    found: dict[str, float] = {}
    for measurement in measurements:
        if measurement.name in found:
            raise ValueError(f"{measurement.name!r} was measured twice")
        found[measurement.name] = measurement.median
    return found
