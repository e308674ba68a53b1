"""Measure speed on a GPU, beside the CPU: `python -m experiments.benchmark_gpu --help`.

Keep the machine quiet meanwhile. Every number is the median of repeated runs, with the smallest and the
largest beside it.
"""

from dataclasses import dataclass
from pathlib import Path

import tyro

from experiments.speed import gpu
from experiments.speed.benchmark_page import describe, table
from experiments.speed.measurement import BenchmarkGroup, measure_all, write_measurements
from swarm_gym.command import command
from swarm_gym.errors import SettingError
from swarm_gym.files import write_atomically

CAPTION = "Firefly swarms on a GPU, on the three cases"


@dataclass(frozen=True)
class GpuBenchmarkConfig:
    """Options of the benchmark."""

    output: Path = Path("results/benchmark-gpu")
    """Folder for benchmark.json and a page with the table."""
    repeats: int = 5
    """Number of runs for each number that has a range."""


def main() -> None:
    """Measure, then print and store the table."""
    config = tyro.cli(GpuBenchmarkConfig, description=__doc__)
    with command():
        name = _gpu()
        measured = measure_all({"gpu": BenchmarkGroup(gpu.quantities, gpu.summary)}, config.repeats)
        machine = write_measurements(config.output / "benchmark.json", measured)
        page = config.output / "README.md"
        shown = table("gpu", measured["gpu"], CAPTION).markdown()
        write_atomically(page, f"# Benchmark on a GPU\n\n{name}; {describe(machine)}\n\n{shown}")
    print(page.read_text(encoding="utf-8"))
    print(f"written: {page}")


def _gpu() -> str:
    """Return the name of the GPU.

    Raises:
        SettingError: if there is none; rates of the simulator say nothing about one.
    """
    from swarm_gym.gpu.state import torch_device
    from swarm_gym.gpu.warps import IS_SIMULATED

    if IS_SIMULATED:
        raise SettingError("NUMBA_ENABLE_CUDASIM=1 simulates a GPU, whose speed says nothing: unset it")
    import torch

    return torch.cuda.get_device_name(torch_device())


if __name__ == "__main__":
    main()
