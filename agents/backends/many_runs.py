"""Many training or tuning runs by one command, with several presets and seeds, on a backend."""

import contextlib
import dataclasses
import io
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from agents.backends import Backend, BackendOptions, Task, WorkLostError
from swarm_gym.runs.folder import RunFolderError, RunTakenError, is_begun
from swarm_gym.training.config import TrainConfig
from swarm_gym.tuning.config import TuneConfig

LOCK_TIMEOUT = 180.0  # seconds; file servers may hold the locks of a lost machine for a while, NFS for 90

Config = TypeVar("Config", TrainConfig, TuneConfig)


class Finished(NamedTuple):
    """A run that ended without an error.

    Attributes:
        result: file of the result.
        summary: result in a few words.
    """

    result: Path
    summary: str


class RunOutcome(NamedTuple):
    """The outcome of a run: its result, or an error.

    Attributes:
        folder: folder of the run.
        finished: result; None after an error.
        error: message of the error.
    """

    folder: Path
    finished: Finished | None
    error: str = ""

    def __str__(self) -> str:
        if self.finished is None:
            return f"{self.folder}: failed: {self.error}"
        return f"{self.folder}: done, {self.finished.summary}, {self.finished.result}"


def configs_of_seeds(config: Config, seeds: Sequence[int]) -> list[Config]:
    """Return one configuration per seed; the folder of a named run is <runs>/<name>/<seed>.

    Raises:
        ValueError: for a repeated seed.
    """
    if len(set(seeds)) < len(seeds):
        raise ValueError(f"--seeds: each one once, got {' '.join(map(str, seeds))}")
    configs = []
    for seed in seeds:
        name = f"{config.name}/{seed}" if config.name else ""
        configs.append(dataclasses.replace(config, seed=seed, name=name))
    return configs


def run_all(
    work: Callable[[Config], Finished],
    configs: Sequence[Config],
    where: BackendOptions,
    controllers: Iterable[str] = (),
) -> None:
    """Run configurations on the backend of the options, and print each outcome when it is known.

    Args:
        work: `train` or `tune`.
        configs: configurations of the runs.
        where: options of the backend.
        controllers: names of controllers that the runs make.

    Raises:
        RunFolderError: at the end, if runs failed.
        BackendError, MissingExtraError, ValueError: if the backend cannot be used.
    """
    failed = 0
    with contextlib.closing(where.make(configs[0].runs, controllers)) as backend:
        for outcome in carry_out(work, configs, backend):
            print(outcome, flush=True)
            failed += outcome.finished is None
    if failed:
        raise RunFolderError(f"{failed} of {len(configs)} runs failed; --resume continues them")


def carry_out(
    work: Callable[[Config], Finished], configs: Sequence[Config], backend: Backend
) -> Iterator[RunOutcome]:
    """Run configurations on a backend; yield outcomes as runs end.

    With `resume`, runs continue from their last checkpoint, and those that never began begin. Without it,
    runs that have begun are refused. An error ends only its own run, and a run that is lost with a process
    continues from its last checkpoint.

    Args:
        work: `train` or `tune`.
        configs: configurations of the runs, whose folders all workers see.
        backend: backend of the runs.
    """
    left = []
    for config in configs:
        if not config.resume and is_begun(config.folder):
            yield RunOutcome(config.folder, None, "it holds a run already; --resume continues it")
        else:
            config.runs.mkdir(parents=True, exist_ok=True)
            left.append(config)
    there = [_seen_from_anywhere(config) for config in left]
    lock_timeout = 0.0 if backend.on_this_machine else LOCK_TIMEOUT
    ended = set()
    try:
        for number, outcome in backend.run(Task(_run, (work, lock_timeout)), there):
            ended.add(number)
            yield outcome._replace(folder=left[number].folder)
    except WorkLostError as error:
        for number, config in enumerate(left):
            if number not in ended:
                yield RunOutcome(config.folder, None, str(error))


def train(config: TrainConfig) -> Finished:
    """Run a training and return its result."""
    from swarm_gym.training.run import TrainingRun  # imports torch, which takes seconds

    run = TrainingRun(config)
    return Finished(run.run(), run.verdict)


def tune(config: TuneConfig) -> Finished:
    """Run a tuning and return its result."""
    from swarm_gym.tuning.run import TuningRun

    run = TuningRun(config)
    return Finished(run.run(), f"{run.num_steps} steps")


def _run(config: Config, work: Callable[[Config], Finished], lock_timeout: float) -> RunOutcome:
    if not config.runs.is_dir():
        return RunOutcome(
            config.folder, None, f"{config.runs} is missing on a worker; --runs must be seen by all machines"
        )
    end = time.monotonic() + lock_timeout
    while True:
        # The command that this one resumes, or a process that was lost, may have begun the run.
        config = dataclasses.replace(config, resume=is_begun(config.folder))
        try:
            with contextlib.redirect_stderr(io.StringIO()):  # progress bars of several runs are unreadable
                return RunOutcome(config.folder, work(config))
        except Exception as error:
            if not isinstance(error, RunTakenError) or time.monotonic() >= end:
                return RunOutcome(config.folder, None, f"{type(error).__name__}: {error}")
        time.sleep(1.0)


def _seen_from_anywhere(config: Config) -> Config:
    """Return the same configuration for a process in another working directory."""
    config = dataclasses.replace(config, runs=config.runs.absolute())
    if isinstance(config, TuneConfig) and config.output:
        return dataclasses.replace(config, output=config.output.absolute())
    return config
