"""Commands killed by SIGKILL, at random moments or at certain ones, and begun again until they end.

A command runs as `python -m` runs it, in a process of its own. That process is forked from a server which has
imported everything, since imports take longer than the commands of these tests.
"""

import importlib
import io
import multiprocessing
import os
import runpy
import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from functools import wraps
from multiprocessing.sharedctypes import RawArray, RawValue
from pathlib import Path
from typing import NamedTuple

import numpy as np

from helpers.small_commands import Command

CONTEXT = multiprocessing.get_context("forkserver")
COMMANDS = ["agents.train", "agents.tune", "experiments.evaluate"]
CONTEXT.set_forkserver_preload([*COMMANDS, "torch._dynamo", "experiments.documents.figures"])
KILLED = -signal.SIGKILL
LONGEST = 240.0  # seconds, of a command

# What a process is doing, by the functions that do it; the innermost counts.
PHASES = {
    "swarm_gym.training.learners.ppo.PPOLearner.begin": "imitation",
    "stable_baselines3.PPO.collect_rollouts": "rollout",
    "stable_baselines3.PPO.train": "update",
    "swarm_gym.training.learners.evolution.EvolutionLearner._earn": "rollout",
    "cmaes.SepCMA.tell": "update",
    "cmaes.CMA.tell": "update",
    "swarm_gym.training.run.TrainingRun._validate": "validation",
    "swarm_gym.training.run.TrainingRun._write_hyperparameters": "hyperparameters",
    "swarm_gym.training.events.TrainingEvents.flush": "events",
    "swarm_gym.training.run.save_policy": "policy file",
    "swarm_gym.runs.checkpoints.Checkpoints.save": "checkpoint",
    "swarm_gym.tuning.side_by_side.SideBySide.run": "episodes",
    "swarm_gym.tuning.run.TuningRun._estimate": "estimate",
    "optuna.create_study": "opening the study",
    "optuna.Study.ask": "asking the study",
    "optuna.Study.tell": "telling the study",
    "experiments.runs.episode.Episode.run": "run",
    "experiments.runs.database.Results.add": "storing runs",
    "experiments.documents.suite_page.make_tables": "tables",
    "experiments.documents.suite_page.write_page": "tables",
}


class Moment(NamedTuple):
    """A call of a function, by its dotted name: which one, and whether the process dies before or after it.

    Only calls count whose last argument is a path of this name, if one is given.
    """

    function: str
    number: int = 1
    when: str = "after"
    name: str = ""


class Watched:
    """A command that runs.

    Attributes:
        phase: work it is doing, or was doing when it was killed.
        stored: how many rows it has stored in a results database.
    """

    def __init__(self, command: Command, log: Path, moment: Moment | None = None):
        self._phase, self._stored = RawArray("c", 40), RawValue("q", 0)
        shared = (self._phase, self._stored)
        self.log = log
        self._phase.value = b"before its first line"
        self._process = CONTEXT.Process(target=_run, args=(command, log, shared, moment))
        self._process.start()

    @property
    def phase(self) -> str:
        return self._phase.value.decode()

    @property
    def stored(self) -> int:
        return self._stored.value

    def kill_after(self, seconds: float) -> bool:
        """Kill it then, unless it has ended; whether it was alive."""
        self._process.join(seconds)
        self._process.kill()
        return self._ended() == KILLED

    def wait(self) -> int:
        """Let it end; its exit status, negative for a signal."""
        return self._ended()

    def _ended(self) -> int:
        self._process.join(LONGEST)
        assert self._process.exitcode is not None, (
            f"still running: {self.log.read_text(encoding='utf-8')[-2000:]}"
        )
        assert self._process.exitcode in {0, KILLED}, self.log.read_text(encoding="utf-8")[-2000:]
        return self._process.exitcode


def run_killed_at(command: Callable[[], Command], moments: Sequence[Moment], log: Path) -> None:
    """Run a command that dies at each of these moments, and then to its end.

    Args:
        command: function that returns the command to run next.
        moments: in the order of the starts; each is counted from a start.
        log: file for what is printed.
    """
    for moment in moments:
        assert Watched(command(), log, moment).wait() == KILLED, f"{moment} never came"
    assert Watched(command(), log).wait() == 0


def run_killed_at_random(
    command: Callable[[Path], Command],
    check: Callable[[Path, int, int], None],
    folder: Path,
    kills: int,
    seed: int,
) -> Counter[str]:
    """Kill a command at random moments and begin it again until it ends, in one folder after the other.

    Moments are uniform in the time that the command takes. Those after its end do not count.

    Args:
        command: function of a folder that returns the command to run next in it.
        check: function called after every kill and at the end with the folder, the number of rows that its
            processes have stored, and the number of processes killed.
        folder: for the folders.
        kills: how many times a living process is to be killed.
        seed: seed of the random moments.

    Returns:
        What the processes were doing when they were killed.
    """
    imported = CONTEXT.Process(target=int)
    imported.start()
    imported.join()
    begun = time.monotonic()
    assert Watched(command(folder / "timed"), folder / "timed.log").wait() == 0
    duration = time.monotonic() - begun
    generator = np.random.default_rng(seed)
    phases: Counter[str] = Counter()
    place = 0
    while phases.total() < kills:
        place, stored, killed, alive = place + 1, 0, 0, True
        here, log = folder / f"run {place}", folder / f"run {place}.log"
        while alive:
            watched = Watched(command(here), log)
            alive = phases.total() < kills and watched.kill_after(generator.uniform(0.0, duration))
            if alive:
                phases[watched.phase] += 1
                killed += 1
            else:
                assert watched.wait() == 0
            stored += watched.stored
            check(here, stored, killed)
    print(f"{kills} kills in {place} runs of {duration:.1f} s: {dict(phases)}")
    return phases


def _run(command: Command, log: Path, shared: tuple, moment: Moment | None) -> None:
    """Run a command in this process, with its phases announced and its moment of death armed."""
    output = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    for stream in (1, 2):
        os.dup2(output, stream)
    sys.stdout, sys.stderr = (io.TextIOWrapper(io.FileIO(n, "w"), line_buffering=True) for n in (1, 2))
    for name, value in command.patches.items():
        owner, attribute = find(name)
        setattr(owner, attribute, value)
    phase, stored = shared
    phase.value = b"start"
    for name, doing in PHASES.items():
        owner, attribute = find(name)
        setattr(owner, attribute, _announced(getattr(owner, attribute), doing, phase, stored))
    if moment is not None:
        owner, attribute = find(moment.function)
        setattr(owner, attribute, _deadly(getattr(owner, attribute), moment))
    sys.argv = [command.module, *command.arguments]
    runpy.run_module(command.module, run_name="__main__", alter_sys=True)


def find(name: str) -> tuple[object, str]:
    """Return the module or class that a dotted name belongs to, and the name there."""
    *owner, attribute = name.split(".")
    for length in range(len(owner), 0, -1):
        try:
            found: object = importlib.import_module(".".join(owner[:length]))
        except ModuleNotFoundError:
            continue
        for part in owner[length:]:
            found = getattr(found, part)
        return found, attribute
    raise AssertionError(f"there is no {name}")


def _announced(function: Callable, doing: str, phase: RawArray, stored: RawValue) -> Callable:
    @wraps(function)
    def announced(*args, **kwargs):
        before, phase.value = phase.value, doing.encode()
        result = function(*args, **kwargs)
        phase.value = before
        if doing == "storing runs":
            stored.value += len(args) - 1  # besides the database
        return result

    return announced


def _deadly(function: Callable, moment: Moment) -> Callable:
    calls = 0

    @wraps(function)
    def deadly(*args, **kwargs):
        nonlocal calls
        calls += not moment.name or Path(args[-1]).name == moment.name
        last = calls == moment.number and (not moment.name or Path(args[-1]).name == moment.name)
        if last and moment.when == "before":
            os.kill(os.getpid(), signal.SIGKILL)
        result = function(*args, **kwargs)
        if last:
            os.kill(os.getpid(), signal.SIGKILL)
        return result

    return deadly
