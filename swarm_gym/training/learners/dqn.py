"""Deep Q-networks, by stable-baselines3: the policy chooses from a grid of sizes and repair degrees.

Source: V. Mnih et al., "Human-level control through deep reinforcement learning", Nature 518 (2015), with
returns over several steps as in M. Hessel et al., "Rainbow", AAAI 2018. They are not corrected for choices
that were random or that the network would not make any more. The network estimates the return of each
choice; the policy takes the choice with the largest estimate.
"""

import json
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
import stable_baselines3
import torch
from gymnasium.spaces import Discrete
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from stable_baselines3.common.logger import Logger

from swarm_gym.checks import require_integer, require_number
from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.sb3 import ChoiceVecEnv, make_choices
from swarm_gym.training.algorithms import DQN
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.learners.environments import (
    draws_numbers,
    feature_names,
    make_reference,
    make_swarms,
)
from swarm_gym.training.learners.learner import Learner
from swarm_gym.training.learners.ppo import step_size
from swarm_gym.training.learners.stopped_chunk import State, go_on, stopped_state
from swarm_gym.training.sb3_vec_env import SB3VecEnv

# Share of random choices: it falls from 1 to this one over `exploration_steps`. In the first rollout all
# choices are random, since nothing is learned before it ends.
LEAST_EXPLORATION = 0.05
# At first the network prefers the choice next to no correction, or without a base next to the middle of the
# ranges, by so much in units of the reward.
PREFERENCE = 0.01
# What is kept of the last steps of all swarms; `timeouts` stay False, since no episode is truncated.
REPLAYED = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")


class ExploringDQN(stable_baselines3.DQN):
    """The library's DQN, in which every swarm draws for itself whether its next choice is random."""

    action_space: Discrete

    def predict(
        self,
        observation: NDArray | dict[str, NDArray],
        state: tuple[NDArray, ...] | None = None,
        episode_start: NDArray | None = None,
        deterministic: bool = False,
    ) -> tuple[NDArray, tuple[NDArray, ...] | None]:
        """Return the numbers of the choices of B swarms, some of them random unless `deterministic`."""
        chosen, state = super().predict(observation, state, episode_start, deterministic=True)
        if not deterministic:
            numbers = self.action_space.np_random
            explores = numbers.random(len(chosen)) < self.exploration_rate
            drawn = numbers.integers(self.action_space.n, size=len(chosen))
            chosen = np.where(explores, drawn, chosen)
        return chosen, state


class DQNLearner(Learner):
    """DQN of stable-baselines3 with tanh layers, on a grid of population sizes and repair degrees."""

    network = "choices"

    def __init__(self, config: TrainConfig, options: DQN):
        super().__init__()
        self.config, self.options = config, options
        _require_usable(config, options)
        torch.set_num_threads(1)  # as for PPO
        env, base = make_swarms(config, config.num_swarms, AutoresetMode.SAME_STEP)
        self.features = feature_names(config, base)
        self.num_decisions = int(np.prod(env.single_action_space.shape or ()))
        if self.num_decisions != 2:
            raise ValueError(
                f"algorithm 'dqn' decides size and repair degree only; action {config.action!r} has "
                f"{self.num_decisions} decisions"
            )
        swarms = SB3VecEnv(env, base, make_reference(config, config.num_swarms))
        self.choices = make_choices(options.size_choices, options.degree_choices)
        self.env = ChoiceVecEnv(swarms, self.choices)
        self.model = self._make_model()
        self.model.set_logger(Logger(folder=None, output_formats=[]))
        self._stopped: State | None = None  # where the present chunk can go on from
        simulation: Any = self.env.get_attr("simulation")[0]
        # Else resets do not lead to where episodes, and random numbers of a base, were.
        self._stops_between_rollouts = not simulation.may_end_early and not draws_numbers(config)

    @property
    def num_steps(self) -> int:  # type: ignore[override]
        """Environment steps so far."""
        return self.model.num_timesteps

    @property
    def in_chunk(self) -> bool:
        """True if some rollouts of the chunk are done."""
        return self._stopped is not None

    def begin(self) -> None:
        """Prefer the choice next to zero: where zero is one, a policy with a base begins as its base."""
        last = self._layers()[-1]
        with torch.no_grad():
            last.weight.zero_()
            last.bias.zero_()
            last.bias[int(np.abs(self.choices).sum(axis=1).argmin())] = PREFERENCE
        self.model.q_net_target.load_state_dict(self.model.q_net.state_dict())

    def learn(self, seed: int) -> dict[str, float]:
        """Run `rollouts_per_chunk` episodes of every swarm with updates at each step; return scalars."""
        model, begin = self.model, 0
        model.set_random_seed(seed)  # also that of the environment
        if self._stopped is None:
            # New episodes and averages, so that any chunk can be the first of a resumed run.
            model._last_obs = None
            model.ep_info_buffer = None
            if (replay := self._replay).size():  # returns of several steps end with the episodes before
                last = replay.pos - 1
                replay.timeouts[last] = np.logical_not(replay.dones[last])
        else:
            stopped: Any = self._stopped
            begin = stopped["rollouts"]
            go_on(model, stopped, seed)
            model.action_space.np_random.bit_generator.state = json.loads(stopped["choices"])
        model.exploration_rate = self._exploration(0.0)
        for rollout in range(begin, self.config.rollouts_per_chunk):
            model.learn(_steps_of_rollout(self.config), reset_num_timesteps=False, log_interval=10**9)
            if self._stops_between_rollouts:
                drawn = json.dumps(model.action_space.np_random.bit_generator.state)
                self._stopped = {**stopped_state(model, rollout + 1), "choices": drawn}
                self.after_rollout()
        self._stopped = None
        found = {name: float(value) for name, value in model.logger.name_to_value.items()}
        ended: Any = model.ep_info_buffer
        found["rollout/ep_rew_mean"] = float(np.mean([episode["r"] for episode in ended]))
        return found

    def weights(self) -> Weights:
        """Return the layers that estimate returns, and the choices."""
        found = {"choices": self.choices}
        for number, layer in enumerate(self._layers()):
            found[f"{number}.weight"] = layer.weight.detach().numpy().copy()
            found[f"{number}.bias"] = layer.bias.detach().numpy().copy()
        return found

    def shape(self) -> dict[str, int]:
        """Return the number of choices."""
        return {"num_choices": len(self.choices)}

    def state(self) -> dict[str, object]:
        """Return networks, optimizer, counters and the steps that are replayed."""
        model, replay = self.model, self._replay
        filled = replay.size()
        return {
            "policy": model.policy.state_dict(),
            "optimizer": model.policy.optimizer.state_dict(),
            "num_timesteps": model.num_timesteps,
            "updates": model._n_updates,
            "calls": model._n_calls,
            "replay": {name: torch.as_tensor(getattr(replay, name)[:filled]) for name in REPLAYED},
            "place": replay.pos,
            "full": replay.full,
            **({} if self._stopped is None else {"stopped": self._stopped}),
        }

    def load(self, state: Mapping[str, object]) -> None:
        """Continue from a state."""
        stored: Any = state
        model, replay = self.model, self._replay
        model.policy.load_state_dict(stored["policy"])
        model.policy.optimizer.load_state_dict(stored["optimizer"])
        model.num_timesteps, model._n_updates = stored["num_timesteps"], stored["updates"]
        model._n_calls = stored["calls"]
        for name, steps in stored["replay"].items():
            getattr(replay, name)[: len(steps)] = steps.numpy()
        replay.pos, replay.full = stored["place"], stored["full"]
        self._stopped = stored.get("stopped")

    @property
    def _replay(self) -> Any:
        """The last steps of all swarms."""
        return self.model.replay_buffer

    def _layers(self) -> list[torch.nn.Linear]:
        return [layer for layer in self.model.q_net.q_net if isinstance(layer, torch.nn.Linear)]

    def _exploration(self, _: float) -> float:
        """Return the share of random choices after the steps so far; the library's is of one call only."""
        gone = self.num_steps / max(self.options.exploration_steps, 1)
        return max(1.0 - gone * (1.0 - LEAST_EXPLORATION), LEAST_EXPLORATION)

    def _make_model(self) -> ExploringDQN:
        config, options = self.config, self.options
        with warnings.catch_warnings():
            # The target network may follow at every step of many swarms.
            warnings.filterwarnings("ignore", "The number of environments used is greater", UserWarning)
            model = ExploringDQN(
                "MlpPolicy",
                self.env,
                learning_rate=options.learning_rate,
                buffer_size=options.replay_size,
                learning_starts=_steps_of_rollout(config),
                batch_size=options.batch_size,
                gamma=options.discount,
                train_freq=1,
                gradient_steps=options.gradient_steps,
                n_steps=options.return_steps,
                target_update_interval=options.target_steps,
                stats_window_size=config.rollouts_per_chunk * config.num_swarms,
                policy_kwargs={"net_arch": list(config.hidden_layers), "activation_fn": torch.nn.Tanh},
                seed=config.seed,
                device="cpu",
            )
        model.lr_schedule = lambda _: step_size(options, self.num_steps)
        model.exploration_schedule = self._exploration
        return model


def _steps_of_rollout(config: TrainConfig) -> int:
    """Return the number of environment steps of one episode of every swarm."""
    return config.iterations * config.num_swarms


def _require_usable(config: TrainConfig, options: DQN) -> None:
    """Raise an error for options that DQN cannot use."""
    require_choices({name: getattr(options, name) for name in ("size_choices", "degree_choices")})
    for name in ("batch_size", "gradient_steps", "target_steps"):
        require_integer(name, getattr(options, name), 1)
    require_integer("return_steps", options.return_steps, 1, config.iterations)
    require_integer("exploration_steps", options.exploration_steps, 0)
    require_integer("replay_size", options.replay_size, _steps_of_rollout(config))
    if config.max_evaluations:
        raise ValueError(
            f"dqn needs episodes of one length: max_evaluations must be 0, got {config.max_evaluations}"
        )


def require_choices(choices: Mapping[str, tuple[float, ...]]) -> None:
    """Raise an error unless the choices of each decision, by option, are different numbers in [-1, 1].

    Raises:
        ValueError: naming the option.
    """
    for name, numbers in choices.items():
        if len(set(numbers)) < max(len(numbers), 1):
            raise ValueError(f"{name} must be different numbers, at least one, got {numbers}")
        for number in numbers:
            require_number(name, number, -1.0, 1.0)
