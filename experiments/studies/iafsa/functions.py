"""Test functions of the IAFSA paper by the names of their scenarios."""

import re
from typing import NamedTuple

from experiments.studies.iafsa.published import MEAN_BEST

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
