"""The reward relative to a reference controller's from the same start.

With `final-gap`, the reward at the end of an episode compares final gaps: log(gap of the reference) minus
log(gap of the policy). The price of the policy's evaluations is subtracted. Advantages of a start that any
controller has cancel out, so that rewards of easy and hard scenarios have one scale.
"""

from collections import deque
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
from numpy.typing import NDArray

from swarm_gym.arrays import AnyArray
from swarm_gym.controllers import Controller, SizeLimits, make_controller
from swarm_gym.episode_seeds import read_seeds
from swarm_gym.errors import SettingError, shown
from swarm_gym.settings import Settings
from swarm_gym.sources import GUIDED
from swarm_gym.vector_env import Infos
from swarm_gym.wrappers.grouped_episodes import require_native


class Reference:
    """Returns of a reference controller, by swarm and episode, from the same starts as the policy's.

    The reference runs in a twin environment. With the same seeds, episode k of swarm b has the same seed and
    scenario in both. For the same PS(0) it has the same first population. The twin runs only when its results
    are needed, so that episodes of the two may have different lengths.

    Args:
        controller: controller that decides in the twin environment.
        env: twin environment with autoreset mode SAME_STEP, and no price.
    """

    def __init__(self, controller: Controller, env: VectorEnv):
        if env.metadata.get("autoreset_mode") != AutoresetMode.SAME_STEP:
            raise ValueError(f"expected autoreset mode SAME_STEP, got {env.metadata.get('autoreset_mode')}")
        self.controller = controller
        self.env = env
        self.has_begun = False

    def reset(self, seed: int | list[int | None]) -> None:
        """Begin the first episodes of this seed, or of these seeds."""
        # Native vectors take lists of seeds, too.
        self._observations, _ = self.env.reset(seed=seed)  # type: ignore[arg-type]
        first = seed if isinstance(seed, int | np.integer) else seed[0]
        self.controller.reset(self.env.num_envs, first or 0)
        self._forget()

    def begin_next(self) -> None:
        """Begin the next episodes of all swarms, although the last ones were perhaps not run."""
        self._observations, _ = self.env.reset()
        self._forget()

    def _forget(self) -> None:
        self.has_begun = True
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


def _start(settings: Settings) -> tuple[int, str]:
    """Return the size of the first population, and where its members come from."""
    source = str(settings.new_members)
    return settings.initial_population_size, f"{GUIDED} {source}" if settings.source == GUIDED else source


class PairedReward(VectorWrapper):
    """Episodes whose last reward is less by what a reference controller earns from the same start.

        envs = gymnasium.make_vec(
            "swarm_gym/Firefly-v0", num_envs=64, autoreset_mode="SameStep", reward="final-gap"
        )
        envs = PairedReward(envs, "fixed:80")

    The reference pays no price and has no budget, so it does not depend on these.

    Args:
        env: native vector of swarms on the CPU with autoreset mode SAME_STEP.
        reference: controller, or name of one, that begins with the same population as the swarms.

    Raises:
        SettingError: for a vector or a reference that cannot be paired, with the reason.
        UnknownNameError: if there is no controller of that name.
    """

    def __init__(self, env: VectorEnv, reference: str | Controller):
        swarms = require_native("PairedReward", env, AutoresetMode.SAME_STEP)
        super().__init__(env)
        self._swarms = swarms
        settings, name = swarms.settings, shown(reference)
        limits = SizeLimits(settings.min_population_size, settings.max_population_size)
        controller = make_controller(reference, limits) if isinstance(reference, str) else reference
        if controller.price is not None:
            raise SettingError(
                f"reference {name} observes a price, but a reference pays none; choose another one"
            )
        unpriced = {"source": settings.source, "price": 0.0, "max_evaluations": None}
        changes: dict[str, Any] = controller.options_with(unpriced)
        twin = swarms.twin(**changes)
        (size, source), (theirs, other) = (_start(one.settings) for one in (swarms, twin))
        if (size, source) != (theirs, other):
            raise SettingError(
                f"reference {name} begins with {theirs} members from {other}, but the swarms with {size} "
                f"from {source}: a paired reward compares equal starts; change initial_population_size or "
                f"source, or name another reference, such as spsfa-tip:initial_population_size={size}"
            )
        self._reference = Reference(controller, twin)

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, object] | None = None,
    ) -> tuple[NDArray, Infos]:
        """Begin episodes of all swarms, and of the reference.

        Args:
            seed: seed of the first swarm, or a list with one for each swarm.
            options: must be None: seeds alone decide how the episodes of both begin.

        Raises:
            SettingError: without seeds, for malformed ones, or for options.
        """
        if seed is None or None in read_seeds(seed, self.num_envs):
            raise SettingError("PairedReward needs a seed, so that both begin the same episodes; give seed")
        if options:
            raise SettingError(f"options of reset must be None for paired rewards, got {shown(options)}")
        found = self._swarms.reset(seed=seed)
        self._reference.reset(seed)
        return found

    def step(self, actions: AnyArray) -> tuple[NDArray, NDArray, NDArray, NDArray, Infos]:
        """Advance every swarm by one iteration; subtract the reference's return where an episode ends."""
        observations, rewards, terminated, truncated, infos = self.env.step(actions)
        if terminated.any():
            rewards = rewards.copy()
            rewards[terminated] -= self._reference.next_returns(np.flatnonzero(terminated))
        return observations, rewards, terminated, truncated, infos

    def close(self, **options: object) -> None:
        """Close both vectors."""
        self._reference.env.close()
        super().close(**options)
