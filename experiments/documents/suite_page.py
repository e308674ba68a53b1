"""The results page of a suite: its tables and figures on one page, and the tables as files of their own."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from experiments.catalogue import SUITES, TABLES
from experiments.documents.digests import digests_of_groups, digests_of_results, seeing
from experiments.documents.records import Record, record_of, short_commit
from experiments.runs.configuration import optimizers_of
from experiments.runs.database import Results
from experiments.runs.entries import FROM_CONTENT, IDENTITIES, KEY
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.tables.document import MADE_WITH
from experiments.tables.table import Table, write_tables_page
from swarm_gym.checks import look_up
from swarm_gym.comparing.entrants import with_encoding
from swarm_gym.files import write_atomically


def make_tables(suite: Suite, results: Results) -> list[Table]:
    """Return all tables of a suite.

    Raises:
        ResultsError: if a run of the suite is missing.
        UnknownNameError: if the suite names a table that no study has.
    """
    makers = [look_up("table", name, TABLES) for name in suite.tables]
    outcomes = outcomes_of(suite, results)
    return [table for make in makers for table in make(suite, outcomes)]


def outcomes_of(suite: Suite, results: Results) -> Outcomes:
    """Return the numbers of all runs of a suite.

    Raises:
        ResultsError: if a run of the suite is missing.
    """
    options = with_encoding(optimizers_of(suite), suite.options)
    return results.outcomes(suite.controllers, suite.seeds, options, suite.alone)


def record_of_suite(suite: Suite, results: Results) -> Record:
    """Return the record of a suite's runs, with what its controllers were when they ran."""
    commits = {one.get("commit", "unknown") for one in results.provenances(suite.controllers, suite.seeds)}
    stored = results.configuration()
    identity: dict[str, Any] = {}
    if stored.get(IDENTITIES) == FROM_CONTENT:  # a database of an earlier version tells them apart otherwise
        identity = {key.removeprefix(KEY): one for key, one in stored.items() if key.startswith(KEY)}
    digests = digests_of_groups(seeing(suite), identity)
    return record_of(suite.name, commits, digests | digests_of_results(optimizers_of(suite), commits))


def write_page(
    suite: Suite,
    tables: Sequence[Table],
    figures: Sequence[Path],
    folder: Path,
    made_with: Sequence[Mapping[str, str]] = (),
) -> Path:
    """Write every table to files of its own, and a README.md that shows all of them; return the latter.

    Args:
        suite: suite that was run.
        tables: tables of the suite.
        figures: files in the folder; those that are SVG are shown.
        folder: folder of the page, made if missing.
        made_with: provenances of the runs, written as one line; documents take it from a file of its own.
    """
    pictures = [
        f"![{figure.stem.replace('-', ' ')}]({figure.name})\n"
        for figure in figures
        if figure.suffix == ".svg"
    ]
    seeds = "seed" if suite.num_seeds == 1 else "seeds"
    runs = f"{suite.num_seeds} {seeds} per controller and scenario"
    if made_with:
        said = f"{runs}, scenarios: {len(suite.scenarios)}. {describe_provenance(made_with)}"
        write_atomically(folder / MADE_WITH, said)
    above = [f"Made by `{command_of(suite)}`.\n"]
    if made_with:
        above.append(describe_provenance(made_with))
    return write_tables_page(folder, f"Suite {suite.name}: {runs}", tables, above, pictures)


def write_collection_page(name: str, pages: Sequence[Path], folder: Path) -> Path:
    """Write a README.md that leads to the pages of a collection's suites, and return it."""
    links = [f"* [{page.parent.name}]({page.relative_to(folder).as_posix()})" for page in pages]
    return write_atomically(folder / "README.md", "\n".join([f"# Suites of {name}\n", *links, ""]))


def describe_provenance(made_with: Sequence[Mapping[str, str]]) -> str:
    """Return one line with all commits and all versions of some provenances."""
    values: dict[str, set[str]] = {}
    for provenance in made_with:
        for name, value in provenance.items():
            values.setdefault(name, set()).add(value)
    commits = sorted(short_commit(commit) for commit in values.pop("commit", ()))
    found = [f"commit{'s' if len(commits) > 1 else ''} {', '.join(commits)}"] if commits else []
    found += [f"{name} {', '.join(sorted(versions))}" for name, versions in sorted(values.items())]
    return f"Runs made with: {'; '.join(found)}.\n"


def command_of(suite: Suite) -> str:
    """Return the command that makes the runs and tables of a suite."""
    usual = SUITES.get(suite.name, suite)
    parts = [f"python -m experiments.evaluate --suite {suite.name} --seeds {suite.num_seeds}"]
    if suite.controllers != usual.controllers:
        parts.append(f"--controllers {' '.join(suite.controllers)}")
    if suite.scenarios != usual.scenarios:
        parts.append(f"--scenarios {' '.join(suite.scenarios)}")
    if suite.optimizer != usual.optimizer:
        parts.append(f"--optimizer {suite.optimizer}")
    return " ".join(parts)
