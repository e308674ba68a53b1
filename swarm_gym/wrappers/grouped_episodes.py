"""A wrapper of a native vector in which swarms of a group begin alike.

The mean return of a group is a baseline without a critic, see `swarm_gym.wrappers.groups`.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
from numpy.typing import NDArray

from swarm_gym.arrays import AnyArray
from swarm_gym.checks import refuse_negative_seed, require_integer
from swarm_gym.episode_seeds import read_seeds
from swarm_gym.errors import SettingError, shown
from swarm_gym.vector_env import Infos, SwarmVectorEnv
from swarm_gym.wrappers.groups import Groups

Decide = Callable[[NDArray], NDArray]


class GroupedEpisodes(VectorWrapper):
    """Episodes in groups: swarms of a group share seed, scenario, price and the state in which they differ.

        envs = gymnasium.make_vec("swarm_gym/Firefly-v0", num_envs=64, autoreset_mode="Disabled")
        envs = GroupedEpisodes(envs, group_size=8)

    Neighbours are a group. All episodes end with the last iteration, and the next ones begin in the same
    step, as with the autoreset mode SAME_STEP. A swarm whose episode ends early, such as one that arrives,
    rests until then: it has no rewards, and its actions do nothing. Rewards of common iterations are not
    paid. Episodes have seeds of the range for training, see `swarm_gym.runs.seeds`.

    Args:
        env: native vector of swarms on the CPU with autoreset mode DISABLED.
        group_size: number of swarms in a group; the number of swarms is a multiple of it.
        firsts: iterations, counted from 0, at which the swarms of a group begin to differ; one of them is
            drawn for all episodes that begin together.
        decide: function from observations (B, k) to actions in the common iterations; None is a correction of
            zero, so the base of the environment decides alone.
        at_events: whether, in half of the rollouts, the swarms of a group go on from the state of their first
            one after every event on the map.

    Attributes:
        first: the iteration at which the episodes under way began to differ.
        num_common_steps: environment steps in common iterations so far, each computed once for its group.

    Raises:
        SettingError: for a vector that cannot copy states, resets by itself or is on a GPU, or for groups
            that it cannot have.
    """

    def __init__(
        self,
        env: VectorEnv,
        group_size: int,
        firsts: tuple[int, ...] = (0,),
        decide: Decide | None = None,
        *,
        at_events: bool = False,
    ):
        swarms = require_native("GroupedEpisodes", env, AutoresetMode.DISABLED)
        super().__init__(env)
        self._swarms = swarms
        require_integer("group_size", group_size, 1, env.num_envs)
        if env.num_envs % group_size:
            raise SettingError(
                f"num_envs must be a multiple of group_size, got {env.num_envs} and {group_size}; choose "
                "another group_size"
            )
        if not firsts:
            raise SettingError("firsts must have at least one iteration, got none; (0,) is the beginning")
        for first in firsts:
            require_integer("firsts", first, 0, swarms.settings.iterations - 1)
        if decide is None and max(firsts) > 0 and not swarms.is_corrected:
            raise SettingError(
                f"firsts {firsts}: nothing decides in the common iterations; give decide, or make the "
                "environment with a base"
            )
        self._decide: Decide = self._zeros if decide is None else decide
        self._groups = Groups(env, None, group_size, tuple(firsts), at_events)
        self._length = 0
        self.metadata = {**env.metadata, "autoreset_mode": AutoresetMode.SAME_STEP}

    @property
    def first(self) -> int:
        """The iteration at which the episodes under way began to differ."""
        return self._groups.first

    @property
    def num_common_steps(self) -> int:
        """Environment steps in common iterations so far, each computed once for its group."""
        return self._groups.num_common_steps

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, object] | None = None,
    ) -> tuple[NDArray, Infos]:
        """Begin new episodes of all groups.

        Args:
            seed: seed of all further episodes; of a list, the first counts; None goes on.
            options: must be None: seeds alone decide how the episodes of a group begin.

        Raises:
            SettingError: for options, or malformed seeds.
            gymnasium.error.Error: for a seed that is not a natural number.
        """
        if options:
            raise SettingError(f"options of reset must be None for groups, got {shown(options)}")
        first = None if seed is None else read_seeds(seed, self.num_envs)[0]
        if first is not None:
            refuse_negative_seed(first)
            self._groups.seed(first)
        return self._begin()

    def step(self, actions: AnyArray) -> tuple[NDArray, NDArray, NDArray, NDArray, Infos]:
        """Advance all swarms by one iteration; after the last one, new episodes begin.

        Returns:
            Observations (B, k), rewards (B,), which episodes have terminated (B,), False for truncated (B,),
            and infos, with `final_obs` and `final_info` at the end.
        """
        swarms = self._swarms
        observations, rewards, ended = swarms.step_running(actions)
        self._length += 1
        nobody, everyone = np.zeros_like(ended), np.ones_like(ended)
        if self._length < swarms.settings.iterations:
            observations = self._groups.join(observations)
            return observations, rewards, nobody, nobody, swarms.infos(everyone)
        final = swarms.final_infos(everyone)
        observations, infos = self._begin()
        return observations, rewards, everyone, nobody, {**infos, **final}

    def _begin(self) -> tuple[NDArray, Infos]:
        begun = self._groups.begin(self._decide)
        self._length = self.first
        return begun.observations, self._swarms.infos(np.ones(self.num_envs, dtype=np.bool_))

    def _zeros(self, observations: NDArray) -> NDArray:
        space: Any = self.single_action_space
        return np.zeros((len(observations), *space.shape), dtype=space.dtype)


def require_native(wrapper: str, env: VectorEnv, mode: AutoresetMode) -> SwarmVectorEnv:
    """Return a native vector of swarms on the CPU with an autoreset mode; refuse any other vector.

    Args:
        wrapper: name of the wrapper, for messages.
        env: vector that shall be wrapped.
        mode: autoreset mode that it needs.

    Raises:
        SettingError: saying what the vector lacks.
    """
    if not isinstance(env, SwarmVectorEnv):
        raise SettingError(
            f"{wrapper} needs a vector that can copy the states of its swarms, which {type(env).__name__} "
            "cannot; wrap the SwarmVectorEnv that gymnasium.make_vec returns for an id of swarm_gym, and put "
            "other wrappers around it"
        )
    if env.simulation.xp is not np:
        raise SettingError(f"{wrapper} needs swarms on the CPU, got device 'cuda'; set device to 'cpu'")
    if (given := env.metadata["autoreset_mode"]) != mode:
        raise SettingError(
            f"{wrapper} needs autoreset mode {mode.value!r}, got {given.value!r}; make the vector with "
            f"autoreset_mode={mode.value!r}"
        )
    return env
