"""Score every controller that ships: `python -m experiments.scores [SUITE ...]`.

Writes a CSV file for each scored suite, with a row for each controller, environment and set of scenarios.
Rows that are there stay if their seeds and the digest of their controller are still right. The others are
exported from a results database, which keeps every run that finished, so that the command goes on where it
was stopped. To compute a file anew, delete it and its database.
"""

from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from agents.backends import Backend, BackendError, BackendOptions
from experiments.runs.configuration import configuration
from experiments.runs.database import Results, ResultsError
from experiments.runs.runner import missing_runs, run_missing
from experiments.scoring.claimed_rows import ClaimError, check_claim
from experiments.scoring.files import SCORES, read_scores, scores_file, write_scores
from experiments.scoring.score import ScoreRow, export
from experiments.scoring.submission import Submission, digest_of
from experiments.scoring.suites import SCORED, ScoredSuite, get_scored
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError


@dataclass(frozen=True)
class ScoresConfig:
    """Options of the command."""

    suites: Annotated[tuple[str, ...], tyro.conf.Positional, tyro.conf.arg(metavar="SUITE")] = ()
    """Scored suites to compute, e.g. headline optimizers; by default all. A wrong name lists them."""
    output: Path = SCORES
    """Folder of the CSV files, by default scores."""
    results: Path = Path("results/scores")
    """Folder of the results databases that keep the runs, one for each suite, by default results/scores. With
    results/study, the runs of the study are taken."""
    where: tyro.conf.OmitArgPrefixes[BackendOptions] = field(default_factory=BackendOptions)


def compute(scored: ScoredSuite, path: Path, database: Path, backend: Backend) -> int:
    """Make the rows that a file of scores lacks, drop those that are out of date, and return how many it has.

    Args:
        scored: the suite.
        path: file of scores of the suite.
        database: results database that keeps the runs; it is opened only if rows are missing.
        backend: backend that carries out the runs.

    Raises:
        ScoreFileError: if the file is there and cannot be read.
        ResultsError: if the database cannot be used.
        BackendError: if the backend cannot be used.
    """
    digests = {name: digest_of(name, scored) for name in scored.entrants}
    rows = _kept(scored, path, digests)
    lacking = tuple(name for name in digests if name not in rows)
    if lacking:
        experiment = scored.part(lacking)
        with closing(Results(database, configuration(experiment))) as results:
            for notice in results.changed:
                print(notice, flush=True)
            try:
                run_missing(experiment, results, backend)
            finally:  # rows of the controllers that are complete, if the command is stopped
                undone = {controller for controller, _, _ in missing_runs(experiment, results)}
                done = {name: digests[name] for name in lacking if name not in undone}
                for row in export(done, scored, results) if done else ():
                    rows.setdefault(row.controller, []).append(row)
                _write(scored, path, rows)
    else:
        _write(scored, path, rows)
    return sum(map(len, rows.values()))


def _kept(scored: ScoredSuite, path: Path, digests: dict[str, str]) -> dict[str, list[ScoreRow]]:
    """Return the rows of those entrants whose rows are complete and up to date."""
    stored: dict[str, list[ScoreRow]] = {}
    for row in read_scores(path) if path.exists() else ():
        stored.setdefault(row.controller, []).append(row)
    kept = {}
    for name, digest in digests.items():
        try:
            alone = Submission(name, digest, (name,), is_policy=False)
            kept[name] = check_claim(path, stored.get(name, []), alone, scored)
        except ClaimError:
            continue
    return kept


def _write(scored: ScoredSuite, path: Path, rows: dict[str, list[ScoreRow]]) -> None:
    write_scores(path, (row for name in scored.entrants for row in rows.get(name, ())))


def main() -> None:
    """Score as the command line says."""
    config = tyro.cli(ScoresConfig, description=__doc__)
    with command(
        ResultsError,
        BackendError,
        MissingExtraError,
        kept="runs that finished are stored, and the same command goes on",
    ):
        chosen = [get_scored(name) for name in config.suites or SCORED]
        with closing(config.where.make(config.output)) as backend:
            for scored in chosen:
                path = scores_file(config.output, scored.name)
                database = config.results / f"{scored.name}.sqlite"
                print(f"{path}: {compute(scored, path, database, backend)} rows", flush=True)


if __name__ == "__main__":
    main()
