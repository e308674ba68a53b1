"""Measure swarm_gym and other libraries in one run: `python -m experiments.speed.peers --help`."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import tyro
from tqdm import tqdm

from experiments.speed.measurement import Measurement, Quantity, measure, write_measurements
from experiments.speed.peers import bezier, fish, libraries, with_niapy
from experiments.speed.peers.runs import Peer, ratios

FISH = (Peer("scikit-opt AFSA", fish.OURS, libraries.scikit_opt_fish_swarm),)
PEERS = (
    Peer("pyswarms GlobalBestPSO", "particle-swarm", libraries.pyswarms_particle_swarm),
    Peer("pygmo pso_gen", "particle-swarm", libraries.pygmo_particle_swarm),
    Peer("pymoo PSO", "particle-swarm", libraries.pymoo_particle_swarm),
    Peer("pygmo sga", "elite-genetic", libraries.pygmo_genetic),
    Peer("pymoo GA", "elite-genetic", libraries.pymoo_genetic),
)


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
    fireflies = _measured(list(with_niapy.quantities()), config.repeats, with_niapy.summary)
    curves = _measured(list(bezier.quantities(PEERS)), config.repeats, ratios)
    schools = _measured(list(fish.quantities(FISH)), config.repeats, ratios)
    write_measurements(file, {"peers": fireflies, "bezier-peers": curves, "fish-peers": schools})
    for m in fireflies + curves + schools:
        print(f"{m.name:65} {m.median:10.4g} {m.unit}")
    print(f"written: {file}")


def _measured(
    quantities: list[Quantity], repeats: int, summary: Callable[[list[Measurement]], list[Measurement]]
) -> list[Measurement]:
    """Return the measurements of quantities, and their summary."""
    measured = [measure(q, repeats) for q in tqdm(quantities, unit="quantity", desc="peers")]
    return measured + summary(measured)


if __name__ == "__main__":
    main()
