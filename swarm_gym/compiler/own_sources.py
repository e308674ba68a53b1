"""Sources outside of the package that compiled code depends on: the optimizers and kernels of users.

The folder of the cache is named by the sources of this package. Code that was compiled for a class of a user
also depends on the module of this class and on what it imports. Parameters of an own optimizer are such a
class.

The cache needs the source that a module was executed from. Code that was typed in has no file: in a notebook
cell, IPython, on standard input or after `python -c`. A module that `importlib.reload` has executed again may
mix old and new code. So neither is cached, and each process compiles it.
"""

import ast
import hashlib
import importlib.util
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

import numba

PACKAGE = __name__.partition(".")[0]
_LIBRARIES = tuple(
    Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "platstdlib", "purelib", "platlib")
)


class UnknownSourceError(Exception):
    """A module without one known source, so that nobody can tell whether it has changed."""


class _Execution(NamedTuple):
    """The execution of a module: `importlib.reload` begins another one, with a new `spec`."""

    number: int
    spec: Any
    file: Path | None
    source: bytes


_executions: dict[str, _Execution] = {}


def has_file(function: FunctionType) -> bool:
    """Return whether a function was read from a source file, and not typed in."""
    return Path(function.__code__.co_filename).is_file()


def tell_apart(function: FunctionType) -> None:
    """Rename a function whose module is executed again, since Numba links code by names, the old code, too.

    The source of its module is read here, while it is executed: somebody may edit the file later.
    """
    for name in own_modules(function.__module__, ()):
        number = _execution(name).number
        if number > 1:
            function.__qualname__ += f"@{number}"


def own_modules(module: str | None, types: Iterable[numba.types.Type]) -> frozenset[str]:
    """Return the names of modules outside of this package that compiled code belongs to.

    Args:
        module: name of the module of the compiled function; None for one of no module.
        types: Numba's types of its arguments.
    """
    names = {module or "", *(found.__module__ for kind in types for found in _classes(kind))}
    return frozenset(name for name in names if _top(name) not in (PACKAGE, "numba", "builtins"))


def digest_of_modules(names: frozenset[str]) -> str:
    """Return a digest of the sources of modules and of all that they import, libraries left out.

    Raises:
        UnknownSourceError: if a module has no source file, as in a notebook, or was executed again.
    """
    found: dict[str, _Execution] = {}
    for name in names:
        if _execution(name).file is None:
            raise UnknownSourceError(name)
        _collect(name, frozenset(map(_top, names)), found)
    digest = hashlib.sha256()
    for name, execution in sorted(found.items()):
        if execution.number > 1:
            raise UnknownSourceError(name)
        digest.update(name.encode())
        digest.update(execution.source)
    return digest.hexdigest()[:16]


def _classes(kind: Any) -> Iterator[type]:
    """Yield the classes of all named tuples in a type."""
    if isinstance(kind, numba.types.BaseNamedTuple):
        yield kind.instance_class
    if isinstance(kind, numba.types.BaseTuple):
        for part in kind.types:
            yield from _classes(part)


def _collect(name: str, own: frozenset[str], found: dict[str, _Execution]) -> None:
    """Add the sources of a module and of what it imports: modules of the same packages, and no libraries."""
    module = sys.modules.get(name)
    file = _file_of(module)
    if module is None or file is None or name in found or _top(name) == PACKAGE:
        return
    if _top(name) not in own and any(file.is_relative_to(folder) for folder in _LIBRARIES):
        return
    found[name] = execution = _execution(name)
    for imported in _imports(execution.source, module.__package__ or ""):
        _collect(imported, own, found)


def _execution(name: str) -> _Execution:
    """Return the present execution of a module, with its source when it was first asked for."""
    module, last = sys.modules.get(name), _executions.get(name)
    spec = getattr(module, "__spec__", None)
    if last is None or last.spec is not spec:
        file = _file_of(module)
        source = b"" if file is None else file.read_bytes()
        _executions[name] = _Execution(1 if last is None else last.number + 1, spec, file, source)
    return _executions[name]


@cache
def _imports(source: bytes, package: str) -> tuple[str, ...]:
    """Return the names of modules that a source imports; some may be names of attributes."""
    names = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            relative = "." * node.level + (node.module or "")
            base = importlib.util.resolve_name(relative, package) if node.level else relative
            names += [base, *(f"{base}.{alias.name}" for alias in node.names)]
    return tuple(names)


def _file_of(module: ModuleType | None) -> Path | None:
    """Return the source file of a module; None where there is none, or where more can be typed in."""
    name = getattr(module, "__file__", None)
    if getattr(module, "__name__", None) == "__main__" and hasattr(sys, "ps1"):
        return None  # after `python -i` and `%run` a prompt goes on in the module of the script
    return Path(name).resolve() if name is not None and name.endswith(".py") else None


def _top(name: str) -> str:
    return name.partition(".")[0]
