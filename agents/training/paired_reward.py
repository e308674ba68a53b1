"""A terminal reward relative to another controller: how much better one ends from the same start.

log(final gap of the reference) - log(own final gap), minus the price of one's own evaluations. What a start
gives away to any controller drops out, so that the rewards of easy and hard scenarios are of one size. The
gap is that of `swarm_gym.reward`.
"""

from collections import deque

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller

PAIRED = "paired"  # the name of this reward in a training configuration
ENV_REWARD = "final-gap"  # what the environments pay then


class Reference:
    """What a controller earns, swarm by swarm and episode by episode, from the starts that others get.

    A twin environment: with the same seeds, episode k of swarm b has the same seed in both, and with it the
    same scenario and, for the same PS(0), the same first population. It runs only when its results are asked
    for, so that episodes of the two need not be of one length.

    Args:
        controller: decides in the twin.
        env: the twin, SAME_STEP, with the reward `ENV_REWARD` and no price.
    """

    def __init__(self, controller: Controller, env: VectorEnv):
        if env.metadata.get("autoreset_mode") != AutoresetMode.SAME_STEP:
            raise ValueError(f"expected autoreset mode SAME_STEP, got {env.metadata.get('autoreset_mode')}")
        self.controller = controller
        self.env = env

    def reset(self, seed: int) -> None:
        """Begin with the first episodes of this seed."""
        self._observations, _ = self.env.reset(seed=seed)
        self.controller.reset(self.env.num_envs, seed)
        self._returns = np.zeros(self.env.num_envs)
        self._waiting: list[deque[float]] = [deque() for _ in range(self.env.num_envs)]

    def next_returns(self, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        """(r,) what these r swarms, by number, earn in their next episodes that were not asked for yet."""
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
