"""A results database as one page: tables, figures, replays, and how all of it came about.

The page is one HTML file, which needs no network and no other file: open it, send it on, print it. What it
says comes from the database, to which nothing is written; the runs that it replays are made again and left
out if they end otherwise than what is stored.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from experiments.catalogue import get_suite
from experiments.report.contents import Request, make_report
from experiments.report.document import to_html
from experiments.runs.database import Results, ResultsError
from experiments.runs.run import RunKey
from experiments.runs.runner import environment_configuration
from swarm_gym.command import command
from swarm_gym.files import write_atomically

REPLAY_FORM = "CONTROLLER,SCENARIO,SEED"


@dataclass(frozen=True)
class ReportConfig:
    """Options of a report."""

    database: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """What `python -m experiments.evaluate` wrote, as results/paper.sqlite."""
    suite: str = ""
    """Which suite it is of; by default that of the file's name."""
    output: Path | None = None
    """The page; by default report.html in the folder of the suite's tables, as results/paper/report.html."""
    replays: Annotated[tuple[str, ...] | None, tyro.conf.arg(metavar=REPLAY_FORM)] = None
    """Runs to replay, as spsfa-tip,case1,0; those of the suite by default."""
    figures: bool = True
    """Whether to draw figures."""


def write_report(config: ReportConfig) -> Path:
    """Write the page; returns its file.

    Raises:
        ResultsError: if the database cannot be used, or lacks a run that is to be replayed.
    """
    suite = get_suite(config.suite or config.database.stem)
    replays = None if config.replays is None else [_run_key(text) for text in config.replays]
    results = Results.stored(config.database, environment_configuration(suite))
    try:
        report = make_report(Request(config.database, suite, replays, config.figures), results)
    finally:
        results.close()
    output = config.output or config.database.parent / suite.name / "report.html"
    return write_atomically(output, to_html(report))


def _run_key(text: str) -> RunKey:
    controller, *rest = text.rsplit(",", 2)
    if len(rest) != 2 or not rest[1].isdigit():
        raise ResultsError(f"--replays takes {REPLAY_FORM}, as spsfa-tip,case1,0, got {text!r}")
    return controller, rest[0], int(rest[1])


def main() -> None:
    """Write the page that the command line asks for."""
    config = tyro.cli(ReportConfig, description=__doc__)
    with command(ResultsError):
        page = write_report(config)
    print(f"report: {page} ({page.stat().st_size / 1e6:.1f} MB)")


if __name__ == "__main__":
    main()
