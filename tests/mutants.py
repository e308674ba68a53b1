"""Mutation check: `python -m tests.mutants` seeds faults one at a time and reports which no test finds.

The faults are in `mutants.toml`. Each one is a single replacement, made in a copy of the sources, where the
narrow tests that should find it are run. The check takes minutes, so `make test` leaves it out. It exits
with status 1 if a fault survives, or if the tests fail without one.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue

ROOT = Path(__file__).parents[1]
FILE = ROOT / "tests/mutants.toml"
COPIED = ("swarm_gym", "agents", "experiments", "tests", "scores", "docs", "pyproject.toml")
TIMEOUT = 600  # seconds; a fault that makes a loop endless is found
# Exit statuses of pytest: all tests passed, some failed, or could not be collected.
PASSED, FOUND = 0, (1, 2)


@dataclass(frozen=True)
class Fault:
    """A fault in one place.

    Attributes:
        name: sentence about the fault, which begins with the part of the project.
        file: path of the file from the root.
        old: text that is in the file once.
        new: text in its place.
        tests: arguments of pytest that choose the tests which should find the fault.
        jit: whether kernels are compiled; without it they run as plain Python.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    jit: bool = True

    def seeded(self, source: str) -> str:
        """Return the source of the file with the fault.

        Raises:
            ValueError: if the text is not in it exactly once, or does not change.
        """
        if source.count(self.old) != 1 or self.old == self.new:
            raise ValueError(f"{self.file}: expected once and to be changed: {self.old!r}")
        return source.replace(self.old, self.new)


def faults() -> list[Fault]:
    """Return the faults of `mutants.toml`."""
    stated = tomllib.loads(FILE.read_text(encoding="utf-8"))["fault"]
    return [Fault(**{**entry, "tests": tuple(entry["tests"])}) for entry in stated]


def status_of(folder: Path, tests: tuple[str, ...], jit: bool) -> int:
    """Return the exit status of pytest in a copy of the sources; 1 if the tests do not end."""
    options = ("-x", "-q", "-n", "0", "-p", "no:cacheprovider", "-p", "no:randomly")
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    environment["NUMBA_DISABLE_JIT"] = "0" if jit else "1"
    command = [sys.executable, "-m", "pytest", *options, *tests]
    try:
        return subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, timeout=TIMEOUT, check=False
        ).returncode
    except subprocess.TimeoutExpired:
        return 1


def copy_sources(folder: Path) -> None:
    """Copy what tests need into a folder."""
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, folder / name)


def is_found(fault: Fault, folder: Path) -> bool:
    """Seed a fault in a copy of the sources, run its tests, remove it again; return whether they failed.

    Raises:
        RuntimeError: if pytest ends in another way, e.g. since no test was chosen.
    """
    path = folder / fault.file
    source = path.read_text(encoding="utf-8")
    path.write_text(fault.seeded(source), encoding="utf-8")
    try:
        status = status_of(folder, fault.tests, fault.jit)
    finally:
        path.write_text(source, encoding="utf-8")
    if status != PASSED and status not in FOUND:
        raise RuntimeError(f"{fault.name}: pytest ended with status {status} for {' '.join(fault.tests)}")
    return status in FOUND


def main() -> int:
    """Run the check; return the status of the command."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("words", nargs="*", help="check only faults whose name contains one of these words")
    parser.add_argument("--jobs", type=int, default=1, help="number of faults that are checked at once")
    options = parser.parse_args()
    chosen = [
        fault
        for fault in faults()
        if not options.words or any(word in f"{fault.name} {fault.file}" for word in options.words)
    ]
    if not chosen:
        parser.error("no fault has such a name")
    with tempfile.TemporaryDirectory(prefix="mutants-") as made:
        folders: SimpleQueue[Path] = SimpleQueue()
        for job in range(options.jobs):
            folder = Path(made) / str(job)
            folder.mkdir()
            copy_sources(folder)
            folders.put(folder)

        def in_a_copy(work, *arguments):
            folder = folders.get()
            try:
                return work(folder, *arguments)
            finally:
                folders.put(folder)

        with ThreadPoolExecutor(options.jobs) as pool:
            groups = sorted({(fault.tests, fault.jit) for fault in chosen})
            statuses = pool.map(lambda group: in_a_copy(status_of, *group), groups)
            broken = [tests for (tests, _), status in zip(groups, statuses, strict=True) if status != PASSED]
            if broken:
                print("these tests fail without a fault:", *(" ".join(tests) for tests in broken), sep="\n")
                return 1
            survivors = []
            checked = pool.map(lambda fault: in_a_copy(lambda folder: is_found(fault, folder)), chosen)
            for fault, found in zip(chosen, checked, strict=True):
                print("found   " if found else "SURVIVES", fault.name, flush=True)
                survivors += [] if found else [fault]
    print(f"{len(chosen) - len(survivors)} of {len(chosen)} faults are found")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
