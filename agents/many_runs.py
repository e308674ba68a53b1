"""The same training with several seeds, each a run of its own; some of them side by side."""

import contextlib
import dataclasses
import io
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky.process_executor import TerminatedWorkerError

from agents.train_config import TrainConfig
from agents.training_run import TrainingRun


class Outcome(NamedTuple):
    """What became of a run: the file of its best policy and that one's return, or an error."""

    folder: Path
    best: Path | None
    best_return: float
    error: str


def configs_of_seeds(config: TrainConfig, seeds: Sequence[int]) -> list[TrainConfig]:
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


def train_seeds(configs: Sequence[TrainConfig], jobs: int) -> Iterator[Outcome]:
    """Run trainings in processes, this many at a time; yields their outcomes as they end.

    With `resume`, runs go on where they were stopped, and those that never began begin. An error ends its own
    run only; a process that is killed ends all that have not ended yet.
    """
    if jobs < 1:
        raise ValueError(f"--jobs must be positive, got {jobs}")
    left = {config.folder: config for config in configs}
    # One thread per process, see agents.learners.ppo.
    with parallel_config(backend="loky", inner_max_num_threads=1):
        workers = Parallel(n_jobs=jobs, return_as="generator_unordered", batch_size=1, pre_dispatch=jobs)
        try:
            for outcome in workers(delayed(_train)(config) for config in configs):
                del left[outcome.folder]
                yield outcome
        except TerminatedWorkerError:
            for folder in left:
                yield Outcome(folder, None, float("nan"), "its process, or that of another run, was killed")


def describe(outcome: Outcome) -> str:
    """An outcome in one line."""
    if outcome.best is None:
        return f"{outcome.folder}: failed: {outcome.error}"
    return f"{outcome.folder}: done, best validation return {outcome.best_return:.4f}, {outcome.best}"


def _train(config: TrainConfig) -> Outcome:
    if config.resume and not (config.folder / "config.json").exists():
        config = dataclasses.replace(config, resume=False)
    try:
        run = TrainingRun(config)
        with contextlib.redirect_stderr(io.StringIO()):  # progress bars of several runs are unreadable
            best = run.run()
    except Exception as error:
        return Outcome(config.folder, None, float("nan"), f"{type(error).__name__}: {error}")
    return Outcome(config.folder, best, float(run.best_return), "")
