"""Measure swarm_gym and other libraries in one run: `python -m experiments.speed.peers --help`."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import tyro

from experiments.speed.measurement import BenchmarkGroup, measure_all, write_measurements
from experiments.speed.peers import comparisons, libraries
from experiments.speed.peers.runs import Peer, ratios

FIREFLIES = (Peer("niapy", "firefly", libraries.niapy_firefly),)
FISH = (Peer("scikit-opt AFSA", comparisons.FISH, libraries.scikit_opt_fish_swarm),)
PEERS = (
    Peer("pyswarms GlobalBestPSO", "particle-swarm", libraries.pyswarms_particle_swarm),
    Peer("pygmo pso_gen", "particle-swarm", libraries.pygmo_particle_swarm),
    Peer("pymoo PSO", "particle-swarm", libraries.pymoo_particle_swarm),
    Peer("pygmo sga", "elite-genetic", libraries.pygmo_genetic),
    Peer("pymoo GA", "elite-genetic", libraries.pymoo_genetic),
)
GROUPS = {
    "peers": BenchmarkGroup(partial(comparisons.firefly_quantities, FIREFLIES), comparisons.firefly_summary),
    "bezier-peers": BenchmarkGroup(partial(comparisons.curve_quantities, PEERS), ratios),
    "fish-peers": BenchmarkGroup(partial(comparisons.fish_quantities, FISH), ratios),
}


@dataclass(frozen=True)
class PeersConfig:
    """Options of the comparison."""

    output: Path = Path("results/benchmark")
    """Folder for peers.json."""
    repeats: int = 5
    """Number of runs for each number."""


def main() -> None:
    """Measure, then print and store the numbers."""
    config = tyro.cli(PeersConfig, description=__doc__)
    file = config.output / "peers.json"
    groups = measure_all(GROUPS, config.repeats)
    write_measurements(file, groups)
    for measured in groups.values():
        for m in measured:
            print(f"{m.name:65} {m.median:10.4g} {m.unit}")
    print(f"written: {file}")


if __name__ == "__main__":
    main()
