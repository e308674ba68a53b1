"""The errors of this package; every message names the value, what was expected and where it came from."""

import reprlib
from collections.abc import Iterable
from difflib import get_close_matches
from itertools import islice

# Limits of the values in messages, so that a message is not longer than a screen.
_SHORT = reprlib.Repr()
_SHORT.maxlevel, _SHORT.maxlist, _SHORT.maxtuple, _SHORT.maxdict = 3, 12, 12, 6
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 400


def shown(value: object) -> str:
    """Return any object as text for a message, shortened where it is long."""
    try:
        return _SHORT.repr(value)
    except Exception:  # an integer has thousands of digits, or an object's repr fails
        return f"<{type(value).__name__}>"


LONGEST_LIST = 200  # characters of the names that a message lists, two lines
_MOST_COMPARED = 2_000  # names


def listed(names: Iterable[str], given: object = "", where: str = "") -> str:
    """Return names for a message: all that fit into two lines, else those most like the one that was given.

    Args:
        names: valid names, in order.
        given: name that was given instead.
        where: command, file or page that lists all, for a message that does not.
    """
    names = list(names)
    whole = ", ".join(names)
    if len(whole) <= LONGEST_LIST:
        return whole
    text = given if isinstance(given, str) else shown(given)
    some = get_close_matches(text[:100], islice(names, _MOST_COMPARED), n=5, cutoff=0.0)
    while len(some) > 1 and len(", ".join(some)) > LONGEST_LIST:
        some.pop()
    return f"{', '.join(some)}, ... ({len(names):,} in all{f', see {where}' if where else ''})"


class SwarmGymError(Exception):
    """Base class of the errors that swarm_gym raises on purpose; workers can send any of them."""

    def __reduce__(self) -> tuple[object, ...]:
        return _received, (type(self), self.args), self.__dict__


def _received(kind: type[SwarmGymError], args: tuple[object, ...]) -> SwarmGymError:
    # The message is complete, so the constructor that composes it is not called again.
    return kind.__new__(kind, *args)


class ScenarioError(SwarmGymError, ValueError):
    """A scenario that is not a well-formed task."""


class NoPathError(ScenarioError):
    """A task without a solution: obstacles separate start and target, or none was found."""


class UnknownNameError(SwarmGymError, ValueError):
    """A name that is not in its registry.

    Args:
        kind: kind of the names.
        name: name that was given.
        valid: names of the registry.
        where: command, file or page that lists all names, for a registry of many.

    Attributes:
        valid: all names of the registry, of which a message may list the most alike only.
    """

    def __init__(self, kind: str, name: object, valid: Iterable[str], where: str = ""):
        self.valid = tuple(sorted(valid))
        super().__init__(f"unknown {kind} {shown(name)}; valid: {listed(self.valid, name, where)}")


class SettingError(SwarmGymError, ValueError):
    """A value that an option of an environment cannot have."""


class ActionError(SwarmGymError, ValueError):
    """An action that is not an element of the action space."""


class StepOrderError(SwarmGymError, RuntimeError):
    """A call of `step` when no episode is under way."""


class DeviceError(SwarmGymError, RuntimeError):
    """A kernel that has failed on a GPU."""


class MissingExtraError(SwarmGymError, ImportError):
    """A library that is needed but missing; an extra of this package installs it."""

    def __init__(self, purpose: str, library: str, extra: str):
        super().__init__(
            f"{purpose} needs {library}: run `pip install 'swarm_gym[{extra}]'`, or in a checkout of the "
            f"project `pip install '.[{extra}]'`"
        )
