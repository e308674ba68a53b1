"""Families of scenarios, whose names have the form `<family>:<more>`.

The scenarios of a family are generated from their names, or read from files.
"""

import re
from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

from swarm_gym.checks import look_up
from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.dynamic.scenario import AnyScenario

# Maximum number of scenarios that one name can stand for.
MAX_RANGE = 200_000
# Pattern of a number in a name: without sign and leading zero, so that every scenario has only one name.
NUMBER = "(?:0|[1-9][0-9]{0,8})"


class Family(NamedTuple):
    """A family of scenarios: the form of its names, and how they are read.

    Attributes:
        usage: form of the names, for messages.
        samples: some names, one of each form; empty if the scenarios need files, seconds or an optimizer of
            their own, or are functions that belong to another library.
        expand: function that returns the names of the single scenarios that a name stands for, and raises
            `ScenarioError` for a name of another form.
        make: function that returns the single scenario of a name.
        tidy: function that returns the one form of a name that may be written in several ways.
    """

    usage: str
    samples: tuple[str, ...]
    expand: Callable[[str], tuple[str, ...]]
    make: Callable[[str], AnyScenario]
    tidy: Callable[[str], str] = str


class SizedSplit(Protocol):
    """A split of a family that has a number of scenarios."""

    @property
    def size(self) -> int:
        """Number of scenarios."""


def expand_split(name: str, family: str, splits: Mapping[str, SizedSplit], example: str) -> tuple[str, ...]:
    """Return the names of the single scenarios that `<family>:<split>:<number>` or a range of numbers means.

    Args:
        name: the name.
        family: name of the family.
        splits: splits by name.
        example: a range, for messages.

    Raises:
        UnknownNameError: if there is no such split.
        ScenarioError: if the name has another form, or a number is not in its split.
    """
    parts = name.split(":")
    if len(parts) != 3:
        raise ScenarioError(
            f"scenario {shown(name)}: expected {family}:<split>:<number>, with a split of {', '.join(splits)}"
        )
    _, split, numbers = parts
    size = look_up(f"split of {family}", split, splits).size
    chosen = numbers_below(size, numbers, name, example, shown(split))
    return tuple(f"{family}:{split}:{number}" for number in chosen)


def numbers_below(size: int, text: str, name: str, example: str, after: str) -> range:
    """Return the numbers that a text such as `7` or `0-511` stands for, all below a size.

    Args:
        size: number that all have to be below.
        text: part of the name that stands for numbers.
        name: whole name, for messages.
        example: a range, for messages.
        after: part of the name that the numbers follow, for messages.

    Raises:
        ScenarioError: if the text has another form, or a number is too large.
    """
    numbers = parse_numbers(text, name)
    if not numbers or numbers[-1] >= size:
        raise ScenarioError(
            f"scenario {shown(name)}: expected a number from 0 to {size - 1}, or a range of them such as "
            f"{example}, after {after}, got {shown(text)}"
        )
    return numbers


def spaceless(name: str) -> str:
    """Return a name without spaces at its ends and around `:`, `?`, `#`, `&`, `=` and `,`."""
    return re.sub(r" *([:?#&=,]) *", r"\1", name.strip(" "))


def spaceless_beside_path(name: str) -> str:
    """Return a name such as `<family>:<path>#7` without needless spaces; those inside the path stay."""
    match = re.fullmatch(r"([^:]*):(.*)([?#].*)", name, re.DOTALL)
    if match is None:
        return spaceless(name)
    family, path, rest = match.groups()
    return f"{family.strip(' ')}:{path.strip(' ')}{spaceless(rest)}"


def parse_numbers(text: str, name: str) -> range:
    """Return the numbers that a text such as `7` or `0-511` stands for, the last one included.

    Args:
        text: part of the name that stands for numbers.
        name: whole name, for messages.

    Returns:
        The numbers; empty if the text has another form.

    Raises:
        ScenarioError: if there are more than `MAX_RANGE` numbers.
    """
    match = re.fullmatch(rf"({NUMBER})(?:-({NUMBER}))?", text)
    numbers = range(int(match[1]), int(match[2] or match[1]) + 1) if match else range(0)
    if len(numbers) > MAX_RANGE:
        raise ScenarioError(
            f"scenario {shown(name)}: expected a range of at most {MAX_RANGE} numbers, got {shown(text)}"
        )
    return numbers
