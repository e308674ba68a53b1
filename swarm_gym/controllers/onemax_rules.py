"""Controllers of the (1 + (lambda, lambda)) genetic algorithm on OneMax, which see n and the ones f.

| name | lambda_m | lambda_c | alpha | beta |
|---|---|---|---|---|
| `theory` | sqrt(n / (n - f)) | as many | 1 | 1 |
| `one-fifth:factor=1.5` | divided by the factor after a gain, else times its fourth root | as many | 1 | 1 |
| `symbolic` | 1 up to f = 0.95 n, then as `theory` | 2 times `theory` | 0.001, then 1 | 1 |
| `static:mutants=8,children=32,strength=1.5,bias=1` | constant | constant | constant | constant |
| `optimal:onemax` | what is optimal, see `swarm_gym.reference.onemax.optima` | | | |

Sources: B. Doerr, C. Doerr, F. Ebel, Theoretical Computer Science 567, 2015 (`theory`, `one-fifth`); T.
Nguyen, P. Le, C. Doerr, N. Dang, FOGA 2025 (`symbolic`, from the code that they published).
"""

import math
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.controllers.parameters import Range, parse_parameters
from swarm_gym.optimizers import get_optimizer
from swarm_gym.reference.onemax.adaptive import Ladder
from swarm_gym.reference.onemax.optima import CHOICES, LambdaDecisions, packaged

Floats = NDArray[np.float64]

OPTIMIZER = "one-plus-lambda-lambda"
LARGEST = 512
LATE = 0.95  # share of ones after which `symbolic` crosses over
REACH = 10.0  # multiple of the lambda of theory up to which expectations of `one-fifth` are computed
LITTLE = 0.001  # alpha of `symbolic` before: a strength of 1, nearly always


@dataclass
class OneMaxRule(Controller):
    """A rule of the parameters by the length of the string and the number of ones."""

    observation: str = field(init=False, default="theory")
    initial_population_size: int = field(init=False, default=1)
    made_for: str | None = field(init=False, default=OPTIMIZER)
    needed_limits: SizeLimits | None = field(init=False, default=SizeLimits(1, LARGEST))
    ranges: ClassVar[Mapping[str, Range]] = {}

    def __post_init__(self) -> None:
        for name, span in self.ranges.items():
            span.require(name, getattr(self, name))

    @classmethod
    def from_argument(cls, argument: str, limits: SizeLimits) -> Self:  # noqa: ARG003
        """Return the rule with parameters such as `factor=1.5`; empty text is the defaults.

        Raises:
            SettingError: for an unknown key or a value outside its range; the message lists the valid ones.
        """
        return cls(**parse_parameters(argument, cls.ranges))

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Begin episodes; nothing is remembered."""

    def act(self, observations: NDArray) -> Floats:
        """Return actions (B, 2) or (B, 5), by (B, 2) lengths and numbers of ones; see `action`."""
        lengths, ones = observations[:, 0], np.minimum(observations[:, 1], observations[:, 0] - 1.0)
        size, *others = self._decide(lengths, ones)
        others = [np.clip(each, *span) for each, span in zip(others, _spans(), strict=False)]
        return np.stack([np.clip(size, 1.0, LARGEST), np.zeros(len(ones)), *others], axis=1)

    def identity(self) -> object:
        """Return the name of the rule and its parameters."""
        return type(self).__name__, {name: getattr(self, name) for name in self.ranges}

    @abstractmethod
    def _decide(self, lengths: Floats, ones: Floats) -> tuple[Floats, ...]:
        """Return the size, and in the layout `extended` children, strength and bias, (B,) each."""


@cache
def _spans() -> list[tuple[float, float]]:
    """Return the least and the largest value of children, strength and bias in an action."""
    parameters = get_optimizer(OPTIMIZER).decided_parameters().values()
    return [parameter.decided for parameter in parameters if parameter.decided is not None]


def sizes_of_theory(lengths: Floats, ones: Floats) -> Floats:
    """Return lambda = sqrt(n / (n - f)), to the nearest whole number; halves go down, as published."""
    return np.ceil(np.sqrt(lengths / (lengths - ones)) - 0.5)


@dataclass
class Theory(OneMaxRule):
    """The control of lambda that is asymptotically optimal."""

    def _decide(self, lengths: Floats, ones: Floats) -> tuple[Floats, ...]:
        return (sizes_of_theory(lengths, ones),)


@dataclass
class OneFifth(OneMaxRule):
    """The one-fifth success rule for a real lambda, which never learns n or f.

    Mutants and children are its whole part, and a mutant flips each bit with probability lambda / n. Of
    eleven ways to round, this one comes nearest to the published runtimes
    (docs/readings-optimizers.md).

    Attributes:
        factor: F; lambda is divided by it after a gain, and grows by its fourth root otherwise.
    """

    action: str = field(init=False, default="extended")
    factor: float = 1.5
    ranges: ClassVar[Mapping[str, Range]] = {"factor": Range(1.01, 10.0)}
    fall: ClassVar[int] = 4  # lambda grows by a root of the factor of this degree

    def reset(self, num_swarms: int, seed: int = 0) -> None:  # noqa: ARG002
        """Forget sizes and numbers of ones."""
        self._sizes, self._ones = np.ones(num_swarms), np.full(num_swarms, np.inf)
        self._lengths = np.zeros(num_swarms)

    def _decide(self, lengths: Floats, ones: Floats) -> tuple[Floats, ...]:
        begins, gains = (ones < self._ones) | (lengths != self._lengths), ones > self._ones
        grown = np.minimum(self._sizes * math.sqrt(math.sqrt(self.factor)), lengths)
        sizes = np.where(gains, np.maximum(self._sizes / self.factor, 1.0), grown)
        self._sizes, self._ones, self._lengths = np.where(begins, 1.0, sizes), ones.copy(), lengths.copy()
        whole = np.minimum(np.floor(self._sizes), LARGEST)
        return whole, whole, self._sizes / whole, np.ones(len(whole))

    def ladder(self, size: int, reach: float = REACH) -> Ladder:
        """Return the rule on strings of one length as a ladder of the values F^(r / 4) of lambda.

        Lambda is at most the length, which is the end of the ladder. A gain there leads to the value four
        rungs below, which is not exactly the length divided by F; few runs come so far.

        Args:
            size: n, the length of the string.
            reach: lambda ends at this multiple of theory's lambda, sqrt(n / (n - f)); infinite for no such
                end, which changed expected runtimes by less than 0.01 % and takes many times as long.
        """
        values = self.factor ** (np.arange(math.ceil(self.fall * math.log(size, self.factor))) / self.fall)
        values = np.append(values[values < size], float(size))
        whole = np.minimum(np.floor(values), LARGEST)
        numbers = whole.astype(np.int64)
        ends = np.maximum(reach * np.sqrt(size / (size - np.arange(size))), 1.0)
        last = np.searchsorted(values, ends, side="right") - 1
        return Ladder(LambdaDecisions(numbers, numbers, values / whole, np.ones(len(whole))), last, self.fall)


@dataclass
class Symbolic(OneMaxRule):
    """The published rule of three parameters that was read off learned policies."""

    action: str = field(init=False, default="extended")

    def _decide(self, lengths: Floats, ones: Floats) -> tuple[Floats, ...]:
        theory, late = sizes_of_theory(lengths, ones), ones / lengths > LATE
        strength = np.where(late, 1.0, LITTLE)
        return np.where(late, theory, 1.0), 2.0 * theory, strength, np.ones(len(ones))


@dataclass
class Static(OneMaxRule):
    """Constant values of all four parameters."""

    action: str = field(init=False, default="extended")
    mutants: int = 8
    children: int = 32
    strength: float = 1.0
    bias: float = 1.0
    ranges: ClassVar[Mapping[str, Range]] = {
        "mutants": Range(1, LARGEST, integer=True),
        "children": Range(1, 256, integer=True),
        "strength": Range(0.001, 32.0),
        "bias": Range(0.1, 4.0),
    }

    def _decide(self, lengths: Floats, ones: Floats) -> tuple[Floats, ...]:  # noqa: ARG002
        numbers = self.mutants, self.children, self.strength, self.bias
        return tuple(np.full(len(ones), float(number)) for number in numbers)


@dataclass
class Optimal(OneMaxRule):
    """The optimal control among choices of a name, for lengths whose optima ship.

    Attributes:
        choices: a name in `swarm_gym.reference.onemax.optima.CHOICES`.
    """

    action: str = field(init=False, default="extended")
    choices: str = "onemax"

    def __post_init__(self) -> None:
        look_up("choices", self.choices, CHOICES)

    @classmethod
    def from_argument(cls, argument: str, limits: SizeLimits) -> Self:  # noqa: ARG003
        """Return the control of `onemax` and the like.

        Raises:
            UnknownNameError: if there are no choices of that name.
        """
        return cls(argument)

    def identity(self) -> object:
        """Return the name of the choices and their values."""
        chosen = CHOICES[self.choices]
        return "Optimal", [
            list(each) for each in (chosen.mutants, chosen.children, chosen.strength, chosen.bias)
        ]

    def _decide(self, lengths: Floats, ones: Floats) -> tuple[Floats, ...]:
        decided = np.empty((4, len(ones)))
        for length in np.unique(lengths).tolist():
            here = lengths == length
            found: LambdaDecisions = packaged(int(length), self.choices).decisions
            columns = (found.mutants, found.children, found.strength, found.bias)
            decided[:, here] = [column[ones[here].astype(int)] for column in columns]
        return tuple(decided)


RULES: dict[str, type[OneMaxRule]] = {
    "theory": Theory,
    "one-fifth": OneFifth,
    "symbolic": Symbolic,
    "static": Static,
    "optimal": Optimal,
}
