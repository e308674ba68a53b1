"""Find out what a controller makes of its inputs: `python -m experiments.sensitivity --help`.

An input is taken away by showing its mean course instead: at every iteration, its mean there over all
episodes. The first table shows how much decisions change in the states that the controller visits. The second
shows what whole episodes without the input cost, on the same scenarios and seeds. Without all inputs but the
iteration, the controller is a fixed schedule; what it loses then is the worth of observing the population.
Seeds are those reserved for analyses; no model was selected by them.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from agents import make_controller
from experiments.analysis.episodes import analysis_seeds
from experiments.analysis.sensitivity import analyse
from experiments.runs.database import ResultsError
from swarm_gym.command import command
from swarm_gym.training.config import stored_config


@dataclass(frozen=True)
class SensitivityConfig:
    """Options of the analysis."""

    policy: str = "learned:three-cases/0@1"
    """Controller to analyse, e.g. learned:three-cases/0@1."""
    seeds: int = 50
    """Number of episodes per scenario; at least 2."""
    scenarios: tuple[str, ...] = ()
    """Scenarios to run on, e.g. case1; by default those that the policy was validated on."""
    output: Path = Path("results/sensitivity")
    """Folder that tables and figures are written to."""
    threads: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """Number of threads that share the swarms. Results do not depend on it."""


def main() -> None:
    """Carry out the analysis that the command line asks for."""
    config = tyro.cli(SensitivityConfig, description=__doc__)
    from experiments.analysis.sensitivity_report import write_report  # imports a plotting library

    with command(ResultsError):
        seeds = analysis_seeds(config.seeds)
        controller = make_controller(config.policy)
        training = stored_config(getattr(controller, "manifest", {}))
        scenarios = config.scenarios or training.validation_scenarios or training.scenarios
        found = analyse(config.policy, controller, training, scenarios, seeds, config.threads)
        print(f"results: {write_report(found, config.output)}")


if __name__ == "__main__":
    main()
