"""The errors of this package; each names the value, what was expected and where it came from."""

from collections.abc import Iterable


class SwarmGymError(Exception):
    """Base class of every error that swarm_gym raises on purpose."""


class ScenarioError(SwarmGymError, ValueError):
    """A scenario is not a well-formed planning task."""


class UnknownNameError(SwarmGymError, ValueError):
    """A name is not in its registry."""

    def __init__(self, kind: str, name: object, valid: Iterable[str]):
        super().__init__(f"unknown {kind} {name!r}; valid: {', '.join(sorted(valid))}")


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
