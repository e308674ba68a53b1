"""Episodes in groups, for stable-baselines3: swarms of a group share seed, scenario, price and first state.

Sources: Z. Shao et al., "DeepSeekMath", arXiv 2402.03300 (2024), where advantages are relative to a group;
A. Kazemnejad et al., "VinePPO", arXiv 2410.01679 (2024), where groups begin inside of episodes.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from swarm_gym.controllers.learned.residual import Base, carried_out
from swarm_gym.runs.seeds import TRAINING_START, TRAINING_STOP
from swarm_gym.training.beginnings import begin_together
from swarm_gym.training.sb3_vec_env import SB3VecEnv


class GroupedVecEnv(SB3VecEnv):
    """Episodes whose first iterations are common to a group of swarms, and not part of the training.

    New episodes begin at once. A swarm whose episode ends early, such as one that arrives, rests until the
    last iteration: it has no rewards then, and its actions do nothing.

    Args:
        env: environment without autoreset.
        base: controller to whose decisions the actions are added, if any.
        group_size: number of swarms in a group, neighbours.
        firsts: iterations, counted from 0, at which the swarms of a group begin to differ; one of them is
            drawn for all episodes that begin together.
        decide: function from the policy's observations to its actions in the common iterations; None lets
            the base decide alone.
        at_events: whether, in half of the rollouts, the swarms of a group go on from the state of their first
            one after every event on the map. The luck of that state is then common to the group; each swarm
            keeps the rewards of what it did before.

    Attributes:
        first: the iteration at which the episodes under way began to differ.
        num_common_steps: environment steps in common iterations so far, each computed once for its group.
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
        self._episodes = np.arange(env.num_envs) // group_size
        self._leaders = self._episodes * group_size  # the first swarm of each swarm's group
        self._firsts = firsts
        self._decide = decide
        self._at_events = at_events
        self._joining = False  # whether swarms go on together after events in this rollout
        self._generator = np.random.default_rng()
        self.num_common_steps = 0
        self.first = firsts[0]

    def reset(self) -> NDArray:
        """Begin new episodes of all groups; after `seed`, the same ones again."""
        if self._seeds[0] is not None:
            self._generator = np.random.default_rng(self._seeds[0])
            self._reset_seeds()
        return self._begin()

    def step_wait(self) -> tuple[NDArray, NDArray, NDArray, list[dict[str, object]]]:
        """Advance all swarms, as `SB3VecEnv` does."""
        inner: Any = self.env.unwrapped
        observations, rewards, dones = inner.step_running(self._actions)
        self._returns += rewards
        self._lengths += 1
        if self._lengths[0] < inner.settings.iterations:
            if self._joining:
                observations = self._join(observations)
            not_yet = np.zeros_like(dones)
            return self._see(observations), rewards, not_yet, [{} for _ in range(self.num_envs)]
        swarms = inner.simulation.swarms
        by_env = [
            self._ended(row, observations[row], swarms.best_fitness[row], swarms.evaluations[row])
            for row in range(self.num_envs)
        ]
        return self._begin(), rewards, dones, by_env

    def _begin(self) -> NDArray:
        self.first = self._firsts[self._generator.integers(len(self._firsts))]
        if self._at_events:
            self._joining = bool(self._generator.integers(2))
        groups = int(self._episodes[-1]) + 1
        seed = int(self._generator.integers(TRAINING_START, TRAINING_STOP - groups))
        begun = begin_together(
            self.env, self.base, self._episodes, seed, self.first, self._decide and self._act
        )
        self.num_common_steps += begun.num_steps
        self._returns[:] = begun.returns
        self._lengths[:] = self.first
        return self._see(begun.observations)

    def _join(self, observations: NDArray) -> NDArray:
        """Return the observations after groups whose map has just changed have joined their first swarm."""
        inner: Any = self.env.unwrapped
        simulation = inner.simulation
        begins = simulation.worlds.begins[simulation.swarms.problem]
        changed = (begins > 0) & (begins == simulation.iteration)
        if not changed.any():
            return observations
        own = np.arange(self.num_envs)
        return inner.copy_swarms(np.where(changed, self._leaders, own))

    def _act(self, observations: NDArray) -> NDArray:
        """Return the actions of a policy without noise."""
        assert self._decide is not None
        seen = self._see(observations)
        return carried_out(self._decide(seen), self._proposal)
