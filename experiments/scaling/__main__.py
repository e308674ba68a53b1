"""Measure what backends add to the work: `python -m experiments.scaling --help`; needs the extra `ray`.

Keep the machine quiet meanwhile. Nodes are logical nodes of this machine. The measured overheads and the
measured time of the study's work give a prediction for clusters; see `experiments.scaling.model`.
"""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import tyro
from joblib import cpu_count
from tqdm import tqdm

from agents.backends import BackendError
from experiments.catalogue import get_suite
from experiments.runs.episode import Episode
from experiments.scaling import overheads
from experiments.scaling.findings_page import Findings, write_page
from experiments.scaling.study import EVALUATED, TIMED_PRESETS, time_runs, time_training
from experiments.speed.measurement import machine
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.warm_up import warm_up_single

ROUNDS = 4  # backends take turns, since the machine may be slow for a while


@dataclass(frozen=True)
class ScalingConfig:
    """Options of the benchmark of backends."""

    output: Path = Path("results/scaling")
    """Folder that tables and the figure are written to."""
    units: int = 1000
    """Number of units of work that backends are compared with."""
    seconds: float = 0.2
    """Length of a unit in seconds."""
    nodes: tuple[int, ...] = (1, 2, 4, 8)
    """Numbers of logical nodes to measure, e.g. 1 2 4; each has four processors, and its units sleep."""
    units_per_worker: int = 50
    """Number of units for each processor of a logical node."""
    sample: int = 40
    """Number of runs to time of each suite of the study."""
    training_steps: int = 64_000
    """Environment steps of each training that is timed."""


def measure_all(config: ScalingConfig) -> Findings:
    """Measure all that the tables show.

    Raises:
        MissingExtraError: if Ray is missing.
    """
    warm_up_single("firefly")
    cores = cpu_count()
    config.output.mkdir(parents=True, exist_ok=True)
    run = Episode(("spsfa-tip", "case1", 1), get_suite("paper")).run({})
    with (
        TemporaryDirectory(dir=config.output) as folder,
        tqdm(total=6 + len(config.nodes) + len(EVALUATED), unit="figure", desc="scaling") as bar,
    ):

        def say(what: str) -> None:
            bar.update()
            bar.set_postfix_str(what)

        backends = [
            timed
            for _ in range(ROUNDS)
            for timed in overheads.time_backends(config.units // ROUNDS, config.seconds, cores)
        ]
        say("nodes that compute")
        each = max(config.units // 10, 1)
        nodes = [
            overheads.time_nodes(count, 1, "compute", each, config.seconds) for count in range(1, cores + 1)
        ]
        for count in config.nodes:
            say(f"{count} nodes that wait")
            nodes.append(overheads.time_nodes(count, 4, "wait", config.units_per_worker, config.seconds))
        say("start")
        start = overheads.time_start(cores)
        say("units of no length")
        empty = overheads.count_units(config.units, cores)
        say("results and rows")
        results = overheads.count_results(config.units, cores, run, Path(folder))
        rows = overheads.count_rows(10 * config.units, run, Path(folder))
        runs = {}
        for name in EVALUATED:
            say(f"runs of {name}")
            suite = get_suite(name)
            runs[name] = time_runs(suite, suite.all_runs(), config.sample)
        say("training")
        steps = {kind: time_training(preset, config.training_steps) for kind, preset in TIMED_PRESETS.items()}
    return Findings(machine(), backends, nodes, start, empty, results, rows, runs, steps)


def main() -> None:
    """Measure, then print and store the tables."""
    config = tyro.cli(ScalingConfig, description=__doc__)
    with command(MissingExtraError, BackendError):
        page = write_page(measure_all(config), config.output)
    print(page.read_text(encoding="utf-8"))
    print(f"written: {page}")


if __name__ == "__main__":
    main()
