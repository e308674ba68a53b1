"""Words of the pages of results on how runs were made: commits by day, and what has changed since."""

from collections.abc import Callable, Iterable, Mapping
from functools import cache
from itertools import groupby

from experiments.catalogue import SUITES
from experiments.documents.digests import (
    RESULTS_OF,
    digests_of_one_max,
    digests_of_rivals,
    digests_of_strong,
    digests_of_terrain,
    digests_today,
)
from experiments.documents.records import Record, kept_records
from experiments.tables.table import Row, Table, wrapped

OUT_OF_DATE, EARLIER, AS_TODAY = "**out of date**", "before portable numbers", "as today"
NOT_RECORDED = "not recorded"
DAY = 10  # characters of a date at the beginning of a time
# Digests of today by the names of records that are of no suite.
TODAY: Mapping[str, Callable[[], Mapping[str, str]]] = {
    "known-optimum": digests_of_one_max,
    "learners": digests_of_rivals,
    **dict.fromkeys(
        ("strong-optimizers", "strong-repeated", "strong-on-bbob", "beside-libraries", "beside-pycma"),
        digests_of_strong,
    ),
    **{
        f"terrain-{part}": digests_of_terrain
        for part in ("all", "longer", "longest", "eight", "longer-guided", "fresh", "longest-guided")
    },
}


@cache
def today(name: str) -> Mapping[str, str]:
    """Return the digests of what would decide the runs of a record today."""
    return digests_today(SUITES[name]) if name in SUITES else TODAY.get(name, dict)()


def record(name: str) -> Record:
    """Return the record of that name; an empty one if none was kept."""
    return kept_records().get(name, Record(name, {}, {}))


def state(found: Record) -> str:
    """Return what is to be known of runs: whether anything has changed since, or is not recorded."""
    if not found.commits:
        return NOT_RECORDED
    changed = found.changed(today(found.name)) if found.digests else []
    parts = [f"{OUT_OF_DATE}: {', '.join(changed)}"] if changed else []
    if not found.is_portable:
        parts.append(EARLIER)
    if not found.digests:
        parts.append(f"digests {NOT_RECORDED}")
    elif not any(name.startswith(RESULTS_OF) for name in found.digests):
        parts.append(f"digests of optimizers {NOT_RECORDED}")
    return "; ".join(parts) or AS_TODAY


def short_state(names: Iterable[str]) -> str:
    """Return the least that is to be known of several records: the worst of them counts."""
    states = [state(record(name)) for name in names]
    for worst in (OUT_OF_DATE, EARLIER):
        if number := sum(worst in one for one in states):
            return f"{worst}: {number} of {len(states)} suites" if len(states) > 1 else worst
    return NOT_RECORDED if any(NOT_RECORDED in one for one in states) else AS_TODAY


def days(commits: Mapping[str, str]) -> str:
    """Return commits by the days on which they were committed; `not recorded` without any."""
    by_day = groupby(commits, lambda commit: commits[commit][:DAY] or "unknown day")
    return ", ".join(f"{day} ({', '.join(same)})" for day, same in by_day) or NOT_RECORDED


def lines_of(names: Iterable[str]) -> str:
    """Return a line for each record, which stands below a headline."""
    said = [_line(record(name)) for name in names]
    return wrapped(f"Runs made with: {'. '.join(said)}.")


def _line(found: Record) -> str:
    if not found.commits:
        return f"`{found.name}`, commit {NOT_RECORDED}"
    return f"`{found.name}`, commits of {days(found.commits)}: {state(found)}"


def span(names: Iterable[str]) -> str:
    """Return the first and the last day on which commits made the runs of records, and their number."""
    commits = {commit: time for name in names for commit, time in record(name).commits.items()}
    known = sorted({time[:DAY] for time in commits.values() if time})
    if not known:
        return NOT_RECORDED
    whole = known[0] if len(known) == 1 else f"{known[0]} to {known[-1]}"
    return f"{whole}, {len(commits)} commit{'s' if len(commits) > 1 else ''}"


def outdated(names: Iterable[str]) -> set[str]:
    """Return what has changed of what decided the runs of records, by the names in the records."""
    records = [record(name) for name in names]
    return {name for one in records if one.digests for name in one.changed(today(one.name))}


def records_table(pages: Mapping[str, Iterable[str]]) -> Table:
    """Return the table of all records.

    Args:
        pages: names of records by the page that shows their runs, a link.
    """
    rows: list[Row] = [
        {
            "runs": f"`{name}`",
            "page": page,
            "commits by day": days(record(name).commits),
            "state": state(record(name)),
        }
        for page, names in pages.items()
        for name in names
    ]
    caption = (
        "Runs behind the pages: commits that made them, by the day of the commit, and what has changed "
        "since. As today: no recorded digest, of controllers or of what optimizers compute, has changed. "
        f"{EARLIER.capitalize()}: made before the elementary functions of the project decided runs, so that "
        "last digits may differ"
    )
    return Table.of("records", caption, rows)
