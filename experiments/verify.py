"""Verify scores of policies: `python -m experiments.verify FILE.safetensors --suite headline`.

Runs a policy again on the seeds that the suite states, and compares every run with what is claimed: with the
rows of `--claim`, else with those that scores/ has for the digest of the file. Without a claim it measures
only. `--output` writes the rows that were found, which are a claim that others can verify. The exit status is
0 if all claims hold, and 1 if one does not, or if a submission or claim is refused.
"""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from tqdm import tqdm

from experiments.runs.episode import warm_up
from experiments.scoring.cases import Case, StoredScores, packaged_cases, submitted_cases
from experiments.scoring.comparison import Verdict, overall
from experiments.scoring.files import SCORES, write_scores
from experiments.scoring.report import conclusion, report
from experiments.scoring.suites import SCORED, get_scored
from swarm_gym.command import command
from swarm_gym.comparing.entrants import entrant


@dataclass(frozen=True)
class VerifyConfig:
    """Options of the command."""

    files: Annotated[tuple[str, ...], tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = ()
    """Policies to verify: files, or packaged ones such as learned:three-cases/0@1. By default all packaged
    policies, with the rows in scores/."""
    suite: str | None = None
    """Scored suite, e.g. headline. By default those whose scores have the digest of the file."""
    claim: Path | None = None
    """CSV file with the claimed rows, e.g. row.csv. By default the rows in scores/ that have the digest."""
    output: Path | None = None
    """CSV file for the rows that were found, e.g. row.csv. By default none is written."""
    scores: Path = SCORES
    """Folder of the stored scores, by default scores."""


def cases_of(config: VerifyConfig) -> list[Case]:
    """Return the cases that a command line asks for; whatever is wrong with one is refused here.

    Raises:
        ValueError: for a refused submission or claim; `submitted_cases` lists the reasons.
    """
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
        OSError: if the rows cannot be written.
    """
    cases = cases_of(config)
    for case in cases:
        for name in case.submission.entrants:
            warm_up(entrant(name, case.scored.suite.optimizer).optimizer, case.scored.suite)
    say = report if config.files else conclusion
    found, verdicts = [], []
    with tqdm(total=sum(case.num_runs for case in cases), unit="run") as bar:
        for case in cases:
            comparisons = case.verify(bar.update)
            found += [one.found for one in comparisons]
            verdicts.append(overall(comparisons))
            bar.write(say(case, comparisons), file=sys.stdout)
    counts = [f"{count} {verdict.value}" for verdict in Verdict if (count := verdicts.count(verdict))]
    print(f"{len(cases)} verified: {', '.join(counts) or 'nothing is claimed'}")
    if config.output is not None:
        print(f"{len(found)} rows: {write_scores(config.output, found)}")
    return Verdict.DIFFERS not in verdicts


def main() -> None:
    """Verify as the command line says."""
    config = tyro.cli(VerifyConfig, description=__doc__)
    with command():
        holds = verify(config)
    sys.exit(not holds)


if __name__ == "__main__":
    main()
