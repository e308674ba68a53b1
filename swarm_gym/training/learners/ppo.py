"""Proximal policy optimization, by stable-baselines3.

Source: J. Schulman et al., "Proximal policy optimization algorithms", arXiv 1707.06347 (2017). One rollout is
one episode of every swarm.
"""

import warnings
from collections.abc import Mapping
from typing import Any, ClassVar, TypedDict

import numpy as np
import stable_baselines3
import torch
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.utils import set_random_seed

from swarm_gym.action import includes, require_same_decisions
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import require_fitting
from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.controllers.learned.residual import Base
from swarm_gym.optimizers import get_optimizer
from swarm_gym.runs.seeds import TRAINING_START
from swarm_gym.training.algorithms import PPO, ChoicePPO, ClippedOptions, GradientOptions, RecurrentPPO
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.grouped_vec_env import GroupedVecEnv
from swarm_gym.training.imitation import Demonstration, demonstrate, imitate
from swarm_gym.training.joined_vec_env import JoinedVecEnv
from swarm_gym.training.learners.checks import has_groups
from swarm_gym.training.learners.environments import (
    draws_numbers,
    feature_names,
    make_reference,
    make_swarms,
    parts_of,
)
from swarm_gym.training.learners.group_advantages import GroupBuffer
from swarm_gym.training.learners.learner import Learner
from swarm_gym.training.learners.stopped_chunk import State, go_on, stopped_state
from swarm_gym.training.sb3_vec_env import SB3VecEnv


class PolicyOptions(TypedDict):
    """Options of the library's policy without a memory."""

    net_arch: list[int]
    log_std_init: float


class PPOLearner(Learner):
    """PPO with separate hidden layers for actor and critic."""

    algorithm: ClassVar[type] = stable_baselines3.PPO
    policy: ClassVar[str | type] = "MlpPolicy"
    options: PPO | ChoicePPO | RecurrentPPO

    def __init__(self, config: TrainConfig, options: PPO | ChoicePPO | RecurrentPPO):
        super().__init__()
        self.config, self.options = config, options
        self._stopped: State | None = None  # where the present chunk can go on from
        self._draws_numbers = draws_numbers(config)
        self._teacher = None
        if options.warm_start != "none":
            self._teacher = make_controller(options.warm_start, config.limits)
        # One thread for the whole process, environments included: torch's threads spin between its parallel
        # regions, and networks of this size do not get faster with more of them.
        torch.set_num_threads(1)
        set_random_seed(config.seed)
        grouped = has_groups(config)
        mode = AutoresetMode.DISABLED if grouped else AutoresetMode.SAME_STEP
        made = [make_swarms(part, part.num_swarms, mode) for part in parts_of(config)]
        env, base = made[0]
        if self._teacher is not None:
            if not includes(config.action, self._teacher.action):
                raise ValueError(
                    f"warm_start {options.warm_start!r}: a controller with actions {self._teacher.action!r} "
                    f"cannot be imitated in the layout {config.action!r}"
                )
            try:
                controlled = get_optimizer(config.optimizer)
                require_same_decisions(self._teacher.made_for, self._teacher.action, controlled)
                require_fitting(self._teacher, config.max_evaluations or None)
            except ValueError as error:
                raise ValueError(f"warm_start {options.warm_start!r}: {error}") from error
        if grouped:
            firsts = options.branches or (config.corrected_from,)
            parts = [
                GroupedVecEnv(*one, options.group_size, firsts, self._mean_actions, options.branch_at_events)
                for one in made
            ]
            self.env: SB3VecEnv | JoinedVecEnv = parts[0] if len(parts) == 1 else JoinedVecEnv(parts)
        else:
            self.env = self._make_env(env, base)
        self.features = feature_names(config, base)
        self.num_decisions = int(np.prod(env.single_action_space.shape or ()))
        self._mean_weights: Weights = {}
        settings: Any = self.env.get_attr("settings")[0]
        self._iterations = settings.iterations
        self.model = self._make_model()
        if options.decay_steps:
            self.model.lr_schedule = self._decayed
        self.model.set_logger(Logger(folder=None, output_formats=[]))

    def _make_env(self, env: VectorEnv, base: Base | None) -> Any:
        """Return the environment of the library's model, without groups."""
        return SB3VecEnv(env, base, make_reference(self.config, self.config.num_swarms))

    @property
    def num_steps(self) -> int:  # type: ignore[override]
        """Environment steps so far."""
        return self.model.num_timesteps + self.env.uncounted_steps

    @property
    def in_chunk(self) -> bool:
        """True if some rollouts of the chunk are done."""
        return self._stopped is not None

    def begin(self) -> None:
        """Imitate the teacher, if any; with a base, at least the critic learns the returns of the base.

        Without a critic, a policy with a base needs no imitation: it begins with corrections of zero. So does
        one with rollouts of some steps, whose episodes are too long for it.
        """
        begins_at_zero = not self.options.critic or self.options.rollout_steps > 0
        if self._teacher is None and begins_at_zero and self.env.base is not None:
            with torch.no_grad():
                for parameter in self.model.policy.action_net.parameters():
                    parameter.zero_()
        elif self._teacher is not None or self.env.base is not None:
            seed = TRAINING_START + self.config.seed
            assert isinstance(self.env, SB3VecEnv)  # several optimizers have neither a teacher nor a critic
            shown = demonstrate(self._teacher, self.env, self._noise(), self.options.discount, seed)
            imitate(self.model.policy, self._lessons(shown), self._predict, seed)
            self.env.uncounted_steps = 0  # steps of demonstrations are not counted

    def learn(self, seed: int) -> dict[str, float]:
        """Run `rollouts_per_chunk` rollouts with an update after each; return scalars of the updates."""
        config, begin = self.config, 0
        if self._stopped is None:
            set_random_seed(seed)
            self.env.seed(seed)
            # New episodes and averages, so that any chunk can be the first of a resumed run.
            self.model._last_obs = None
            self.model.ep_info_buffer = None
        else:
            stopped: Any = self._stopped
            uncounted, begin = self.env.uncounted_steps, stopped["rollouts"]
            go_on(self.model, self._stopped, seed)
            self.env.uncounted_steps = uncounted
        for rollout in range(begin, config.rollouts_per_chunk):
            self._begin_rollout()
            steps = self.model.n_steps * config.num_swarms
            self.model.learn(steps, reset_num_timesteps=False, log_interval=10**9)
            self._average_weights()
            if self._stops_between_rollouts:
                self._stopped = stopped_state(self.model, rollout + 1)
                self.after_rollout()
        self._stopped = None
        found = {name: float(value) for name, value in self.model.logger.name_to_value.items()}
        ended: Any = self.model.ep_info_buffer
        if ended:  # none may end in a few steps of long episodes
            found["rollout/ep_rew_mean"] = float(np.mean([episode["r"] for episode in ended]))
        return found

    def weights(self) -> Weights:
        """Return the layers that compute the mean action, or their running mean where there is one."""
        return self._mean_weights or self._last_weights()

    def _average_weights(self) -> None:
        """Move the running mean of the weights towards the last ones."""
        if share := self.options.averaging:
            last = self._last_weights()
            mean = self._mean_weights or last
            self._mean_weights = {name: share * mean[name] + (1.0 - share) * last[name] for name in last}

    def _last_weights(self) -> Weights:
        return {name: tensor.numpy() for name, tensor in actor_layers(self.model.policy).items()}

    def state(self) -> dict[str, object]:
        """Return networks, optimizer and counters."""
        return {
            "mean_weights": {name: torch.as_tensor(array) for name, array in self._mean_weights.items()},
            "policy": self.model.policy.state_dict(),
            "optimizer": self.model.policy.optimizer.state_dict(),
            "num_timesteps": self.model.num_timesteps,
            "num_common_steps": self.env.uncounted_steps,
            "updates": self.model._n_updates,
            **({} if self._stopped is None else {"stopped": self._stopped}),
        }

    def load(self, state: Mapping[str, object]) -> None:
        """Continue from a state."""
        stored: Any = state
        self._mean_weights = {name: tensor.numpy() for name, tensor in stored["mean_weights"].items()}
        self.model.policy.load_state_dict(stored["policy"])
        self.model.policy.optimizer.load_state_dict(stored["optimizer"])
        self.model.num_timesteps = stored["num_timesteps"]
        self.env.uncounted_steps = stored["num_common_steps"]
        self.model._n_updates = stored["updates"]
        self._stopped = stored.get("stopped")

    @property
    def _stops_between_rollouts(self) -> bool:
        """True if each rollout is one whole episode of every swarm, and begins without the policy."""
        if self.options.rollout_steps or self.options.branches or self._draws_numbers:
            return False
        simulations: list[Any] = self.env.get_attr("simulation")
        return has_groups(self.config) or not any(each.may_end_early for each in simulations)

    def _lessons(self, shown: Demonstration) -> Demonstration:
        """Return the sequences of an imitation: single steps."""
        return shown.one_by_one()

    def _predict(self, seen: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Return mean actions (N, k) and values (N,) of observations (sequences, length, features)."""
        flat = seen.flatten(0, 1)
        policy = self.model.policy
        return policy.get_distribution(flat).mode(), policy.predict_values(flat).flatten()

    def _mean_actions(self, seen: NDArray) -> NDArray:
        """Return the actions (B, k) of the policy without noise."""
        with torch.no_grad():
            return self._predict(torch.as_tensor(seen)[:, None])[0].numpy()

    def _noise(self) -> float:
        """Return the standard deviation of actions; where noise is held, that at the begin of episodes."""
        if self.options.noise_steps == 1:
            return float(np.exp(self.model.policy.log_std.detach().numpy().mean()))
        self.env.seed(TRAINING_START + self.config.seed)
        observations = torch.as_tensor(self.env.reset())
        with torch.no_grad():
            return float(self.model.policy.get_distribution(observations).distribution.stddev.mean())

    def _begin_rollout(self) -> None:
        """Make the next rollout one episode: groups of swarms begin to differ at different iterations."""
        if self.model._last_obs is None:
            self.model._last_obs = self.env.reset()
            self.model._last_episode_starts = np.ones(self.env.num_envs, dtype=bool)
        self.model.n_steps = self.model.rollout_buffer.buffer_size = self._rollout_steps

    @property
    def _rollout_steps(self) -> int:
        """Steps of every swarm in the next rollout, by default those that it decides in an episode."""
        return self.options.rollout_steps or self._iterations - self.env.first

    def _decayed(self, _: float) -> float:
        """Return the step size of Adam after the steps so far; the library's share is of one call only."""
        return step_size(self.options, self.num_steps)

    def _policy_options(self) -> dict[str, Any]:
        return {**policy_options(self.config, self.options)}

    def _buffer_options(self) -> dict[str, Any]:
        """Return the options of the model about its rollouts."""
        options = self.options
        if options.group_size == 1 and options.critic and options.noise_steps == 1:
            return {}
        buffer: dict[str, Any] = {
            name: getattr(options, name) for name in ("group_size", "critic", "noise_steps")
        }
        buffer["num_optimizers"] = len(self.config.optimizers)
        if self.config.max_evaluations:
            buffer["ran"] = lambda: self.env.ran
        return {"rollout_buffer_class": GroupBuffer, "rollout_buffer_kwargs": buffer}

    def _make_model(self) -> Any:
        """Return the library's model; a last minibatch may be smaller than the others, which it warns of."""
        config, options = self.config, self.options
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "You have specified a mini-batch size", UserWarning)
            return self.algorithm(
                self.policy,
                self.env,
                learning_rate=options.learning_rate,
                n_steps=self._rollout_steps,
                batch_size=options.batch_size,
                n_epochs=options.epochs,
                gamma=options.discount,
                gae_lambda=options.gae_lambda,
                clip_range=options.clip_range,
                ent_coef=options.entropy_weight,
                vf_coef=0.5 if options.critic else 0.0,
                target_kl=options.target_kl,
                policy_kwargs=self._policy_options(),
                seed=config.seed,
                device="cpu",
                use_sde=options.noise_steps != 1,
                sde_sample_freq=options.noise_steps or -1,
                **self._buffer_options(),
            )


def policy_options(config: TrainConfig, options: ClippedOptions) -> PolicyOptions:
    """Return the options of the library's policy without a memory."""
    return {"net_arch": list(config.hidden_layers), "log_std_init": options.log_std}


def step_size(options: GradientOptions, num_steps: int) -> float:
    """Return the step size of Adam after some environment steps."""
    share = 1.0 - num_steps / options.decay_steps if options.decay_steps else 1.0
    return options.learning_rate * max(share, 0.0)


def actor_layers(policy: ActorCriticPolicy) -> dict[str, torch.Tensor]:
    """Return copies of the layers of a policy that compute the mean action, named as in policy files."""
    modules: Any = policy.mlp_extractor.policy_net
    layers = [module for module in modules if isinstance(module, torch.nn.Linear)]
    last: Any = policy.action_net
    weights = {}
    for number, layer in enumerate([*layers, last]):
        weights[f"{number}.weight"] = layer.weight.detach().clone()
        weights[f"{number}.bias"] = layer.bias.detach().clone()
    return weights
