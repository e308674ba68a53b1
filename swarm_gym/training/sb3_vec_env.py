"""Swarms for stable-baselines3 in which a base proposes decisions and a reference is subtracted."""

from typing import Any

import numpy as np
from gymnasium.vector import VectorEnv
from numpy.typing import NDArray

from swarm_gym.controllers.learned.residual import Base, Proposal
from swarm_gym.sb3 import NativeVecEnv
from swarm_gym.wrappers.paired_reward import Reference


class SB3VecEnv(NativeVecEnv):
    """A native vector of swarms in which a policy may correct a base.

    Args:
        env: environment with scaled actions; with a base, its observations have the columns of the base
            and then the columns of the policy.
        base: controller to whose decisions the actions are added, if any.
        reference: reference whose return from the same start is subtracted at the end of an episode, if any.

    Attributes:
        first: the iteration in which the policy begins to decide.
        uncounted_steps: environment steps so far that the library does not count, less those that it counts
            of resting swarms.
        ran: (B,) which swarms the last step has advanced.
    """

    first = 0
    uncounted_steps = 0

    def __init__(self, env: VectorEnv, base: Base | None = None, reference: Reference | None = None):
        own: Any = env.single_observation_space
        super().__init__(env, None if base is None else base.observation_space(own))
        self.base = base
        self.reference = reference
        self._proposal: Proposal | None = None
        self.ran = np.ones(self.num_envs, dtype=np.bool_)

    def reset(self) -> NDArray:
        """Begin new episodes of all swarms, with the seed given to `seed`, or else the next ones of all."""
        if self.reference is not None:
            seed = self._seeds[0]
            if seed is not None:
                self.reference.reset(seed)
            elif self.reference.has_begun:
                self.reference.begin_next()
            else:
                raise ValueError("a reference needs a seed to begin the same episodes: call seed() first")
        observations = super().reset()
        if self.base is not None:
            self.base.controller.reset(self.num_envs)
        return self._see(observations)

    def step_async(self, actions: NDArray) -> None:
        """Keep the actions for `step_wait`, as corrections of what the base has proposed."""
        super().step_async(actions if self._proposal is None else self._proposal.corrected(actions))

    def step_wait(self) -> tuple[NDArray, NDArray, NDArray, list[dict[str, object]]]:
        """Advance all swarms; infos of ended episodes have `episode` and `terminal_observation`."""
        observations, rewards, dones, infos = super().step_wait()
        return self._see(observations), rewards, dones, infos

    def _rewarded(self, rewards: NDArray, dones: NDArray) -> NDArray:
        if self.reference is None or not dones.any():
            return rewards
        rewards = rewards.copy()
        rewards[dones] -= self.reference.next_returns(np.flatnonzero(dones))
        return rewards

    def _see(self, observations: NDArray) -> NDArray:
        """Return the policy's observations; the base proposes its decisions for this step."""
        if self.base is None:
            return observations
        self._proposal = self.base.propose(observations)
        return self._proposal.seen

    def _last(self, observation: NDArray) -> NDArray:
        """Return the policy's last observation of an episode, without a proposal of the base."""
        return observation if self.base is None else self.base.last(observation)
