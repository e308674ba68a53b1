"""What an optimizer offers to the simulation that drives it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import look_up, require_number
from swarm_gym.optimizers import loop
from swarm_gym.population import Swarms
from swarm_gym.problem.tables import Table
from swarm_gym.threads import spread


@dataclass(frozen=True)
class Knob:
    """A numeric parameter of an optimizer, or one that takes one of several names: see `choice`.

    Attributes:
        default: its value where nothing else is said.
        low: the least value it may take.
        high: the largest.
        symbol: the paper's letter.
        meaning: what it is, with its unit.
        decided: the range, both positive, that an extended action decides within at every iteration; None
            leaves the parameter as it is through an episode.
        choices: the names that it takes; kernels, and the record of an episode, have the index instead.
    """

    default: float
    low: float
    high: float
    symbol: str
    meaning: str
    decided: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()

    def number(self, name: str, value: object) -> float:
        """The value as kernels know it.

        Args:
            name: of the parameter, for messages.
            value: a number, or one of the choices.

        Raises:
            SettingError: if it is not a number in the range.
            UnknownNameError: if it is none of the choices.
        """
        if self.choices:
            return float(look_up(name, value, {choice: k for k, choice in enumerate(self.choices)}))
        require_number(name, value, self.low, self.high)
        return float(value)  # type: ignore[arg-type]


def choice(meaning: str, *choices: str) -> Knob:
    """A parameter that takes one of these names, the first where nothing else is said."""
    return Knob(0.0, 0.0, len(choices) - 1.0, "", meaning, choices=choices)


class Optimizer:
    """Names, parameters and kernels of an optimizer, and the calls that advance swarms by them.

    All arrays have a leading swarm axis of length B. All calls change `swarms` in place, and leave
    E(P), mean and standard deviation of the collision and the feasible share in `swarms.summary`.

    Attributes:
        name: what it is registered as.
        knobs: its parameters, by name.
        smallest_population: the least size that it can work with.
        encodings: names of `Settings.encoding` that it can work with; the first is its default.
        adopts: whether it can begin with a given population.
        is_on_its_way: whether its first member is a robot that goes while it looks for the way.
        rules: what stands for its kernels in `driver`.
        kernels: what it does to a swarm.
    """

    name: ClassVar[str]
    knobs: ClassVar[dict[str, Knob]]
    smallest_population: ClassVar[int] = 1
    encodings: ClassVar[tuple[str, ...]] = ("waypoints", "bezier")
    adopts: ClassVar[bool] = True
    is_on_its_way: ClassVar[bool] = False
    rules: ClassVar[type]
    kernels: ClassVar[loop.Kernels]

    def __init_subclass__(cls) -> None:
        loop.enter(cls.rules, cls.kernels)

    @classmethod
    def initialise(
        cls,
        swarms: Swarms,
        tables: Table,
        chosen: NDArray[np.bool_],
        sizes: NDArray[np.int64],
        mean_weight: float,
        given: bool = False,
        knobs: NDArray[np.float64] | None = None,
    ) -> None:
        """Begin the chosen swarms with first populations of these sizes, (B,).

        They are drawn, or taken from the first rows of the positions where these are `given`. Parameters
        are the defaults where there are no `knobs`, (B, number of knobs).
        """
        if knobs is None:
            knobs = np.tile(cls.knob_values({}), (len(sizes), 1))
        loop.begin_chosen(cls.rules(), swarms, tables, chosen, sizes, knobs, given, mean_weight)

    @classmethod
    def step(
        cls,
        swarms: Swarms,
        tables: Table,
        chosen: NDArray[np.bool_],
        sizes: NDArray[np.int64],
        repair_degrees: NDArray[np.float64],
        knobs: NDArray[np.float64],
        mean_weight: float,
        num_threads: int = 1,
    ) -> None:
        """Resize the chosen swarms and advance them by one iteration.

        Args:
            swarms: the state.
            tables: stacked problems.
            chosen: (B,) which swarms take part.
            sizes: (B,) population sizes of this iteration.
            repair_degrees: (B,) phi in [0, 1]; 0 is no repair.
            knobs: (B, number of knobs) parameters in the order of `knobs`.
            mean_weight: k of eq. 7.
            num_threads: that the swarms are spread over; nothing else depends on it.
        """

        def run(part: NDArray[np.bool_]) -> None:
            loop.step_chosen(cls.rules(), swarms, tables, part, sizes, repair_degrees, knobs, mean_weight)

        spread(run, chosen, num_threads)

    @classmethod
    def re_evaluate(
        cls,
        swarms: Swarms,
        tables: Table,
        chosen: NDArray[np.bool_],
        mean_weight: float,
        num_threads: int = 1,
    ) -> None:
        """Evaluate anew what the chosen swarms remember, since their problems have changed.

        Members come first, in order; those that the budget does not suffice for are deleted, of which there
        must be one evaluation left. The best so far stays only if it still is the best.
        """

        def run(part: NDArray[np.bool_]) -> None:
            loop.re_evaluate_chosen(cls.rules(), swarms, tables, part, mean_weight)

        spread(run, chosen, num_threads)

    @staticmethod
    def decision_vectors(swarms: Swarms, row: int, dimension: int) -> list[NDArray[np.float64]]:
        """All decision vectors that a swarm remembers, as views (m, dimension); the first are its members."""
        size = swarms.size[row]
        return [swarms.positions[row, :size, :dimension], swarms.best_position[row : row + 1, :dimension]]

    @staticmethod
    def memory_columns(dimension: int) -> int:  # noqa: ARG004
        """K, how many numbers are remembered of each member, of decision vectors of that length."""
        return 0

    @staticmethod
    def num_registers(capacity: int) -> int:  # noqa: ARG004
        """R, how many integers are remembered of a swarm of up to so many members."""
        return 0

    @staticmethod
    def walk_points(tables: Table, iterations: int) -> int:  # noqa: ARG004
        """L, of how many points the longest walk is that is remembered, in episodes on these problems."""
        return 0

    @staticmethod
    def field_size(tables: Table) -> int:  # noqa: ARG004
        """F, how many numbers are remembered of the places of the largest of these maps."""
        return 0

    @staticmethod
    def affordable_size(evaluations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Real-valued population sizes, (B,), whose iterations take about that many evaluations, (B,)."""
        return evaluations

    @classmethod
    def decided_knobs(cls) -> dict[int, Knob]:
        """The parameters that extended actions decide, by their place in `knobs`."""
        return {place: knob for place, knob in enumerate(cls.knobs.values()) if knob.decided is not None}

    @classmethod
    def knob_values(cls, chosen: Mapping[str, float | str]) -> NDArray[np.float64]:
        """Parameters in order, the chosen ones in place of their defaults, names as their indices.

        Raises:
            SettingError: if a value is not a number in its range.
            UnknownNameError: if it is none of the parameter's choices.
        """
        values = [
            knob.number(name, chosen[name]) if name in chosen else knob.default
            for name, knob in cls.knobs.items()
        ]
        return np.array(values)
