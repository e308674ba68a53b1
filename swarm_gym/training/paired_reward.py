"""The paired reward: a policy's final result relative to that of a reference controller from the same start.

The reward at the end of an episode is log(final gap of the reference) - log(final gap of the policy), minus
the price of the policy's evaluations. Advantages of a start that any controller has cancel out, so that
rewards of easy and hard scenarios have one scale. The gap is that of `swarm_gym.reward`.
"""

from collections import deque
from typing import TYPE_CHECKING

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

if TYPE_CHECKING:
    from swarm_gym.controllers.controller import Controller

PAIRED = "paired"  # name of this reward in a training configuration
ENV_REWARD = "final-gap"  # reward of the environments from which it is computed


class Reference:
    """Returns of a reference controller, by swarm and episode, from the same starts as the policy's.

    The reference runs in a twin environment. With the same seeds, episode k of swarm b has the same seed in
    both, and so the same scenario and, for the same PS(0), the same first population. The twin runs only when
    its results are needed, so that episodes of the two may have different lengths.

    Args:
        controller: controller that decides in the twin environment.
        env: twin environment with autoreset mode SAME_STEP, the reward `ENV_REWARD` and no price.
    """

    def __init__(self, controller: "Controller", env: VectorEnv):
        if env.metadata.get("autoreset_mode") != AutoresetMode.SAME_STEP:
            raise ValueError(f"expected autoreset mode SAME_STEP, got {env.metadata.get('autoreset_mode')}")
        self.controller = controller
        self.env = env

    def reset(self, seed: int) -> None:
        """Begin the first episodes of this seed."""
        self._observations, _ = self.env.reset(seed=seed)
        self.controller.reset(self.env.num_envs, seed)
        self._returns = np.zeros(self.env.num_envs)
        self._waiting: list[deque[float]] = [deque() for _ in range(self.env.num_envs)]

    def next_returns(self, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the (r,) returns of the next episodes of r swarms, given by their numbers (r,)."""
        while not all(self._waiting[row] for row in rows):
            self._step()
        return np.array([self._waiting[row].popleft() for row in rows])

    def _step(self) -> None:
        actions = self.controller.act(self._observations)
        self._observations, rewards, ended, _, _ = self.env.step(actions)
        self._returns += rewards
        for row in np.flatnonzero(ended):
            self._waiting[row].append(float(self._returns[row]))
        self._returns[ended] = 0.0
