"""Checks of numbers and names that users give."""

from collections.abc import Mapping
from typing import TypeVar

import gymnasium
import numpy as np

from swarm_gym.errors import SettingError, UnknownNameError, shown

Entry = TypeVar("Entry")


def require_number(name: str, value: object, low: float, high: float) -> None:
    """Raise an error if a value is not a number in [low, high]; NaN lies in no interval.

    Raises:
        SettingError: with name, value and interval.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        raise SettingError(f"{name} must be a number, got {shown(value)}")
    if not low <= value <= high:
        raise SettingError(f"{name} must lie in [{low:g}, {high:g}], got {shown(value)}")


def require_integer(name: str, value: object, low: int, high: int = 10**9) -> None:
    """Raise an error if a value is not an integer in [low, high].

    Raises:
        SettingError: with name, value and interval.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise SettingError(f"{name} must be an integer, got {shown(value)}")
    if not low <= value <= high:
        raise SettingError(f"{name} must lie in [{low}, {high}], got {shown(value)}")


def look_up(kind: str, name: object, registry: Mapping[str, Entry]) -> Entry:
    """Return the entry of a name in a registry.

    Args:
        kind: kind of the entries, for messages.
        name: name to look up.
        registry: entries by name.

    Raises:
        UnknownNameError: if there is no entry of that name; the message lists the valid names.
    """
    if not isinstance(name, str) or name not in registry:
        raise UnknownNameError(kind, name, registry)
    return registry[name]


def refuse_negative_seed(seed: object) -> None:
    """Raise an error for a negative seed, as Gymnasium does, but with a shortened message.

    Raises:
        gymnasium.error.Error: if the seed is negative.
    """
    if isinstance(seed, int) and seed < 0:
        raise gymnasium.error.Error(f"seed must be a natural number, got {shown(seed)}")
