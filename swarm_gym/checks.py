"""Checks of plain numbers that come from a user."""

import numpy as np

from swarm_gym.errors import SettingError


def require_number(name: str, value: object, low: float, high: float) -> None:
    """Refuse what is not a number in [low, high]; NaN is in no interval.

    Raises:
        SettingError: with name, value and interval.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        raise SettingError(f"{name} must be a number, got {value!r}")
    if not low <= value <= high:
        raise SettingError(f"{name} must lie in [{low:g}, {high:g}], got {value!r}")


def require_integer(name: str, value: object, low: int, high: int = 10**9) -> None:
    """Refuse what is not an integer in [low, high].

    Raises:
        SettingError: with name, value and interval.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise SettingError(f"{name} must be an integer, got {value!r}")
    if not low <= value <= high:
        raise SettingError(f"{name} must lie in [{low}, {high}], got {value!r}")
