"""A training run: in chunks, with checkpoints, validation, and exact resuming."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch.utils.tensorboard import SummaryWriter
from tqdm import tqdm

from agents.controller import Controller
from agents.learned import load_learned
from agents.learners import make_learner
from agents.learners.environments import reference_controller
from agents.paired_reward import PAIRED
from agents.policy_file import save_policy
from agents.provenance import provenance
from agents.rollout import Episodes, run_episodes
from agents.run_folder import RunFolderError, as_json, prepare_folder
from agents.seeds import VALIDATION, training_seed
from agents.train_config import TrainConfig
from swarm_gym.files import write_atomically

# Where a run lies and whether it goes on are not part of what it computes, and a run may be made longer.
_LOCATION = ("runs", "name", "resume", "threads")
_NOT_COMPARED = (*_LOCATION, "total_steps")


PACKAGES = ("cmaes", "gymnasium", "numba", "numpy", "sb3-contrib", "stable-baselines3", "torch")


class TrainingRun:
    """A run on disk: configuration, checkpoint, TensorBoard events, latest and best policy."""

    def __init__(self, config: TrainConfig):
        self.config = config
        self.folder = config.folder
        self.checkpoint = self.folder / "checkpoint.pt"
        self.chunk = 0
        self.best_return = -np.inf
        # Asked for once: what runs is what was imported now.
        self.provenance = provenance(*PACKAGES)
        self.learner = make_learner(config)
        # Only now, since a configuration that cannot be run shall leave nothing behind.
        prepare_folder(self.folder, config, config.resume, _NOT_COMPARED)
        self.writer = SummaryWriter(str(self.folder))

    def run(self) -> Path:
        """Train to the end; returns the file of the best policy by validation."""
        config = self.config
        if config.resume and self.checkpoint.exists():
            self._load_checkpoint()
        else:
            self.learner.begin()
        self._baseline = self._run_reference()
        if self.chunk == 0:
            self._validate()
            self._save_checkpoint()
        with tqdm(
            total=config.total_steps, initial=self.learner.num_steps, unit="step", desc=config.name
        ) as bar:
            while self.learner.num_steps < config.total_steps:
                before = self.learner.num_steps
                self._train_chunk()
                mean_return = self._validate()
                self._save_checkpoint()
                bar.set_postfix({"validation": f"{mean_return:.3f}", "best": f"{self.best_return:.3f}"})
                bar.update(self.learner.num_steps - before)
        self.writer.close()
        return self.folder / "best.safetensors"

    def _train_chunk(self) -> None:
        scalars = self.learner.learn(training_seed(self.config.seed, self.chunk))
        self.chunk += 1
        for name, value in scalars.items():
            self.writer.add_scalar(name, value, self.learner.num_steps)

    def _validate(self) -> float:
        """Mean return on the validation seeds; keeps the policy, and the best one by this number."""
        config, step = self.config, self.learner.num_steps
        latest = self.folder / "latest.safetensors"
        self._save_policy(latest, {})
        by_scenario = self._run_validation(load_learned(latest, config.limits), config.env_options())
        results = {}
        for scenario, episodes in by_scenario.items():
            results[scenario] = {
                "return": float(episodes.returns.mean()) - self._baseline.get(scenario, 0.0),
                "final_fitness": float(episodes.final_fitness.mean()),
                "evaluations": float(episodes.evaluations.mean()),
            }
            for name, value in results[scenario].items():
                self.writer.add_scalar(f"validation/{scenario}/{name}", value, step)
        self._write_decisions(list(by_scenario.values()), step)
        mean_return = float(np.mean([result["return"] for result in results.values()]))
        self.writer.add_scalar("validation/return", mean_return, step)
        self._save_policy(latest, results)
        if mean_return > self.best_return:
            self.best_return = mean_return
            self._save_policy(self.folder / "best.safetensors", results)
        return mean_return

    def _run_reference(self) -> dict[str, float]:
        """What a paired reward takes off the mean return, by validation scenario."""
        if self.config.reward != PAIRED:
            return {}
        by_scenario = self._run_validation(*reference_controller(self.config))
        return {scenario: float(episodes.returns.mean()) for scenario, episodes in by_scenario.items()}

    def _run_validation(self, controller: Controller, options: dict[str, Any]) -> dict[str, Episodes]:
        config = self.config
        seeds = VALIDATION[: config.validation_seeds]
        return {
            scenario: run_episodes(
                controller, scenario, seeds, config.optimizer, num_threads=config.threads, **options
            )
            for scenario in config.validation_scenarios or config.scenarios
        }

    def _write_decisions(self, episodes: list[Episodes], step: int) -> None:
        """Mean size and phi by iteration, as scalars at every tenth."""
        for name in ("sizes", "repair_degrees"):
            values = np.concatenate([getattr(e, name) for e in episodes])
            for iteration in range(0, values.shape[1], 10):
                column = values[:, iteration]
                if np.isnan(column).all():
                    break  # a budget has ended all episodes before
                self.writer.add_scalar(f"{name}/iteration {iteration + 1:03}", np.nanmean(column), step)

    def _save_policy(self, path: Path, validation: dict[str, Any]) -> None:
        config = self.config
        manifest = {
            "action": config.action,
            "base": config.base,
            "corrected_from": config.corrected_from,
            "config": {k: v for k, v in as_json(config).items() if k not in _LOCATION},
            "features": self.learner.features,
            "max_evaluations": config.max_evaluations or None,
            "num_decisions": self.learner.num_decisions,
            "optimizer": config.optimizer,
            "price": list(config.price),
            "hidden_layers": list(config.hidden_layers),
            "lstm_size": config.lstm_size,
            "network": self.learner.network,
            "initial_population_size": config.initial_population_size,
            "max_population_size": config.max_population_size,
            "min_population_size": config.min_population_size,
            "observation": config.observation,
            "steps": self.learner.num_steps,
            "validation": validation,
            "validation_seeds": [VALIDATION.start, VALIDATION.start + config.validation_seeds],
            "provenance": self.provenance,
        }
        save_policy(path, self.learner.weights(), manifest)

    def _save_checkpoint(self) -> None:
        state = {
            "learner": self.learner.state(),
            "chunk": self.chunk,
            "best_return": self.best_return,
        }
        content = io.BytesIO()
        torch.save(state, content)
        write_atomically(self.checkpoint, content.getvalue())

    def _load_checkpoint(self) -> None:
        try:
            state = torch.load(self.checkpoint, weights_only=True)
        except Exception as error:
            raise RunFolderError(f"{self.checkpoint}: not a readable checkpoint ({error})") from error
        self.learner.load(state["learner"])
        self.chunk = state["chunk"]
        self.best_return = state["best_return"]
