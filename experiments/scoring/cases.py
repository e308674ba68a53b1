"""Cases to verify: submissions to suites with what is claimed about them, checked before anything runs."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.runs.configuration import configuration
from experiments.runs.database import Results
from experiments.scoring.claimed_rows import check_claim, rows_of
from experiments.scoring.files import read_scores, scores_file
from experiments.scoring.score import ScoreRow, export, measure
from experiments.scoring.submission import Submission, digest_of_policy, read_submission
from experiments.scoring.suites import LEARNED, SCORED, ScoredSuite, get_scored
from experiments.scoring.verdicts import ScoreComparison, compare

DATABASE = ".sqlite"  # suffix of results databases


@dataclass(frozen=True)
class SubmittedCase:
    """A submission to a suite, and what is claimed about it.

    Attributes:
        submission: the submission.
        scored: suite that scores it.
        claimed: rows that are claimed, in the order of the runs; empty without a claim.
        source: file or database of the claim; None without one.
    """

    submission: Submission
    scored: ScoredSuite
    claimed: tuple[ScoreRow, ...]
    source: Path | None

    @property
    def num_runs(self) -> int:
        """Number of runs that verify it."""
        return len(self.submission.entrants) * sum(len(chosen.runs) for chosen in self.scored.sets.values())

    def verify(self, ran: Callable[[int], Any] = lambda _: None) -> list[ScoreComparison]:
        """Make the runs, and return a comparison for each environment and set of scenarios.

        Args:
            ran: function that is called with the number of runs that have ended since the last call.
        """
        found = measure(self.submission.digests, self.scored, ran)
        if not self.claimed:
            return [ScoreComparison(None, row, None) for row in found]
        return [
            compare(claimed, row, self.scored.sets[row.scenario_set])
            for claimed, row in zip(self.claimed, found, strict=True)
        ]


class StoredScores:
    """A folder with a file of scores for each suite; each file is read once.

    Args:
        folder: the folder.

    Attributes:
        folder: the folder.
    """

    def __init__(self, folder: Path):
        self.folder = folder
        self._rows: dict[Path, list[ScoreRow]] = {}

    def path(self, scored: ScoredSuite) -> Path:
        """Return the file of a suite."""
        return scores_file(self.folder, scored.name)

    def rows(self, scored: ScoredSuite) -> list[ScoreRow]:
        """Return the rows of a suite; none if it has no file."""
        return self.read(self.path(scored)) if self.path(scored).exists() else []

    def read(self, path: Path) -> list[ScoreRow]:
        """Return the rows of a file.

        Raises:
            ScoreFileError: if it cannot be read.
        """
        if path not in self._rows:
            self._rows[path] = read_scores(path)
        return self._rows[path]


def packaged_cases(suites: Sequence[ScoredSuite], stored: StoredScores) -> list[SubmittedCase]:
    """Return the cases of all packaged policies of these suites, with their stored rows as claims.

    Raises:
        ScoreFileError, ClaimError: if rows are missing or out of date.
    """
    return [
        make_case(f"{LEARNED}:{policy}", scored, stored.path(scored), stored)
        for scored in suites
        for policy in scored.policies
    ]


def submitted_cases(
    names: Sequence[str], suite: str | None, claim: Path | None, stored: StoredScores
) -> list[SubmittedCase]:
    """Return the cases of submissions.

    Args:
        names: policy files, names of packaged policies, or entrants of the suites that are no policies.
        suite: suite that scores them; None is every suite whose stored scores have the digest.
        claim: file of scores, or results database, with the claims; None is the stored scores, where these
            have the digest.
        stored: the stored scores.

    Raises:
        PolicyFileError: if a file is no policy.
        ResultsError: if the claim is a results database that lacks runs, or is of another configuration.
        SubmissionError: if a policy is not for the suite, or its manifest lies.
        ScoreFileError, ClaimError: if a claim cannot be used, or is about something else.
        UnknownNameError: if there is no such suite.
        ValueError: if no suite is named, and none has the digest.
    """
    return [
        make_case(name, scored, claim, stored)
        for name in names
        for scored in ([get_scored(suite)] if suite is not None else _suites_of(name, stored))
    ]


def make_case(name: str, scored: ScoredSuite, claim: Path | None, stored: StoredScores) -> SubmittedCase:
    """Return the case of a submission to a suite; `submitted_cases` describes the arguments and errors."""
    submission = read_submission(name, scored)
    if claim is not None and claim.suffix == DATABASE:
        return SubmittedCase(submission, scored, tuple(_stored_rows(claim, submission, scored)), claim)
    path = claim or stored.path(scored)
    rows = stored.read(path) if claim else stored.rows(scored)
    if claim or rows_of(submission, rows):
        return SubmittedCase(submission, scored, tuple(check_claim(path, rows, submission, scored)), path)
    return SubmittedCase(submission, scored, (), None)


def _stored_rows(database: Path, submission: Submission, scored: ScoredSuite) -> list[ScoreRow]:
    """Return the rows of the runs that a results database has of a submission, in the order of its runs."""
    needed = configuration(scored.part(submission.entrants))
    with closing(Results.stored(database, needed)) as results:
        return export(submission.digests, scored, results)


def _suites_of(name: str, stored: StoredScores) -> list[ScoredSuite]:
    """Return the suites whose stored scores have the digest of a submission."""
    if beside := [scored for scored in SCORED.values() if name in scored.references]:
        return beside
    digest = digest_of_policy(name)
    found = [scored for scored in SCORED.values() if any(row.digest == digest for row in stored.rows(scored))]
    if not found:
        raise ValueError(
            f"{name}: no file in {stored.folder} has its digest; choose the --suite that shall score it, one "
            f"of {', '.join(SCORED)}"
        )
    return found
