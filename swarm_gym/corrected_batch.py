"""A batch of swarms in which a controller, the base, decides, and actions are corrections of its decisions.

Source: T. Silver et al., "Residual policy learning", arXiv 1812.06298 (2018). Decisions and corrections are
added in an action layout scaled to [-1, 1], as in `swarm_gym.controllers.learned.residual`. A correction of
zero leaves a decision as the base has made it, to the last bit. So the action of zeros is the base.

The base sees its own observation layout. The policy observes its layout and then, in [-1, 1], the decisions
that the base proposes; at the end of an episode these are zeros.
"""

import copy
import dataclasses
from collections import deque
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.action import ACTIONS, Action, make_action
from swarm_gym.batch import Flags, Floats, SwarmBatch
from swarm_gym.controllers import Controller, make_controller, make_controller_for
from swarm_gym.controllers.controller import require_trial
from swarm_gym.controllers.registry import LIMITS, limits_of
from swarm_gym.errors import ActionError, SettingError, shown
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings
from swarm_gym.simulation import Decisions, Simulation
from swarm_gym.sources import GUIDED, SMOOTH

# Options of a base that are not those of the environment: the policy has layouts of its own.
_OF_THE_BASE_ALONE = ("observation", "action", "made_for")
SOURCE_OPTIONS = ("source", "smooth_share", "amplitude")


class CorrectedBatch(SwarmBatch):
    """A batch of B swarms whose actions are corrections of a base.

    Args:
        base: name of a controller, or a controller.
        optimizer: name of the optimizer.
        options: options of `Settings` and parameters of the optimizer. The base's first population, budget,
            price and limits of population sizes are the defaults. `action` is by default the first layout in
            [-1, 1] with the decisions of the base.
        num_swarms: number of swarms B.
        num_threads: number of threads that the swarms are spread over; None takes all that Numba has.
        simulation_class: class of the simulation; its arrays must be NumPy's.

    Attributes:
        base: the controller whose decisions are corrected.

    Raises:
        SettingError: for a base that these episodes or this action layout exclude, or state on a GPU.
        UnknownNameError: if there is no controller of that name.
        ValueError: for an argument that a controller cannot take.
    """

    def __init__(
        self,
        base: str | Controller,
        optimizer: str,
        options: Mapping[str, object],
        num_swarms: int,
        num_threads: int | None = None,
        simulation_class: type[Simulation] = Simulation,
    ):
        self._name = shown(base)
        if simulation_class.xp is not np:
            raise SettingError(
                f"base {self._name} decides in the memory of the host; set device to 'cpu', or train with "
                "the algorithm device-ppo, which corrects a base on a GPU"
            )
        self.base = _controller_of(base, optimizer, options)
        seen = make_observation(self.base.observation)
        chosen = completed(self.base, options)
        if "action" not in options:
            chosen["action"] = _default_layout(self.base, optimizer, chosen)
        # Options of the same swarms without the base, whose action layout is free again.
        self.options = {name: value for name, value in chosen.items() if name != "action" or name in options}
        super().__init__(optimizer, chosen, num_swarms, num_threads, simulation_class, seen.arrival_window)
        self._seen = seen
        space = seen.space(self.simulation)
        self._seen_low, self._seen_high = space.low, space.high
        self._require_fitting_episodes()
        own = dataclasses.replace(self.settings, action=self.base.action, made_for=self.base.made_for)
        self._proposed = make_action(own, get_optimizer(optimizer))
        self._require_same_decisions(optimizer)
        number = len(self._action.labels)
        box = self.observation_space
        ends = (np.concatenate([each, np.full(number, one)]) for each, one in ((box.low, -1), (box.high, 1)))
        low, high = (each.astype(np.float32) for each in ends)
        self.observation_space = Box(low, high, dtype=np.float32)
        self._decided: NDArray = np.zeros((num_swarms, number))  # by the base, in natural units
        self._asked: NDArray = np.zeros(
            (num_swarms, number), dtype=np.float32
        )  # the same in the layout's numbers
        self._stale: Flags = np.ones(num_swarms, dtype=np.bool_)  # swarms whose base has not decided yet
        # The base may have a memory. Where copies of swarms, or swarms that waited, have a wrong one, it sees
        # their observations again: those of an episode are never more than these.
        self._wrong: Flags = np.zeros(num_swarms, dtype=np.bool_)
        self._past: deque[NDArray] = deque(maxlen=self.settings.iterations + 1)
        self._seed: int | None = None

    def reset_base(self, seed: int | None) -> None:
        """Begin the episodes of all swarms for the base, with the seed of the first swarm, if any."""
        if seed is None:
            seed = 0 if self._seed is None else self._seed + len(self._stale)
        self._seed = seed
        self._past.clear()
        self.base.reset(len(self._stale), seed)

    def reset(
        self,
        chosen: Flags,
        seeds: NDArray[np.uint32],
        options: Mapping[str, object] | None,
    ) -> None:
        """Begin episodes in the chosen swarms, see `SwarmBatch.reset`."""
        super().reset(chosen, seeds, options)
        if self._seed is None:
            self.reset_base(None)
        self._stale |= chosen

    def step(self, chosen: Flags, actions: object) -> tuple[Floats, Flags]:
        """Advance the chosen swarms by one iteration; actions are corrections, see `SwarmBatch.step`."""
        found = super().step(chosen, actions)
        self._stale |= chosen
        return found

    def observe(self) -> NDArray:
        """Return the policy's observations of all swarms, (B, k): its layout, and the base's proposals."""
        self._propose()
        running = self.simulation.running[:, None]
        return self._joined(np.where(running, self._asked, 0.0))

    def observe_last(self) -> NDArray:
        """Return the policy's observations (B, k) of episodes that have just ended, without proposals."""
        return self._joined(np.zeros_like(self._asked))

    def copy_rows(self, rows: NDArray[np.int64]) -> None:
        """Make swarm i, for every i, a copy of swarm rows[i], as the base sees it, too."""
        self._propose()
        super().copy_rows(rows)
        self._decided, self._asked, self._stale = self._decided[rows], self._asked[rows], self._stale[rows]
        self._past = deque((seen[rows] for seen in self._past), maxlen=self._past.maxlen)
        self._wrong = self._wrong[rows] | (rows != np.arange(len(rows)))

    def _decide(self, numbers: Floats, chosen: Flags) -> Decisions:
        """Return the decisions of the base plus corrections (B, k)."""
        self._propose()
        corrections = np.where(chosen[:, None], numbers, 0.0)
        # Rounded as those of residual policies are.
        sums = np.clip(self._asked + corrections.astype(self._asked.dtype), -1.0, 1.0)
        corrected = self._action.values(sums.astype(np.float64), self.simulation)
        columns = zip(corrections.T, self._decided.T, corrected, strict=True)
        decided = [np.where(one == 0.0, base, both) for one, base, both in columns]
        return self._action.carry_out(decided, self.simulation)

    def _propose(self) -> None:
        """Let the base decide for the swarms that have changed since it decided last."""
        running = self.simulation.running
        changed = self._stale & running
        if not changed.any():
            return
        actions = self._decisions_on(changed, running & ~changed)
        numbers, valid = self._proposed.read(actions, self.simulation)
        if (wrong := running & ~valid).any():
            try:
                self._proposed.refuse(numbers, wrong)
            except ActionError as error:
                raise ActionError(f"base {self._name}: {error}") from error
        values = np.stack(self._proposed.values(numbers, self.simulation), axis=1)
        decided = self._action.completed(values)
        asked = self._action.encode(decided, self.simulation)
        self._decided = np.where(changed[:, None], decided, self._decided)
        self._asked = np.where(changed[:, None], asked, self._asked)
        self._stale = self._stale & ~running

    def _decisions_on(self, changed: Flags, waiting: Flags) -> NDArray:
        """Return the actions (B, k) of the base for the swarms that have changed, (B,); others wait, (B,)."""
        seen = np.clip(self._seen.observe(self.simulation), self._seen_low, self._seen_high)
        if (self.simulation.iteration[self.simulation.running] == 0).all():
            self._past.clear()  # episodes that begin have no past
            self._wrong[:] = False
        self._past.append(seen)
        if waiting.any():
            # Swarms that wait are not to be seen twice: their past moves by one observation.
            past = list(self._past)
            for before, after in reversed(list(pairwise(past))):
                after[waiting] = before[waiting]
        if not (self._wrong & changed).any():
            self._wrong |= waiting
            return self.base.act(seen)
        assert self._seed is not None
        self._wrong[:] = False
        self.base.reset(len(seen), self._seed)
        return [self.base.act(each) for each in self._past][-1]

    def _joined(self, asked: NDArray) -> NDArray:
        return np.concatenate([super().observe(), asked], axis=1, dtype=np.float32, casting="same_kind")

    def _require_fitting_episodes(self) -> None:
        """Raise an error if the base needs other episodes than the settings describe.

        Raises:
            SettingError: naming the option, its value and the one that the base needs.
        """
        settings, limits = self.settings, self.base.needed_limits
        needed: dict[str, Any] = {"max_evaluations": self.base.max_evaluations, "price": self.base.price}
        if limits is not None:
            needed |= dict(zip(LIMITS, (limits.smallest, limits.largest), strict=True))
        for name, value in needed.items():
            if value is not None and value != getattr(settings, name):
                raise SettingError(
                    f"base {self._name} needs episodes with {name} {value!r}, got "
                    f"{getattr(settings, name)!r}; leave the option out, or choose another base"
                )

    def _require_same_decisions(self, optimizer: str) -> None:
        """Raise an error if the decisions of the base cannot be corrected in the action layout.

        Raises:
            SettingError: naming the base, its decisions and the layouts that have them.
        """
        layout = self._action
        if _corrects(layout, self._proposed.labels):
            return
        valid = _fitting_layouts(self._proposed.labels, self.settings, optimizer)
        raise SettingError(
            f"base {self._name} decides {', '.join(self._proposed.labels)}, which the action layout "
            f"{layout.name!r} ({', '.join(layout.labels)}) cannot correct: corrections need a layout in "
            f"[-1, 1] that is not paced and has all of these; choose one of {', '.join(valid)}"
        )


def make_batch(
    base: str | Controller | None,
    optimizer: str,
    options: Mapping[str, object],
    num_swarms: int,
    num_threads: int | None = None,
    simulation_class: type[Simulation] = Simulation,
) -> SwarmBatch:
    """Return a batch of swarms; with a base, its actions are corrections."""
    if base is None:
        return SwarmBatch(optimizer, options, num_swarms, num_threads, simulation_class)
    return CorrectedBatch(base, optimizer, options, num_swarms, num_threads, simulation_class)


def _corrects(layout: Action, labels: tuple[str, ...]) -> bool:
    """Return whether a layout is in [-1, 1], begins with these decisions and does not depend on a budget."""
    space, paced = layout.space, layout.name.endswith("paced")
    scaled = bool((space.low == -1.0).all() and (space.high == 1.0).all())
    return scaled and not paced and layout.labels[: len(labels)] == labels


def _controller_of(base: object, optimizer: str, options: Mapping[str, object]) -> Controller:
    """Return a controller, given itself or its name, for the population sizes that the swarms may have."""
    if isinstance(base, Controller):
        require_trial(base)
        return copy.deepcopy(base)  # its memory is that of these swarms
    if not isinstance(base, str):
        raise SettingError(
            f"base must be a controller, or the name of one such as 'spsfa-tip' or "
            f"'open-loop:three-cases', got {shown(base)}"
        )
    if set(LIMITS) & set(options):
        return make_controller(base, limits_of(optimizer, options))
    return make_controller_for(optimizer, base)


def completed(base: Controller, options: Mapping[str, object]) -> dict[str, object]:
    """Return the options of an environment with those that a base needs, where they are not given."""
    needed: dict[str, object] = {**base.env_options()}
    for name in _OF_THE_BASE_ALONE:
        needed.pop(name, None)
    # The amplitude of smooth members holds around planned ways, too.
    keeps_amplitude = options.get("source") == GUIDED and needed.get("source") == SMOOTH
    if set(SOURCE_OPTIONS) & set(options) and not keeps_amplitude:
        needed = {name: value for name, value in needed.items() if name not in SOURCE_OPTIONS}
    return {**needed, **options}


def _default_layout(base: Controller, optimizer: str, options: Mapping[str, object]) -> str:
    """Return the first action layout in which the decisions of a base can be corrected."""
    kind = get_optimizer(optimizer)
    settings = Settings.from_options(kind, {**options, "action": base.action})
    labels = make_action(settings, kind).labels
    return _fitting_layouts(labels, settings, optimizer)[0]


def _fitting_layouts(labels: tuple[str, ...], settings: Settings, optimizer: str) -> list[str]:
    """Return the names of the scaled action layouts with these decisions, those with the fewest first."""
    found: list[tuple[int, str]] = []
    for name in ACTIONS:
        try:
            layout = make_action(dataclasses.replace(settings, action=name), get_optimizer(optimizer))
        except SettingError:  # needs a budget, or decides what these swarms do not have
            continue
        if _corrects(layout, labels):
            found.append((len(layout.labels), name))
    return [name for _, name in sorted(found, key=lambda each: each[0])]
