"""Families: scenarios that are generated from their names, `<family>:<more>`."""

from collections.abc import Callable
from typing import NamedTuple

from swarm_gym.scenarios.scenario import Scenario


class Family(NamedTuple):
    """How the names of a family are read.

    Attributes:
        usage: the form of the names, for messages.
        samples: some names, one of each sort.
        expand: the names of single scenarios that a name stands for; refuses what is no name.
        make: the single scenario of a name.
    """

    usage: str
    samples: tuple[str, ...]
    expand: Callable[[str], tuple[str, ...]]
    make: Callable[[str], Scenario]
