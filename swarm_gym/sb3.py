"""Vectors of swarms for stable-baselines3, which takes vector environments of its own kind only.

    from stable_baselines3 import PPO
    from swarm_gym.sb3 import make_vec

    model = PPO("MlpPolicy", make_vec("firefly", 64, scenario=["case1", "case2", "case3"]), n_steps=100)
    model.learn(100_000)

All swarms stay in one native vector, so that stepping them costs what it costs without stable-baselines3.
Swarms on a GPU (`device="cuda"`) are copied to the memory of the host at every step.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from swarm_gym.arrays import as_numpy
from swarm_gym.errors import MissingExtraError
from swarm_gym.vector_env import SwarmVectorEnv

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as error:
    raise MissingExtraError("swarm_gym.sb3", "stable-baselines3", "study") from error


def make_vec(
    optimizer: str = "firefly",
    num_envs: int = 64,
    *,
    seed: int | None = None,
    num_threads: int | None = None,
    **options: Any,
) -> "NativeVecEnv":
    """Return a vector of swarms as a `VecEnv`; `VecMonitor` and `VecNormalize` may wrap it.

    Args:
        optimizer: a name in `swarm_gym.optimizers.OPTIMIZERS`.
        num_envs: number of swarms.
        seed: seed of the first swarm's first episode, from which those of the others count up.
        num_threads: number of threads that the swarms are spread over; None takes all that Numba has.
        options: options of `SwarmVectorEnv`, such as `device`, of `swarm_gym.settings.Settings` and
            parameters of the optimizer, by name. By default observations are `scaled` and actions
            `normalised`, as policies of neural networks expect.

    Raises:
        UnknownNameError: for an option, optimizer, scenario, layout or reward that does not exist.
        SettingError: for a value that an option cannot have.
    """
    options = {"observation": "scaled", "action": "normalised", **options}
    mode = AutoresetMode.SAME_STEP
    env = SwarmVectorEnv(num_envs, optimizer, autoreset_mode=mode, num_threads=num_threads, **options)
    made = NativeVecEnv(env)
    made.seed(seed)
    return made


class NativeVecEnv(VecEnv):
    """A native vector of swarms as stable-baselines3 takes it.

    The info of an episode that ended has its sum of rewards, its length, its last observation, the best
    fitness and the evaluations; that of an episode under way is empty.

    Args:
        env: environment with the autoreset mode of this class, `SAME_STEP`.
        observation_space: space of the policy's observations; None for that of the environment.

    Raises:
        ValueError: if the environment has another autoreset mode.
    """

    autoreset_mode = AutoresetMode.SAME_STEP

    def __init__(self, env: VectorEnv, observation_space: Any = None):
        if (given := env.metadata.get("autoreset_mode")) != self.autoreset_mode:
            raise ValueError(f"expected autoreset mode {self.autoreset_mode.name}, got {given}")
        self.env = env
        self.render_mode = None
        space: Any = env.single_observation_space if observation_space is None else observation_space
        super().__init__(env.num_envs, space, env.single_action_space)
        self._actions = np.empty(0)
        self._returns = np.zeros(env.num_envs)
        self._lengths = np.zeros(env.num_envs, dtype=np.int64)

    def reset(self) -> NDArray:
        """Begin new episodes of all swarms, with the seed given to `seed`, if any."""
        observations, _ = self.env.reset(seed=self._seeds[0])
        self._reset_seeds()
        self._returns[:] = 0.0
        self._lengths[:] = 0
        return as_numpy(observations)

    def step_async(self, actions: NDArray) -> None:
        """Keep the actions for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[NDArray, NDArray, NDArray, list[dict[str, Any]]]:
        """Advance all swarms; infos of ended episodes have `episode` and `terminal_observation`."""
        *found, infos = self.env.step(self._actions)
        observations, rewards, terminated, truncated = map(as_numpy, found)
        dones = terminated | truncated
        rewards = self._rewarded(rewards, dones)
        self._returns += rewards
        self._lengths += 1
        by_env: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        last: Any = as_numpy(infos["final_obs"]) if dones.any() else None
        for row in np.flatnonzero(dones):
            final = infos["final_info"]
            by_env[row] = self._ended(
                int(row),
                last[row],
                final["best_fitness"][row],
                final["evaluations"][row],
                truncated=bool(truncated[row] and not terminated[row]),
            )
        self._returns[dones] = 0.0
        self._lengths[dones] = 0
        return observations, rewards, dones, by_env

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

    def _rewarded(self, rewards: NDArray, dones: NDArray) -> NDArray:  # noqa: ARG002
        """Return the rewards (B,) that the learner sees."""
        return rewards

    def _last(self, observation: NDArray) -> NDArray:
        """Return the policy's last observation of an episode."""
        return observation

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

    def _rows(self, indices: int | Sequence[int] | None) -> list[int]:
        return list(self._get_indices(indices))
