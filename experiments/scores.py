"""Score every controller that ships: `python -m experiments.scores [SUITE ...]`.

Writes a CSV file for each scored suite, with a row for each controller, environment and set of scenarios.
Rows that are there stay if their seeds and the digest of their controller are still right; delete a file to
compute it anew. The file is written after each controller, so that the command goes on where it was stopped.
"""

from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro
from tqdm import tqdm

from agents.backends import Backend, BackendError, BackendOptions, Task
from experiments.runs.episode import warm_up
from experiments.scoring.claims import ClaimError, check_claim
from experiments.scoring.files import SCORES, read_scores, scores_file, write_scores
from experiments.scoring.score import Score, score
from experiments.scoring.submission import Submission, digest_of
from experiments.scoring.suites import SCORED, ScoredSuite, get_scored
from swarm_gym.command import command
from swarm_gym.comparing.entrants import entrant
from swarm_gym.errors import MissingExtraError


@dataclass(frozen=True)
class ScoresConfig:
    """Options of the command."""

    suites: Annotated[tuple[str, ...], tyro.conf.Positional, tyro.conf.arg(metavar="SUITE")] = ()
    """Scored suites to compute, e.g. headline optimizers; by default all. A wrong name lists them."""
    output: Path = SCORES
    """Folder of the CSV files, by default scores."""
    where: tyro.conf.OmitArgPrefixes[BackendOptions] = field(default_factory=BackendOptions)


def compute(scored: ScoredSuite, path: Path, backend: Backend) -> int:
    """Make the rows that a file of scores lacks, drop those that are out of date, and return how many it has.

    Raises:
        ScoreFileError: if the file is there and cannot be read.
        BackendError: if the backend cannot be used.
    """
    digests = {name: digest_of(name, scored) for name in scored.entrants}
    kept = _kept(scored, path, digests)
    missing = [(name, digest) for name, digest in digests.items() if name not in kept]
    if missing and backend.on_this_machine:  # here once, or each worker would print that it compiles
        for optimizer in {entrant(name, scored.suite.optimizer).optimizer for name, _ in missing}:
            warm_up(optimizer, scored.suite)
    num_runs = sum(len(chosen.runs) for chosen in scored.sets.values())
    with tqdm(total=len(missing) * num_runs, unit="run", desc=scored.name) as bar:
        for number, rows in backend.run(Task(score_unit, (scored.name,)), missing):
            kept[missing[number][0]] = rows
            _write(scored, path, kept)
            bar.update(num_runs)
    _write(scored, path, kept)
    return sum(map(len, kept.values()))


def score_unit(unit: tuple[str, str], suite: str) -> list[Score]:
    """Return the scores of an entrant and the digest of its controller; workers call this."""
    return score(*unit, get_scored(suite))


def _kept(scored: ScoredSuite, path: Path, digests: dict[str, str]) -> dict[str, list[Score]]:
    """Return the rows of those entrants whose rows are complete and up to date."""
    stored: dict[str, list[Score]] = {}
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


def _write(scored: ScoredSuite, path: Path, rows: dict[str, list[Score]]) -> None:
    write_scores(path, (row for name in scored.entrants for row in rows.get(name, ())))


def main() -> None:
    """Score as the command line says."""
    config = tyro.cli(ScoresConfig, description=__doc__)
    with command(
        BackendError, MissingExtraError, kept="the same command goes on from the rows that were written"
    ):
        chosen = [get_scored(name) for name in config.suites or SCORED]
        with closing(config.where.make(config.output)) as backend:
            for scored in chosen:
                path = scores_file(config.output, scored.name)
                print(f"{path}: {compute(scored, path, backend)} rows", flush=True)


if __name__ == "__main__":
    main()
