"""Parameters of controllers: their ranges, and their text in names, e.g. `spsfa:growth=500,decay=0.1`."""

from collections.abc import Mapping
from dataclasses import dataclass

from swarm_gym.checks import require_integer, require_number
from swarm_gym.errors import SettingError, shown

Number = float | int


@dataclass(frozen=True)
class Range:
    """Valid values of a parameter: numbers from `low` to `high`, both included."""

    low: Number
    high: Number
    integer: bool = False

    def require(self, name: str, value: object) -> None:
        """Raise an error if a value is not in the range.

        Raises:
            SettingError: naming the parameter, the value and the range.
        """
        if self.integer:
            require_integer(name, value, int(self.low), int(self.high))
        else:
            require_number(name, value, self.low, self.high)

    def __str__(self) -> str:
        return f"{'integer ' if self.integer else ''}in [{self.low:g}, {self.high:g}]"


def parse_parameters(argument: str, ranges: Mapping[str, Range]) -> dict[str, Number]:
    """Return the values in `key=value,key=value` by key; empty text has none.

    Raises:
        SettingError: for an unknown key, a repeated key, or a value that is no number or outside its range;
            the message lists the valid keys and ranges.
    """
    values: dict[str, Number] = {}
    for part in argument.split(",") if argument else ():
        key, _, text = part.partition("=")
        try:
            if key not in ranges:
                raise SettingError(f"unknown parameter {shown(key)}")
            if key in values:
                raise SettingError(f"{key} is given twice")
            values[key] = _number(key, text, ranges[key])
            ranges[key].require(key, values[key])
        except SettingError as error:
            valid = ", ".join(f"{name} {span}" for name, span in ranges.items())
            raise SettingError(f"{shown(part)} in {shown(argument)}: {error}; valid: {valid}") from None
    return values


def format_parameters(values: Mapping[str, Number]) -> str:
    """Return `key=value,key=value`, the shortest text that `parse_parameters` reads as the same values."""
    return ",".join(f"{key}={repr(value).removesuffix('.0')}" for key, value in values.items())


def _number(key: str, text: str, span: Range) -> Number:
    try:
        return int(text) if span.integer else float(text)
    except ValueError:
        raise SettingError(f"{key} must be {'an integer' if span.integer else 'a number'}") from None
