"""Optima that are known, by a digest of the problem: packaged, or computed here before.

`optima.json` (the paper's cases, also with a gate or a block on them) and the files of fields are generated
by `python -m swarm_gym.reference.waypoint_optimum --ship`; tests compute them again. What is computed by
`swarm_gym.reference.ensure_optima` is stored in the user's cache, a file for each problem.
"""

import hashlib
import json
import math
from functools import cache
from importlib import resources
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

import swarm_gym.problem
from swarm_gym.files import digest_of_sources, user_cache, write_atomically
from swarm_gym.problem import Problem

# Files that come with the package, by the fields whose optima they have.
FIELD_FILES = {
    "random_fields.json": (
        "random-fields:train:0-511",
        "random-fields:validation:0-63",
        "random-fields:test:0-599",
        "random-fields:denser:0-39",
        "random-fields:larger:0-39",
        "random-fields:narrow:0-39",
        "random-fields:large-obstacles:0-39",
        "random-fields:rotated:0-39",
    ),
    "dynamic_fields.json": (
        "dynamic-fields:train:0-255",
        "dynamic-fields:validation:0-63",
        "dynamic-fields:test:0-599",
        "dynamic-fields:moving:0-299",
    ),
}


class FieldOptimum(NamedTuple):
    """The least fitness on a field of circles, in map units.

    Attributes:
        digest: name of the problem, see `digest`.
        fitness: least fitness.
        shortest_path: length of the shortest path.
    """

    digest: str
    fitness: float
    shortest_path: float


def digest(problem: Problem) -> str:
    """Return a name of a problem that is equal for equal geometry, encoding and weight."""
    return hashlib.sha256(repr(problem.identity).encode()).hexdigest()[:16]


@cache
def packaged_optima() -> dict[str, float]:
    """Return the least fitness of the problems that ship with the package, by digest, in map units."""
    found = {entry["digest"]: entry["fitness"] for entry in json.loads(_text("optima.json"))}
    for file in FIELD_FILES:
        found.update((field.digest, field.fitness) for field in packaged_fields(file).values())
    return found


def packaged_fields(file: str) -> dict[str, FieldOptimum]:
    """Return the optima in a file of `FIELD_FILES`, by name of the field."""
    return {name: FieldOptimum(*entry) for name, entry in json.loads(_text(file)).items()}


def _text(file: str) -> str:
    return resources.files("swarm_gym.reference").joinpath(file).read_text(encoding="utf-8")


def known_optimum(problem: Problem) -> float:
    """Return the least fitness of a problem if it is given, packaged or stored, else NaN."""
    if problem.least_fitness is not None:
        return problem.least_fitness
    name = digest(problem)
    if name in packaged_optima():
        return packaged_optima()[name]
    try:
        return float(_stored(name).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return math.nan


def gap_to_optimum(fitness: ArrayLike, optimum: ArrayLike) -> NDArray[np.float64]:
    """Return the fitness above the optimum, relative to it; absolute if that is 0; NaN if it is NaN."""
    unit = np.where(np.equal(optimum, 0.0), 1.0, optimum)
    return np.subtract(fitness, optimum) / unit


def store_optimum(problem: Problem, fitness: float) -> None:
    """Make the least fitness of a problem, in map units, known to this user's processes from now on."""
    write_atomically(_stored(digest(problem)), repr(float(fitness)))


def _stored(name: str) -> Path:
    return user_cache() / "optima" / _definition() / name


@cache
def _definition() -> str:
    """Return a digest of the sources that define fitness; optima stored under other sources do not count."""
    return digest_of_sources(Path(swarm_gym.problem.__file__).parent)
