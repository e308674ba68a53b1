"""The scenario of a BBOB function, `function:bbob-<function>-<dimension>-<instance>`.

Source: N. Hansen, S. Finck, R. Ros, A. Auger, "Real-parameter black-box optimization benchmarking 2009:
noiseless functions definitions", INRIA RR-6829, 2009. `swarm_gym.problem.bbob` computes the values.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.bbob.instance import FUNCTION_NAMES, REACH, Instance
from swarm_gym.scenarios.function_scenario import FunctionScenario

FUNCTIONS = range(1, len(FUNCTION_NAMES) + 1)


class BbobSuite(NamedTuple):
    """Values that the parts of a scenario can have.

    Attributes:
        title: name of the suite, for messages.
        name: name of the suite, with which the names of its functions begin.
        dimensions: dimensions of decision vectors.
        instances: numbers of instances.
        instance: word for the number of an instance.
    """

    title: str
    name: str
    dimensions: Sequence[int]
    instances: Sequence[int]
    instance: str = "instance"


# A rotation takes time that grows with the cube of the dimension.
BBOB = BbobSuite("BBOB", "bbob", range(2, 101), range(1, 1001))


@dataclass(frozen=True)
class BbobScenario(FunctionScenario):
    """The task to find the minimum of a BBOB function, from which its least value f_opt is subtracted.

    So the least value is 0, as for every test function, and what is found is the precision that BBOB
    reports. The domain is [-5, 5] in every component; the minimum lies inside it, but for the linear slope
    (f5) in a corner.

    Attributes:
        name: name under which results are filed.
        function: `bbob-1` to `bbob-24`.
        dimension: D, the length of a decision vector, 2 to 100.
        optimum: (D,) x_opt, the position of the minimum; it follows from the others.
        instance: number of the instance, 1 to 1000; it fixes optimum, rotations and f_opt.

    Raises:
        ScenarioError: for a function, a dimension or an instance that does not exist.
    """

    suite: ClassVar[BbobSuite] = BBOB
    optimum: tuple[float, ...] = field(init=False)
    instance: int = 1

    def __post_init__(self) -> None:
        where, prefix = f"scenario {shown(self.name)}", self.suite.name
        functions = {f"{prefix}-{number}": number for number in FUNCTIONS}
        if self.function not in functions:
            raise ScenarioError(
                f"{where}: expected a function from {prefix}-1 to {prefix}-{FUNCTIONS[-1]}, got "
                f"{shown(self.function)}"
            )
        require_parts(where, functions[self.function], self.dimension, self.instance, self.suite)
        object.__setattr__(self, "dimension", int(self.dimension))
        object.__setattr__(self, "instance", int(self.instance))
        object.__setattr__(self, "optimum", tuple(self.drawn.optimum.tolist()))

    @property
    def number(self) -> int:
        """Number of the function, 1 to 24."""
        return int(self.function.rpartition("-")[2])

    @property
    def form(self) -> int:
        """Number of the formula by which problems compute the values: the number of the function."""
        return self.number

    @cached_property
    def drawn(self) -> Instance:
        """The instance: optimum, rotations, peaks and f_opt."""
        return Instance(self.number, self.dimension, self.instance)

    @property
    def identity(self) -> tuple[object, ...]:
        """The suite and the numbers of function, dimension and instance."""
        return self.suite.name, self.number, self.dimension, self.instance

    @property
    def least_value(self) -> float:
        """f_opt: what fitness leaves out. The value that BBOB defines is the fitness plus this."""
        return self.drawn.least_value

    @property
    def domain(self) -> tuple[float, float]:
        """The smallest and the largest value of every component: -5 and 5."""
        return -REACH, REACH


def require_parts(
    where: str, function: object, dimension: object, instance: object, suite: BbobSuite = BBOB
) -> None:
    """Raise an error unless a suite has a function of that number, dimension and instance.

    Args:
        where: scenario that is asked for, as the message begins.
        function: number of the function.
        dimension: length of a decision vector.
        instance: number of the instance.
        suite: the suite.

    Raises:
        ScenarioError: with the value and those that are valid.
    """
    for part, value, valid in (
        ("function", function, FUNCTIONS),
        ("dimension", dimension, suite.dimensions),
        (suite.instance, instance, suite.instances),
    ):
        is_integer = isinstance(value, int | np.integer) and not isinstance(value, bool)
        if not is_integer or value not in valid:
            between = "to" if isinstance(valid, range) else "and"
            raise ScenarioError(
                f"{where}: {suite.title} has the {part}s {valid[0]} {between} {valid[-1]}, got {part} "
                f"{shown(value)}"
            )
