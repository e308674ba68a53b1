"""Swarms of several optimizers side by side, for a policy that is trained on all of them at once."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices

from swarm_gym.training.sb3_vec_env import SB3VecEnv


class JoinedVecEnv(VecEnv):
    """Several native vectors of swarms, one after the other, as one `VecEnv`.

    Args:
        parts: vectors with equal spaces, whose episodes have the same length and begin together.

    Attributes:
        parts: the vectors.
        base: controller that the policy corrects in the first part; None if there is none in any part.
        first: the iteration in which the policy begins to decide.

    Raises:
        ValueError: for parts whose observations or actions differ.
    """

    def __init__(self, parts: Sequence[SB3VecEnv]):
        self.parts = tuple(parts)
        first = self.parts[0]
        for part in self.parts[1:]:
            for kind in ("observation_space", "action_space"):
                if getattr(part, kind).shape != getattr(first, kind).shape:
                    raise ValueError(
                        f"optimizers of one training need equal decisions and observations, but {kind} has "
                        f"shapes {getattr(first, kind).shape} and {getattr(part, kind).shape}"
                    )
        self.base = first.base
        self.first = first.first
        self.render_mode = None
        self._ends = np.cumsum([part.num_envs for part in self.parts])
        super().__init__(int(self._ends[-1]), first.observation_space, first.action_space)

    @property
    def uncounted_steps(self) -> int:
        """Environment steps so far that the library does not count, see `SB3VecEnv`."""
        return sum(part.uncounted_steps for part in self.parts)

    @uncounted_steps.setter
    def uncounted_steps(self, count: int) -> None:
        for part in self.parts:
            part.uncounted_steps = 0
        self.parts[0].uncounted_steps = count

    @property
    def ran(self) -> NDArray[np.bool_]:
        """(B,) which swarms the last step has advanced."""
        return np.concatenate([part.ran for part in self.parts])

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Seed the next episodes, each part differently."""
        if seed is None:
            seed = int(np.random.default_rng().integers(2**31))
        for number, part in enumerate(self.parts):
            part.seed(seed + number)
        return [seed] * self.num_envs

    def reset(self) -> NDArray:
        """Begin new episodes of all swarms."""
        return np.concatenate([part.reset() for part in self.parts])

    def step_async(self, actions: NDArray) -> None:
        """Keep the actions of each part for `step_wait`."""
        for part, own in zip(self.parts, np.split(actions, self._ends[:-1]), strict=True):
            part.step_async(own)

    def step_wait(self) -> tuple[NDArray, NDArray, NDArray, list[dict[str, object]]]:
        """Advance all swarms."""
        results = [part.step_wait() for part in self.parts]
        observations, rewards, dones = (np.concatenate([result[k] for result in results]) for k in range(3))
        return observations, rewards, dones, [info for result in results for info in result[3]]

    def close(self) -> None:
        """Close all parts."""
        for part in self.parts:
            part.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[object]:
        """Return an attribute of the vector that each requested swarm is in."""
        by_env = [value for part in self.parts for value in part.get_attr(attr_name)]
        return [by_env[row] for row in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: object, indices: VecEnvIndices = None) -> None:
        """Raise an error, as a part does."""
        self.parts[0].set_attr(attr_name, value, indices)

    def env_method(
        self,
        method_name: str,
        *method_args: object,
        indices: VecEnvIndices = None,
        **method_kwargs: object,
    ) -> list[object]:
        """Raise an error, as a part does."""
        return self.parts[0].env_method(method_name, *method_args, indices=indices, **method_kwargs)

    def env_is_wrapped(self, wrapper_class: type, indices: VecEnvIndices = None) -> list[bool]:  # noqa: ARG002
        """Return False for every swarm: none is wrapped by itself."""
        return [False] * len(list(self._get_indices(indices)))
