"""Write a report of a results database: tables, figures, replays, and how they were made.

The report is one HTML file that needs no network and no other file: open it, share it, print it. Its content
comes from the database, which is only read. Runs to replay are run again; a replay is left out if its run
ends otherwise than the stored one.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from experiments.choice import Choice
from experiments.report.completeness import refuse_own_code
from experiments.report.contents import Request, make_report
from experiments.report.document import to_html
from experiments.runs.configuration import environment_configuration
from experiments.runs.database import Results, ResultsError
from experiments.runs.run import RunKey
from swarm_gym.command import command
from swarm_gym.files import write_atomically
from swarm_gym.outputs import require_outputs

REPLAY_FORM = "CONTROLLER,SCENARIO,SEED"


@dataclass(frozen=True)
class ReportConfig:
    """Options of a report."""

    database: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """Results database that `python -m experiments.evaluate` wrote, e.g. results/paper.sqlite."""
    suite: str = ""
    """Suite of the runs, e.g. paper; by default the name of the file without its ending."""
    output: Path | None = None
    """File to write; by default report.html among the suite's tables, e.g. results/paper/report.html."""
    choice: tyro.conf.OmitArgPrefixes[Choice] = field(default_factory=Choice)
    replays: Annotated[tuple[str, ...] | None, tyro.conf.arg(metavar=REPLAY_FORM)] = None
    """Runs to replay, e.g. spsfa-tip,case1,0; by default those that the suite names."""
    figures: bool = True
    """Draw figures; without them, the report is written faster."""


def write_report(config: ReportConfig) -> Path:
    """Write a report and return the path of its file.

    Raises:
        ResultsError: if the database cannot be used, or lacks a run to replay.
        SettingError: if the output cannot be written, or is the database.
        OwnCodeError: if it has runs of own code that the command line does not name.
    """
    if config.output is not None:
        require_outputs([config.output], [config.database])
    suite = config.choice.suite(config.suite or config.database.stem)
    replays = None if config.replays is None else [_run_key(text) for text in config.replays]
    results = Results.stored(config.database, environment_configuration(suite))
    try:
        refuse_own_code(results, suite)
        report = make_report(Request(config.database, suite, replays, config.figures), results)
    finally:
        results.close()
    output = config.output or config.database.parent / suite.name / "report.html"
    return write_atomically(output, to_html(report))


def _run_key(text: str) -> RunKey:
    """Return the key of a run that the command line names."""
    controller, *rest = text.rsplit(",", 2)
    if len(rest) != 2 or not rest[1].isdigit():
        raise ResultsError(f"--replays takes {REPLAY_FORM}, e.g. spsfa-tip,case1,0, got {text!r}")
    return controller, rest[0], int(rest[1])


def main() -> None:
    """Write the report that the command line asks for."""
    config = tyro.cli(ReportConfig, description=__doc__)
    with command(ResultsError):
        file = write_report(config)
        print(f"report: {file} ({file.stat().st_size / 1e6:.1f} MB)")


if __name__ == "__main__":
    main()
