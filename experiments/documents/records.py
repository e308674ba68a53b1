"""Records of results: which commits made the runs, and digests of what decided them.

A command that makes runs writes a record beside its tables. `experiments.publish` keeps the records of the
results that it publishes in `docs/results/records.json`. docs/results-runs.md shows them, and marks what has
changed since.
"""

import json
import subprocess
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from swarm_gym.files import write_atomically

COMMIT_DIGITS = 10
KEPT = Path("docs/results/records.json")
# Decisions and observations rest on the project's own elementary functions since this time, that of a
# commit. The last digits of earlier runs may be others today.
PORTABLE_SINCE = "2026-11-26T01:23:15+00:00"


@dataclass(frozen=True)
class Record:
    """Commits and digests of the runs behind some tables.

    Attributes:
        name: name of the suite, or of the part of the results.
        commits: commits that made the runs, by their first digits: when each was committed, ISO 8601, or
            nothing if that is unknown.
        digests: digests of what decided the runs, by name: groups of controllers, rows of a table, or
            `results of firefly`, what an optimizer computes. Without any, they were not recorded.
    """

    name: str
    commits: Mapping[str, str]
    digests: Mapping[str, str]

    @property
    def is_portable(self) -> bool:
        """True if all runs are known to be younger than the elementary functions of the project."""
        return bool(self.commits) and all(time >= PORTABLE_SINCE for time in self.commits.values())

    def changed(self, today: Mapping[str, str]) -> list[str]:
        """Return the names of what decided the runs and is another now, or is no longer there."""
        return [name for name, digest in self.digests.items() if today.get(name) != digest]


def record_of(name: str, commits: Iterable[str], digests: Mapping[str, str]) -> Record:
    """Return the record of runs.

    Args:
        name: name of the suite, or of the part of the results.
        commits: commits of the runs, as their provenance states them; unknown ones are left out.
        digests: digests of what decided the runs, by name.
    """
    known = {short_commit(commit) for commit in commits} - {"", "unknown"}
    times = {commit: time_of(commit) for commit in known}
    ordered = sorted(times, key=lambda commit: (times[commit], commit))
    return Record(name, {commit: times[commit] for commit in ordered}, dict(sorted(digests.items())))


def commits_in(files: Iterable[Path]) -> set[str]:
    """Return the commits that JSON files of runs name; a file of an earlier version names none."""
    stored = [json.loads(file.read_text(encoding="utf-8")) for file in files]
    return {one["provenance"]["commit"] for one in stored if "provenance" in one}


def write_record(record: Record, folder: Path) -> Path:
    """Write a record beside the tables in a folder, and return its file."""
    content = json.dumps(asdict(record), indent=1)
    return write_atomically(folder / f"record-{record.name}.json", content + "\n")


def records_in(folder: Path) -> list[Record]:
    """Return the records in a folder and below it."""
    files = sorted(folder.rglob("record-*.json"))
    return [Record(**json.loads(file.read_text(encoding="utf-8"))) for file in files]


def kept_records() -> dict[str, Record]:
    """Return the records of published results by their names."""
    if not KEPT.is_file():
        return {}
    return {one["name"]: Record(**one) for one in json.loads(KEPT.read_text(encoding="utf-8"))}


def keep(records: Iterable[Record]) -> None:
    """Keep the records of results that were published; those of other results stay."""
    new = {record.name: record for record in records}
    if not new:
        return
    kept = kept_records() | new
    content = json.dumps([asdict(kept[name]) for name in sorted(kept)], indent=1)
    write_atomically(KEPT, content + "\n")


def short_commit(commit: str) -> str:
    """Return a commit with fewer digits, and whether files were changed since."""
    digits, separator, dirty = commit.partition("-")
    return f"{digits[:COMMIT_DIGITS]}{separator}{dirty}"


def time_of(commit: str) -> str:
    """Return when a commit was committed, ISO 8601; empty if this checkout does not know it."""
    return git("show", "--no-patch", "--format=%cI", commit.partition("-")[0]).strip()


def git(*arguments: str) -> str:
    """Return what git prints in the folder of this file; nothing if it fails."""
    folder = Path(__file__).parent
    try:
        done = subprocess.run(["git", *arguments], cwd=folder, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return ""
    return done.stdout
