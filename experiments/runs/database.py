"""The results database: one SQLite file per suite, one transaction per finished run.

The key of a run is (controller, scenario, seed). The file stores the configuration of its runs: settings of
the environments, geometry of the scenarios, weights of the policies. Other settings or scenarios are refused;
the runs of a controller that has changed are kept aside.
"""

import json
import os
import sqlite3
from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import closing, contextmanager
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from experiments.runs.entries import IDENTITIES, KEY, EntryError, keep_aside, require_identities
from experiments.runs.outcomes import Outcomes
from experiments.runs.run import Run, RunKey, Snapshot

SCHEMA = """
CREATE TABLE IF NOT EXISTS configuration (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS runs (
    controller TEXT NOT NULL,
    scenario TEXT NOT NULL,
    seed INTEGER NOT NULL,
    final_fitness REAL NOT NULL,
    final_collision REAL NOT NULL,
    evaluations INTEGER NOT NULL,
    seconds REAL NOT NULL,
    best_path BLOB NOT NULL,
    trace BLOB NOT NULL,
    provenance TEXT NOT NULL,
    columns TEXT NOT NULL,
    way BLOB NOT NULL,
    PRIMARY KEY (controller, scenario, seed)
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS snapshots (
    controller TEXT NOT NULL,
    scenario TEXT NOT NULL,
    seed INTEGER NOT NULL,
    iteration INTEGER NOT NULL,
    paths BLOB NOT NULL,
    collisions BLOB NOT NULL,
    PRIMARY KEY (controller, scenario, seed, iteration)
) WITHOUT ROWID;
"""

MOST_SHOWN = 300  # characters of a value in a message
LOCK_TIMEOUT = 60.0  # seconds, while another process writes to the database


class ResultsError(RuntimeError):
    """A results database cannot be used; the message names the file and the reason."""


class Results:
    """A results database, opened for one configuration.

    Args:
        path: file of the database; created if missing.
        configuration: values that runs depend on, by key; new keys are added. The entry of a controller that
            has changed is kept aside, see `experiments.runs.entries`; other values that differ are refused.

    Attributes:
        path: file of the database.
        connection: connection with SQLite.
        changed: notices on entries that were kept aside, two lines each.
        identities: identities of the controllers of the configuration, as JSON by name.

    Raises:
        ResultsError: if the file is not a results database, or holds runs of another configuration.
    """

    def __init__(self, path: Path, configuration: Mapping[str, Any] | None = None):
        path.parent.mkdir(parents=True, exist_ok=True)
        with self._opened(path, str(path)):
            self.connection.execute("PRAGMA journal_mode = WAL")
            self.connection.executescript(SCHEMA)
            self._check_columns()
            self.changed = self._keep_aside(configuration or {})
            self._adopt(self._compare(configuration or {}))
            controllers = {key: value for key, value in (configuration or {}).items() if key.startswith(KEY)}
            self.identities |= {key.removeprefix(KEY): _json(value) for key, value in controllers.items()}

    @classmethod
    def in_memory(cls) -> "Results":
        """Open an empty database that ends with this process."""
        return cls(Path(":memory:"))

    @classmethod
    def stored(cls, path: Path, configuration: Mapping[str, Any] | None = None) -> "Results":
        """Open an existing database for reading only.

        Raises:
            ResultsError: if the file is missing, is not a results database, or has another configuration.
        """
        if not path.is_file():
            raise ResultsError(
                f"{path}: there is no such results database; `python -m experiments.evaluate` makes one"
            )
        results = cls.__new__(cls)
        results.changed = []
        with results._opened(path, _read_only_uri(path), uri=True):
            results._check_columns()
            results._compare(configuration or {})
        return results

    def close(self) -> None:
        """Close the file."""
        self.connection.close()

    def configuration(self) -> dict[str, Any]:
        """Return the configuration of the stored runs, by key."""
        rows = self._rows("SELECT key, value FROM configuration ORDER BY key")
        return {key: self._value(value) for key, value in rows}

    def finished(self) -> set[RunKey]:
        """Return the keys of the stored runs."""
        return set(self._rows("SELECT controller, scenario, seed FROM runs"))

    def add(self, *runs: Run) -> None:
        """Store runs and their snapshots in one transaction; a run that is already stored stays unchanged.

        Raises:
            ResultsError: if the file cannot be written, a number is missing in a run, or another process has
                stored that a controller has changed; runs that were stored before are still there.
        """
        with self.writing() as connection:
            self._require_unchanged({run.controller for run in runs})
            connection.executemany(
                "INSERT INTO runs VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
                map(_row, runs),
            )
            connection.executemany(
                "INSERT INTO snapshots VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
                [
                    (*_key(run), kept.iteration, kept.paths.tobytes(), kept.collisions.tobytes())
                    for run in runs
                    for kept in run.snapshots
                ],
            )

    def runs(self, controller: str, scenario: str, num_seeds: int, first_seed: int = 0) -> list[Run]:
        """Return the runs of one controller on one scenario, in the order of their seeds, without snapshots.

        Args:
            controller: name of the controller.
            scenario: name of the scenario.
            num_seeds: number of consecutive seeds.
            first_seed: first of these seeds.
        """
        query = (
            "SELECT * FROM runs "
            "WHERE controller = ? AND scenario = ? AND seed >= ? AND seed < ? ORDER BY seed"
        )
        key = (controller, scenario, first_seed, first_seed + num_seeds)
        return [_run(row) for row in self._rows(query, key)]

    def outcomes(
        self,
        controllers: Sequence[str],
        seeds: Mapping[str, Sequence[int]],
        options: Mapping[str, Any] | None = None,
        alone: Sequence[str] = (),
    ) -> Outcomes:
        """Return the numbers of runs, without paths and traces.

        Args:
            controllers: names of the controllers.
            seeds: seeds by name of the scenario; all scenarios have the same number of seeds.
            options: options of all environments of the suite.
            alone: names of the controllers that are also groups of their own.

        Raises:
            ResultsError: if a run is missing.
        """
        rows = {controller: c for c, controller in enumerate(controllers)}
        columns = {(name, seed): (s, k) for s, name in enumerate(seeds) for k, seed in enumerate(seeds[name])}
        num_seeds = len(next(iter(seeds.values())))
        values = np.full((4, len(rows), len(seeds), num_seeds), np.nan)
        query = (
            "SELECT controller, scenario, seed, final_fitness, final_collision, evaluations, seconds "
            "FROM runs"
        )
        for controller, scenario, seed, *four in self._rows(query):
            if controller in rows and (scenario, seed) in columns:
                values[:, rows[controller], *columns[scenario, seed]] = four
        for (c, controller), (s, scenario) in product(enumerate(controllers), enumerate(seeds)):
            there = num_seeds - np.isnan(values[0, c, s]).sum()
            if there < num_seeds:
                raise ResultsError(
                    f"{self.path}: {controller} on {scenario} has {there} of {num_seeds} runs; run the suite "
                    "again to make the others"
                )

        def load(controller: str, scenario: str) -> list[Run]:
            return self.runs(controller, scenario, num_seeds, seeds[scenario][0])

        fitness, collision, evaluations, seconds = values
        numbers = fitness, collision, evaluations, seconds
        return Outcomes(tuple(controllers), tuple(seeds), *numbers, load, options or {}, tuple(alone))

    def provenances(
        self, controllers: Sequence[str], seeds: Mapping[str, Sequence[int]]
    ) -> list[dict[str, str]]:
        """Return the distinct provenances of the runs of these controllers, sorted by their text.

        Args:
            controllers: names of the controllers.
            seeds: seeds by name of the scenario.
        """
        query = "SELECT controller, scenario, seed, provenance FROM runs"
        found = {
            provenance
            for controller, scenario, seed, provenance in self._rows(query)
            if controller in controllers and seed in seeds.get(scenario, ())
        }
        return [json.loads(provenance) for provenance in sorted(found)]

    def snapshots(self, controller: str, scenario: str, seed: int) -> list[Snapshot]:
        """Return the stored populations of a run, in the order of their iterations."""
        query = (
            "SELECT iteration, paths, collisions FROM snapshots "
            "WHERE controller = ? AND scenario = ? AND seed = ? ORDER BY iteration"
        )
        found = []
        for iteration, paths, collisions in self._rows(query, (controller, scenario, seed)):
            members = np.frombuffer(collisions)
            found.append(Snapshot(iteration, np.frombuffer(paths).reshape(len(members), -1, 2), members))
        return found

    def _rows(self, query: str, values: Sequence[object] = ()) -> list[tuple[Any, ...]]:
        """Return the rows of a query; raise ResultsError where the file is damaged."""
        try:
            return self.connection.execute(query, tuple(values)).fetchall()
        except sqlite3.Error as error:
            raise ResultsError(f"{self.path}: cannot be read ({error})") from error

    def _value(self, text: str) -> Any:
        try:
            return json.loads(text)
        except ValueError as error:
            raise ResultsError(f"{self.path}: a damaged value in its configuration ({error})") from error

    def _require_unchanged(self, controllers: Set[str]) -> None:
        """Raise ResultsError if the database says by now that a controller is another one."""
        query = "SELECT value FROM configuration WHERE key = ? AND value != ?"
        for name in sorted(controllers & self.identities.keys()):
            if self.connection.execute(query, (KEY + name, self.identities[name])).fetchone():
                raise ResultsError(
                    f"{self.path}: {name} has changed meanwhile, and another process stores runs of the new "
                    "one; run the command again"
                )

    @contextmanager
    def _opened(self, path: Path, name: str, uri: bool = False) -> Iterator[None]:
        """Connect to a file, `name` for SQLite, and close it again if it proves unusable."""
        self.path = path
        self.identities: dict[str, str] = {}
        try:
            self.connection: sqlite3.Connection = sqlite3.connect(name, timeout=LOCK_TIMEOUT, uri=uri)
        except sqlite3.Error as error:
            raise ResultsError(f"{path}: cannot be opened ({error})") from error
        try:
            yield
        except sqlite3.Error as error:
            self.connection.close()
            raise ResultsError(f"{path}: not a usable results database ({error})") from error
        except ResultsError:
            self.connection.close()
            raise

    @contextmanager
    def writing(self) -> Iterator[sqlite3.Connection]:
        """Carry out a transaction."""
        try:
            with self.connection as connection:
                yield connection
        except sqlite3.Error as error:
            raise ResultsError(
                f"{self.path}: cannot be written ({error}); runs that were stored before are still there, "
                "and the same command goes on from them"
            ) from error

    def _check_columns(self) -> None:
        """Raise ResultsError if the table of runs is missing, or has other columns than `SCHEMA` gives it."""
        found = _columns_of_runs(self.connection)
        if not found:
            raise ResultsError(f"{self.path}: not a results database, since it has no table of runs")
        with closing(sqlite3.connect(":memory:")) as empty:
            empty.executescript(SCHEMA)
            expected = _columns_of_runs(empty)
        if found != expected:
            raise ResultsError(
                f"{self.path}: not a results database of this version; its table of runs has the columns "
                f"{', '.join(found)}, expected {', '.join(expected)}; use another --database, or delete "
                "the file"
            )

    def _compare(self, configuration: Mapping[str, Any]) -> dict[str, str]:
        """Return what is not stored yet of a configuration; raise ResultsError if a value differs."""
        stored = dict(self.connection.execute("SELECT key, value FROM configuration"))
        new = {key: _json(value) for key, value in configuration.items()}
        for key, value in new.items():
            if stored.get(key, value) != value:
                was, now = _excerpt(stored[key], value), _excerpt(value, stored[key])
                raise ResultsError(
                    f"{self.path} holds runs of another configuration: {key} was {was}, is now {now}; use "
                    "another --database, or delete the file"
                )
        return {key: value for key, value in new.items() if key not in stored}

    def _keep_aside(self, configuration: Mapping[str, Any]) -> list[str]:
        """Keep the entries of controllers aside that have changed, and return notices on them."""
        controllers = {key: value for key, value in configuration.items() if key.startswith(KEY)}
        if IDENTITIES in configuration:
            try:
                require_identities(str(self.path), self.configuration())
            except EntryError as error:
                raise ResultsError(str(error)) from error
        # Nothing is renamed in a database that is refused.
        self._compare({key: value for key, value in configuration.items() if key not in controllers})
        new = {key.removeprefix(KEY): _json(value) for key, value in controllers.items()}
        with self.writing() as connection:
            return [f"{self.path}: {notice}" for notice in keep_aside(connection, new)]

    def _adopt(self, new: Mapping[str, str]) -> None:
        """Store new parts of the configuration."""
        with self.writing() as connection:
            connection.executemany("INSERT OR IGNORE INTO configuration VALUES (?, ?)", list(new.items()))


def _json(value: Any) -> str:
    return json.dumps(value, sort_keys=True)


def _excerpt(value: str, other: str) -> str:
    """Return a stored value from about where it differs from another one, shortened."""
    start = next((k for k, (a, b) in enumerate(zip(value, other, strict=False)) if a != b), 0)
    begin = max(0, min(start - MOST_SHOWN // 2, len(value) - MOST_SHOWN))
    end = begin + MOST_SHOWN
    return f"{'...' if begin else ''}{value[begin:end]}{'...' if end < len(value) else ''}"


def _columns_of_runs(connection: sqlite3.Connection) -> list[str]:
    return [column for _, column, *_ in connection.execute("PRAGMA table_info(runs)")]


def _read_only_uri(path: Path) -> str:
    """Return the URI by which SQLite opens a file for reading only."""
    # A reader puts lock files beside a database. In a folder that cannot be written, nobody can write either.
    alone = not os.access(path.parent, os.W_OK) and not path.with_name(f"{path.name}-wal").exists()
    return f"{path.resolve().as_uri()}?mode=ro{'&immutable=1' if alone else ''}"


def _key(run: Run) -> RunKey:
    return run.controller, run.scenario, run.seed


def _row(run: Run) -> tuple:
    """Return a run as a row of the table, in the order of its columns."""
    return (
        *_key(run),
        run.final_fitness,
        run.final_collision,
        run.evaluations,
        run.seconds,
        run.best_path.tobytes(),
        run.trace.tobytes(),
        json.dumps(dict(run.provenance), sort_keys=True),
        json.dumps(run.columns),
        run.trajectory.tobytes(),
    )


def _run(row: tuple) -> Run:
    """Return the run of a row of the table."""
    *numbers, best_path, trace, provenance, columns, trajectory = row
    names = tuple(json.loads(columns))
    controller, scenario, seed, fitness, collision, evaluations, seconds = numbers
    return Run(
        controller,
        scenario,
        seed,
        fitness,
        collision,
        evaluations,
        seconds,
        np.frombuffer(best_path).reshape(-1, 2),
        np.frombuffer(trace).reshape(-1, len(names)),
        json.loads(provenance),
        columns=names,
        trajectory=np.frombuffer(trajectory).reshape(-1, 2),
    )
