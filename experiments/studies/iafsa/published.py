"""Numbers printed in the IAFSA paper, for comparison with ours, and its test functions.

Source: Zhang, Guan, Pu, "The robot path planning based on improved artificial fish swarm algorithm", Math.
Probl. Eng. 2016, tables 2 to 5: 100 fish; means of 50 runs of 50, 100 and 200 iterations, convergence over
100 runs, mean lengths of 50 runs on a map in metres. The maps of that paper are in figures only;
`scenarios.papers.iafsa` has ours.
"""

import re
from typing import NamedTuple

ITERATIONS = (50, 100, 200)
# Dimension that the IAFSA paper states for each function; all optima are 0.
DIMENSIONS = {"rastrigin": 10, "easom": 2, "booth": 2, "bohachevsky": 2, "sum-squares": 10}

_BEST = {
    "rastrigin": (
        (0.019541667, 0.016765714, 0.01565533), (0.004902857, 0.00363, 0.002735),
    ),
    "easom": (
        (0.021071, 0.022532, 0.0218015), (0.0030341, 0.003865, 0.00344955),
    ),
    "booth": (
        (0.007065, 0.005180909, 0.006078095), (0.000732, 0.001251818, 0.001003333),
    ),
    "bohachevsky": (
        (0.010106, 0.013684, 0.008507), (0.002489, 0.003235, 0.002446),
    ),
    "sum-squares": (
        (0.008670, 0.011748, 0.011235), (0.001848, 0.003260, 0.004433),
    ),
}  # fmt: skip

# Table 2: mean best value by function, optimizer and number of iterations.
MEAN_BEST: dict[tuple[str, str, int], float] = {
    (function, optimizer, iterations): value
    for function, rows in _BEST.items()
    for optimizer, values in zip(("fish-swarm", "improved-fish-swarm"), rows, strict=True)
    for iterations, value in zip(ITERATIONS, values, strict=True)
}


class Convergence(NamedTuple):
    """Iterations to convergence, whose criterion the IAFSA paper does not state."""

    maximum: float
    minimum: float
    mean: float


# Table 3, by function and optimizer.
CONVERGENCE: dict[tuple[str, str], Convergence] = {
    ("rastrigin", "fish-swarm"): Convergence(128, 45, 81),
    ("easom", "fish-swarm"): Convergence(27, 7, 19),
    ("booth", "fish-swarm"): Convergence(24, 5, 17),
    ("bohachevsky", "fish-swarm"): Convergence(30, 8, 21),
    ("sum-squares", "fish-swarm"): Convergence(49, 17, 34),
    ("rastrigin", "improved-fish-swarm"): Convergence(22, 8, 16),
    ("easom", "improved-fish-swarm"): Convergence(11, 5, 5),
    ("booth", "improved-fish-swarm"): Convergence(15, 4, 9),
    ("bohachevsky", "improved-fish-swarm"): Convergence(13, 2, 7),
    ("sum-squares", "improved-fish-swarm"): Convergence(19, 6, 13),
}

SWARMS = ("fish-swarm", "hybrid-fish-swarm", "improved-fish-swarm")

_LENGTHS = {
    # Table 4, the "self-created" map.
    ("turtlebot3", "A-B"): (6.658, 7.201, 6.352, 5.624),
    ("turtlebot3", "B-C"): (4.713, 5.593, 4.731, 3.956),
    ("turtlebot3", "C-D"): (3.967, 4.002, 3.989, 3.253),
    ("turtlebot3", "D-E"): (3.594, 3.702, 3.536, 2.821),
    # Table 5, the "real" map.
    ("playground", "A-B"): (5.824, 6.855, 5.875, 5.31),
    ("playground", "A-C"): (12.621, 14.255, 12.751, 10.982),
    ("playground", "E-D"): (3.875, 4.254, 4.045, 3.125),
    ("playground", "D-B"): (13.352, 15.245, 14.145, 11.145),
}

# Mean length in metres by our map, route and method.
ROUTE_LENGTHS: dict[tuple[str, str, str], float] = {
    (site, pair, method): length
    for (site, pair), row in _LENGTHS.items()
    for method, length in zip(("a-star", *SWARMS), row, strict=True)
}


AFSA, IAFSA = "fish-swarm", "improved-fish-swarm"


class Function(NamedTuple):
    """A test function by the set of its scenarios, `function:booth-2`, or `function:booth-2-shifted`."""

    key: str
    dimension: int

    @classmethod
    def of(cls, scenario_set: str) -> "Function":
        """Return the function of a set of scenarios.

        Raises:
            ValueError: if the scenarios are not of a test function.
        """
        match = re.fullmatch(r"function:([a-z-]+)-([0-9]+)(?:-shifted)?", scenario_set)
        if not match:
            raise ValueError(f"scenarios {scenario_set!r}: expected function:<name>-<dimension>[-shifted]")
        return cls(match[1], int(match[2]))

    @property
    def label(self) -> str:
        """Name of the function as tables print it."""
        return f"{self.key.replace('-', ' ').capitalize()}, {self.dimension}-D"


def published_mean(scenario_set: str, optimizer: str, iterations: int) -> float:
    """Return the mean best value that the IAFSA paper prints of a function; its dimension may differ."""
    return MEAN_BEST[Function.of(scenario_set).key, optimizer, iterations]
