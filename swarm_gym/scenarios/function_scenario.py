"""Test functions of optimizers, whose least value is looked for: no map, no path.

Source: Y. Zhang, G. Guan, X. Pu, "The robot path planning based on improved artificial fish swarm algorithm",
Mathematical Problems in Engineering, 2016, which compares optimizers on these five. Formulas as in S.
Surjanovic, D. Bingham, "Virtual library of simulation experiments: test functions and datasets"; here with
z = x - o, o being where the least value is, and with a constant that makes this value 0:

| name | f(x) | o |
|---|---|---|
| `rastrigin` | z_k^2 + 10 (1 - cos(2 pi z_k)), summed over k | 0 |
| `sum-squares` | k z_k^2, summed over k = 1, 2, ... | 0 |
| `easom` | 1 - (product of all cos(z_k)) exp(-sum of all z_k^2) | pi |
| `booth` | (z_1 + 2 z_2)^2 + (2 z_1 + z_2)^2, summed over the pairs (1, 2), (3, 4), ... | 1, 3, 1, 3, ... |
| `bohachevsky` | z_k^2 + 2 z_(k+1)^2 - 0.3 cos(3 pi z_k) - 0.4 cos(4 pi z_(k+1)) + 0.7, over all k < D | 0 |

In two dimensions Easom's is -cos(x_1) cos(x_2) exp(-(x_1 - pi)^2 - (x_2 - pi)^2), to which the paper adds 1,
Booth's (x_1 + 2 x_2 - 7)^2 + (2 x_1 + x_2 - 5)^2, and Bohachevsky's the first of the three of that name.
Their forms in more dimensions are ours, but for the chain of Bohachevsky's, which is common. The paper does
not print the domains: a reading is [-5.12, 5.12] for Rastrigin's and [-10, 10] for the others.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from swarm_gym.checks import look_up
from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.scenario import require_numbers

MAX_DIMENSION = 1000


class Definition(NamedTuple):
    """What there is to know of a function besides its values.

    Attributes:
        reach: components lie in [-reach, reach].
        optimum: where its least value is, repeated over the components.
        dimensions: that it is defined for.
    """

    reach: float
    optimum: tuple[float, ...] = (0.0,)
    dimensions: range = range(1, MAX_DIMENSION + 1)


# By name; `problem.functions` has the values.
FUNCTIONS = {
    "rastrigin": Definition(5.12),
    "sum-squares": Definition(10.0),
    "easom": Definition(10.0, (math.pi,)),
    "booth": Definition(10.0, (1.0, 3.0), range(2, MAX_DIMENSION + 1, 2)),
    "bohachevsky": Definition(10.0, dimensions=range(2, MAX_DIMENSION + 1)),
}


@dataclass(frozen=True)
class FunctionScenario:
    """Find where a function has its least value, which is 0; there is nothing to collide with.

    So collision, and with it E(P), is 0 throughout, every member is feasible, repair changes nothing whatever
    phi is, and the schedule of the SPSFA paper, which compares E(P) with its first value, keeps its size.
    Where maps have paths, there are vectors in parallel coordinates: points (number of the component, from 1;
    its value). Lengths in map units are in units of the components.

    Attributes:
        name: what results are filed under.
        function: a name in `FUNCTIONS`.
        dimension: D, the length of a decision vector.
        optimum: (D,) where the function is 0, inside the domain; by default where its formula has it.

    Raises:
        UnknownNameError: if there is no such function.
        ScenarioError: if it has not that dimension, or the optimum is malformed or outside the domain.
    """

    name: str
    function: str
    dimension: int
    optimum: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        where = f"scenario {shown(self.name)}"
        require_dimension(where, self.function, self.dimension)
        given = self.optimum
        if isinstance(given, tuple) and not given:
            given = (FUNCTIONS[self.function].optimum * self.dimension)[: self.dimension]
        optimum = require_numbers(where, "optimum", given, self.dimension)
        low, high = self.domain
        for component, value in enumerate(optimum, 1):
            if not low <= value <= high:
                raise ScenarioError(
                    f"{where}: component {component} of the optimum must lie in [{low}, {high}], got {value}"
                )
        object.__setattr__(self, "dimension", int(self.dimension))
        object.__setattr__(self, "optimum", optimum)

    @property
    def domain(self) -> tuple[float, float]:
        """The least and the largest value of every component."""
        reach = FUNCTIONS[self.function].reach
        return -reach, reach


def require_dimension(where: str, function: str, dimension: object) -> None:
    """Refuse a dimension that a function has not.

    Raises:
        UnknownNameError: if there is no such function.
        ScenarioError: if it has not that dimension.
    """
    dimensions = look_up("test function", function, FUNCTIONS).dimensions
    is_integer = isinstance(dimension, int | np.integer) and not isinstance(dimension, bool)
    if not is_integer or dimension not in dimensions:
        first, second, last = dimensions[0], dimensions[1], dimensions[-1]
        raise ScenarioError(
            f"{where}: {function!r} has the dimensions {first}, {second}, ..., {last}, not {shown(dimension)}"
        )
