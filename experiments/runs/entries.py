"""The entries of a results database: all runs of one controller, under its name.

A policy or a piece of own code may change under its name. Its runs so far are then kept aside, as
`<name>#<digest>`, and new runs have the name. Tables and reports show entries that are not aside.
"""

import hashlib
import json
import sqlite3
from collections.abc import Mapping
from contextlib import closing
from typing import NamedTuple

ASIDE = "#"
DIGITS = 8
KEY = "controller "  # what the keys of controllers begin with in the configuration
TABLES = ("runs", "snapshots")
# This key says how a database tells controllers apart: by `Controller.identity`. Databases of earlier
# versions lack it: there, numbers that depend on the processor are part of what some controllers are.
IDENTITIES, FROM_CONTENT = "identities", "from content"


class EntryError(ValueError):
    """An entry that is not there, or is there already; the message names it."""


class StoredEntry(NamedTuple):
    """An entry of a database.

    Attributes:
        name: name of the controller; with `ASIDE` and a digest, if it has changed since.
        digest: digest of what the controller is; empty if it is not stored.
        num_runs: number of runs.
        num_scenarios: number of scenarios that they are on.
        commits: commits that made them, shortened.
    """

    name: str
    digest: str
    num_runs: int
    num_scenarios: int
    commits: tuple[str, ...]


def is_aside(name: str) -> bool:
    """Return whether an entry was kept aside since its controller changed."""
    return ASIDE in name


def digest_of(stored: str) -> str:
    """Return the digest of the stored identity of a controller."""
    return hashlib.sha256(stored.encode()).hexdigest()[:DIGITS]


def entries_of(connection: sqlite3.Connection) -> list[StoredEntry]:
    """Return the entries of a database, sorted by name."""
    query = (
        "SELECT controller, COUNT(*), COUNT(DISTINCT scenario), json_group_array(DISTINCT provenance) "
        "FROM runs GROUP BY controller ORDER BY controller"
    )
    identities = _identities(connection)
    return [
        StoredEntry(
            name,
            digest_of(identities[name]) if name in identities else "",
            num_runs,
            num_scenarios,
            tuple(sorted({json.loads(text).get("commit", "unknown")[:10] for text in json.loads(made_with)})),
        )
        for name, num_runs, num_scenarios, made_with in connection.execute(query)
    ]


def keep_aside(connection: sqlite3.Connection, new: Mapping[str, str]) -> list[str]:
    """Rename the entries of controllers that have changed, and return a notice on each, of two lines.

    Args:
        connection: database, in a transaction.
        new: identities of controllers by name, as JSON.
    """
    identities = _identities(connection)
    notices, names = [], set(identities)
    for name, identity in new.items():
        if identities.get(name, identity) == identity:
            continue
        before, after = digest_of(identities[name]), digest_of(identity)
        kept, known = f"{name}{ASIDE}{before}", f"{name}{ASIDE}{after}"
        count = _count(connection, name)
        if count:
            _move(connection, name, kept)
        else:
            _forget(connection, name)
        again = _move(connection, known, name) if known in names else 0
        if count:
            used = f"its {again} runs of before are used again, and " if again else "and "
            notices.append(
                f"{name} has changed since its runs, from digest {before} to {after};\n"
                f"  its {count} runs are kept as {kept}, {used}new ones are made"
            )
    return notices


def _move(connection: sqlite3.Connection, name: str, new: str) -> int:
    """Rename an entry, or add its runs to those of the new name, and return how many these are."""
    for table in TABLES:
        connection.execute(f"UPDATE OR IGNORE {table} SET controller = ? WHERE controller = ?", (new, name))
    connection.execute("UPDATE OR REPLACE configuration SET key = ? WHERE key = ?", (KEY + new, KEY + name))
    _forget(connection, name)  # runs that were there under the new name, too
    return _count(connection, new)


def require_identities(path: str, stored: Mapping[str, str]) -> None:
    """Raise an error if a database tells controllers apart as earlier versions did.

    Args:
        path: name of the database, for the message.
        stored: configuration of the database by key.

    Raises:
        EntryError: naming the command that carries it over.
    """
    if IDENTITIES not in stored and any(key.startswith(KEY) for key in stored):
        raise EntryError(
            f"{path} tells controllers apart as earlier versions did; run this command once, which keeps all "
            f"runs: python -m experiments.entries carry-over {path}"
        )


def rename(connection: sqlite3.Connection, name: str, new: str) -> int:
    """Rename an entry and return the number of its runs.

    Raises:
        EntryError: if there is no such entry, or one of the new name.
    """
    num_runs = _require(connection, name)
    if _count(connection, new):
        raise EntryError(f"there is an entry {new!r} already; drop or rename it first")
    _forget(connection, new)  # of which an identity may be left
    _move(connection, name, new)
    return num_runs


def drop(connection: sqlite3.Connection, name: str) -> int:
    """Delete an entry and return the number of its runs.

    Raises:
        EntryError: if there is no such entry.
    """
    num_runs = _require(connection, name)
    _forget(connection, name)
    return num_runs


def merge(connection: sqlite3.Connection, other: sqlite3.Connection) -> dict[str, int]:
    """Copy runs that a database lacks from another one, and return their numbers by entry.

    An entry of the same name and another controller comes as one that was kept aside.

    Raises:
        EntryError: if settings or scenarios of the two databases differ.
    """
    query = "SELECT key, value FROM configuration"
    ours, theirs = dict(connection.execute(query)), dict(other.execute(query))
    for key in sorted(ours.keys() & theirs.keys()):
        if not key.startswith(KEY) and ours[key] != theirs[key]:
            raise EntryError(f"the databases have runs of different environments: {key} differs")
    if (IDENTITIES in ours) != (IDENTITIES in theirs):
        raise EntryError(
            "one of the databases tells controllers apart as earlier versions did; carry it over first: "
            "python -m experiments.entries carry-over FILE"
        )
    copied = {}
    for (name,) in other.execute("SELECT DISTINCT controller FROM runs ORDER BY controller").fetchall():
        identity = theirs.get(KEY + name)
        changed = identity is not None and ours.get(KEY + name, identity) != identity
        new = f"{name}{ASIDE}{digest_of(identity)}" if changed and identity else name
        before = _count(connection, new)
        for table in TABLES:
            with closing(other.execute(f"SELECT * FROM {table} WHERE controller = ?", (name,))) as rows:
                marks = ", ".join("?" * len(rows.description))
                connection.executemany(
                    f"INSERT OR IGNORE INTO {table} VALUES ({marks})", ((new, *row[1:]) for row in rows)
                )
        if identity is not None:
            connection.execute("INSERT OR IGNORE INTO configuration VALUES (?, ?)", (KEY + new, identity))
        copied[new] = _count(connection, new) - before
    connection.executemany(
        "INSERT OR IGNORE INTO configuration VALUES (?, ?)",
        [(key, value) for key, value in theirs.items() if not key.startswith(KEY)],
    )
    return copied


def _identities(connection: sqlite3.Connection) -> dict[str, str]:
    rows = connection.execute("SELECT key, value FROM configuration")
    return {key.removeprefix(KEY): value for key, value in rows if key.startswith(KEY)}


def _count(connection: sqlite3.Connection, name: str) -> int:
    return int(connection.execute("SELECT COUNT(*) FROM runs WHERE controller = ?", (name,)).fetchone()[0])


def _require(connection: sqlite3.Connection, name: str) -> int:
    """Return the number of runs of an entry.

    Raises:
        EntryError: if it has none; the message lists those that have.
    """
    num_runs = _count(connection, name)
    known = name in _identities(connection)
    if not num_runs and not known:
        names = [row[0] for row in connection.execute("SELECT DISTINCT controller FROM runs")]
        raise EntryError(f"there is no entry {name!r}; there are {', '.join(sorted(names)[:20]) or 'none'}")
    return num_runs


def _forget(connection: sqlite3.Connection, name: str) -> None:
    for table in TABLES:
        connection.execute(f"DELETE FROM {table} WHERE controller = ?", (name,))
    connection.execute("DELETE FROM configuration WHERE key = ?", (KEY + name,))
