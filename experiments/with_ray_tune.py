"""Search hyperparameters of a preset with Ray Tune, an example: `python -m experiments.with_ray_tune --help`.

It needs the extra `ray-tune`. A trial is a training run in a folder of its own, `<runs>/<trial>`. From rung
to rung of ASHA (L. Li et al., "A system for massively parallel hyperparameter tuning", MLSys 2020), runs are
prolonged, and the worse ones are stopped. A run that is prolonged, or whose node was lost, resumes from its
checkpoint.
"""

import contextlib
import io
import os
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tyro

from agents.backends import BackendError, BackendOptions
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.runs.folder import is_begun
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.presets import load_preset
from swarm_gym.training.run import TrainingRun

METRIC = "validation_return"


@dataclass(frozen=True)
class SearchConfig:
    """Options of a search."""

    preset: str = "three-cases"
    """Training preset whose hyperparameters are searched."""
    trials: int = 16
    """Number of trials; each is a random point of the search space."""
    rungs: int = 4
    """Number of times that trials are compared and the worse ones stopped."""
    total_steps: int = 640_000
    """Environment steps of a trial that is never stopped early."""
    runs: Path = Path("runs/ray-tune")
    """Folder of the training runs; all nodes must be able to read and write it."""
    address: str | None = None
    """Address of a Ray cluster, e.g. 10.0.0.1:6379; by default Ray is started on this machine."""
    jobs: int = 0
    """Number of trials at a time; 0 for one per processor."""
    seed: int = 0
    """Seed of the search; trainings have the seed of the preset."""


def train_in_rungs(values: Mapping[str, Any], preset: TrainConfig, config: SearchConfig) -> None:
    """Train the preset with other values, as one trial; report its validation after every rung."""
    from ray import tune

    name = tune.get_context().get_trial_id()
    for rung in range(1, config.rungs + 1):
        steps = config.total_steps * rung // config.rungs
        trained = preset.changed(**values, runs=config.runs, name=name, total_steps=steps)
        run = TrainingRun(replace(trained, resume=is_begun(trained.folder)))
        with contextlib.redirect_stderr(io.StringIO()):  # progress bars of several runs are unreadable
            run.run()
        tune.report({METRIC: float(run.best_return), "steps": run.learner.num_steps})


def search(config: SearchConfig) -> tuple[Path, dict[str, Any]]:
    """Return the policy file of the best trial by validation, and the values that it was trained with.

    Raises:
        MissingExtraError: if Ray Tune is missing.
        BackendError: if the cluster cannot be used, or if no trial reached its first rung.
        ValueError: if an option has a value out of its range.
    """
    for name in ("trials", "rungs", "total_steps"):
        if getattr(config, name) < 1:
            raise ValueError(f"--{name.replace('_', '-')} must be positive, got {getattr(config, name)}")
    try:
        from ray import tune
        from ray.tune.schedulers import ASHAScheduler
    except ImportError as error:
        raise MissingExtraError("this example", "Ray Tune", "ray-tune") from error
    preset = load_preset(config.preset)
    controllers = (preset.base, preset.reference, preset.algorithm.warm_start)
    where = BackendOptions("ray", config.address, config.jobs)
    runs = config.runs.absolute()
    space = {
        "learning_rate": tune.loguniform(1e-4, 3e-3),
        "log_std": tune.uniform(-2.5, -0.8),
        "clip_range": tune.uniform(0.1, 0.3),
    }
    os.environ["RAY_CHDIR_TO_TRIAL_DIR"] = "0"  # workers stay in the folder with code and maps
    with closing(where.make(runs, controllers)) as backend:
        backend.workers()  # connects, and sends code and maps to the workers
        tuner = tune.Tuner(
            tune.with_parameters(train_in_rungs, preset=preset, config=replace(config, runs=runs)),
            param_space=space,
            tune_config=tune.TuneConfig(
                metric=METRIC,
                mode="max",
                num_samples=config.trials,
                max_concurrent_trials=config.jobs or None,
                scheduler=ASHAScheduler(max_t=config.rungs, grace_period=1, reduction_factor=2),
                search_alg=tune.search.BasicVariantGenerator(random_state=config.seed),
            ),
            run_config=tune.RunConfig(
                name="search",
                storage_path=str(runs),
                failure_config=tune.FailureConfig(max_failures=2),
            ),
        )
        try:
            best = tuner.fit().get_best_result()
        except RuntimeError as error:
            raise BackendError(f"no trial reached its first rung: {error}") from error
    trial = (best.metrics or {})["trial_id"]
    return config.runs / trial / "best.safetensors", best.config or {}


def main() -> None:
    """Carry out the search that the command line asks for."""
    config = tyro.cli(SearchConfig, description=__doc__)
    with command(MissingExtraError, BackendError):
        policy, values = search(config)
    print(f"best values: {values}\nuse the policy as controller learned:{policy}")


if __name__ == "__main__":
    main()
