"""Sources outside of the package that compiled code depends on: those of optimizers and kernels of users.

The folder of the cache is named by the sources of this package. Code that was compiled for a class of a user,
such as the parameters of an own optimizer, also depends on the module of this class and on what it imports.
"""

import ast
import hashlib
import importlib.util
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numba

PACKAGE = __name__.partition(".")[0]
_LIBRARIES = tuple(
    Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "platstdlib", "purelib", "platlib")
)


class UnknownSourceError(Exception):
    """A module has no source file, so that nobody can tell whether it has changed."""


def own_modules(module: str, types: Iterable[Any]) -> frozenset[str]:
    """Return the names of modules outside of this package that compiled code belongs to.

    Args:
        module: name of the module of the compiled function.
        types: Numba's types of its arguments.
    """
    names = {module, *(found.__module__ for kind in types for found in _classes(kind))}
    return frozenset(name for name in names if _top(name) not in (PACKAGE, "numba", "builtins"))


@cache
def digest_of_modules(names: frozenset[str]) -> str:
    """Return a digest of the sources of modules and of all that they import, libraries left out.

    It is computed once in a process, as modules are imported once.

    Raises:
        UnknownSourceError: if a module has no source file, as in a notebook.
    """
    found: dict[str, Path] = {}
    for name in names:
        if _file_of(sys.modules.get(name)) is None:
            raise UnknownSourceError(name)
        _collect(name, frozenset(map(_top, names)), found)
    digest = hashlib.sha256()
    for name, file in sorted(found.items()):
        digest.update(name.encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def _classes(kind: Any) -> Iterator[type]:
    """Yield the classes of all named tuples in a type."""
    if isinstance(kind, numba.types.BaseNamedTuple):
        yield kind.instance_class
    if isinstance(kind, numba.types.BaseTuple):
        for part in kind.types:
            yield from _classes(part)


def _collect(name: str, own: frozenset[str], found: dict[str, Path]) -> None:
    """Add the files of a module and of what it imports: modules of the same packages, and no libraries."""
    module = sys.modules.get(name)
    file = _file_of(module)
    if module is None or file is None or name in found or _top(name) == PACKAGE:
        return
    if _top(name) not in own and any(file.is_relative_to(folder) for folder in _LIBRARIES):
        return
    found[name] = file
    for imported in _imports(file, module.__package__ or ""):
        _collect(imported, own, found)


def _imports(file: Path, package: str) -> Iterator[str]:
    """Yield the names of modules that a source file imports; some may be names of attributes."""
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name
        elif isinstance(node, ast.ImportFrom):
            relative = "." * node.level + (node.module or "")
            base = importlib.util.resolve_name(relative, package) if node.level else relative
            yield base
            for alias in node.names:
                yield f"{base}.{alias.name}"


def _file_of(module: ModuleType | None) -> Path | None:
    name = getattr(module, "__file__", None)
    return Path(name).resolve() if name is not None and name.endswith(".py") else None


def _top(name: str) -> str:
    return name.partition(".")[0]
