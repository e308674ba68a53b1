"""Faults around a command: the message and exit status report them, and finished work is kept."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from agents.backends import BackendOptions
from experiments.evaluate import EvaluateConfig, evaluate
from experiments.runs.database import ResultsError
from helpers.small_commands import (
    CONTROLLERS,
    Command,
    assert_same_result,
    assert_same_training,
    evaluation,
    rows,
    training,
    tuning,
)

if not sys.platform.startswith("linux"):
    pytest.skip("needs Linux: it looks at processes and mounts", allow_module_level=True)

pytestmark = pytest.mark.slow

COMMAND_TIMEOUT = 400  # seconds, for a command
CAN_MOUNT = subprocess.run(["unshare", "-rm", "true"], capture_output=True, check=False).returncode == 0
needs_mounts = pytest.mark.skipif(not CAN_MOUNT, reason="needs `unshare -rm`, to mount file systems")

# Commands of some seconds.
COMMANDS = {
    "evaluate": lambda folder: evaluation(folder, seeds=12, jobs=2),
    "evaluate on Ray": lambda folder: evaluation(folder, seeds=12, jobs=2, backend="ray"),
    "train": lambda folder: training("evolution", folder),
    "tune": lambda folder: tuning("open-loop", folder),
    "tune with Optuna": lambda folder: tuning("schedule", folder),
}


def goes_on(name):
    """Return what a command says of how its work goes on."""
    return "the same command goes on" if name.startswith("evaluate") else "--resume continues"


def assert_same(name, whole, folder):
    if name.startswith("evaluate"):
        assert rows(folder) == rows(whole)
        assert len(rows(whole)) == 3 * 3 * 12
    elif name == "train":
        assert_same_training(whole / "it", folder / "it")
    else:
        assert_same_result("open-loop" if name == "tune" else "schedule", whole, folder)


class Running:
    """A command in a process group of its own, as a terminal makes one."""

    def __init__(self, command: Command, log, prefix=()):
        self.log = log
        with log.open("w") as output:
            self.process = subprocess.Popen(
                [*prefix, sys.executable, "-m", command.module, *command.arguments],
                stdout=output,
                stderr=output,
                start_new_session=True,
            )

    def wait_until_it_has_begun(self):
        """Wait until the progress bar shows that something is finished."""
        self.wait_until(lambda: re.search(r" [1-9][0-9]*/[0-9]+ \[", self.log.read_text()))

    def wait_until(self, happened):
        """Wait until a condition holds, which has to be before the command ends."""
        end = time.monotonic() + COMMAND_TIMEOUT
        while not happened():
            assert self.process.poll() is None, self.log.read_text()
            assert time.monotonic() < end
            time.sleep(0.02)

    def workers(self):
        """Return the process ids of its workers."""
        found = subprocess.run(["pgrep", "-g", str(self.process.pid), "-f", "loky.backend.popen_loky"],
                               capture_output=True, text=True, check=False)  # fmt: skip
        return [int(pid) for pid in found.stdout.split()]

    def end(self):
        """Wait for its end; return the exit status and the printed text, which has no traceback."""
        status = self.process.wait(COMMAND_TIMEOUT)
        said = self.log.read_text()
        assert "Traceback" not in said, said
        return status, said

    def is_gone(self):
        """Return True if all its processes have ended."""
        try:
            os.killpg(self.process.pid, 0)
        except ProcessLookupError:
            return True
        return False


def run(command, log, prefix=()):
    return Running(command, log, prefix).end()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Return the results of the commands without faults, computed when they are asked for."""
    folder = tmp_path_factory.mktemp("whole")

    def of(name):
        here = folder / name.replace(" ", "-")
        if not here.exists():
            here.mkdir()
            assert run(COMMANDS[name](here), folder / "log")[0] == 0
        return here

    return of


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM], ids=["Ctrl-C", "SIGTERM"])
@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_that_is_told_to_end(tmp_path, whole, name, sent):
    here = tmp_path / "here"
    running = Running(COMMANDS[name](here), tmp_path / "log")
    running.wait_until_it_has_begun()
    # A terminal interrupts all processes of a command; a batch system often signals the first one alone.
    (os.killpg if sent == signal.SIGINT else os.kill)(running.process.pid, sent)
    status, said = running.end()
    assert status == 128 + sent
    assert {signal.SIGINT: "interrupted; ", signal.SIGTERM: "terminated; "}[sent] in said
    assert goes_on(name) in said
    end = time.monotonic() + 20
    while not running.is_gone():
        assert time.monotonic() < end, "processes are left"
        time.sleep(0.1)
    assert run(COMMANDS[name](here), tmp_path / "log")[0] == 0
    assert_same(name, whole(name), here)


def mounted(place, kept, options):
    """Return a command prefix that mounts a file system in memory and keeps its files elsewhere."""
    script = (
        f'mount -t tmpfs -o {options} none "{place}" || exit 99\n'
        f'"$@"\nstatus=$?\ncp -r "{place}/." "{kept}"\nexit $status'
    )
    for folder in (place, kept):
        folder.mkdir()
    return ["unshare", "-rm", "sh", "-c", script, "sh"]


def fill(path):
    """Write until the disk is full."""
    with suppress(OSError), path.open("wb", buffering=0) as file:
        while True:
            file.write(bytes(1000))


@needs_mounts
@pytest.mark.parametrize("name", COMMANDS)
def test_a_full_disk_ends_a_command_that_then_goes_on(tmp_path, whole, name):
    disk, kept = tmp_path / "disk", tmp_path / "kept"
    running = Running(COMMANDS[name](disk), tmp_path / "log", mounted(disk, kept, "size=20m"))
    seen = Path(f"/proc/{running.process.pid}/root{disk}")  # the file system as the command sees it
    running.wait_until_it_has_begun()
    os.killpg(running.process.pid, signal.SIGSTOP)
    fill(seen / "filler")
    os.killpg(running.process.pid, signal.SIGCONT)
    status, said = running.end()
    assert status == 1
    assert "error: " in said
    assert str(disk) in said
    assert "full" in said or "No space left" in said
    assert goes_on(name) in said
    # Nothing is lost once the disk has room again.
    before = rows(kept)
    assert before or not name.startswith("evaluate")
    disk.rmdir()
    shutil.move(kept, disk)
    (disk / "filler").unlink()
    assert run(COMMANDS[name](disk), tmp_path / "log")[0] == 0
    assert_same(name, whole(name), disk)
    assert set(before) <= set(rows(disk))


@needs_mounts
@pytest.mark.parametrize("name", COMMANDS)
def test_a_folder_that_is_read_only_is_named(tmp_path, name):
    disk = tmp_path / "disk"
    begin = time.monotonic()
    status, said = run(COMMANDS[name](disk), tmp_path / "log", mounted(disk, tmp_path / "kept", "ro"))
    assert status == 1
    assert "error: " in said
    assert str(disk) in said
    assert "read-only" in said.lower() or "unable to open" in said
    assert time.monotonic() - begin < 60  # before any work
    assert list((tmp_path / "kept").iterdir()) == []


@needs_mounts
def test_tables_are_made_of_a_database_that_is_read_only(tmp_path, whole):
    """Check that results can be read without the right to write them."""
    disk, kept = tmp_path / "disk", tmp_path / "kept"
    disk.mkdir()
    shutil.copy(whole("evaluate") / "paper.sqlite", disk)
    script = f'mount --bind -o ro "{disk}" "{disk}" && mount -o remount,bind,ro "{disk}" && exec "$@"'
    prefix = ["unshare", "-rm", "sh", "-c", script, "sh"]
    command = evaluation(kept, seeds=12, database=disk / "paper.sqlite")
    command = command._replace(arguments=[*command.arguments, "--no-simulate"])
    assert run(command, tmp_path / "log", prefix)[0] == 0
    tables = [path.relative_to(kept) for path in kept.rglob("*.csv")]
    assert tables
    for path in tables:
        assert (kept / path).read_bytes() == (whole("evaluate") / path).read_bytes()
    assert [path.name for path in disk.iterdir()] == ["paper.sqlite"]


def test_a_worker_process_that_is_killed_is_replaced(tmp_path, whole):
    here = tmp_path / "here"
    running = Running(COMMANDS["evaluate"](here), tmp_path / "log")
    for stored in (3, 30):
        running.wait_until(lambda stored=stored: len(rows(here)) > stored and running.workers())
        os.kill(running.workers()[0], signal.SIGKILL)
    status, said = running.end()
    assert status == 0
    assert said.count("a worker process was killed") == 2
    assert_same("evaluate", whole("evaluate"), here)


def test_worker_processes_that_are_killed_again_and_again_are_given_up(tmp_path, monkeypatch):
    monkeypatch.setattr("experiments.runs.runner.run_unit", lambda *_: os.kill(os.getpid(), signal.SIGKILL))
    with pytest.raises(ResultsError, match=r"killed 3 times.*is memory short.*108 runs are missing"):
        evaluate(
            EvaluateConfig(seeds=12, controllers=CONTROLLERS, where=BackendOptions(jobs=2), output=tmp_path)
        )


def test_two_evaluations_may_write_into_one_database(tmp_path, whole):
    here = tmp_path / "here"
    both = [Running(COMMANDS["evaluate"](here), tmp_path / f"log{number}") for number in range(2)]
    assert [running.end()[0] for running in both] == [0, 0]
    assert_same("evaluate", whole("evaluate"), here)


@pytest.mark.parametrize("name", ["train", "tune"])
def test_two_processes_do_not_work_on_one_run(tmp_path, whole, name):
    here = tmp_path / "here"
    running = Running(COMMANDS[name](here), tmp_path / "log")
    running.wait_until_it_has_begun()
    running.process.send_signal(signal.SIGSTOP)
    status, said = run(COMMANDS[name](here), tmp_path / "other")  # with --resume
    running.process.send_signal(signal.SIGCONT)
    assert status == 1
    assert f"error: {here / 'it'}: another process works on this run" in said
    assert running.end()[0] == 0
    assert_same(name, whole(name), here)
