"""Episodes in groups, for stable-baselines3; `swarm_gym.wrappers.groups` describes the groups."""

from collections.abc import Callable
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from swarm_gym.arrays import as_numpy
from swarm_gym.controllers.learned.residual import Base, carried_out
from swarm_gym.training.sb3_vec_env import SB3VecEnv
from swarm_gym.wrappers.groups import Groups


class GroupedVecEnv(SB3VecEnv):
    """Episodes whose first iterations are common to a group of swarms, and not part of the training.

    New episodes begin at once. A swarm whose episode ends early, such as one that arrives, rests until the
    last iteration: it has no rewards then, and its actions do nothing. With a budget of evaluations most
    swarms rest in the end: `ran` tells which do not, and steps of resting swarms are not counted.

    Args:
        env: environment without autoreset.
        base: controller to whose decisions the actions are added, if any.
        group_size: number of swarms in a group, neighbours.
        firsts: iterations at which the swarms of a group begin to differ, see `wrappers.groups.Groups`.
        decide: function from the policy's observations to its actions in the common iterations; None lets
            the base decide alone.
        at_events: whether groups join their first swarm after events, see `wrappers.groups.Groups`.

    Attributes:
        first: the iteration at which the episodes under way began to differ.
        uncounted_steps: environment steps in common iterations so far, each computed once for its group, less
            those of resting swarms where there is a budget.
    """

    autoreset_mode = AutoresetMode.DISABLED

    def __init__(
        self,
        env: VectorEnv,
        base: Base | None,
        group_size: int,
        firsts: tuple[int, ...] = (0,),
        decide: Callable[[NDArray], NDArray] | None = None,
        at_events: bool = False,
    ):
        super().__init__(env, base)
        self._groups = Groups(env, base, group_size, firsts, at_events)
        self._decide = decide
        self.uncounted_steps = 0
        swarms: Any = env.unwrapped
        self._has_budget = swarms.settings.max_evaluations is not None
        self.first = firsts[0]

    def reset(self) -> NDArray:
        """Begin new episodes of all groups; after `seed`, the same ones again."""
        if (seed := self._seeds[0]) is not None:
            self._groups.seed(seed)
            self._reset_seeds()
        return self._begin()

    def step_wait(self) -> tuple[NDArray, NDArray, NDArray, list[dict[str, object]]]:
        """Advance all swarms, as `SB3VecEnv` does."""
        inner: Any = self.env.unwrapped
        if self._has_budget:
            self.ran = as_numpy(inner.simulation.running).copy()
            self.uncounted_steps -= int((~self.ran).sum())
        observations, rewards, dones = inner.step_running(self._actions)
        self._returns += rewards
        self._lengths += 1
        if self._lengths[0] < inner.settings.iterations:
            observations = self._groups.join(observations)
            not_yet = np.zeros_like(dones)
            return self._see(observations), rewards, not_yet, [{} for _ in range(self.num_envs)]
        swarms = inner.simulation.swarms
        by_env = [
            self._ended(row, observations[row], swarms.best_fitness[row], swarms.evaluations[row])
            for row in range(self.num_envs)
        ]
        return self._begin(), rewards, dones, by_env

    def _begin(self) -> NDArray:
        begun = self._groups.begin(self._decide and self._act)
        self.first = self._groups.first
        self.uncounted_steps += begun.num_steps
        self._returns[:] = begun.returns
        self._lengths[:] = self.first
        return self._see(begun.observations)

    def _act(self, observations: NDArray) -> NDArray:
        """Return the actions of a policy without noise."""
        assert self._decide is not None
        seen = self._see(observations)
        return carried_out(self._decide(seen), self._proposal)
