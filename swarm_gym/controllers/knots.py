"""Knots: the decisions of an open loop at a few iterations, as a file of an open loop states them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from typing import NotRequired, Self, TypedDict, cast

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import require_number
from swarm_gym.compiler.elementary import exp, interpolate, log
from swarm_gym.errors import shown
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.own_code import refuse_unless_given
from swarm_gym.sources import SOURCE_DECISIONS, SOURCE_RANGES, Source

Floats = NDArray[np.float64]
# A function to the scale on which a decision is interpolated, and its inverse.
_Scale = tuple[Callable[[Floats], Floats], Callable[[Floats], Floats]]

SIZE, DEGREE = "population size", "repair degree"  # names of the decisions that every open loop has
# Far beyond the length of an episode; an open loop has a row for each iteration up to the last knot.
MAX_KNOT = 10**5

_LOGARITHM: _Scale = (log, exp)
_ROOT: _Scale = (np.sqrt, np.square)
_AS_IT_IS: _Scale = (np.asarray, np.asarray)
_SCALES = {"smooth_share": _AS_IT_IS, "amplitude": _LOGARITHM, "immigrants": _ROOT}


class KnotsContent(TypedDict):
    """The entries of a file that knots are read from."""

    initial_population_size: int
    knots: list[int]
    sizes: list[float]
    repair_degrees: list[float]
    knobs: dict[str, Sequence[float]]
    optimizer: NotRequired[str]
    sources: NotRequired[dict[str, list[float]]]
    first_source: NotRequired[dict[str, float]]


@dataclass(frozen=True)
class Knots:
    """Decisions at a few iterations, the knots.

    Attributes:
        initial_population_size: PS(0); the decision at the first knot is the size of iteration 1.
        iterations: iterations of the knots in increasing order, the first one 0.
        sizes: population size at each knot.
        repair_degrees: phi at each knot, in [0, 1].
        knobs: parameters of the optimizer at each knot by name, in the order of the extended action.
        sources: decisions on new members at each knot by name, in the order of `SOURCE_DECISIONS`; without
            them, the environment's source never changes.
        first_source: source of the first population; None is the environment's own.
        optimizer: optimizer whose parameters `knobs` has.

    Raises:
        ValueError: for decisions that no open loop can have; the message has the value.
    """

    initial_population_size: int
    iterations: Sequence[int]
    sizes: Sequence[float]
    repair_degrees: Sequence[float]
    knobs: Mapping[str, Sequence[float]] = field(default_factory=dict)
    sources: Mapping[str, Sequence[float]] = field(default_factory=dict)
    first_source: Source | None = None
    optimizer: str = "firefly"

    def __post_init__(self) -> None:
        if not isinstance(self.knobs, Mapping):
            raise ValueError(f"open loop: knobs must have a list for each name, got {shown(self.knobs)}")
        self._check_iterations()
        if not all(0 < value < np.inf for column in (self.sizes, *self.knobs.values()) for value in column):
            raise ValueError("open loop: sizes and parameters must be positive and finite")
        if not all(0 <= degree <= 1 for degree in self.repair_degrees):
            raise ValueError(f"open loop: phi must lie in [0, 1], got {shown(self.repair_degrees)}")
        if self.knobs or self.sources:
            self._check_knobs()
        if self.sources:
            self._check_sources()
        if not isinstance(self.initial_population_size, int | np.integer):
            raise ValueError(
                "open loop: initial_population_size must be an integer, got "
                f"{shown(self.initial_population_size)}"
            )

    @classmethod
    def read(cls, file: Mapping[str, object]) -> Self:
        """Return the knots in the content of a file.

        Raises:
            OwnCodeError: if it names an optimizer of own code.
            KeyError, TypeError, ValueError: if it lacks an entry, or an entry is invalid.
        """
        content = cast(KnotsContent, file)  # as the class and the functions below check
        if (optimizer := content.get("optimizer", cls.optimizer)) not in OPTIMIZERS:
            refuse_unless_given("optimizer", optimizer, "optimizer")
        return cls(
            content["initial_population_size"],
            content["knots"],
            content["sizes"],
            content["repair_degrees"],
            content["knobs"],
            _lists_by_name(content["sources"]) if "sources" in content else {},
            Source.of(content["first_source"]) if "first_source" in content else None,
            optimizer,
        )

    def content(self) -> KnotsContent:
        """Return the entries that `read` reads."""
        content: KnotsContent = {
            "optimizer": self.optimizer,
            "initial_population_size": self.initial_population_size,
            "knots": list(self.iterations),
            "sizes": list(self.sizes),
            "repair_degrees": list(self.repair_degrees),
            "knobs": dict(self.knobs),
        }
        if self.sources:
            content["sources"] = {name: list(column) for name, column in self.sources.items()}
        if self.first_source:
            content["first_source"] = asdict(self.first_source)
        return content

    @property
    def action(self) -> str:
        """Action layout of the decisions."""
        return "sourced" if self.sources else "extended" if self.knobs else "natural"

    @property
    def columns(self) -> dict[str, Sequence[float]]:
        """All decisions at each knot by name, in the order of an action."""
        return {SIZE: self.sizes, DEGREE: self.repair_degrees, **self.knobs, **self.sources}

    def between(self) -> Floats:
        """Return the decisions at every iteration up to the last knot, (iterations, number of decisions).

        Values are clipped to the values at the knots. Without this, exp(log(x)) may be the next number after
        x, and x may be the bound of an action.
        """
        scales = [_LOGARITHM, _ROOT, *(_LOGARITHM for _ in self.knobs), *(_SCALES[n] for n in self.sources)]
        iterations = np.arange(self.iterations[-1] + 1)
        found = []
        for column, (scale, back) in zip(self.columns.values(), scales, strict=True):
            there = scale(np.asarray(column, dtype=np.float64))
            found.append(
                np.clip(back(interpolate(iterations, self.iterations, there)), min(column), max(column))
            )
        return np.stack(found, axis=1)

    def _check_iterations(self) -> None:
        """Raise an error for iterations that do not increase from 0, or do not fit the decisions."""
        knots = self.iterations
        columns = self.sizes, self.repair_degrees, *self.knobs.values(), *self.sources.values()
        lengths = [len(column) for column in columns]
        if any(length != len(knots) for length in lengths):
            raise ValueError(f"open loop: {len(knots)} knots, but {lengths} values")
        whole = all(isinstance(knot, int | np.integer) for knot in knots)
        if not whole or len(knots) < 1 or knots[0] != 0 or any(b <= a for a, b in pairwise(knots)):
            raise ValueError(
                f"open loop: knots must be integers, begin with 0 and increase, got {shown(knots)}"
            )
        if knots[-1] > MAX_KNOT:
            raise ValueError(f"open loop: knots go up to {MAX_KNOT}, got {knots[-1]}")

    def _check_knobs(self) -> None:
        """Raise an error for parameters that the action lacks, in another order or outside their ranges."""
        declared = get_optimizer(self.optimizer).decided_parameters()
        decided = {name: parameter.decided for name, parameter in declared.items()}
        if list(self.knobs) != list(decided):
            raise ValueError(
                f"open loop: further decisions of {self.optimizer!r} are {', '.join(decided)}, in this "
                f"order; got {', '.join(self.knobs) or 'none'}"
            )
        for name, span in decided.items():
            low, high = span or (0.0, 0.0)
            if not all(low <= value <= high for value in self.knobs[name]):
                raise ValueError(f"open loop: {name} must lie in [{low:g}, {high:g}], got {self.knobs[name]}")

    def _check_sources(self) -> None:
        """Raise an error for decisions on new members that a sourced action cannot have."""
        if tuple(self.sources) != SOURCE_DECISIONS:
            raise ValueError(
                f"open loop: decisions on new members are {', '.join(SOURCE_DECISIONS)}, in this order; got "
                f"{', '.join(self.sources)}"
            )
        for name, column in self.sources.items():
            for value in column:
                require_number(f"open loop: {name}", value, *SOURCE_RANGES[name])


def _lists_by_name(sources: object) -> Mapping[str, list[float]]:
    """Return the decisions on new members of a file, which have to be lists by name."""
    if not isinstance(sources, dict) or not sources:
        raise ValueError(f"sources must have {', '.join(SOURCE_DECISIONS)}, got {shown(sources)}")
    for name, column in sources.items():
        if not isinstance(column, list):
            raise ValueError(f"{name} must be a list with a number for each knot, got {shown(column)}")
    return sources
