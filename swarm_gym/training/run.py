"""A training run: chunks with checkpoints and validation, which can be resumed exactly."""

import dataclasses
import io
import time
from collections.abc import Callable, Mapping
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import torch

from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.learned.policy_file import load_policy, save_policy
from swarm_gym.controllers.registry import load_learned
from swarm_gym.rollout import Episodes, look_away, run_episodes
from swarm_gym.runs.checkpoints import Checkpoints
from swarm_gym.runs.folder import RunFolderError, as_json, prepare_folder
from swarm_gym.runs.provenance import provenance
from swarm_gym.runs.seeds import VALIDATION, training_seed
from swarm_gym.simulation import Simulation
from swarm_gym.training.algorithms import foreign_options
from swarm_gym.training.config import PAIRED, EnvOptions, TrainConfig
from swarm_gym.training.events import Progress, TrainingEvents
from swarm_gym.training.learners import make_learner
from swarm_gym.training.learners.environments import (
    digests_of_controllers,
    first_population,
    make_base,
    reference_controller,
    stated_source,
)
from swarm_gym.training.pictures import make_replay_strip

# Options that do not change the results of a run; in addition, a resumed run may be longer.
_LOCATION = ("runs", "name", "resume", "threads")
_NOT_COMPARED = (*_LOCATION, "total_steps")

# Seconds after which a rollout ends with a checkpoint, where the chunk can be stopped there.
BETWEEN_CHECKPOINTS = 5.0

PACKAGES = ("cmaes", "gymnasium", "numba", "numpy", "sb3-contrib", "stable-baselines3", "torch")


class TrainingRun:
    """A training run in a folder: configuration, checkpoints, TensorBoard events, latest and best policy."""

    def __init__(self, config: TrainConfig):
        self.config = config
        self.folder = config.folder
        self.checkpoints = Checkpoints(self.folder, ".pt")
        self.best = self.folder / "best.safetensors"
        self.chunk = 0
        self.best_return = -np.inf
        self._saved = -np.inf  # when the last checkpoint was stored, in seconds
        # Read once, since the imported code is what runs, whatever changes on the disk.
        self.provenance = provenance(*PACKAGES)
        self.learner = make_learner(config)
        self._first_size, source = first_population(config, make_base(config))
        self._first_source = stated_source(config, source)  # or the policy would begin with others in use
        self._controllers = digests_of_controllers(config)
        # Created only now, so that an invalid configuration leaves no folder.
        self._lock = prepare_folder(
            self.folder,
            config.options(),
            config.resume,
            # Earlier versions stored the options of all algorithms.
            (*_NOT_COMPARED, *foreign_options(config.algorithm.name)),
        )
        self._goes_on = config.resume and self._load_checkpoint()
        if not self._goes_on:
            self.events = TrainingEvents(self.folder, {} if config.resume else None)
        self.replay = make_replay_strip()

    def run(self) -> Path:
        """Train to the end; return the file of the policy with the best validation."""
        try:
            return self._run()
        except OSError as error:
            if error.filename is None and error.errno is not None:  # TensorBoard does not name its files
                raise OSError(error.errno, error.strerror, str(self.folder)) from error
            raise
        finally:
            self._lock.release()

    @property
    def verdict(self) -> str:
        """The best validation return in words, and whether training had a part in it."""
        found = f"best validation return {self.best_return:.4f}"
        if load_policy(self.best)[1]["steps"] > 0:
            return found
        return f"{found}, did not improve on what it began with"

    def _run(self) -> Path:
        config, learner = self.config, self.learner
        learner.after_rollout = self._save_sometimes
        with Progress(config.name, config.total_steps, lambda: learner.num_steps) as progress:
            if not self._goes_on:
                with progress.during("preparation"):
                    learner.begin()
                self._save_checkpoint()
            with progress.during("validation"):
                self._baseline = self._run_reference()
                if self.best_return == -np.inf:
                    self._validate()
                    self._save_checkpoint()
            while learner.num_steps < config.total_steps or learner.in_chunk:
                self._train_chunk()
                with progress.during("validation"):
                    mean_return = self._validate()
                self._save_checkpoint()
                progress.show(validation=mean_return, best=self.best_return)
        self._write_hyperparameters()
        self.events.close()
        return self.best

    def _train_chunk(self) -> None:
        scalars = self.learner.learn(training_seed(self.config.seed, self.chunk))
        self.chunk += 1
        self.events.add_scalars(scalars, self.learner.num_steps)

    def _validate(self) -> float:
        """Return the mean return on the validation seeds; save the policy, also as the best one if it is."""
        config, step = self.config, self.learner.num_steps
        latest = self.folder / "latest.safetensors"
        self._save_policy(latest, {})
        look = self.replay.look if self.replay else look_away
        by_scenario = self._run_validation(load_learned(latest, config.limits), config.env_options(), look)
        results = {}
        for scenario, episodes in by_scenario.items():
            results[scenario] = {
                "return": float(episodes.returns.mean()) - self._baseline.get(scenario, 0.0),
                "final_fitness": float(episodes.final_fitness.mean()),
                "evaluations": float(episodes.evaluations.mean()),
            }
        mean_return = float(np.mean([result["return"] for result in results.values()]))
        self.events.add_scalars({**_by_name("validation", results), "validation/return": mean_return}, step)
        self.events.add_decisions(by_scenario, step)
        if self.replay:
            self.events.add_replay(self.replay.draw(), step)
        self._save_policy(latest, results)
        if mean_return > self.best_return:
            self.best_return = mean_return
            self._save_policy(self.best, results)
        return mean_return

    def _run_reference(self) -> dict[str, float]:
        """Return the reference's mean return by validation scenario; empty without a paired reward."""
        if self.config.reward != PAIRED:
            return {}
        by_scenario = self._run_validation(*reference_controller(self.config))
        return {scenario: float(episodes.returns.mean()) for scenario, episodes in by_scenario.items()}

    def _run_validation(
        self,
        controller: Controller,
        options: EnvOptions,
        look: Callable[[Simulation], None] = look_away,
    ) -> dict[str, Episodes]:
        """Run episodes on the validation seeds of each scenario; `look` sees the first scenario.

        Where the policy is trained on several optimizers, episodes are named by optimizer and scenario.
        """
        config = self.config
        scenarios = config.validation_scenarios or config.scenarios
        seeds, threads = VALIDATION[: config.validation_seeds], config.threads
        found = {}
        for optimizer, scenario in product(config.optimizers, scenarios):
            name = f"{optimizer}/{scenario}" if config.algorithm.also_on else scenario
            found[name] = run_episodes(
                controller, scenario, seeds, optimizer, look, num_threads=threads, **options
            )
            look = look_away
        return found

    def _write_hyperparameters(self) -> None:
        """Write the options of the run and the validation of its best policy."""
        options = {name: v for name, v in as_json(self.config.options()).items() if name not in _NOT_COMPARED}
        validation = load_policy(self.best)[1]["validation"]
        metrics = {"hparam/best_return": self.best_return, **_by_name("hparam", validation)}
        self.events.add_hyperparameters(options, metrics, self.learner.num_steps)

    def _save_policy(self, path: Path, validation: dict[str, Any]) -> None:
        config, source = self.config, self._first_source
        also_on = config.algorithm.also_on
        manifest = {
            "action": config.action,
            "base": config.base,
            "corrected_from": config.corrected_from,
            "config": {k: v for k, v in as_json(config.options()).items() if k not in _LOCATION},
            "features": self.learner.features,
            "max_evaluations": config.max_evaluations or None,
            "num_decisions": self.learner.num_decisions,
            **self.learner.shape(),
            "optimizer": config.optimizer,
            **({"also_on": list(also_on)} if also_on else {}),
            "price": list(config.price),
            "hidden_layers": list(config.hidden_layers),
            "lstm_size": config.algorithm.lstm_size,
            "network": self.learner.network,
            "initial_population_size": self._first_size,
            **({} if source is None else {"first_source": dataclasses.asdict(source)}),
            "max_population_size": config.max_population_size,
            "min_population_size": config.min_population_size,
            "observation": config.observation,
            "steps": self.learner.num_steps,
            "validation": validation,
            "validation_seeds": [VALIDATION.start, VALIDATION.start + config.validation_seeds],
            "provenance": self.provenance,
        }
        save_policy(path, self.learner.weights(), manifest)

    def _save_sometimes(self) -> None:
        """Store the state of the run within a chunk, if the last checkpoint is some seconds old."""
        if time.monotonic() - self._saved > BETWEEN_CHECKPOINTS:
            self._save_checkpoint()

    def _save_checkpoint(self) -> None:
        """Store the state of the run; events are flushed first, as a resumed run does not repeat them."""
        state = {
            "learner": self.learner.state(),
            "chunk": self.chunk,
            "best_return": self.best_return,
            "events": self.events.flush(),
            "controllers": self._controllers,
        }
        content = io.BytesIO()
        torch.save(state, content)
        self.checkpoints.save(content.getvalue())
        self._saved = time.monotonic()

    def _load_checkpoint(self) -> bool:
        """Load the last checkpoint and return whether there is one; later results are computed again."""
        state = self.checkpoints.load(lambda content: torch.load(io.BytesIO(content), weights_only=True))
        if state is None:
            return False
        for role, before in state.get("controllers", {}).items():  # earlier versions stored none
            if self._controllers.get(role) != before:
                raise RunFolderError(
                    f"--resume: {role} {getattr(self.config, role)!r} has changed since {self.folder} was "
                    "trained with it; train under another --name"
                )
        self.learner.load(state["learner"])
        self.chunk = state["chunk"]
        self.best_return = state["best_return"]
        self.events = TrainingEvents(self.folder, state["events"], self.learner.num_steps)
        return True


def _by_name(prefix: str, results: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    """Return the numbers of all scenarios under the names of their scalars."""
    return {
        f"{prefix}/{scenario}/{name}": value
        for scenario, numbers in results.items()
        for name, value in numbers.items()
    }
