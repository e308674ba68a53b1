"""Run a suite and write its tables and figures: `python -m experiments.evaluate --help`.

Finished runs are kept in a database: a suite that was stopped goes on where it stopped, and one that is
complete is not run again, only its tables and figures are written. With `--no-simulate` nothing is run at
all: tables and figures come from the database, and where that lacks runs, they are named.
"""

import dataclasses
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

import tyro

from agents.backends import Backend, BackendError, BackendOptions
from experiments.catalogue import COLLECTIONS, get_suite
from experiments.documents.page import write_collection_page, write_page
from experiments.runs.database import Results, ResultsError
from experiments.runs.entrants import entrant
from experiments.runs.runner import configuration, environment_configuration, refuse_missing, run_missing
from experiments.runs.suite import Suite
from experiments.tables import make_tables
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError


@dataclass(frozen=True)
class EvaluateConfig:
    """Options of an evaluation."""

    suite: str = "paper"
    """Which suite, or collection of suites."""
    seeds: int | None = None
    """Seeds per controller and scenario; the suite's own number by default."""
    controllers: tuple[str, ...] = ()
    """Controllers instead of the suite's."""
    output: Path = Path("results")
    """Tables and figures go to <output>/<suite>, the database to <output>/<suite>.sqlite; those of the suites
    of a collection to <output>/<collection>/<suite> and beside it."""
    database: Path | None = None
    """Another database file."""
    where: tyro.conf.OmitArgPrefixes[BackendOptions] = field(default_factory=BackendOptions)
    figures: bool = True
    """Whether to draw figures."""
    simulate: bool = True
    """Whether runs that are missing are made, or refused."""


def evaluate(config: EvaluateConfig) -> Path:
    """Run what is missing, then write tables and figures; returns the page that shows them."""
    if config.suite in COLLECTIONS:
        return _evaluate_collection(config)
    suite = get_suite(config.suite)
    if config.controllers:
        suite = dataclasses.replace(suite, controllers=tuple(dict.fromkeys(config.controllers)))
    if config.seeds is not None:
        least = min(2, suite.num_seeds)  # where one is enough, the tables are over many scenarios
        if config.seeds < least:
            raise ResultsError(f"--seeds must be at least {least}, got {config.seeds}")
        suite = dataclasses.replace(suite, num_seeds=config.seeds)
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
    try:
        if backend:
            with closing(backend):
                run_missing(suite, results, backend)
        else:
            refuse_missing(suite, results)
        folder = config.output / suite.name
        print(f"writing tables and figures to {folder}", flush=True)
        tables = make_tables(suite, results)
        figures = _figures(suite, results, folder) if config.figures else []
        made_with = results.provenances(suite.controllers, suite.seeds)
        page = write_page(suite, tables, figures, folder, made_with)
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
    config = tyro.cli(EvaluateConfig, description=__doc__)
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
