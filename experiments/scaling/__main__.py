"""Measure what backends add to the work: `python -m experiments.scaling --help`; needs the extra `ray`.

Keep the machine quiet meanwhile. Nodes are logical ones of this machine. What they were measured to add, and
what the study's work was measured to take, give a prediction for clusters, see `experiments.scaling.model`.
"""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import tyro
from joblib import cpu_count
from tqdm import tqdm

from agents.backends import BackendError
from experiments.catalogue import get_suite
from experiments.runs.runner import all_runs, run_one
from experiments.scaling import measure
from experiments.scaling.page import Findings, write_page
from experiments.scaling.study import EVALUATED, TIMED_PRESETS
from experiments.speed.measurement import machine
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.warm_up import warm_up_single

ROUNDS = 4  # in which backends take turns, lest one of them meet a slow minute of the machine


@dataclass(frozen=True)
class ScalingConfig:
    """Options of the benchmark of backends."""

    output: Path = Path("results/scaling")
    """Where tables and the figure go."""
    units: int = 1000
    """Units that backends are compared with."""
    seconds: float = 0.2
    """Length of each."""
    nodes: tuple[int, ...] = (1, 2, 4, 8)
    """How many logical nodes of four processors; what runs there waits, since the cores are fewer."""
    units_per_worker: int = 50
    """Units of each processor of these."""
    sample: int = 40
    """Runs of each suite of the study that are timed."""
    training_steps: int = 64_000
    """Steps of the trainings that are timed."""


def measure_all(config: ScalingConfig) -> Findings:
    """All that the tables show.

    Raises:
        MissingExtraError: if Ray is missing.
    """
    warm_up_single("firefly")
    cores = cpu_count()
    config.output.mkdir(parents=True, exist_ok=True)
    run = run_one(("spsfa-tip", "case1", 1), get_suite("paper"), {})
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
            for timed in measure.time_backends(config.units // ROUNDS, config.seconds, cores)
        ]
        say("nodes that compute")
        each = max(config.units // 10, 1)
        nodes = [
            measure.time_nodes(count, 1, "compute", each, config.seconds) for count in range(1, cores + 1)
        ]
        for count in config.nodes:
            say(f"{count} nodes that wait")
            nodes.append(measure.time_nodes(count, 4, "wait", config.units_per_worker, config.seconds))
        say("start")
        start = measure.time_start(cores)
        say("units of no length")
        empty = measure.count_units(config.units, cores)
        say("results and rows")
        results = measure.count_results(config.units, cores, run, Path(folder))
        rows = measure.count_rows(10 * config.units, run, Path(folder))
        runs = {}
        for name in EVALUATED:
            say(f"runs of {name}")
            suite = get_suite(name)
            runs[name] = measure.time_runs(suite, all_runs(suite), config.sample)
        say("training")
        steps = {
            kind: measure.time_training(preset, config.training_steps)
            for kind, preset in TIMED_PRESETS.items()
        }
    return Findings(machine(), backends, nodes, start, empty, results, rows, runs, steps)


def main() -> None:
    """Measure, print and store."""
    config = tyro.cli(ScalingConfig, description=__doc__)
    with command(MissingExtraError, BackendError):
        page = write_page(measure_all(config), config.output)
    print(page.read_text(encoding="utf-8"))
    print(f"written: {page}")


if __name__ == "__main__":
    main()
