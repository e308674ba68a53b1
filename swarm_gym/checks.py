"""Checks of numbers and names that come from a user."""

from collections.abc import Mapping
from typing import TypeVar

import gymnasium
import numpy as np

from swarm_gym.errors import SettingError, UnknownNameError, shown

Entry = TypeVar("Entry")


def require_number(name: str, value: object, low: float, high: float) -> None:
    """Refuse what is not a number in [low, high]; NaN is in no interval.

    Raises:
        SettingError: with name, value and interval.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        raise SettingError(f"{name} must be a number, got {shown(value)}")
    if not low <= value <= high:
        raise SettingError(f"{name} must lie in [{low:g}, {high:g}], got {shown(value)}")


def require_integer(name: str, value: object, low: int, high: int = 10**9) -> None:
    """Refuse what is not an integer in [low, high].

    Raises:
        SettingError: with name, value and interval.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise SettingError(f"{name} must be an integer, got {shown(value)}")
    if not low <= value <= high:
        raise SettingError(f"{name} must lie in [{low}, {high}], got {shown(value)}")


def look_up(kind: str, name: object, registry: Mapping[str, Entry]) -> Entry:
    """The entry of that name.

    Raises:
        UnknownNameError: if there is none; the message lists the valid names.
    """
    if not isinstance(name, str) or name not in registry:
        raise UnknownNameError(kind, name, registry)
    return registry[name]


def refuse_negative_seed(seed: object) -> None:
    """Refuse a seed below 0, as Gymnasium does, which would show all of its digits.

    Raises:
        gymnasium.error.Error: if it is.
    """
    if isinstance(seed, int) and seed < 0:
        raise gymnasium.error.Error(f"seed must be a natural number, got {shown(seed)}")
