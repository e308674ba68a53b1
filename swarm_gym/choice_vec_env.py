"""The environment of learners that choose: an action is the number of one of several actions."""

from itertools import product

import numpy as np
from gymnasium.spaces import Discrete
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn


def make_choices(*numbers: tuple[float, ...]) -> NDArray[np.float32]:
    """Return all actions with one of these numbers for each of k decisions, scaled to [-1, 1]: (n, k)."""
    return np.array(list(product(*numbers)), dtype=np.float32)


class ChoiceVecEnv(VecEnvWrapper):
    """Swarms in which an action is the number of a row of `choices`.

    Args:
        env: environment whose actions have k numbers.
        choices: (n, k) the actions that can be chosen.
    """

    def __init__(self, env: VecEnv, choices: NDArray):
        super().__init__(env, action_space=Discrete(len(choices)))
        self.choices = choices

    def reset(self) -> NDArray:
        """Begin new episodes of all swarms."""
        return self.venv.reset()  # type: ignore[return-value]

    def step_async(self, actions: NDArray) -> None:
        """Keep the chosen actions for `step_wait`, given their numbers (B,)."""
        self.venv.step_async(self.choices[actions])

    def step_wait(self) -> VecEnvStepReturn:
        """Advance all swarms."""
        return self.venv.step_wait()
