"""Verify scores of policies: `python -m experiments.verify FILE.safetensors --suite headline`.

Runs a policy again on the seeds that the suite states, and compares every run with what is claimed: with the
rows or stored runs of `--claim`, else with the rows that scores/ has for the digest of the file. Without a
claim it measures only. `--output` writes the rows that were found, which are a claim that others can verify.
The exit status is 0 if all claims hold, and 1 if one does not, or if a submission or claim is refused.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from tqdm import tqdm

from experiments.runs.database import ResultsError
from experiments.runs.runner import warm_up_all
from experiments.scoring.cases import StoredScores, SubmittedCase, packaged_cases, submitted_cases
from experiments.scoring.claimed_rows import DIGITS
from experiments.scoring.files import SCORES, ScoreFileError, write_scores
from experiments.scoring.ranking import objective
from experiments.scoring.suites import SCORED, get_scored
from experiments.scoring.verdicts import ScoreComparison, Verdict, overall
from swarm_gym.command import command

HEADS = (
    "environment", "scenarios", "claimed gap", "found gap", "claimed evaluations", "found evaluations",
    "claimed feasible", "found feasible", "verdict",
)  # fmt: skip
NOTHING = "-"  # where nothing is claimed
# The texts of numbers, by column of a score.
FORMS: dict[str, Callable[[float], str]] = {
    "gap": lambda share: f"{100 * share:.6f} %",
    "evaluations": lambda number: f"{number:,.1f}",
    "feasible": lambda share: f"{100 * share:.1f} %",
}


def report(case: SubmittedCase, comparisons: Sequence[ScoreComparison]) -> str:
    """Return a table of what is claimed and what was found, and the verdict."""
    rows = [HEADS, *map(_cells, comparisons)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)) for row in rows]
    submission = case.submission
    head = f"{submission.name}: digest {submission.digest[:DIGITS]}, suite {case.scored.name}"
    source = f"claim of {case.source}" if case.source else "no claim"
    return "\n".join(
        [f"{head}, {source}", *(f"  {line.rstrip()}" for line in lines), conclusion(case, comparisons)]
    )


def conclusion(case: SubmittedCase, comparisons: Sequence[ScoreComparison]) -> str:
    """Return the verdict on a case in a line, with the first number that differs if there is one.

    Where nothing is claimed, the line has the objective instead, by which suites rank.
    """
    verdict = overall(comparisons)
    runs = f"{case.num_runs} runs of {case.scored.name}"
    if verdict is None:
        reached = objective([one.found for one in comparisons])
        return f"{case.submission.name}: measured only, nothing is claimed, {runs}, objective {reached:.3f}"
    differing = [one.difference for one in comparisons if one.difference]
    first = f": {differing[0]}" if differing else ""
    return f"{case.submission.name}: {verdict.value}, {runs}{first}"


def _cells(one: ScoreComparison) -> list[str]:
    numbers = [
        NOTHING if row is None else form(getattr(row, name))
        for name, form in FORMS.items()
        for row in (one.claimed, one.found)
    ]
    verdict = NOTHING if one.verdict is None else one.verdict.value
    return [one.found.environment, one.found.scenario_set, *numbers, verdict]


@dataclass(frozen=True)
class VerifyConfig:
    """Options of the command."""

    files: Annotated[tuple[str, ...], tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = ()
    """Policies to verify: files, or packaged ones such as learned:three-cases/0@1. By default all packaged
    policies, with the rows in scores/."""
    suite: str | None = None
    """Scored suite, e.g. headline. By default those whose scores have the digest of the file."""
    claim: Path | None = None
    """CSV file with the claimed rows, e.g. row.csv, or a results database whose runs are the claim, e.g.
    results/study/headline.sqlite. By default the rows in scores/ that have the digest."""
    output: Path | None = None
    """CSV file for the rows that were found, e.g. row.csv. By default none is written."""
    scores: Path = SCORES
    """Folder of the stored scores, by default scores."""


def cases_of(config: VerifyConfig) -> list[SubmittedCase]:
    """Return the cases that a command line asks for; whatever is wrong with one is refused here.

    Raises:
        ValueError, ResultsError: for a refused submission or claim; `submitted_cases` lists the reasons.
    """
    if config.claim is None and config.scores != SCORES and not config.scores.is_dir():
        raise ScoreFileError(f"--scores {config.scores}: there is no such folder")
    stored = StoredScores(config.scores)
    if config.files:
        return submitted_cases(config.files, config.suite, config.claim, stored)
    if config.claim is not None:
        raise ValueError(f"--claim {config.claim} needs the FILE that it is about")
    chosen = list(SCORED.values()) if config.suite is None else [get_scored(config.suite)]
    return packaged_cases(chosen, stored)


def verify(config: VerifyConfig) -> bool:
    """Verify what a command line asks for, print verdicts, and return whether all claims hold.

    Raises:
        ValueError: for a refused submission or claim; nothing has run then.
        ResultsError: for a results database that cannot be the claim; nothing has run then.
        OSError: if the rows cannot be written.
    """
    cases = cases_of(config)
    for case in cases:
        warm_up_all(case.scored.part(case.submission.entrants))
    say = report if config.files else conclusion
    found, verdicts = [], []
    with tqdm(total=sum(case.num_runs for case in cases), unit="run") as bar:
        for case in cases:
            comparisons = case.verify(bar.update)
            found += [one.found for one in comparisons]
            verdicts.append(overall(comparisons))
            bar.write(say(case, comparisons), file=sys.stdout)
    counts = [f"{count} {verdict.value}" for verdict in Verdict if (count := verdicts.count(verdict))]
    print(
        f"{len(cases)} verified: {', '.join(counts)}"
        if counts
        else f"{len(cases)} measured: nothing is claimed"
    )
    if config.output is not None:
        print(f"{len(found)} rows: {write_scores(config.output, found)}")
    return Verdict.DIFFERS not in verdicts


def main() -> None:
    """Verify as the command line says."""
    config = tyro.cli(VerifyConfig, description=__doc__)
    with command(ResultsError):
        holds = verify(config)
    sys.exit(not holds)


if __name__ == "__main__":
    main()
