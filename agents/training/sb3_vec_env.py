"""A Gymnasium vector environment as a stable-baselines3 `VecEnv`; the library has no adapter of its own."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

from agents.training.paired_reward import Reference
from swarm_gym.controllers.learned.residual import Base, Proposal


class SB3VecEnv(VecEnv):
    """A wrapper of a vector environment with autoreset mode SAME_STEP, as stable-baselines3 expects.

    Args:
        env: environment with scaled actions; with a base, the columns of its observations are those of the
            base and then those of the policy.
        base: controller to whose decisions the actions are added, if any.
        reference: reference whose return from the same start is subtracted at the end of an episode, if any.

    Attributes:
        first: the iteration in which the policy begins to decide.
        num_common_steps: environment steps so far that are not part of the training.
    """

    autoreset_mode = AutoresetMode.SAME_STEP
    first = 0
    num_common_steps = 0

    def __init__(self, env: VectorEnv, base: Base | None = None, reference: Reference | None = None):
        if (given := env.metadata.get("autoreset_mode")) != self.autoreset_mode:
            raise ValueError(f"expected autoreset mode {self.autoreset_mode.name}, got {given}")
        self.env = env
        self.render_mode = None
        self.base = base
        self.reference = reference
        self._proposal: Proposal | None = None
        observation_space: Any = env.single_observation_space
        if base is not None:
            observation_space = base.observation_space(observation_space)
        super().__init__(env.num_envs, observation_space, env.single_action_space)
        self._actions = np.empty(0)
        self._returns = np.zeros(env.num_envs)
        self._lengths = np.zeros(env.num_envs, dtype=np.int64)

    def reset(self) -> NDArray:
        """Begin new episodes of all swarms, with the seed given to `seed`, if any."""
        seed = self._seeds[0]
        if self.reference is not None:
            if seed is None:
                raise ValueError("a reference needs a seed to begin the same episodes: call seed() first")
            self.reference.reset(seed)
        observations, _ = self.env.reset(seed=seed)
        self._reset_seeds()
        self._returns[:] = 0.0
        self._lengths[:] = 0
        if self.base is not None:
            self.base.controller.reset(self.num_envs)
        return self._see(observations)

    def step_async(self, actions: NDArray) -> None:
        """Keep the actions for `step_wait`."""
        self._actions = actions if self._proposal is None else self._proposal.corrected(actions)

    def step_wait(self) -> tuple[NDArray, NDArray, NDArray, list[dict[str, Any]]]:
        """Advance all swarms; infos of ended episodes have `episode` and `terminal_observation`."""
        observations, rewards, terminated, truncated, infos = self.env.step(self._actions)
        dones = terminated | truncated
        if self.reference is not None and dones.any():
            rewards = rewards.copy()
            rewards[dones] -= self.reference.next_returns(np.flatnonzero(dones))
        self._returns += rewards
        self._lengths += 1
        by_env: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for row in np.flatnonzero(dones):
            final = infos["final_info"]
            by_env[row] = self._ended(
                int(row),
                infos["final_obs"][row],
                final["best_fitness"][row],
                final["evaluations"][row],
                truncated=bool(truncated[row] and not terminated[row]),
            )
        self._returns[dones] = 0.0
        self._lengths[dones] = 0
        return self._see(observations), rewards, dones, by_env

    def close(self) -> None:
        """Close the vector environment."""
        self.env.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the whole vector, once per requested swarm."""
        return [getattr(self.env.unwrapped, attr_name)] * len(self._rows(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:  # noqa: ARG002
        """Raise an error: attributes belong to all swarms at once."""
        raise AttributeError(f"cannot set {attr_name!r} of single swarms in a native vector")

    def env_method(
        self,
        method_name: str,
        *method_args: Any,  # noqa: ARG002
        indices: Any = None,  # noqa: ARG002
        **method_kwargs: Any,  # noqa: ARG002
    ) -> list[Any]:
        """Raise an error: swarms of a native vector have no methods of their own."""
        raise AttributeError(f"cannot call {method_name!r} of single swarms in a native vector")

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:  # noqa: ARG002
        """Return False for every swarm: none is wrapped by itself."""
        return [False] * len(self._rows(indices))

    def _see(self, observations: NDArray) -> NDArray:
        """Return the policy's observations; the base proposes its decisions for this step."""
        if self.base is None:
            return observations
        self._proposal = self.base.propose(observations)
        return self._proposal.seen

    def _ended(
        self, row: int, last: NDArray, best_fitness: float, evaluations: int, *, truncated: bool = False
    ) -> dict[str, Any]:
        """Return the info of an episode that ended with an observation, of the swarm in that row."""
        return {
            "terminal_observation": self._last(last),
            "TimeLimit.truncated": truncated,
            "episode": {"r": float(self._returns[row]), "l": int(self._lengths[row]), "t": 0.0},
            "best_fitness": float(best_fitness),
            "evaluations": int(evaluations),
        }

    def _last(self, observation: NDArray) -> NDArray:
        """Return the policy's last observation of an episode, without a proposal of the base."""
        return observation if self.base is None else self.base.last(observation)

    def _rows(self, indices: int | Sequence[int] | None) -> list[int]:
        return list(self._get_indices(indices))
