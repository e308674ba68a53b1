"""The functions on which rows of this study are compared: MetaBox's, and those of BBOB by dimension."""

from typing import NamedTuple

from experiments.studies.strong.published import EVALUATIONS, SCENARIOS
from swarm_gym.scenarios.bbob.instance import FUNCTION_NAMES

# Dimensions of BBOB's functions. Policies were trained in ten; means and intervals are over the first three.
COMPARED = (5, 10, 20)
OTHERS = (3, 40)
# Instances which no training, tuning or suite has.
INSTANCES = (101, 102)
NUM_FUNCTIONS = len(FUNCTION_NAMES)
EVALUATIONS_PER_DIMENSION = 2_000  # those of MetaBox's functions in ten dimensions


class Ground(NamedTuple):
    """Functions, and the budget that a run has on each.

    Attributes:
        name: part of the names of files; empty for MetaBox's functions.
        scenarios: names of the scenarios.
        evaluations: evaluations of a run.
        first_seed: number of the test seed of the first run.
    """

    name: str
    scenarios: tuple[str, ...]
    evaluations: int
    first_seed: int = 0


METABOX = Ground("", tuple(SCENARIOS), EVALUATIONS)
# The same functions with seeds on which no row was chosen.
REPEATED = Ground("repeated", tuple(SCENARIOS), EVALUATIONS, first_seed=151)


def bbob(dimension: int) -> Ground:
    """Return the functions of BBOB in a dimension, instance after instance of each function."""
    scenarios = tuple(
        f"function:bbob-{function}-{dimension}-{instance}"
        for function in range(1, NUM_FUNCTIONS + 1)
        for instance in INSTANCES
    )
    return Ground(f"bbob-{dimension}", scenarios, EVALUATIONS_PER_DIMENSION * dimension)
