"""OneMax: the task to find the bit string of n ones, by the names `onemax:<n>`.

Source: B. Doerr, C. Doerr, F. Ebel, "From black-box complexity to designing new genetic algorithms",
Theoretical Computer Science 567, 87-104, 2015, whose (1 + (lambda, lambda)) genetic algorithm solves it. The
number of ones is all that matters of a string: every order of its bits is as likely as any other. So a string
stands here as its number of ones, and decision vectors have this one component.

`onemax:500` begins with half the bits set, as published runs do. `onemax:500-start:400` begins with 400 ones.
"""

import re
from dataclasses import dataclass, field

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.family import NUMBER, Family, parse_numbers
from swarm_gym.scenarios.function_scenario import FunctionScenario

NAME = "onemax"
USAGE = f"{NAME}:<n>[-start:<ones>]"

SIZES = range(10, 100_001)


@dataclass(frozen=True)
class OneMaxScenario(FunctionScenario):
    """The task to set all bits of a string; the fitness is the number of bits that are not set.

    Attributes:
        name: name under which results are filed.
        function: `onemax`.
        dimension: 1, the length of a decision vector: the number of ones.
        optimum: (1,) n, the number of ones wanted.
        size: n, the length of the string, 10 to 100,000.
        start: number of ones at the beginning, 0 to n; by default half of them, rounded down.

    Raises:
        ScenarioError: for a length or a number of ones outside its range.
    """

    function: str = field(init=False, default=NAME)
    dimension: int = field(init=False, default=1)
    optimum: tuple[float, ...] = field(init=False)
    size: int = 100
    start: int = -1

    def __post_init__(self) -> None:
        where = f"scenario {shown(self.name)}"
        _require(where, "the length n", self.size, SIZES)
        start = self.size // 2 if self.start == -1 else self.start
        _require(where, "the number of ones at the start", start, range(self.size + 1))
        object.__setattr__(self, "size", int(self.size))
        object.__setattr__(self, "start", int(start))
        object.__setattr__(self, "optimum", (float(self.size),))

    @property
    def domain(self) -> tuple[float, float]:
        """The smallest and the largest number of ones: 0 and n."""
        return 0.0, float(self.size)


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single scenarios that a name stands for; `onemax:100-500` stands for 401.

    Raises:
        ScenarioError: if the name has another form, or a number is out of range.
    """
    sizes, start = _parse(name)
    names = tuple(f"{NAME}:{size}{start}" for size in sizes)
    for one in names[:1] + names[-1:]:
        make(one)  # refuses what is out of range
    return names


def make(name: str) -> OneMaxScenario:
    """Return the single scenario of that name."""
    sizes, start = _parse(name)
    ones = {"start": int(start.partition(":")[2])} if start else {}
    return OneMaxScenario(name, size=sizes[0], **ones)


def _parse(name: str) -> tuple[range, str]:
    """Return the lengths, one or more, and the text after them."""
    match = re.fullmatch(rf"{NAME}:({NUMBER}(?:-{NUMBER})?)(-start:{NUMBER})?", name)
    sizes = parse_numbers(match[1], name) if match else range(0)
    if match is None or not sizes:
        raise ScenarioError(
            f"scenario {shown(name)}: expected {USAGE}, with a length n from {SIZES[0]} to {SIZES[-1]} or a "
            f"range of them such as {NAME}:100-500"
        )
    return sizes, match[2] or ""


def _require(where: str, what: str, value: object, valid: range) -> None:
    is_integer = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not is_integer or value not in valid:
        raise ScenarioError(
            f"{where}: {what} must be a whole number from {valid[0]} to {valid[-1]}, got {shown(value)}"
        )


FAMILY = Family(USAGE, (), expand, make)
