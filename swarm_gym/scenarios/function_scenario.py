"""Test functions for optimizers: the task is to find the minimum; there is no map and no path.

Source: Y. Zhang, G. Guan, X. Pu, "The robot path planning based on improved artificial fish swarm algorithm",
Mathematical Problems in Engineering, 2016, which compares optimizers on these five functions. The formulas
follow S. Surjanovic, D. Bingham, "Virtual library of simulation experiments: test functions and datasets".
Here z = x - o, where o is the position of the minimum, and a constant is added so that the minimum is 0:

| name | f(x) | o |
|---|---|---|
| `rastrigin` | z_k^2 + 10 (1 - cos(2 pi z_k)), summed over k | 0 |
| `sum-squares` | k z_k^2, summed over k = 1, 2, ... | 0 |
| `easom` | 1 - (product of all cos(z_k)) exp(-sum of all z_k^2) | pi |
| `booth` | (z_1 + 2 z_2)^2 + (2 z_1 + z_2)^2, summed over the pairs (1, 2), (3, 4), ... | 1, 3, 1, 3, ... |
| `bohachevsky` | z_k^2 + 2 z_(k+1)^2 - 0.3 cos(3 pi z_k) - 0.4 cos(4 pi z_(k+1)) + 0.7, over all k < D | 0 |

In two dimensions these are the usual functions:

* Easom's is -cos(x_1) cos(x_2) exp(-(x_1 - pi)^2 - (x_2 - pi)^2), to which the paper adds 1.
* Booth's is (x_1 + 2 x_2 - 7)^2 + (2 x_1 + x_2 - 5)^2.
* Bohachevsky's is the first of the three functions of that name.

Their forms in more dimensions are defined here, except the chain of Bohachevsky's, which is common. The paper
does not print the domains; [-5.12, 5.12] for Rastrigin's and [-10, 10] for the others is a reading, see
docs/readings-optimizers.md.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from swarm_gym.checks import look_up
from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.obstacles import require_numbers

MAX_DIMENSION = 1000


class Definition(NamedTuple):
    """The domain, the minimum and the dimensions of a function.

    Attributes:
        reach: bound of the domain: components lie in [-reach, reach].
        optimum: position of the minimum, repeated over the components.
        dimensions: dimensions that the function is defined for.
    """

    reach: float
    optimum: tuple[float, ...] = (0.0,)
    dimensions: range = range(1, MAX_DIMENSION + 1)


# By name; `swarm_gym.problem.function` computes the values.
FUNCTIONS = {
    "rastrigin": Definition(5.12),
    "sum-squares": Definition(10.0),
    "easom": Definition(10.0, (math.pi,)),
    "booth": Definition(10.0, (1.0, 3.0), range(2, MAX_DIMENSION + 1, 2)),
    "bohachevsky": Definition(10.0, dimensions=range(2, MAX_DIMENSION + 1)),
}


@dataclass(frozen=True)
class FunctionScenario:
    """The task to find the minimum of a function, whose value there is 0; nothing can collide.

    The degree of collision, and with it E(P), is always 0. Every member of a population is feasible, and
    repair changes nothing, whatever phi is. The schedule of the SPSFA paper compares E(P) with its first
    value, so it keeps its population size.

    Where scenarios on maps have a path, a test function has a decision vector in parallel coordinates: points
    (number of the component, counted from 1; value of the component). Lengths are in units of the components.

    Attributes:
        name: name under which results are filed.
        function: a name in `FUNCTIONS`.
        dimension: D, the length of a decision vector.
        optimum: (D,) position of the minimum, inside the domain; by default as in the formula.

    Raises:
        UnknownNameError: if there is no such function.
        ScenarioError: if the function is not defined for this dimension, or the optimum is malformed or
            outside the domain.
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
        """The smallest and the largest value of every component."""
        reach = FUNCTIONS[self.function].reach
        return -reach, reach


def require_dimension(where: str, function: str, dimension: object) -> None:
    """Raise an error if a function is not defined for a dimension.

    Raises:
        UnknownNameError: if there is no such function.
        ScenarioError: if the function is not defined for this dimension.
    """
    dimensions = look_up("test function", function, FUNCTIONS).dimensions
    is_integer = isinstance(dimension, int | np.integer) and not isinstance(dimension, bool)
    if not is_integer or dimension not in dimensions:
        first, second, last = dimensions[0], dimensions[1], dimensions[-1]
        raise ScenarioError(
            f"{where}: {function!r} is defined for the dimensions {first}, {second}, ..., {last}, got "
            f"{shown(dimension)}"
        )
