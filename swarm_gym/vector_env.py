"""The environment of many swarms, for `gymnasium.make_vec`; all advance in one compiled call."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from swarm_gym.arrays import AnyArray, as_numpy, copy_of
from swarm_gym.batch import SOMETIMES, is_there
from swarm_gym.controllers import Controller
from swarm_gym.corrected_batch import CorrectedBatch, make_batch
from swarm_gym.episode_seeds import EpisodeSeeds, read_seeds
from swarm_gym.errors import SettingError, UnknownNameError, shown
from swarm_gym.object_arrays import ObjectArray, let_wrappers_keep_objects
from swarm_gym.settings import Settings
from swarm_gym.simulation import Simulation

Flags = NDArray[np.bool_]

# What `info` holds, by name; `final_info` is a dictionary of its own.
Infos: TypeAlias = "dict[str, NDArray | Infos]"

DEVICES = ("cpu", "cuda")
PRECISIONS = ("float64", "float32")


class SwarmVectorEnv(VectorEnv[NDArray, NDArray, NDArray]):
    """A vector of `num_envs` swarms; swarm i equals a `SwarmEnv` with seed + i, bit for bit.

    With a base that draws random numbers, such as `random`, this holds until the first episode of a swarm
    ends: the base goes on with its numbers for all swarms.

    Spaces, rewards, endings and options are as in `swarm_gym.env.SwarmEnv`. The conventions follow
    `gymnasium.vector.SyncVectorEnv`: infos with `_key` masks, `final_obs` and `final_info`, and
    `options["reset_mask"]`.

        envs = gymnasium.make_vec("swarm_gym/Firefly-v0", num_envs=64, scenario="random-fields:train:0-511")
        observations, infos = envs.reset(seed=0)
        observations, rewards, terminated, truncated, infos = envs.step(envs.action_space.sample())

    Names of scenarios and `final_obs` are arrays of objects, which Gymnasium's wrappers for other array
    libraries keep, see `swarm_gym.object_arrays`.

    On the device "cuda", swarms live on a GPU. Observations, rewards and flags are tensors of torch there,
    and so may actions be. Infos of a step are numbers only, in tensors, too; paths are in `final_info` alone.
    `final_obs` is one tensor with a row for each swarm.

    Args:
        num_envs: number of swarms B.
        optimizer: a name in `swarm_gym.optimizers.OPTIMIZERS`.
        base: controller, or name of one such as "open-loop:three-cases", whose decisions actions correct, see
            `swarm_gym.corrected_batch`; None for actions that are decisions. Not on a GPU.
        autoreset_mode: an `AutoresetMode` or its value; it decides when a swarm begins the next episode after
            its episode ended.
        num_threads: number of threads that the swarms are spread over; None takes all that Numba has.
        device: "cpu", or "cuda" for a GPU; the extra `gpu` installs what that needs.
        precision: type of the floats that kernels compute with: "float64", or on a GPU also "float32".
        render_mode: must be None; to see a swarm, render a `SwarmEnv` with the same seed.
        max_episode_steps: must be None; the option `iterations` ends an episode.
        options: options of `swarm_gym.settings.Settings` and parameters of the optimizer, by name.

    Raises:
        UnknownNameError: for an option, optimizer, scenario, layout, reward, device, precision or
            autoreset mode that does not exist.
        SettingError: for a value that an option cannot have, or an option that a GPU has no kernels for.
        MissingExtraError: for the device "cuda" where numba-cuda or torch is not installed.
        ScenarioError: for the name of a scenario that is malformed, or whose map is missing.
    """

    def __init__(
        self,
        num_envs: int = 1,
        optimizer: str = "firefly",
        *,
        base: str | Controller | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        num_threads: int | None = None,
        device: str = "cpu",
        precision: str = "float64",
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
        **options: object,
    ):
        if render_mode is not None:
            raise SettingError(
                f"render_mode must be None for a vector of swarms, got {render_mode!r}; "
                "render a single environment with the same seed"
            )
        if max_episode_steps is not None:
            raise SettingError(
                f"max_episode_steps must be None, got {max_episode_steps!r}; use the option iterations"
            )
        try:
            self._autoreset_mode = AutoresetMode(autoreset_mode)
        except ValueError as error:
            modes = [mode.value for mode in AutoresetMode]
            raise UnknownNameError("autoreset mode", autoreset_mode, modes) from error
        simulation_class = _simulation_on(device, precision)
        self._made_from = {
            **options,
            "optimizer": optimizer,
            "num_threads": num_threads,
            "device": device,
            "precision": precision,
        }
        self._batch = make_batch(base, optimizer, options, num_envs, num_threads, simulation_class)
        if isinstance(self._batch, CorrectedBatch):
            self._made_from |= self._batch.options
        self.num_envs = num_envs
        self.metadata = {"render_modes": [], "autoreset_mode": self._autoreset_mode}
        self._seeds = EpisodeSeeds(num_envs)
        self._ended: Flags = self.simulation.place(np.zeros(num_envs, dtype=np.bool_))
        self.single_action_space = self._batch.action_space
        self.single_observation_space = self._batch.observation_space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

    @property
    def settings(self) -> Settings:
        """The `Settings` of this environment."""
        return self._batch.settings

    @property
    def simulation(self) -> Simulation:
        """The `Simulation` in this environment: populations, histories and problems."""
        return self._batch.simulation

    @property
    def is_corrected(self) -> bool:
        """True if actions are corrections of a base, so that zeros let it decide."""
        return isinstance(self._batch, CorrectedBatch)

    def twin(self, **changes: object) -> "SwarmVectorEnv":
        """Return another vector of as many swarms, without a base, whose options differ by these changes."""
        options: dict[str, Any] = {**self._made_from, **changes}
        return SwarmVectorEnv(self.num_envs, autoreset_mode=self._autoreset_mode, **options)

    def reset(
        self,
        *,
        seed: int | list[int | None] | None = None,
        options: dict[str, object] | None = None,
    ) -> tuple[NDArray, Infos]:
        """Begin episodes in all swarms, or in the swarms of the boolean array `options["reset_mask"]`.

        Args:
            seed: seed of the first swarm, from which the other swarms' seeds count up; or a list with one
                seed per swarm, where None keeps the swarm's random generator.
            options: options of `SwarmEnv.reset`, for all swarms, and `reset_mask`, bool of shape (B,).

        Returns:
            Observations, shape (B, k), and infos.

        Raises:
            UnknownNameError: for an option or scenario that does not exist.
            SettingError: for a value that an option cannot have, or malformed seeds.
            gymnasium.error.Error: for a seed that is not a natural number.
        """
        mask = None
        if isinstance(options, Mapping):
            mask, options = options.get("reset_mask"), {k: v for k, v in options.items() if k != "reset_mask"}
        chosen = self._read_mask(mask)
        let_wrappers_keep_objects()
        self.begin(chosen, seed, options)
        return self._batch.observe(), self.infos(chosen)

    def begin(
        self, chosen: Flags, seed: int | list[int | None] | None, options: Mapping[str, object] | None
    ) -> None:
        """Do what `reset` does in the swarms of the (B,) flags, without observations and infos."""
        self._batch.simulation.read_options(options)
        rows = np.flatnonzero(as_numpy(chosen))
        first = None
        if seed is not None:
            seeds = read_seeds(seed, self.num_envs)
            self._seeds.begin({row: one for row in rows.tolist() if (one := seeds[row]) is not None})
            first = seeds[0]
        if isinstance(self._batch, CorrectedBatch) and chosen.all():
            self._batch.reset_base(first)
        self._batch.reset(chosen, self._seeds.next_of(rows), options)
        self._ended &= self.simulation.place(~chosen)

    def observe(self) -> NDArray:
        """Return the observations of all swarms, (B, k), a new array."""
        return self._batch.observe()

    def step(self, actions: AnyArray) -> tuple[NDArray, NDArray, NDArray, NDArray, Infos]:
        """Advance every swarm by one iteration; swarms whose episode has ended follow the autoreset mode.

        Args:
            actions: one action per swarm, shape (B, number of decisions).

        Returns:
            Observations (B, k), rewards (B,), which episodes have terminated (B,), False for truncated (B,),
            and infos.

        Raises:
            ActionError: if an action is not in the action space.
            StepOrderError: before the first `reset`, or after the end of an episode without autoreset.
        """
        next_step = self._autoreset_mode == AutoresetMode.NEXT_STEP
        nobody = self._ended & False
        restarting = copy_of(self.simulation.xp, self._ended) if next_step else nobody
        rewards, terminated = self._batch.step(~restarting, actions)
        infos: Infos = {}
        if self._autoreset_mode == AutoresetMode.SAME_STEP and terminated.any():
            restarting = terminated
            infos = self.final_infos(terminated)
        if restarting.any():
            rows = np.flatnonzero(as_numpy(restarting))
            self._batch.reset(as_numpy(restarting), self._seeds.next_of(rows), None)
        self._ended = ~self.simulation.running
        infos = {**self.infos(np.ones(self.num_envs, dtype=np.bool_)), **infos}
        return self._batch.observe(), rewards, terminated, nobody, infos

    def final_infos(self, terminated: Flags) -> Infos:
        """Return the infos and observations of these swarms, (B,), before they begin their next episodes."""
        final, rows = self._batch.observe_last(), as_numpy(terminated).copy()
        if isinstance(final, np.ndarray):
            by_swarm = np.full(self.num_envs, None, dtype=object).view(ObjectArray)
            for row in np.flatnonzero(rows):
                by_swarm[row] = final[row].copy()
            final = by_swarm
        return {
            "final_obs": final,
            "_final_obs": rows.copy(),
            "final_info": self._whole_infos(rows),
            "_final_info": rows.copy(),
        }

    def step_running(self, actions: AnyArray, chosen: Flags | None = None) -> tuple[NDArray, NDArray, Flags]:
        """Advance the swarms whose episode is under way, so that whole episodes run side by side.

        Args:
            actions: one action per swarm, shape (B, number of decisions); actions of resting swarms are not
                read.
            chosen: (B,) swarms to advance if their episode is under way, an array of NumPy or of the
                simulation; None chooses all.

        Returns:
            Observations (B, k), rewards (B,), 0 for resting swarms, and which episodes have ended so far
            (B,).

        Raises:
            ActionError: if the action of a running swarm is not in the action space.
            SettingError: if `chosen` has not one flag for each swarm.
            StepOrderError: if a swarm was never reset.
        """
        stepping = ~self._ended
        if chosen is not None:
            is_flags = not isinstance(chosen, np.ndarray) or chosen.dtype == np.bool_
            if tuple(np.shape(chosen)) != (self.num_envs,) or not is_flags:
                raise SettingError(f"chosen must be {self.num_envs} booleans, got {shown(chosen)}")
            stepping &= self.simulation.place(chosen) if isinstance(chosen, np.ndarray) else chosen
        rewards, terminated = self._batch.step(stepping, actions)
        self._ended |= terminated
        return self._batch.observe(), rewards, copy_of(self.simulation.xp, self._ended)

    def copy_swarms(self, rows: "AnyArray | Sequence[int]") -> NDArray:
        """Make swarm i, for every i, a copy of swarm rows[i], to continue differently from the same state.

        Copies develop identically, down to their random numbers, as long as their actions are identical. The
        random generators of later episodes are not copied.

        Args:
            rows: (B,) numbers of the swarms to copy.

        Returns:
            Observations, shape (B, k).

        Raises:
            SettingError: for anything else than B numbers of swarms.
        """
        rows = self._read_rows(rows)
        self._batch.copy_rows(rows)
        self._ended = self._ended[self.simulation.place(rows)]
        return self._batch.observe()

    def infos(self, rows: Flags) -> Infos:
        """Return the infos of these swarms, on a GPU only those that are numbers of its memory."""
        if self.simulation.xp is np:
            return self._whole_infos(rows)
        there = self.simulation.place(rows)
        infos: Infos = {}
        for name, values in self._batch.numbers().items():
            infos[name], infos[f"_{name}"] = values, there
        return infos

    def _whole_infos(self, rows: Flags) -> Infos:
        """Return the infos of these swarms; entries of the others are zero or None, and masked."""
        infos: Infos = {}
        everyone = bool(rows.all())
        for name, values in self._batch.info(rows).items():
            if everyone and name not in SOMETIMES:
                infos[name], infos[f"_{name}"] = values, rows.copy()
                continue
            there = rows & is_there(values) if name in SOMETIMES else rows
            if there.all():  # arrays of infos are new ones, see `SwarmBatch.info`
                infos[name], infos[f"_{name}"] = values, there
            elif there.any():
                blank = np.zeros_like(values) if values.dtype != object else np.full_like(values, None)
                blank[there] = values[there]
                infos[name] = blank
                infos[f"_{name}"] = there.copy()
        return infos

    def _read_mask(self, mask: object) -> Flags:
        if mask is None:
            return np.ones(self.num_envs, dtype=np.bool_)
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
            raise SettingError(f"reset_mask must be a boolean NumPy array, got {shown(mask)}")
        if mask.shape != (self.num_envs,) or not mask.any():
            raise SettingError(f"reset_mask must have shape ({self.num_envs},) and a true value, got {mask}")
        return mask

    def _read_rows(self, rows: "AnyArray | Sequence[int]") -> NDArray[np.int64]:
        given = np.asarray(rows) if isinstance(rows, Sequence) else as_numpy(rows)
        valid = given.shape == (self.num_envs,) and given.dtype.kind in "iu"
        if not valid or given.min() < 0 or given.max() >= self.num_envs:
            raise SettingError(
                f"rows must be {self.num_envs} numbers of swarms from 0 to {self.num_envs - 1}, got "
                f"{shown(rows)}"
            )
        return given.astype(np.int64)


def _simulation_on(device: str, precision: str) -> type[Simulation]:
    """Return the class of simulations on a device, with kernels of a precision."""
    if device not in DEVICES:
        raise UnknownNameError("device", device, DEVICES)
    if precision not in PRECISIONS:
        raise UnknownNameError("precision", precision, PRECISIONS)
    if device == "cpu":
        if precision != "float64":
            raise SettingError(f"precision must be 'float64' on the device 'cpu', got {precision!r}")
        return Simulation
    from swarm_gym.gpu.simulation import DeviceSimulation, SinglePrecisionSimulation

    return DeviceSimulation if precision == "float64" else SinglePrecisionSimulation
