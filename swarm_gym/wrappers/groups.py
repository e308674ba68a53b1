"""Groups of swarms that begin alike: their episodes, joining after events on the map, and advantages.

The luck of a start is common to a group, and the mean of the group takes it out of the advantages. Sources:
Z. Shao et al., "DeepSeekMath", arXiv 2402.03300 (2024), where advantages are relative to a group;
A. Kazemnejad et al., "VinePPO", arXiv 2410.01679 (2024), where groups begin inside of episodes. Here,
advantages are not divided by the group's standard deviation: the mean return is the objective.

Noise that is held for several steps earns one advantage, of the step in which it was drawn. Otherwise
the later steps of the same noise would be praised for its later gains, and not blamed for its earlier costs;
policies learned so ended with too large populations.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from gymnasium.vector import VectorEnv
from numpy.typing import NDArray

from swarm_gym.controllers.learned.residual import Base
from swarm_gym.runs.seeds import TRAINING_START, TRAINING_STOP
from swarm_gym.wrappers.beginnings import CommonBeginning, begin_together

if TYPE_CHECKING:
    import torch

Array = TypeVar("Array", NDArray[np.floating], "torch.Tensor")


class Groups:
    """Groups of neighbouring swarms, whose episodes begin together.

    Args:
        env: native vector of swarms without autoreset.
        base: controller that the caller's policy corrects, if any; it is reset.
        group_size: number of swarms in a group.
        firsts: iterations, counted from 0, at which the swarms of a group begin to differ; one of them is
            drawn for all episodes that begin together.
        at_events: whether, in half of the rollouts, the swarms of a group go on from the state of their first
            one after every event on the map. The luck of that state is then common to the group; each swarm
            keeps the rewards of what it did before.

    Attributes:
        first: the iteration at which the episodes under way began to differ.
        num_common_steps: environment steps in common iterations so far, each computed once for its group.
    """

    def __init__(
        self, env: VectorEnv, base: Base | None, group_size: int, firsts: tuple[int, ...], at_events: bool
    ):
        self._env, self._base = env, base
        self._episodes = np.arange(env.num_envs) // group_size
        self._leaders = self._episodes * group_size  # the first swarm of each swarm's group
        self._firsts = firsts
        self._at_events = at_events
        self._joining = False  # whether swarms go on together after events in this rollout
        self._generator = np.random.default_rng()
        self.num_common_steps = 0
        self.first = firsts[0]

    def seed(self, seed: int) -> None:
        """Seed what is drawn for the next episodes: their seeds, and where they begin to differ."""
        self._generator = np.random.default_rng(seed)

    def begin(self, decide: Callable[[NDArray], NDArray] | None) -> CommonBeginning:
        """Begin new episodes of all groups, with seeds of the range for training.

        Args:
            decide: function from the observations of the environment (B, k) to its actions in the common
                iterations; None lets the base decide alone.
        """
        self.first = self._firsts[self._generator.integers(len(self._firsts))]
        if self._at_events:
            self._joining = bool(self._generator.integers(2))
        number = int(self._episodes[-1]) + 1
        seed = int(self._generator.integers(TRAINING_START, TRAINING_STOP - number))
        begun = begin_together(self._env, self._base, self._episodes, seed, self.first, decide)
        self.num_common_steps += begun.num_steps
        return begun

    def join(self, observations: NDArray) -> NDArray:
        """Return the observations after groups whose map has just changed have joined their first swarm."""
        if not self._joining:
            return observations
        inner: Any = self._env.unwrapped
        simulation = inner.simulation
        begins = simulation.worlds.begins[simulation.swarms.problem]
        changed = (begins > 0) & (begins == simulation.iteration)
        if not changed.any():
            return observations
        own = np.arange(self._env.num_envs)
        return inner.copy_swarms(np.where(changed, self._leaders, own))


def relative_to_group(advantages: Array, group_size: int, noise_steps: int = 1) -> Array:
    """Return advantages of the steps in which the noise was drawn, minus their mean over the group.

    Args:
        advantages: (steps, B), an array of NumPy or a tensor.
        group_size: number of swarms in a group, neighbours.
        noise_steps: number of steps that share their noise; 0 is a whole episode.
    """
    held = noise_steps or len(advantages)
    drawn: Any = advantages[[step // held * held for step in range(len(advantages))]]
    if group_size == 1:
        return drawn
    groups = drawn.reshape(len(drawn), -1, group_size)
    return (groups - groups.mean(axis=2, keepdims=True)).reshape(drawn.shape)
