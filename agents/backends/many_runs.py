"""Many training or tuning runs by one command, of several presets and seeds, carried out by a backend."""

import contextlib
import dataclasses
import io
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from agents.backends import Backend, BackendOptions, Task, WorkLostError
from agents.runs.folder import RunFolderError, RunTakenError, is_begun
from agents.training.config import TrainConfig
from agents.training.run import TrainingRun
from agents.tuning.config import TuneConfig
from agents.tuning.run import TuningRun

# Where a machine is lost, file servers may hold its locks for a while: NFS for 90 seconds.
PATIENCE = 180.0

Config = TypeVar("Config", TrainConfig, TuneConfig)


class Finished(NamedTuple):
    """A run that came to its end: the file of what it made, and that in a few words."""

    result: Path
    summary: str


class RunOutcome(NamedTuple):
    """What became of a run: what it made, or an error."""

    folder: Path
    finished: Finished | None
    error: str = ""

    def __str__(self) -> str:
        if self.finished is None:
            return f"{self.folder}: failed: {self.error}"
        return f"{self.folder}: done, {self.finished.summary}, {self.finished.result}"


def configs_of_seeds(config: Config, seeds: Sequence[int]) -> list[Config]:
    """One configuration per seed; a run that has a name lies in <runs>/<name>/<seed>.

    Raises:
        ValueError: for a seed that is there twice.
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
    """Carry out runs where options say, and tell of each when it ends.

    Args:
        work: `train` or `tune`.
        configs: of the runs.
        where: the options.
        controllers: names of those that the runs make.

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
        raise RunFolderError(f"{failed} of {len(configs)} runs failed; --resume goes on with these")


def carry_out(
    work: Callable[[Config], Finished], configs: Sequence[Config], backend: Backend
) -> Iterator[RunOutcome]:
    """Carry out runs; yields their outcomes as they end.

    With `resume`, runs go on where they were stopped, and those that never began begin; else what has begun
    is refused. An error ends its own run only, and what is lost with a process goes on from its last
    checkpoint.

    Args:
        work: `train` or `tune`.
        configs: of the runs, whose folders all workers see.
        backend: what carries them out.
    """
    left = []
    for config in configs:
        if not config.resume and is_begun(config.folder):
            yield RunOutcome(config.folder, None, "it holds a run already; --resume goes on with it")
        else:
            config.runs.mkdir(parents=True, exist_ok=True)
            left.append(config)
    there = [_seen_from_anywhere(config) for config in left]
    patience = 0.0 if backend.on_this_machine else PATIENCE
    ended = set()
    try:
        for number, outcome in backend.run(Task(_run, (work, patience)), there):
            ended.add(number)
            yield outcome._replace(folder=left[number].folder)
    except WorkLostError as error:
        for number, config in enumerate(left):
            if number not in ended:
                yield RunOutcome(config.folder, None, str(error))


def train(config: TrainConfig) -> Finished:
    """A training run."""
    run = TrainingRun(config)
    return Finished(run.run(), f"best validation return {run.best_return:.4f}")


def tune(config: TuneConfig) -> Finished:
    """A tuning run."""
    run = TuningRun(config)
    return Finished(run.run(), f"{run.num_steps} steps")


def _run(config: Config, work: Callable[[Config], Finished], patience: float) -> RunOutcome:
    if not config.runs.is_dir():
        return RunOutcome(
            config.folder, None, f"{config.runs} is not seen by all machines, as --runs has to be"
        )
    end = time.monotonic() + patience
    while True:
        # Begun by the command that this one resumes, or by a process that was lost.
        config = dataclasses.replace(config, resume=is_begun(config.folder))
        try:
            with contextlib.redirect_stderr(io.StringIO()):  # progress bars of several runs are unreadable
                return RunOutcome(config.folder, work(config))
        except Exception as error:
            if not isinstance(error, RunTakenError) or time.monotonic() >= end:
                return RunOutcome(config.folder, None, f"{type(error).__name__}: {error}")
        time.sleep(1.0)


def _seen_from_anywhere(config: Config) -> Config:
    """The same run for a process that is in another folder."""
    config = dataclasses.replace(config, runs=config.runs.absolute())
    if isinstance(config, TuneConfig) and config.output:
        return dataclasses.replace(config, output=config.output.absolute())
    return config
