"""Every backend does all work, yields each result once, or raises an error with the reason."""

import dataclasses
import itertools
import operator
import os
import signal
import sys
import time
from collections import Counter
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from agents.backends import BackendError, BackendOptions, Task, WorkLostError, ray_backend, slurm
from agents.backends.backend import Outcome
from agents.backends.packing import files_of, pack
from experiments.runs.suite import Suite
from helpers.small_commands import CONTROLLERS, rows
from helpers.stored_runs import make_database
from helpers.trainings import make_policy
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.open_loop import save_open_loop
from swarm_gym.errors import MissingExtraError
from swarm_gym.runs.provenance import git_commit

OPTIONS = {
    "one process": BackendOptions(jobs=1),
    "local": BackendOptions(jobs=2),
    "ray": BackendOptions("ray", jobs=2),
    "slurm": BackendOptions("slurm", "local", jobs=2),
}
needs_posix = pytest.mark.skipif(os.name != "posix", reason="needs POSIX: it kills by signals")
SEVERAL = ("local", "ray", "slurm")  # those whose workers are processes of their own


# Ray and jobs take seconds to start.
KINDS = [pytest.param(name, marks=pytest.mark.slow if name in {"ray", "slurm"} else ()) for name in OPTIONS]


@pytest.fixture(scope="module", params=KINDS)
def backend(request, tmp_path_factory):
    with closing(make(request.param, tmp_path_factory.mktemp("shared"))) as made:
        yield made


def make(name, folder, **changes):
    if name in ("ray", "slurm"):
        library = {"ray": "ray", "slurm": "submitit"}[name]
        module = pytest.importorskip(library, reason=f"needs the extra `{name}`")
        if name == "slurm":
            module.core.core.Job._results_timeout_s = 1  # seconds that it looks for what a killed job told
    return dataclasses.replace(OPTIONS[name], **changes).make(folder)


def test_every_unit_is_carried_out_once(backend):
    assert backend.workers() in (1, 2)
    found = list(backend.run(Task(operator.sub, (1,)), range(20, 50)))
    assert sorted(found) == [(number, number + 19) for number in range(30)]
    assert list(backend.run(Task(operator.sub, (1,)), [])) == []


def test_an_error_of_the_work_is_raised_here(backend):
    with pytest.raises(ZeroDivisionError):
        list(backend.run(Task(operator.truediv, (0,)), [1, 2, 3]))


@pytest.mark.slow
@needs_posix
@pytest.mark.parametrize("name", SEVERAL)
def test_what_is_lost_with_a_process_is_done_again(tmp_path, name):
    def die_once(unit, folder):
        mark = folder / str(unit)
        if unit in {3, 11} and not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return unit

    with closing(make(name, tmp_path)) as backend:
        found = list(backend.run(Task(die_once, (tmp_path,)), range(16)))
    assert sorted(found) == [(number, number) for number in range(16)]
    assert {path.name for path in tmp_path.iterdir()} >= {"3", "11"}


@pytest.mark.slow
@needs_posix
@pytest.mark.parametrize("name", SEVERAL)
def test_work_that_kills_its_worker_is_given_up(tmp_path, name):
    with (
        closing(make(name, tmp_path)) as backend,
        pytest.raises(WorkLostError, match=r"killed 3 times.*is memory short"),
    ):
        list(backend.run(Task(lambda _: os.kill(os.getpid(), signal.SIGKILL)), [1, 2]))


@pytest.mark.slow
@pytest.mark.parametrize(("length", "alone"), [(0.0, False), (0.1, True)])
def test_short_units_share_a_ray_task_and_long_ones_have_their_own(tmp_path, monkeypatch, length, alone):
    monkeypatch.setattr(ray_backend, "TASK_SECONDS", 0.15)

    def work(unit, length):
        import ray

        time.sleep(length)
        return ray.get_runtime_context().get_task_id()

    with closing(make("ray", tmp_path)) as backend:
        found = Counter(name for _, name in backend.run(Task(work, (length,)), range(100)))
    assert found.total() == 100
    assert (max(found.values()) == 1) == alone
    assert max(found.values()) <= ray_backend.MOST_UNITS


class Job:
    """A fake Slurm job, which is lost in some of its states."""

    numbers = itertools.count()

    def __init__(self, task, units, state):
        self.task, self.units, self.state = task, units, state
        self.job_id = next(self.numbers)
        self.cancelled = False

    def done(self):
        return self.state != "PREEMPTED"

    def cancel(self, check):
        self.cancelled = True


@pytest.mark.slow
def test_work_that_needs_too_much_memory_is_given_up_by_ray(tmp_path, monkeypatch):
    monkeypatch.setenv("RAY_memory_usage_threshold", "0.01")  # of all memory, which is in use already
    monkeypatch.setenv("RAY_memory_monitor_refresh_ms", "50")
    with closing(make("ray", tmp_path)) as backend, pytest.raises(WorkLostError, match="is memory short"):
        list(backend.run(Task(time.sleep), [60.0, 60.0]))


@pytest.fixture
def slurm_jobs(tmp_path, monkeypatch):
    """A backend with four fake jobs at a time; `states` are the ends of the first ones, then all succeed."""
    pytest.importorskip("submitit", reason="needs the extra `slurm`")
    monkeypatch.setattr(slurm, "POLL_INTERVAL", 0.0)
    backend = make("slurm", tmp_path, jobs=4)
    states, jobs = [], []

    def submit(task, units):
        jobs.append(Job(task, units, states.pop(0) if states else "COMPLETED"))
        return jobs[-1]

    backend._submit = submit
    backend._outcomes = lambda job: (
        [Outcome(unit) for unit in job.units] if job.state == "COMPLETED" else None
    )
    return backend, states, jobs


@pytest.mark.parametrize("state", ["NODE_FAIL", "TIMEOUT", "PREEMPTED"])
def test_jobs_that_are_lost_together_are_done_again(slurm_jobs, state):
    backend, states, jobs = slurm_jobs
    states += [state] * 8
    assert sorted(backend.run(Task(operator.neg), range(40))) == [(number, number) for number in range(40)]
    assert [job.cancelled for job in jobs] == [True] * 8 + [False] * (len(jobs) - 8)


def test_a_job_that_is_lost_again_and_again_is_given_up_and_the_others_end(slurm_jobs):
    backend, _, jobs = slurm_jobs
    submit = backend._submit
    backend._submit = lambda task, units: spoilt(submit(task, units))

    def spoilt(job):
        job.state = "OUT_OF_MEMORY" if 7 in job.units else job.state
        return job

    found = []
    with pytest.raises(WorkLostError):
        found.extend(number for number, _ in backend.run(Task(operator.neg), range(40)))
    given_up = jobs[[7 in job.units for job in jobs].index(True)].units
    assert sorted(found) == [n for n in range(40) if n not in given_up]
    assert sum(7 in job.units for job in jobs) == 3


def test_where_nothing_succeeds_all_is_given_up_soon(slurm_jobs):
    backend, states, jobs = slurm_jobs
    states += ["OUT_OF_MEMORY"] * 1000
    with pytest.raises(WorkLostError):
        list(backend.run(Task(operator.neg), range(40)))
    assert len(jobs) < 20


@pytest.mark.slow
@pytest.mark.parametrize("name", SEVERAL)
def test_runs_are_those_of_one_process(tmp_path, name):
    suite = Suite("paper", CONTROLLERS, ("case1", "case3"), num_seeds=4, baseline="spsfa-tip")
    for where in ("one process", name):
        with closing(make(where, tmp_path / where)) as backend:
            make_database(tmp_path / where / "paper.sqlite", suite, backend)
    assert len(rows(tmp_path / name)) == 3 * 2 * 4
    assert rows(tmp_path / name) == rows(tmp_path / "one process")
    assert not (tmp_path / name / "slurm").exists()


@pytest.mark.parametrize(("name", "library"), [("ray", "ray"), ("slurm", "submitit")])
def test_without_its_library_the_extra_is_named(tmp_path, monkeypatch, name, library):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(MissingExtraError, match=rf"--backend {name} needs .*swarm_gym\[{name}\]"):
        OPTIONS[name].make(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        (BackendOptions(jobs=-1), ValueError, "--jobs must be positive, or 0 for all cores, got -1"),
        (BackendOptions(address="auto"), ValueError, "--address auto: --backend local has no address"),
        (BackendOptions("slurm", "local"), ValueError, "give the number of jobs"),
    ],
)
def test_options_that_cannot_be_are_refused(tmp_path, options, error, message):
    pytest.importorskip("submitit", reason="needs the extra `slurm`")
    with pytest.raises(error, match=message):
        options.make(tmp_path)


needs_shell = pytest.mark.skipif(os.name != "posix", reason="needs POSIX: it writes shell scripts")
NO_ACCOUNTING = {"srun": "true", "sacct": "echo 'accounting storage is disabled' >&2; exit 1"}


@needs_shell
@pytest.mark.parametrize(
    ("commands", "message"),
    [({}, r"srun.*--address local"), (NO_ACCOUNTING, r"needs Slurm's accounting.*storage is disabled")],
    ids=["no Slurm", "no accounting"],
)
def test_without_slurm_and_its_accounting_it_is_said(tmp_path, monkeypatch, commands, message):
    pytest.importorskip("submitit", reason="needs the extra `slurm`")
    for name, does in commands.items():
        (tmp_path / name).write_text(f"#!/bin/sh\n{does}\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BackendError, match=message):
        BackendOptions("slurm", jobs=1).make(tmp_path / "jobs")


@pytest.mark.parametrize("file", ["../policy.safetensors", "agents/policy.safetensors"])
def test_files_that_cannot_be_brought_along_are_refused(tmp_path, monkeypatch, file):
    here, there = tmp_path / "here", tmp_path / "there"
    (here / "agents").mkdir(parents=True)
    there.mkdir()
    monkeypatch.chdir(here)
    Path(file).touch()
    with pytest.raises(BackendError, match=rf"{file} is not copied to other machines.*below this folder"):
        pack(there, [Path(file)])
    assert not (there / "agents" / "policy.safetensors").exists()


@pytest.mark.parametrize("address", ["127.0.0.1:1", "ray://127.0.0.1:1", "[::1]:99999"])
def test_an_address_where_nobody_is_is_refused(tmp_path, address):
    pytest.importorskip("ray", reason="needs the extra `ray`")
    backend = BackendOptions("ray", address).make(tmp_path)
    with pytest.raises(BackendError, match=r"nothing answers there"):
        backend.workers()


def refuse(*_, **__):
    raise OSError("a required privilege is not held by the client")


@pytest.mark.parametrize("links", [True, False], ids=["links", "no links, as on Windows"])
def test_workers_on_other_machines_get_code_maps_and_the_files_of_controllers(tmp_path, monkeypatch, links):
    rng = np.random.default_rng(0)
    here, there = tmp_path / "here", tmp_path / "there"
    (here / "runs").mkdir(parents=True)
    there.mkdir()
    monkeypatch.chdir(here)
    monkeypatch.setenv("SWARM_GYM_DATA", str(here))
    save_open_loop(Path("runs/base.json"), Knots(60, [0], [30.0], [0.2]), {})
    make_policy(Path("runs/mine.safetensors"), rng, base="open-loop:runs/base.json")
    make_policy(here / "far.safetensors", rng)
    names = ["spsfa", "fixed:3", "learned:three-cases/0", f"learned:{here / 'far.safetensors'}"]
    files = list(files_of([*names, "learned:runs/mine.safetensors@0.5"]))
    assert set(files) == {
        Path("runs/mine.safetensors"), Path("runs/base.json"), here / "far.safetensors"
    }  # fmt: skip
    with monkeypatch.context() as patch:
        if not links:
            patch.setattr(Path, "symlink_to", refuse)
        variables = pack(there, [*files, *files])
    assert (there / "runs" / "mine.safetensors").is_symlink() == (there / "swarm_gym").is_symlink() == links
    assert (there / "swarm_gym" / "env.py").is_file()
    packages = {"swarm_gym", "agents", "experiments"}
    assert {path.name for path in there.iterdir()} == packages | {"swarm_gym_maps", "runs"}
    assert {path.name for path in (there / "runs").iterdir()} == {"base.json", "mine.safetensors"}
    assert (there / variables["SWARM_GYM_DATA"] / "far.safetensors").is_file()
    assert variables["SWARM_GYM_COMMIT"] == git_commit()
    monkeypatch.setenv("SWARM_GYM_COMMIT", "abc")
    assert git_commit() == "abc"
