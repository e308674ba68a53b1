"""Claims about submissions: rows of scores that someone states, checked before anything runs."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from experiments.scoring.score import ScoreRow
from experiments.scoring.submission import Submission
from experiments.scoring.suites import ScoredSuite
from swarm_gym.comparing.entrants import entrant

DIGITS = 12  # of a digest in a message


class ClaimError(ValueError):
    """A claim that is refused; the message names the file, what is wrong and what was expected."""


def check_claim(
    path: Path, rows: Sequence[ScoreRow], submission: Submission, scored: ScoredSuite
) -> list[ScoreRow]:
    """Return the rows of a file that are about a submission, in the order of its runs.

    Args:
        path: the file, for messages.
        rows: all rows of the file.
        submission: the submission.
        scored: suite that scores it.

    Raises:
        ClaimError: if no row has the digest of the submission, or if rows are missing, too many, or over
            other seeds than the suite states.
    """
    mine = rows_of(submission, rows)
    if not mine:
        stated = list(dict.fromkeys(row.digest[:DIGITS] for row in rows))
        more = f" and {len(stated) - 3} more" if len(stated) > 3 else ""
        raise ClaimError(
            f"{path}: digest {', '.join(stated[:3])}{more} is not that of {submission.name}, which is "
            f"{submission.digest[:DIGITS]}"
        )
    places = expected_places(submission, scored)
    for place, count in Counter(row.place for row in mine).items():
        if place not in places:
            raise ClaimError(
                f"{path}: {' on '.join(place)} is not part of the suite {scored.name}; expected "
                f"{_listed(places)}"
            )
        if count > 1:
            raise ClaimError(f"{path}: {count} rows of {' on '.join(place)}, expected one")
    by_place = {row.place: row for row in mine}
    missing = [place for place in places if place not in by_place]
    if missing:
        raise ClaimError(f"{path}: lacks the rows of {_listed(missing)} for {submission.name}")
    for row in mine:
        _refuse_other_seeds(path, row, scored)
    return [by_place[place] for place in places]


def rows_of(submission: Submission, rows: Sequence[ScoreRow]) -> list[ScoreRow]:
    """Return the rows with the digest of a submission; of several under other names, those with its name.

    Controllers that are no policies have to have its name, since rules of several optimizers are alike.
    """
    mine = [row for row in rows if row.digest == submission.digest]
    named = [row for row in mine if row.controller in submission.entrants]
    return named or (mine if submission.is_policy else [])


def expected_places(submission: Submission, scored: ScoredSuite) -> list[tuple[str, str]]:
    """Return environment and set of scenarios of every row that a submission has in a suite."""
    return [
        (scored.environment(entrant(name, scored.experiment.optimizer).optimizer), scenario_set)
        for name in submission.entrants
        for scenario_set in scored.sets
    ]


def _refuse_other_seeds(path: Path, row: ScoreRow, scored: ScoredSuite) -> None:
    expected = scored.sets[row.scenario_set]
    for name in ("first_seed", "num_seeds"):
        if getattr(row, name) != getattr(expected, name):
            raise ClaimError(
                f"{path}: {name} of {row.scenario_set} is {getattr(row, name)}; the suite {scored.name} "
                f"states {getattr(expected, name)}"
            )
    if len(row.fitness_of_runs) != len(expected.runs):
        raise ClaimError(
            f"{path}: {row.scenario_set} has the numbers of {len(row.fitness_of_runs)} runs; the suite "
            f"{scored.name} has {len(expected.runs)}"
        )


def _listed(places: Sequence[tuple[str, str]]) -> str:
    named = [" on ".join(place) for place in places[:6]]
    return ", ".join(named) + (f" and {len(places) - 6} more" if len(places) > 6 else "")
