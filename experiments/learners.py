"""Train learners of other libraries as their users would, and compare: `python -m experiments.learners`.

A training that is stored is not repeated, so the command continues where it was stopped; a training that was
under way begins again. The page docs/learners.md shows the tables.
"""

from dataclasses import dataclass
from pathlib import Path

import tyro
from tqdm import tqdm

from experiments.documents.digests import digests_of_rivals
from experiments.documents.records import Record, commits_in, record_of, write_record
from experiments.runs.labels import label
from experiments.studies.learners.pictures import write_curves
from experiments.studies.learners.recipes import RECIPES
from experiments.studies.learners.tables_of_learners import PAPER, learned, options_table, reached, rivals
from experiments.studies.learners.trainings import train
from swarm_gym.checks import look_up, require_integer
from swarm_gym.command import command
from swarm_gym.runs.provenance import git_commit


@dataclass(frozen=True)
class LearnersConfig:
    """Options of the command."""

    recipes: tuple[str, ...] = tuple(RECIPES)
    """Recipes to train, e.g. ppo sac; by default all. Tables show all that are stored."""
    seeds: tuple[int, ...] = (0, 1, 2, 3, 4)
    """Training seeds."""
    steps: int = 200_000
    """Environment steps of a training, summed over all swarms."""
    output: Path = Path("results/learners")
    """Folder for trainings, tables and curves."""
    train: bool = True
    """Make trainings that are missing (the default), or only tables with --no-train."""


def run(config: LearnersConfig) -> list[Path]:
    """Train what is missing, write tables and curves, and return their files."""
    for name in config.recipes:
        look_up("recipe", name, RECIPES)
    require_integer("--steps", config.steps, 1)
    trainings = config.output / "trainings"
    if config.train:
        # All recipes with one seed before the next seed, so that an early table has all of them.
        for seed in config.seeds:
            for name in config.recipes:
                _train_shown(name, seed, config.steps, trainings)
    beside = rivals()
    samples = learned(trainings, config.steps)
    tables = [reached(samples, beside, config.steps), options_table()]
    for table in tables:
        table.write(config.output)
    objectives = [float(beside[name].objective.mean()) for name in (label(PAPER), "open loop three-cases")]
    write_record(_record(trainings), config.output)
    curves = write_curves(trainings, config.output, config.steps, *objectives)
    return [*(config.output / f"{table.name}.md" for table in tables), *curves]


def _record(trainings: Path) -> Record:
    """Return the record of trainings of any length, and of the controllers beside them, which run now."""
    commits = commits_in(trainings.glob("*/*.json"))
    return record_of("learners", {*commits, git_commit()}, digests_of_rivals())


def _train_shown(name: str, seed: int, steps: int, folder: Path) -> None:
    """Train with a progress bar."""
    with tqdm(total=steps, desc=f"{name}/{seed}", unit="step") as bar:

        def report(done: int) -> None:
            bar.update(done - bar.n)

        train(name, seed, steps, folder, report)


def main() -> None:
    """Train and compare as the command line says."""
    config = tyro.cli(LearnersConfig, description=__doc__)
    with command(kept="trainings that finished are stored, and the same command goes on"):
        for file in run(config):
            print(file)


if __name__ == "__main__":
    main()
