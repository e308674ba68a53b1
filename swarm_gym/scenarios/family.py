"""Families: scenarios that are generated from their names, `<family>:<more>`, or read from files."""

import re
from collections.abc import Callable
from typing import NamedTuple

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.dynamic.scenario import AnyScenario

# How many scenarios one name can stand for.
MAX_RANGE = 200_000
# The pattern of a number in a name: no sign and no leading zero, so that a scenario has one name.
NUMBER = "(?:0|[1-9][0-9]{0,8})"


class Family(NamedTuple):
    """How the names of a family are read.

    Attributes:
        usage: the form of the names, for messages.
        samples: some names, one of each sort; none where files are needed.
        expand: the names of single scenarios that a name stands for; refuses what is no name.
        make: the single scenario of a name.
    """

    usage: str
    samples: tuple[str, ...]
    expand: Callable[[str], tuple[str, ...]]
    make: Callable[[str], AnyScenario]


def parse_numbers(text: str, name: str) -> range:
    """The numbers that `7` or `0-511` stands for, the last included; none if it is no such text.

    Args:
        text: what stands for numbers.
        name: of the scenarios, which it is a part of.

    Raises:
        ScenarioError: if they are more than `MAX_RANGE`.
    """
    match = re.fullmatch(rf"({NUMBER})(?:-({NUMBER}))?", text)
    numbers = range(int(match[1]), int(match[2] or match[1]) + 1) if match else range(0)
    if len(numbers) > MAX_RANGE:
        raise ScenarioError(
            f"scenario {shown(name)}: expected a range of at most {MAX_RANGE} numbers, got {shown(text)}"
        )
    return numbers
