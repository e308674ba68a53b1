"""The catalogue of studies: suites, collections of suites, tables, figures and documents, each by its name.

They are collected from the folders of `experiments.studies`, so that a study is added by adding a folder. Its
modules state what it has, all of it optional:

* `suites.py`: SUITES, a tuple of suites, and COLLECTIONS, tuples of names of suites by the name that stands
  for all of them. DOCUMENTS that show suites whose tables all belong to other studies.
* `tables.py`: TABLES, functions of a suite and its outcomes that make tables, and DOCUMENTS, which show them:
  under each name a page, and its appendix if it has one.
* `figures.py`: FIGURES, functions of what is stored that tell what can be drawn. This module is imported only
  when a figure is drawn, since runs need no plotting library.
* `claims.toml`: comparative sentences about the runs of its suites (`experiments.runs.claims`).

A suite states by name which tables and figures are made of it, also those of another study.
"""

import pkgutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from experiments import studies
from experiments.runs.claims import load_claims
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.tables import Table
from experiments.tables.document import Document
from swarm_gym.errors import UnknownNameError
from swarm_gym.own_code import find, is_own

if TYPE_CHECKING:
    from experiments.plots.stored import FigureMaker

TableMaker = Callable[[Suite, Outcomes], list[Table]]


def _modules(name: str) -> Iterator[ModuleType]:
    """Import and yield the module of that name of every study that has one."""
    for package in pkgutil.iter_modules(studies.__path__, f"{studies.__name__}."):
        if package.ispkg and find_spec(f"{package.name}.{name}"):
            yield import_module(f"{package.name}.{name}")


def _collect(module: str, registry: str) -> dict[str, Any]:
    """Return the entries of a registry of all studies.

    Raises:
        ValueError: if two studies have an entry of the same name.
    """
    found: dict[str, Any] = {}
    for stated in _modules(module):
        entries = getattr(stated, registry, {})
        if not isinstance(entries, Mapping):
            entries = {entry.name: entry for entry in entries}
        if twice := found.keys() & entries.keys():
            raise ValueError(f"{stated.__name__}.{registry}: another study has {', '.join(sorted(twice))}")
        found |= entries
    return found


def _suites() -> dict[str, Suite]:
    """Return the suites of all studies, each with the claims about it.

    Raises:
        ClaimFileError: for a file of claims with an invalid entry.
    """
    files = sorted(Path(*studies.__path__).glob("*/claims.toml"))
    claims = [claim for file in files for claim in load_claims(file)]
    return {
        name: replace(suite, claims=tuple(claim for claim in claims if claim.suite == name))
        for name, suite in _collect("suites", "SUITES").items()
    }


SUITES = _suites()
COLLECTIONS: dict[str, tuple[str, ...]] = _collect("suites", "COLLECTIONS")
TABLES: dict[str, TableMaker] = _collect("tables", "TABLES")
DOCUMENTS: dict[str, tuple[Document, ...]] = _collect("suites", "DOCUMENTS") | _collect("tables", "DOCUMENTS")


@cache
def figures() -> "dict[str, FigureMaker]":
    """Return the makers of figures by name; imports the plotting library."""
    return _collect("figures", "FIGURES")


def get_suite(name: str) -> Suite:
    """Return the suite of that name, which may be one of own code.

    Raises:
        UnknownNameError: if there is none.
        OwnCodeError: if own code cannot be imported, or is no suite.
    """
    if name not in SUITES and not is_own("suite", name):
        valid = (*SUITES, *COLLECTIONS)
        raise UnknownNameError("suite", name, valid, "python -m experiments.evaluate --help")
    return find("suite", name, SUITES, lambda found: isinstance(found, Suite), "a Suite")
