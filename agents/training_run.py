"""A training run: PPO in chunks, with checkpoints, validation, and exact resuming."""

import dataclasses
import io
import json
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from stable_baselines3 import PPO
from stable_baselines3.common.logger import configure
from stable_baselines3.common.utils import set_random_seed
from torch.utils.tensorboard import SummaryWriter
from tqdm import tqdm

from agents import make_controller
from agents.imitation import imitate
from agents.policy_file import save_policy
from agents.ppo import PPOController
from agents.provenance import provenance
from agents.rollout import Episodes, run_episodes
from agents.sb3_vec_env import SB3VecEnv
from agents.seeds import VALIDATION, training_seed
from agents.train_config import TrainConfig
from swarm_gym.files import write_atomically
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.registration import environment_id


class TrainingError(RuntimeError):
    """A run cannot be started or resumed."""


# Where a run lies and whether it goes on are not part of what it computes, and a run may be made longer.
_LOCATION = ("runs", "name", "resume")
_NOT_COMPARED = (*_LOCATION, "total_steps")


def make_env(config: TrainConfig) -> SB3VecEnv:
    """The swarms that a run trains on."""
    return SB3VecEnv(
        gymnasium.make_vec(
            environment_id(config.optimizer),
            num_envs=config.num_swarms,
            scenario=list(config.scenarios),
            observation=config.observation,
            action="normalised",
            initial_population_size=config.initial_population_size,
            autoreset_mode=AutoresetMode.SAME_STEP,
            **config.env_options(),
        )
    )


def make_model(config: TrainConfig, env: SB3VecEnv) -> PPO:
    """PPO as a run begins with it; one rollout is one episode of every swarm."""
    return PPO(
        "MlpPolicy",
        env,
        learning_rate=config.learning_rate,
        n_steps=env.get_attr("settings")[0].iterations,
        batch_size=config.batch_size,
        n_epochs=config.epochs,
        gamma=config.discount,
        gae_lambda=config.gae_lambda,
        clip_range=config.clip_range,
        ent_coef=config.entropy_weight,
        target_kl=config.target_kl,
        policy_kwargs={
            "net_arch": list(config.hidden_layers),
            "log_std_init": config.log_std,
        },
        seed=config.seed,
        device="cpu",
    )


class TrainingRun:
    """A run on disk: configuration, checkpoint, TensorBoard events, latest and best policy."""

    def __init__(self, config: TrainConfig):
        self.config = config
        self.folder = config.folder
        self.checkpoint = self.folder / "checkpoint.pt"
        self.chunk = 0
        self.best_return = -np.inf
        # Asked for once: what runs is what was imported now.
        self.provenance = provenance("gymnasium", "numba", "numpy", "stable-baselines3", "torch")
        self.teacher = None
        if config.warm_start != "none":
            self.teacher = make_controller(config.warm_start, config.limits)
        torch.set_num_threads(1)
        set_random_seed(config.seed)
        self.env = make_env(config)
        self.model = make_model(config, self.env)
        # Only now, since a configuration that cannot be run shall leave nothing behind.
        self._prepare_folder()
        self.model.set_logger(configure(str(self.folder), ["tensorboard"]))
        self.writer = SummaryWriter(str(self.folder))

    def run(self) -> Path:
        """Train to the end; returns the file of the best policy by validation."""
        config = self.config
        if config.resume and self.checkpoint.exists():
            self._load_checkpoint()
        elif self.teacher is not None:
            imitate(self.model, self.teacher, self.env.env)
        per_chunk = self.model.n_steps * config.num_swarms * config.rollouts_per_chunk
        if self.chunk == 0:
            self._validate()
            self._save_checkpoint()
        with tqdm(
            total=config.total_steps, initial=self.model.num_timesteps, unit="step", desc=config.name
        ) as bar:
            while self.model.num_timesteps < config.total_steps:
                before = self.model.num_timesteps
                self._train_chunk(per_chunk)
                mean_return = self._validate()
                self._save_checkpoint()
                bar.set_postfix({"validation": f"{mean_return:.3f}", "best": f"{self.best_return:.3f}"})
                bar.update(self.model.num_timesteps - before)
        self.writer.close()
        return self.folder / "best.safetensors"

    def _train_chunk(self, steps: int) -> None:
        seed = training_seed(self.config.seed, self.chunk)
        set_random_seed(seed)
        self.env.seed(seed)
        # Fresh episodes and averages, so that any chunk can be the first of a resumed run.
        self.model._last_obs = None
        self.model.ep_info_buffer = None
        self.model.learn(steps, reset_num_timesteps=False, log_interval=1)
        self.chunk += 1

    def _validate(self) -> float:
        """Mean return on the validation seeds; keeps the policy, and the best one by this number."""
        config, step = self.config, self.model.num_timesteps
        latest = self.folder / "latest.safetensors"
        self._save_policy(latest, {})
        controller = PPOController(latest, config.limits)
        seeds = VALIDATION[: config.validation_seeds]
        by_scenario: dict[str, Episodes] = {
            scenario: run_episodes(controller, scenario, seeds, config.optimizer, **config.env_options())
            for scenario in config.scenarios
        }
        results = {}
        for scenario, episodes in by_scenario.items():
            results[scenario] = {
                "return": float(episodes.returns.mean()),
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

    def _write_decisions(self, episodes: list[Episodes], step: int) -> None:
        """Mean size and phi by iteration, as scalars at every tenth."""
        for name in ("sizes", "repair_degrees"):
            means = np.concatenate([getattr(e, name) for e in episodes]).mean(axis=0)
            for iteration in range(0, len(means), 10):
                self.writer.add_scalar(f"{name}/iteration {iteration + 1:03}", means[iteration], step)

    def _save_policy(self, path: Path, validation: dict[str, Any]) -> None:
        policy: Any = self.model.policy
        layers = [m for m in policy.mlp_extractor.policy_net if isinstance(m, torch.nn.Linear)]
        weights = {}
        for number, layer in enumerate([*layers, policy.action_net]):
            weights[f"{number}.weight"] = layer.weight.detach().numpy().copy()
            weights[f"{number}.bias"] = layer.bias.detach().numpy().copy()
        config = self.config
        manifest = {
            "action": "normalised",
            "config": {k: v for k, v in _as_json(config).items() if k not in _LOCATION},
            "features": [f.name for f in OBSERVATIONS[config.observation].features],
            "hidden_layers": list(config.hidden_layers),
            "initial_population_size": config.initial_population_size,
            "max_population_size": config.max_population_size,
            "min_population_size": config.min_population_size,
            "observation": config.observation,
            "steps": self.model.num_timesteps,
            "validation": validation,
            "validation_seeds": [VALIDATION.start, VALIDATION.start + config.validation_seeds],
            "provenance": self.provenance,
        }
        save_policy(path, weights, manifest)

    def _prepare_folder(self) -> None:
        stored = self.folder / "config.json"
        mine = _as_json(self.config)
        if not self.config.resume:
            if stored.exists():
                raise TrainingError(
                    f"{self.folder} holds a run already; use --resume, another --name, or delete it"
                )
            write_atomically(stored, json.dumps(mine, indent=2) + "\n")
            return
        if not stored.exists():
            raise TrainingError(f"--resume: there is no run in {self.folder}")
        theirs = json.loads(stored.read_text())
        different = [
            f"{key} was {theirs.get(key)!r}, is {mine[key]!r}"
            for key in mine
            if key not in _NOT_COMPARED and theirs.get(key) != mine[key]
        ]
        if different:
            raise TrainingError(f"--resume: {self.folder} was run with {'; '.join(different)}")

    def _save_checkpoint(self) -> None:
        state = {
            "policy": self.model.policy.state_dict(),
            "optimizer": self.model.policy.optimizer.state_dict(),
            "num_timesteps": self.model.num_timesteps,
            "updates": self.model._n_updates,
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
            raise TrainingError(f"{self.checkpoint}: not a readable checkpoint ({error})") from error
        self.model.policy.load_state_dict(state["policy"])
        self.model.policy.optimizer.load_state_dict(state["optimizer"])
        self.model.num_timesteps = state["num_timesteps"]
        self.model._n_updates = state["updates"]
        self.chunk = state["chunk"]
        self.best_return = state["best_return"]


def _as_json(config: TrainConfig) -> dict[str, Any]:
    return json.loads(json.dumps(dataclasses.asdict(config), default=str))
