"""The parameters of optimizers: their declarations, and their values by name.

The parameters of an optimizer are the fields of a NamedTuple, each `Annotated[float, Parameter(...)]`. An
object of that class holds the values of one swarm. Kernels read `parameters.noise`, and the class chooses
the kernels, as the class of a problem table does. The values of B swarms are one array,
(B, number of parameters), whose columns have the order of the fields. Compiled loops make the object of one
swarm from a row of it.
"""

from dataclasses import dataclass
from typing import NamedTuple, TypeAlias, get_type_hints

from swarm_gym.checks import look_up, require_number

# An object of the class of parameters of any optimizer.
Parameters: TypeAlias = NamedTuple


@dataclass(frozen=True)
class Parameter:
    """A numeric parameter of an optimizer, or one that takes one of several names: see `choice`.

    Attributes:
        default: value where none is given.
        low: smallest value.
        high: largest value.
        symbol: letter in the paper.
        meaning: description, with the unit.
        decided: range, both ends positive, in which an extended action sets the parameter at every iteration;
            None if the parameter is constant in an episode.
        choices: names that the parameter takes; kernels and the record of an episode have the index.
    """

    default: float
    low: float
    high: float
    symbol: str
    meaning: str
    decided: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()

    def number(self, name: str, value: object) -> float:
        """Return a value as kernels know it.

        Args:
            name: name of the parameter, for messages.
            value: a number, or one of the choices.

        Raises:
            SettingError: if the value is not a number in the range.
            UnknownNameError: if the value is none of the choices.
        """
        if self.choices:
            return float(look_up(name, value, {choice: k for k, choice in enumerate(self.choices)}))
        require_number(name, value, self.low, self.high)
        return float(value)  # type: ignore[arg-type]


def choice(meaning: str, *choices: str) -> Parameter:
    """Return a parameter that takes one of these names; the first is the default."""
    return Parameter(0.0, 0.0, len(choices) - 1.0, "", meaning, choices=choices)


def declared_parameters(parameter_class: type) -> dict[str, Parameter]:
    """Return the parameters that the fields of a NamedTuple declare, by name and in order.

    Raises:
        TypeError: if a field is not `Annotated[float, Parameter(...)]`.
    """
    declared = {}
    for name, hint in get_type_hints(parameter_class, include_extras=True).items():
        match getattr(hint, "__metadata__", ()):
            case (Parameter() as parameter,):
                declared[name] = parameter
            case _:
                raise TypeError(
                    f"{parameter_class.__name__}.{name} must be Annotated[float, Parameter(...)], got {hint}"
                )
    return declared
