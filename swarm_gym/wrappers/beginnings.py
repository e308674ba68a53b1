"""Episodes that begin together: swarms that share their first iterations, computed once and then copied."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from gymnasium.vector import VectorEnv
from numpy.typing import NDArray

from swarm_gym.controllers.learned.residual import Base


class CommonBeginning(NamedTuple):
    """Episodes of B swarms after their common iterations.

    Attributes:
        observations: (B, k) observations of the environment.
        returns: (B,) sums of the rewards so far.
        ended: (B,) whether an episode has ended already.
        num_steps: environment steps that were computed, summed over all swarms.
    """

    observations: NDArray
    returns: NDArray[np.float64]
    ended: NDArray[np.bool_]
    num_steps: int


def begin_together(
    env: VectorEnv,
    base: Base | None,
    episodes: NDArray[np.int64],
    seed: int,
    iterations: int = 0,
    decide: Callable[[NDArray], NDArray] | None = None,
) -> CommonBeginning:
    """Begin the episodes with seeds from `seed` on, and copy them to all swarms after some iterations.

    Args:
        env: B swarms.
        base: controller that a policy corrects, if any; it is reset.
        episodes: (B,) number of the episode of every swarm, each of 0 to E - 1 at least once; episode e has
            the seed `seed` + e.
        seed: seed of episode 0.
        iterations: number of iterations that the swarms of an episode share.
        decide: function from observations (B, k) to actions in these iterations; None is the base alone.

    Raises:
        ValueError: for common iterations in which nothing decides.
    """
    swarms: Any = env.unwrapped
    decide = decide or (_alone(base) if base is not None else None)
    if iterations and decide is None:
        raise ValueError(f"{iterations} common iterations need a base or a function that decides")
    # The first swarm of each episode computes the common iterations, and all swarms see what it sees, so that
    # a base with a memory has the same one for all swarms of the episode.
    models = np.unique(episodes, return_index=True)[1][episodes]
    once = models == np.arange(env.num_envs)
    seeds: Any = (seed + episodes).tolist()
    env.reset(seed=seeds, options={"reset_mask": once})
    observations = swarms.copy_swarms(models)
    returns, ended = np.zeros(env.num_envs), np.zeros(env.num_envs, dtype=np.bool_)
    num_steps = 0
    if base is not None:
        base.controller.reset(env.num_envs)
    for _ in range(iterations):
        assert decide is not None
        actions = decide(observations[models])
        num_steps += int((once & ~ended).sum())
        observations, rewards, ended = swarms.step_running(actions, once)
        returns += rewards
    if iterations:
        observations = swarms.copy_swarms(models)
        returns, ended = returns[models], ended[models]
    return CommonBeginning(observations, returns, ended, num_steps)


def _alone(base: Base) -> Callable[[NDArray], NDArray]:
    return lambda observations: base.propose(observations).actions
