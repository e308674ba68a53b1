"""The scenario of a BBOB function, `function:bbob-<function>-<dimension>-<instance>`.

Source: N. Hansen, S. Finck, R. Ros, A. Auger, "Real-parameter black-box optimization benchmarking 2009:
noiseless functions definitions", INRIA RR-6829, 2009. `swarm_gym.problem.bbob` computes the values.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.bbob.instance import FUNCTION_NAMES, REACH, Instance
from swarm_gym.scenarios.function_scenario import FunctionScenario

# Values that the parts of a name can have. A rotation takes time that grows with the cube of the dimension.
FUNCTIONS = range(1, len(FUNCTION_NAMES) + 1)
DIMENSIONS = range(2, 101)
INSTANCES = range(1, 1001)


@dataclass(frozen=True)
class BbobScenario(FunctionScenario):
    """The task to find the minimum of a BBOB function, from which its least value f_opt is subtracted.

    So the least value is 0, as that of every test function, and what is found is the precision that BBOB
    reports. The domain is [-5, 5] in every component; the minimum lies inside it, that of the linear slope
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

    optimum: tuple[float, ...] = field(init=False)
    instance: int = 1

    def __post_init__(self) -> None:
        where = f"scenario {shown(self.name)}"
        functions = {f"bbob-{number}": number for number in FUNCTIONS}
        if self.function not in functions:
            raise ScenarioError(
                f"{where}: expected a function from bbob-1 to bbob-{FUNCTIONS[-1]}, got "
                f"{shown(self.function)}"
            )
        require_parts(where, functions[self.function], self.dimension, self.instance)
        object.__setattr__(self, "dimension", int(self.dimension))
        object.__setattr__(self, "instance", int(self.instance))
        object.__setattr__(self, "optimum", tuple(self.drawn.optimum.tolist()))

    @property
    def number(self) -> int:
        """Number of the function, 1 to 24."""
        return int(self.function.removeprefix("bbob-"))

    @cached_property
    def drawn(self) -> Instance:
        """The instance: optimum, rotations, peaks and f_opt."""
        return Instance(self.number, self.dimension, self.instance)

    @property
    def least_value(self) -> float:
        """f_opt: what fitness leaves out. The value that BBOB defines is the fitness plus this."""
        return self.drawn.least_value

    @property
    def domain(self) -> tuple[float, float]:
        """The smallest and the largest value of every component: -5 and 5."""
        return -REACH, REACH


def require_parts(where: str, function: object, dimension: object, instance: object) -> None:
    """Raise an error unless there is a function of that number, dimension and instance.

    Args:
        where: scenario that is asked for, as the message begins.
        function: number of the function.
        dimension: length of a decision vector.
        instance: number of the instance.

    Raises:
        ScenarioError: with the value and those that are valid.
    """
    for part, value, valid in (
        ("function", function, FUNCTIONS),
        ("dimension", dimension, DIMENSIONS),
        ("instance", instance, INSTANCES),
    ):
        is_integer = isinstance(value, int | np.integer) and not isinstance(value, bool)
        if not is_integer or value not in valid:
            raise ScenarioError(
                f"{where}: BBOB has the {part}s {valid[0]} to {valid[-1]}, got {part} {shown(value)}"
            )
