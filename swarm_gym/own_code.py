"""Names of code outside this package: `module:attribute`, and entry points of installed packages.

They go wherever a name of a registry goes:

| kind | group of entry points | what the name stands for |
|---|---|---|
| controller | `swarm_gym.controllers` | class, or function without arguments, that gives a `Controller` |
| optimizer | `swarm_gym.optimizers` | subclass of `Optimizer` |
| scenario | `swarm_gym.scenarios` | scenario, or function without arguments that returns one |
| observation layout | `swarm_gym.observations` | `Observation` |
| action layout | `swarm_gym.actions` | `Layout` |
| reward | `swarm_gym.rewards` | function of a `Transition` |
| preset | `swarm_gym.presets` | `TrainConfig` |
| suite | `swarm_gym.suites` | `Suite` |

A name is looked up each time it is used. So after an edited notebook cell or `importlib.reload` it stands for
the new code; what was made before keeps the old one.

To import a module is to run its code. So a name imports code only if it is given on a command line or in a
call. Files, such as policies, presets and results databases, may hold names. A name in a file is refused
unless the same name was given before, for instance to `allow`.
"""

import hashlib
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from inspect import getsource
from pathlib import Path
from types import CodeType, FunctionType
from typing import TypeVar, cast

from swarm_gym.errors import SwarmGymError, UnknownNameError, shown

Entry = TypeVar("Entry")

GROUPS = {
    "controller": "swarm_gym.controllers",
    "optimizer": "swarm_gym.optimizers",
    "scenario": "swarm_gym.scenarios",
    "observation layout": "swarm_gym.observations",
    "action layout": "swarm_gym.actions",
    "reward": "swarm_gym.rewards",
    "preset": "swarm_gym.presets",
    "suite": "swarm_gym.suites",
}
_FORM = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*:[A-Za-z_]\w*", re.ASCII)

# Names that were given on the command line or in calls, and those that were used, with their kind.
_given: set[str] = set()
_used: set[tuple[str, str]] = set()


class OwnCodeError(SwarmGymError, ValueError):
    """A name of a user's own code that cannot be imported, is of another kind, or stands in a file only."""


def is_own(kind: str, name: object) -> bool:
    """Return whether a name that is not in the registry of its kind has the form of one of own code."""
    return isinstance(name, str) and (bool(_FORM.fullmatch(name)) or name in _installed(GROUPS[kind]))


def find(
    kind: str, name: object, registry: Mapping[str, Entry], fits: Callable[[object], bool], expected: str
) -> Entry:
    """Return the entry of a name in a registry, or what the name of own code stands for.

    Args:
        kind: key of `GROUPS`.
        name: name that was given on a command line or in a call.
        registry: entries of this package by name.
        fits: whether the attribute that own code has under that name is of the right kind.
        expected: description of the right kind, for messages.

    Raises:
        UnknownNameError: for a name that is neither in the registry nor of the form of own code.
        OwnCodeError: if the module cannot be imported, the attribute is missing or of another kind, or an
            installed package uses a name of the registry for an entry point.
    """
    if isinstance(name, str) and name in registry:
        _refuse_shadow(kind, name)
        return registry[name]
    if not is_own(kind, name):
        raise UnknownNameError(kind, name, [*registry, *_installed(GROUPS[kind]), "<module>:<attribute>"])
    return cast(Entry, own(kind, str(name), fits, expected))


def own(kind: str, name: str, fits: Callable[[object], bool], expected: str) -> object:
    """Import what a name of own code stands for; `find` describes the arguments and errors."""
    found = _imported(kind, name)
    if not fits(found):
        raise OwnCodeError(f"{kind} {shown(name)}: expected {expected}, got {shown(found)}")
    _used.add((kind, name))
    _given.add(name)
    return found


def refuse_unless_given(kind: str, name: object, where: str) -> None:
    """Raise an error if a name from a file stands for own code that was not named outside files.

    Args:
        kind: key of `GROUPS`.
        name: name that is not in the registry of its kind.
        where: the file and the place in it, for the message.

    Raises:
        OwnCodeError: if the name would import code.
    """
    if is_own(kind, name) and not was_given(name):
        raise OwnCodeError(
            f"{where}: {kind} {shown(name)} stands for code, which a name in a file never imports; if you "
            f"trust it, name it yourself: swarm_gym.own_code.allow({name!r}), or --allow {name} in a command"
        )


def was_given(name: object) -> bool:
    """Return whether own code was named outside files in this process."""
    return isinstance(name, str) and name in _given


def allow(*names: str) -> None:
    """Let files name own code; it is imported when it is used."""
    _given.update(names)


def given() -> tuple[str, ...]:
    """Return the names of own code that were given in this process, for `allow` in another one."""
    return tuple(sorted(_given))


def origin_of(kind: str, name: str) -> str:
    """Return a digest of the source of own code, and the version of its distribution if it is installed.

    It changes with any change of the module that the name is in. Modules that this one imports are not part
    of it. Of code without a file, as in a notebook, it is a digest of the definition.
    """
    found = own(kind, name, lambda _: True, "anything")
    file, point = _source_file(kind, name), _installed(GROUPS[kind]).get(name)
    source = _definition(found).encode() if file is None else file.read_bytes()
    digest = f"source {hashlib.sha256(source).hexdigest()[:16]}"
    if point is None or point.dist is None:
        return digest
    return f"{digest} of {point.dist.name} {point.dist.version}"


def source_files() -> dict[str, Path]:
    """Return the files of the own code that was used so far, by name, without installed packages."""
    files = {name: _source_file(kind, name) for kind, name in _used if name not in _installed(GROUPS[kind])}
    return {name: file for name, file in files.items() if file is not None}


def _source_file(kind: str, name: str) -> Path | None:
    """Return the file of the module of own code; None if it has none."""
    point = _installed(GROUPS[kind]).get(name)
    module = import_module(name.partition(":")[0] if point is None else point.module)
    file = getattr(module, "__file__", None)  # a notebook has none
    return None if file is None else Path(file).resolve()


def _definition(found: object) -> str:
    """Return the source of a class or function that was typed in, or else the code that it compiled to."""
    with suppress(OSError, TypeError):
        return getsource(found)  # type: ignore[arg-type]  # other objects raise a TypeError
    inside = [value for _, value in sorted(vars(found).items())] if isinstance(found, type) else [found]
    functions = [value for value in inside if isinstance(value, FunctionType)]
    if not functions:
        return repr(found)
    return "\n".join(_compiled(function.__code__) for function in functions)


def _compiled(code: CodeType) -> str:
    """Return the instructions, names and constants of code as text, without addresses of objects."""
    constants = [_compiled(each) if isinstance(each, CodeType) else repr(each) for each in code.co_consts]
    return repr((code.co_code, code.co_names, constants))


@cache
def _installed(group: str) -> dict[str, EntryPoint]:
    """Return the entry points of installed packages by name."""
    return {point.name: point for point in entry_points(group=group)}


def _refuse_shadow(kind: str, name: str) -> None:
    """Raise an error if an installed package has an entry point of a name that this package has."""
    point = _installed(GROUPS[kind]).get(name)
    if point is not None:
        package = "an installed package" if point.dist is None else point.dist.name
        raise OwnCodeError(
            f"{kind} {name!r}: {package} has an entry point of this name, {point.value!r}; it needs another "
            "one, since swarm_gym has this name"
        )


def _imported(kind: str, name: str) -> object:
    """Return the attribute that a name stands for."""
    point = _installed(GROUPS[kind]).get(name)
    module, _, attribute = (name if point is None else point.value).partition(":")
    try:
        found = import_module(module)
    except Exception as error:  # a module may raise anything while it is imported
        reason = f"{type(error).__name__}: {error}"
        raise OwnCodeError(
            f"{kind} {shown(name)}: module {module!r} cannot be imported ({reason[:400]})"
        ) from error
    for part in attribute.split("."):
        if not hasattr(found, part):
            raise OwnCodeError(f"{kind} {shown(name)}: module {module!r} has no attribute {attribute!r}")
        found = getattr(found, part)
    return found
