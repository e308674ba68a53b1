"""Cells of a results table: numbers with names, and the template that prints them.

A cell keeps its numbers in full, so that every rendering of a table is made from the same numbers. Markdown,
LaTeX and HTML print the template; CSV and JSON write the numbers. A cell that has no numbers is a string.
"""

import math
import re
import string
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.statistics import Interval, mean_interval

Number = float | np.number[Any]

MISSING = "–"

# Says how to read the cells of `signed_p` and `superiority_cell`.
SIGNS = (
    "A p-value has the sign of its rank sum: (−) if the controller is typically below its rival, (+) if "
    "above; A12 is marked where it disagrees with the difference of the means"
)


class _NumberFormatter(string.Formatter):
    """A formatter with two kinds of format specifications that Python does not have.

    `%.1f` prints a share in per cent, without the sign; `k.1f` prints a number in thousands.
    """

    def format_field(self, value: Any, format_spec: str) -> str:
        """Return a number in the format."""
        if format_spec.startswith("%"):
            return format(100 * value, format_spec[1:])
        if format_spec.startswith("k"):
            return format(value / 1000, format_spec[1:])
        return format(value, format_spec)


_FORMATTER = _NumberFormatter()


@dataclass(frozen=True)
class Cell:
    """Numbers by name, and how they are printed; `str(cell)` is the printed text.

    Attributes:
        template: text with a field for each number, such as "{value:.1f} [{low:.1f}, {high:.1f}]". A share is
            printed in per cent by "{value:%.1f} %", a number in thousands by "{value:k.0f}k".
        numbers: numbers by their names in the template; the main one is called `value`. Shares are stored as
            such, so that 5 % is 0.05.
    """

    template: str
    numbers: Mapping[str, float]

    @classmethod
    def of(cls, template: str, **numbers: Number) -> "Cell":
        """Return a cell with these numbers, those of NumPy converted to Python's."""
        return cls(template, {name: _plain(value) for name, value in numbers.items()})

    def __str__(self) -> str:
        return _FORMATTER.vformat(self.template, (), self.numbers)


Entry = Cell | str  # of a row of a table


def number(value: Number | None, form: str = ".1f") -> Entry:
    """Return a cell with one number, or the sign for a missing one if it is None or not a number."""
    if value is None or math.isnan(value):
        return MISSING
    return Cell.of(f"{{value:{form}}}", value=value)


def share(value: Number, form: str = ".1f") -> Entry:
    """Return a cell with a share that is printed in per cent, or the sign for a missing one if it is NaN."""
    return MISSING if math.isnan(value) else Cell.of(f"{{value:%{form}}} %", value=value)


def number_in(value: Number, ends: Interval, form: str = ".1f") -> Cell:
    """Return a cell with a number and its interval: 5.0 [4.0, 6.0]."""
    template = f"{{value:{form}}} [{{low:{form}}}, {{high:{form}}}]"
    return Cell.of(template, value=value, low=ends[0], high=ends[1])


def share_in(value: Number, ends: Interval, form: str = ".1f") -> Cell:
    """Return a cell with a share in per cent and its interval: 5.0 % [4.0, 6.0]."""
    template = f"{{value:%{form}}} % [{{low:%{form}}}, {{high:%{form}}}]"
    return Cell.of(template, value=value, low=ends[0], high=ends[1])


def mean_cell(values: NDArray[np.float64], form: str = ".1f") -> Entry:
    """Return a cell with a mean and its interval, a single value alone, or the sign for a missing number."""
    if values.size < 2:
        return number(values[0], form) if values.size else MISSING
    return number_in(values.mean(), mean_interval(values), form)


def signed_p(p_value: float, direction: int) -> Entry:
    """Return a cell with a p-value and its sign: 0.002 (−) if the values are rather below the other ones."""
    sign = {-1: " (−)", 0: "", 1: " (+)"}[direction]
    return Cell.of(f"{{value:.2g}}{sign}", value=p_value, direction=direction)


def superiority_cell(superiority: float, difference: float) -> Entry:
    """Return a cell with A12, marked where it disagrees with a difference of means: 0.62 ≠ mean."""
    disagrees = (superiority - 0.5) * difference > 0.0 and f"{superiority:.2f}" != "0.50"
    return Cell.of(f"{{value:.2f}}{' ≠ mean' if disagrees else ''}", value=superiority)


def gap_at_cost(gap: Number, evaluations: Number) -> Cell:
    """Return a cell with a gap in per cent, and evaluations in thousands: 2.50 at 38k."""
    return Cell.of("{value:%.2f} at {evaluations:k.0f}k", value=gap, evaluations=evaluations)


def interval_cell(ends: Interval, form: str = ".1f") -> Cell:
    """Return a cell with the two ends of an interval: 4.0 to 6.0."""
    return Cell.of(f"{{low:{form}}} to {{high:{form}}}", low=ends[0], high=ends[1])


def count_of(count: int, total: int) -> Cell:
    """Return a cell with how many of a total: 3 of 4."""
    return Cell.of("{value} of {total}", value=count, total=total)


def verdict(holds: bool) -> str:
    """Return "yes", or a bold "no" where something does not hold."""
    return "yes" if holds else "**no**"


def percent(value: float, form: str = ".1f") -> str:
    """Return a share as a percentage for a caption, or the sign for a missing one if it is NaN."""
    return str(share(value, form))


def plain_text(entry: Entry) -> str:
    """Return the printed text of an entry without marks of bold type."""
    return str(entry).replace("**", "")


def _plain(value: Any) -> float:
    plain = value.item() if isinstance(value, np.generic) else value
    return int(plain) if isinstance(plain, bool) else plain


def printed_interval(entry: Entry, form: re.Pattern[str], expected: str) -> tuple[float, float, float]:
    """Return value, low and high of a cell as it is printed.

    Args:
        entry: the cell.
        form: pattern of the whole cell, with a group for each of the three numbers.
        expected: words for the form, such as "a share with its interval", for the message.

    Raises:
        ValueError: if the cell does not have the form.
    """
    found = form.fullmatch(str(entry))
    if found is None:
        raise ValueError(f"cell {str(entry)!r}: expected {expected}")
    value, low, high = map(float, found.groups())
    return value, low, high
