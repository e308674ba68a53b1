"""The errors of this package; each names the value, what was expected and where it came from."""

import reprlib
from collections.abc import Iterable
from typing import Any

# A message shows what was wrong, and need not be longer than a screen.
_SHORT = reprlib.Repr()
_SHORT.maxlevel, _SHORT.maxlist, _SHORT.maxtuple, _SHORT.maxdict = 3, 12, 12, 6
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 400


def shown(value: object) -> str:
    """A value for a message, shortened where it is long; of any object."""
    try:
        return _SHORT.repr(value)
    except Exception:  # an integer of thousands of digits, or whatever a foreign object does
        return f"<{type(value).__name__}>"


class SwarmGymError(Exception):
    """Base class of every error that swarm_gym raises on purpose; workers can send any of them."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _received, (type(self), self.args), self.__dict__


def _received(kind: type[SwarmGymError], args: tuple[Any, ...]) -> SwarmGymError:
    # Its message is there already, which its own arguments were for.
    return kind.__new__(kind, *args)


class ScenarioError(SwarmGymError, ValueError):
    """A scenario is not a well-formed planning task."""


class UnknownNameError(SwarmGymError, ValueError):
    """A name is not in its registry."""

    def __init__(self, kind: str, name: object, valid: Iterable[str]):
        super().__init__(f"unknown {kind} {shown(name)}; valid: {', '.join(sorted(valid))}")


class SettingError(SwarmGymError, ValueError):
    """An option of an environment has a value it cannot have."""


class ActionError(SwarmGymError, ValueError):
    """An action is not an element of the action space."""


class StepOrderError(SwarmGymError, RuntimeError):
    """`step` was called when there was no episode to advance."""


class MissingExtraError(SwarmGymError, ImportError):
    """A library is needed that only an extra of this package installs."""

    def __init__(self, purpose: str, library: str, extra: str):
        super().__init__(f"{purpose} needs {library}: run `pip install 'swarm_gym[{extra}]'`")
