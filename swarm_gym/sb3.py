"""Vectors of swarms for stable-baselines3, which takes vector environments of its own kind only.

    from stable_baselines3 import PPO
    from swarm_gym.sb3 import make_vec

    model = PPO("MlpPolicy", make_vec("firefly", 64, scenario=["case1", "case2", "case3"]), n_steps=100)
    model.learn(100_000)

All swarms stay in one native vector, so that stepping them costs what it costs without stable-baselines3.
Swarms on a GPU (`device="cuda"`) are copied to the memory of the host at every step.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from itertools import product
from typing import Any

import numpy as np
from gymnasium.spaces import Discrete, Space
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from swarm_gym.arrays import as_numpy
from swarm_gym.checks import require_integer
from swarm_gym.controllers import Controller, make_controller_for
from swarm_gym.corrected_batch import SOURCE_OPTIONS, completed
from swarm_gym.errors import ActionError, MissingExtraError, SettingError, shown
from swarm_gym.learner_options import FOR_CORRECTIONS, learner_options, warn_of_unscaled
from swarm_gym.settings import Settings
from swarm_gym.sources import UNIFORM
from swarm_gym.vector_env import SwarmVectorEnv

try:
    from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper
    from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvStepReturn
except ImportError as error:
    raise MissingExtraError("swarm_gym.sb3", "stable-baselines3", "train") from error


SIGNATURE = "made_for"  # attribute of action spaces, by which `agents.import_sb3` knows the environment
MOST_CHOICES = 100  # values of a decision
# Options of a vector environment that are none of the swarms in it.
OF_VECTORS = ("device", "precision", "render_mode", "max_episode_steps")


def make_vec(
    optimizer: str = "firefly",
    num_envs: int = 64,
    *,
    base: str | Controller | None = None,
    seed: int | None = None,
    num_threads: int | None = None,
    choices: Sequence[int] | None = None,
    **options: object,
) -> VecEnv:
    """Return a vector of swarms as a `VecEnv`; `VecMonitor` and `VecNormalize` may wrap it.

    Args:
        optimizer: a name in `swarm_gym.optimizers.OPTIMIZERS`.
        num_envs: number of swarms.
        base: controller, or name of one such as "open-loop:three-cases", whose decisions actions correct;
            None for actions that are decisions. A policy whose output is zero then is the base.
        seed: seed of the first swarm's first episode, from which the other swarms' seeds count up.
        num_threads: number of threads that the swarms are spread over; None takes all that Numba has.
        choices: number of evenly spaced values of each decision, for learners that choose, such as DQN: the
            action is then the number of one of all combinations. None is no choice.
        options: options of `SwarmVectorEnv`, such as `device`, of `swarm_gym.settings.Settings` and
            parameters of the optimizer, by name. Those that are not given are chosen for learners, see
            `swarm_gym.learner_options`.

    Raises:
        UnknownNameError: for an option, optimizer, scenario, layout or reward that does not exist.
        SettingError: for a value that an option cannot have.
    """
    of_swarms = {name: value for name, value in options.items() if name not in OF_VECTORS}
    if base is not None:
        controller = make_controller_for(optimizer, base, options) if isinstance(base, str) else base
        of_swarms = _completed_for(controller, of_swarms)
    chosen: dict[str, Any] = {**options, **learner_options(optimizer, **of_swarms)}
    if base is not None and "action" not in options:
        chosen["action"] = FOR_CORRECTIONS.get(controller.action, chosen["action"])
    warn_of_unscaled(chosen)
    mode = AutoresetMode.SAME_STEP
    env = SwarmVectorEnv(
        num_envs, optimizer, base=base, autoreset_mode=mode, num_threads=num_threads, **chosen
    )
    made = NativeVecEnv(env)
    made.seed(seed)
    _sign(made.action_space, optimizer, env.settings, base)
    return made if choices is None else ChoiceVecEnv(made, _combinations(choices, made.action_space))


def _completed_for(base: Controller, given: Mapping[str, object]) -> dict[str, object]:
    """Return given options and those that a base needs, so that defaults for learners replace neither."""
    options = completed(base, given)
    if not set(SOURCE_OPTIONS) & set(options):
        options["source"] = UNIFORM
    return options


def _combinations(numbers: Sequence[int], space: Any) -> NDArray[np.float32]:
    """Return all actions with so many evenly spaced values of each decision, (n, k).

    Raises:
        SettingError: for a layout that is not scaled, or numbers that do not fit it.
    """
    if not (space.low == -1.0).all() or not (space.high == 1.0).all():
        raise SettingError("choices need an action layout that is scaled to [-1, 1], such as 'centred'")
    if len(numbers) != space.shape[0]:
        raise SettingError(f"choices needs {space.shape[0]} numbers, one for each decision, got {numbers!r}")
    for number in numbers:
        require_integer("choices", number, 2, MOST_CHOICES)
    return make_choices(*(tuple(np.linspace(-1.0, 1.0, number).tolist()) for number in numbers))


def make_choices(*numbers: tuple[float, ...]) -> NDArray[np.float32]:
    """Return all actions with one of these numbers for each of k decisions, scaled to [-1, 1]: (n, k)."""
    return np.array(list(product(*numbers)), dtype=np.float32)


def _sign(space: Any, optimizer: str, settings: Settings, base: str | Controller | None) -> None:
    """Write into an action space what it stands for; models of the library store it in their zip as text."""
    sizes = "initial_population_size", "min_population_size", "max_population_size", "max_evaluations"
    names = {"optimizer": optimizer, "observation": settings.observation, "action": settings.action}
    corrected = "none" if base is None else base if isinstance(base, str) else shown(base)
    numbers = {name: getattr(settings, name) for name in sizes}
    source = None if settings.source == UNIFORM else asdict(settings.new_members)
    setattr(space, SIGNATURE, {**names, "base": corrected, **numbers, "first_source": source})


class NativeVecEnv(VecEnv):
    """A native vector of swarms as stable-baselines3 takes it.

    The info of an episode that ended has its sum of rewards, its length, its last observation, the best
    fitness and the evaluations. Where the optimum is known, it has the optimality gap, empty for an episode
    under way. `reset_infos` has the infos with which the episodes under way began.

    Args:
        env: environment with the autoreset mode of this class, `SAME_STEP`.
        observation_space: space of the policy's observations; None for the environment's space.

    Raises:
        ValueError: if the environment has another autoreset mode.
    """

    autoreset_mode = AutoresetMode.SAME_STEP

    def __init__(self, env: VectorEnv, observation_space: Space | None = None):
        if (given := env.metadata.get("autoreset_mode")) != self.autoreset_mode:
            raise ValueError(f"expected autoreset mode {self.autoreset_mode.name}, got {given}")
        self.env = env
        self.render_mode = None
        space: Any = env.single_observation_space if observation_space is None else observation_space
        super().__init__(env.num_envs, space, env.single_action_space)
        self._actions = np.empty(0)
        self._began: list[Mapping[str, Any]] = [{}] * env.num_envs  # infos of the whole vector, by swarm
        self._returns = np.zeros(env.num_envs)
        self._lengths = np.zeros(env.num_envs, dtype=np.int64)

    def reset(self) -> NDArray:
        """Begin new episodes of all swarms, with what was given to `seed` and `set_options`, if anything."""
        observations: Any = None
        seeds: Any = self._seeds
        for options, rows in self._alike():
            # A mask that is true everywhere would say the same as none.
            mask = {} if rows.all() else {"reset_mask": rows}
            observations, infos = self.env.reset(seed=seeds, options={**options, **mask})
            for row in np.flatnonzero(rows):
                self._began[row] = infos
        self._reset_seeds()
        self._reset_options()
        self._returns[:] = 0.0
        self._lengths[:] = 0
        return as_numpy(observations)

    def set_options(self, options: Sequence[dict] | dict | None = None) -> None:
        """Keep options of `SwarmVectorEnv.reset` for the next `reset`: for all swarms, or for each one.

        Raises:
            UnknownNameError: for an option or scenario that does not exist.
            SettingError: for a value that an option cannot have, or another number of mappings.
        """
        given = {} if options is None else options
        by_swarm = [given] * self.num_envs if isinstance(given, Mapping) else given
        if isinstance(by_swarm, Sequence):
            by_swarm = [{} if one is None else one for one in by_swarm]
        if not isinstance(by_swarm, Sequence) or len(by_swarm) != self.num_envs:
            raise SettingError(
                f"options must be a mapping, or a list of {self.num_envs}, one for each swarm, "
                f"got {shown(options)}"
            )
        simulation: Any = self.env.unwrapped.simulation  # type: ignore[attr-defined]
        for one in {id(each): each for each in by_swarm}.values():
            simulation.read_options(one)
        super().set_options(list(by_swarm))

    @property
    def reset_infos(self) -> list[dict[str, object]]:
        """The infos, by swarm, with which the episodes under way began."""
        return [_info_of(row, infos) for row, infos in enumerate(self._began)]

    @reset_infos.setter
    def reset_infos(self, infos: list[dict[str, object]]) -> None:
        pass  # `VecEnv` begins with empty ones

    def step_async(self, actions: NDArray) -> None:
        """Keep the actions for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[NDArray, NDArray, NDArray, list[dict[str, object]]]:
        """Advance all swarms; infos of ended episodes have `episode` and `terminal_observation`."""
        *found, infos = self.env.step(self._actions)
        observations, rewards, terminated, truncated = map(as_numpy, found)
        dones = terminated | truncated
        rewards = self._rewarded(rewards, dones)
        self._returns += rewards
        self._lengths += 1
        by_env: list[dict[str, object]] = [{} for _ in range(self.num_envs)]
        last: Any = as_numpy(infos["final_obs"]) if dones.any() else None
        for row in np.flatnonzero(dones):
            final = infos["final_info"]
            has_gap = final.get("_optimality_gap")
            self._began[row] = infos
            by_env[row] = self._ended(
                int(row),
                last[row],
                final["best_fitness"][row],
                final["evaluations"][row],
                final["optimality_gap"][row] if has_gap is not None and has_gap[row] else None,
                truncated=bool(truncated[row] and not terminated[row]),
            )
        self._returns[dones] = 0.0
        self._lengths[dones] = 0
        return observations, rewards, dones, by_env

    def close(self) -> None:
        """Close the vector environment."""
        self.env.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[object]:
        """Return an attribute of the whole vector, once per requested swarm."""
        return [getattr(self.env.unwrapped, attr_name)] * len(self._rows(indices))

    def set_attr(self, attr_name: str, value: object, indices: VecEnvIndices = None) -> None:  # noqa: ARG002
        """Raise an error: attributes belong to all swarms at once."""
        raise AttributeError(f"cannot set {attr_name!r} of single swarms in a native vector")

    def env_method(
        self,
        method_name: str,
        *method_args: object,  # noqa: ARG002
        indices: VecEnvIndices = None,  # noqa: ARG002
        **method_kwargs: object,  # noqa: ARG002
    ) -> list[object]:
        """Raise an error: swarms of a native vector have no methods of their own."""
        raise AttributeError(f"cannot call {method_name!r} of single swarms in a native vector")

    def env_is_wrapped(self, wrapper_class: type, indices: VecEnvIndices = None) -> list[bool]:  # noqa: ARG002
        """Return False for every swarm: none is wrapped by itself."""
        return [False] * len(self._rows(indices))

    def _rewarded(self, rewards: NDArray, dones: NDArray) -> NDArray:  # noqa: ARG002
        """Return the rewards (B,) that the learner sees."""
        return rewards

    def _last(self, observation: NDArray) -> NDArray:
        """Return the policy's last observation of an episode."""
        return observation

    def _ended(
        self,
        row: int,
        last: NDArray,
        best_fitness: float,
        evaluations: int,
        optimality_gap: float | None = None,
        *,
        truncated: bool = False,
    ) -> dict[str, object]:
        """Return the info of an episode that ended with an observation, of the swarm in that row."""
        return {
            "terminal_observation": self._last(last),
            "TimeLimit.truncated": truncated,
            "episode": {"r": float(self._returns[row]), "l": int(self._lengths[row]), "t": 0.0},
            "best_fitness": float(best_fitness),
            "evaluations": int(evaluations),
            **({} if optimality_gap is None else {"optimality_gap": float(optimality_gap)}),
        }

    def _rows(self, indices: VecEnvIndices) -> list[int]:
        return list(self._get_indices(indices))

    def _alike(self) -> Iterator[tuple[dict[str, Any], NDArray[np.bool_]]]:
        """Yield the options for the next `reset`, each with the (B,) swarms that have them."""
        left = np.ones(self.num_envs, dtype=np.bool_)
        while left.any():
            options = self._options[int(np.argmax(left))]
            rows = left & [_equal(options, other) for other in self._options]
            yield options, rows
            left &= ~rows


class ChoiceVecEnv(VecEnvWrapper):
    """Swarms in which an action is the number of a row of `choices`, for learners that choose.

    Args:
        env: environment whose actions have k numbers.
        choices: (n, k) the actions that can be chosen.
    """

    def __init__(self, env: VecEnv, choices: NDArray):
        super().__init__(env, action_space=Discrete(len(choices)))
        self.choices = choices

    @property
    def reset_infos(self) -> list[dict[str, object]]:
        """The infos, by swarm, with which the episodes under way began."""
        return self.venv.reset_infos

    @reset_infos.setter
    def reset_infos(self, infos: list[dict[str, object]]) -> None:
        pass  # `VecEnv` begins with empty ones

    def reset(self) -> NDArray:
        """Begin new episodes of all swarms."""
        return self.venv.reset()  # type: ignore[return-value]

    def step_async(self, actions: NDArray) -> None:
        """Keep the chosen actions for `step_wait`, given their numbers (B,).

        Raises:
            ActionError: if an action is not the number of a choice.
        """
        numbers = np.asarray(actions)
        if numbers.dtype.kind not in "iu" or ((numbers < 0) | (numbers >= len(self.choices))).any():
            raise ActionError(
                f"actions must be numbers of choices, 0 to {len(self.choices) - 1}, got {actions}"
            )
        self.venv.step_async(self.choices[numbers])

    def step_wait(self) -> VecEnvStepReturn:
        """Advance all swarms."""
        return self.venv.step_wait()


def _equal(options: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Return whether two sets of reset options, which may hold arrays, say the same."""
    return options.keys() == other.keys() and all(
        np.array_equal(value, other[name]) for name, value in options.items()
    )


def _info_of(row: int, infos: Mapping[str, Any]) -> dict[str, object]:
    """Return the info of one swarm from the infos of a vector, without what belongs to the episode before."""
    names = [name for name in infos if not name.startswith(("_", "final_"))]
    return {name: as_numpy(infos[name])[row] for name in names if as_numpy(infos[f"_{name}"])[row]}
