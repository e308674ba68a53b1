"""Run a suite and write its tables and figures: `python -m experiments.evaluate --help`.

A database keeps the finished runs. A suite that was stopped goes on where it stopped. A complete suite is not
run again: only its tables and figures are written. With `--no-simulate` nothing is run at all. Tables and
figures come from the database, and the command names the runs that are missing there.
"""

import dataclasses
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

import tyro

from agents.backends import Backend, BackendError, BackendOptions
from experiments.catalogue import COLLECTIONS, SUITES
from experiments.choice import Choice
from experiments.documents.records import write_record
from experiments.documents.suite_page import (
    make_tables,
    outcomes_of,
    record_of_suite,
    write_collection_page,
    write_page,
)
from experiments.runs.configuration import configuration, environment_configuration
from experiments.runs.database import Results, ResultsError
from experiments.runs.groups import scenario_sets
from experiments.runs.runner import refuse_missing, run_missing
from experiments.runs.suite import Suite
from experiments.tables.headline import objectives_as_text
from swarm_gym.command import command
from swarm_gym.comparing.entrants import entrant
from swarm_gym.errors import MissingExtraError


@dataclass(frozen=True)
class EvaluateConfig:
    """Options of an evaluation."""

    suite: str = "paper"
    """Suite or collection of suites to run, e.g. paper, headline or iafsa-paper; see the list above."""
    seeds: int | None = None
    """Number of seeds per controller and scenario, e.g. 20. By default the number that the suite states."""
    controllers: tuple[str, ...] = ()
    """Controllers to run instead of those of the suite, e.g. spsfa-tip fixed:60 mine:Rule. By default the
    suite's."""
    choice: tyro.conf.OmitArgPrefixes[Choice] = field(default_factory=Choice)
    output: Path = Path("results")
    """Folder for results, by default results. Tables and figures of a suite go to <output>/<suite>, its
    database to <output>/<suite>.sqlite. A collection has them in <output>/<collection>."""
    database: Path | None = None
    """Database file, e.g. /scratch/paper.sqlite. By default <output>/<suite>.sqlite."""
    where: tyro.conf.OmitArgPrefixes[BackendOptions] = field(default_factory=BackendOptions)
    figures: bool = True
    """Draw figures, as SVG and PNG (the default), or leave them out with --no-figures."""
    simulate: bool = True
    """Make runs that are missing (the default), or refuse to with --no-simulate."""


def evaluate(config: EvaluateConfig) -> Path:
    """Make the runs that are missing, write tables and figures, and return the page that shows them.

    Raises:
        ResultsError: if there are too few seeds, or the database cannot be used or lacks runs.
        UnknownNameError: if there is no such suite, scenario or optimizer.
        OwnCodeError: if own code cannot be imported, or is of another kind than its name stands for.
    """
    if config.suite in COLLECTIONS:
        return _evaluate_collection(config)
    suite = config.choice.suite(config.suite)
    if config.controllers:
        suite = dataclasses.replace(suite, controllers=tuple(dict.fromkeys(config.controllers)))
    if config.seeds is not None:
        if config.seeds < 1:
            raise ResultsError(f"--seeds must be at least 1, got {config.seeds}")
        suite = dataclasses.replace(suite, num_seeds=config.seeds)
    fewest = suite.num_seeds * min(map(len, scenario_sets(suite.scenarios).values()))
    if fewest < 2:
        raise ResultsError(f"intervals need 2 runs of each set of scenarios, got {fewest}; raise --seeds")
    database = config.database or config.output / f"{suite.name}.sqlite"
    if not config.simulate and not database.exists():
        raise ResultsError(f"{database} does not exist, and --no-simulate forbids to make its runs")
    # First, so that options that cannot be leave no database.
    backend = _backend(suite, config) if config.simulate else None
    results = (
        Results(database, configuration(suite))
        if backend
        else Results.stored(database, environment_configuration(suite))
    )
    for notice in results.changed:
        print(notice, flush=True)
    try:
        if backend:
            with closing(backend):
                run_missing(suite, results, backend)
        else:
            refuse_missing(suite, results)
        folder = config.output / suite.name
        print(f"writing tables and figures to {folder}", flush=True)
        tables = make_tables(suite, results)
        print(objectives_as_text(suite, outcomes_of(suite, results)), flush=True)
        figures = _figures(suite, results, folder) if config.figures else []
        made_with = results.provenances(suite.controllers, suite.seeds)
        page = write_page(suite, tables, figures, folder, made_with)
        write_record(record_of_suite(suite, results), folder)
    finally:
        results.close()
    return page


def _backend(suite: Suite, config: EvaluateConfig) -> Backend:
    controllers = [entrant(name, suite.optimizer).controller for name in suite.controllers]
    return config.where.make(config.output, controllers)


def _evaluate_collection(config: EvaluateConfig) -> Path:
    if config.database is not None:
        raise ResultsError(f"--database is for one suite; {config.suite} has several, with one each")
    folder = config.output / config.suite
    suites = COLLECTIONS[config.suite]
    pages = [evaluate(dataclasses.replace(config, suite=name, output=folder)) for name in suites]
    return write_collection_page(config.suite, pages, folder)


def _figures(suite: Suite, results: Results, folder: Path) -> list[Path]:
    # Imported here: runs need no plotting library.
    from experiments.documents.figures import write_figures

    return write_figures(suite, results, folder)


def main() -> None:
    """Evaluate as the command line says."""
    suites = ", ".join(sorted((*SUITES, *COLLECTIONS)))
    config = tyro.cli(EvaluateConfig, description=f"{__doc__}\nSuites and collections: {suites}.")
    with command(
        ResultsError,
        BackendError,
        MissingExtraError,
        kept="runs that finished are stored, and the same command goes on",
    ):
        page = evaluate(config)
    print(f"results: {page}")


if __name__ == "__main__":
    main()
