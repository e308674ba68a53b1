"""Find out when decisions of a controller matter: `python -m experiments.branching --help`.

Runs with the same seeds are equal up to some iteration. Then one decision is changed for a window of
iterations; after the window, the controller decides unchanged again. The change of the final gap says whether
the outcome was already settled. A second table shows how well each observation, taken at the end of a window,
predicts the final gap (rank correlation). A controller can profit from observations only where runs differ in
something that can still be changed. Seeds are those reserved for analyses; no model was selected by them.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from agents import make_controller
from experiments.analysis.branching import analyse, write_report
from experiments.analysis.episodes import analysis_seeds
from experiments.runs.database import ResultsError
from swarm_gym.command import command


@dataclass(frozen=True)
class BranchingConfig:
    """Options of the analysis."""

    controller: str = "open-loop:three-cases-extended@0.1"
    """Controller to analyse; its action layout must be natural or extended."""
    seeds: int = 100
    """Number of episodes per scenario; at least 2."""
    scenarios: tuple[str, ...] = ("case1", "case2", "case3")
    """Scenarios to run on, e.g. case1; their optima must be known."""
    output: Path = Path("results/branching")
    """Folder that the tables are written to."""
    threads: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """Number of threads that share the swarms. Results do not depend on it."""


def main() -> None:
    """Carry out the analysis that the command line asks for."""
    config = tyro.cli(BranchingConfig, description=__doc__)
    with command(ResultsError):
        seeds = analysis_seeds(config.seeds)
        controller = make_controller(config.controller)
        found = analyse(config.controller, controller, config.scenarios, seeds, config.threads)
        print(f"results: {write_report(found, config.output)}")


if __name__ == "__main__":
    main()
