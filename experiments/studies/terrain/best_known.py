"""The best known flights over the test terrains: a file of this study, from which excess is measured.

`collect` replaces a flight by a better one of stored runs, with a note on where it comes from. A test
measures each of these flights again with code of its own.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from swarm_gym.files import write_atomically
from swarm_gym.problem import Problem
from swarm_gym.scenarios import make_scenario
from swarm_gym.worlds import make_problem

Floats = NDArray[np.float64]

FILE = Path(__file__).parent / "data" / "best_known.json"
CHANGES, LAST_DIGITS = 32, 1e-9  # of vectors, as shares of their bounds, with which the cost has to stay


class Flight(TypedDict):
    """A flight of small cost.

    Attributes:
        cost: cost of the flight.
        encoding: name of the encoding of the vector.
        vector: decision vector of the flight.
        found_by: the row and the number of evaluations that found it.
        replaces: cost of the flight that it replaced, and what had found that; empty for the first one.
    """

    cost: float
    encoding: str
    vector: list[float]
    found_by: str
    replaces: str


def best_known(cost: str, file: Path = FILE) -> dict[str, Flight]:
    """Return the best known flights by the name of their terrain.

    Args:
        cost: name of the cost.
        file: file of the flights; one that is missing has none.
    """
    return _read(file).get(cost, {})


def least_costs(cost: str, terrains: Sequence[str], file: Path = FILE) -> Floats:
    """Return the costs of the best known flights over these terrains; infinite where none is known."""
    known = best_known(cost, file)
    return np.array([known[name]["cost"] if name in known else np.inf for name in terrains])


def collect(runs: Path, terrains: Sequence[str], file: Path = FILE) -> list[str]:
    """Replace best known flights by better ones of stored runs; return the names of their terrains.

    A flight is evaluated again before it is stored. One whose cost hangs on the last digits of its vector, as
    on the edge of a threat, is left out: other code may find another cost.

    Args:
        runs: folder of the files that `measured_costs` writes.
        terrains: names of the terrains whose flights are kept.
        file: file of the flights.
    """
    known, improved = _read(file), []
    for one in tqdm(sorted(runs.glob("*.json")), desc="runs", unit="file"):
        stored = json.loads(one.read_text(encoding="utf-8"))
        terrain, cost = stored.get("terrain"), stored.get("cost")
        if terrain not in terrains or not stored["flight"]["vector"]:
            continue
        flights = known.setdefault(cost, {})
        before = flights.get(terrain)
        least = min(stored["costs"])
        if before is not None and least >= before["cost"]:
            continue
        flight = stored["flight"]
        problem = make_problem(make_scenario(terrain), encoding=flight["encoding"], cost=cost)
        again, _ = problem.evaluate(np.array(flight["vector"]))
        if again != least:
            raise ValueError(f"{one}: the flight costs {again!r}, but {least!r} is stored; delete the file")
        if not is_steady(problem, np.array(flight["vector"])):
            continue
        flights[terrain] = {
            "cost": least,
            "encoding": flight["encoding"],
            "vector": flight["vector"],
            "found_by": f"{stored['row']}, {stored['evaluations']:,} evaluations",
            "replaces": f"{before['cost']}, {before['found_by']}" if before else "",
        }
        improved.append(terrain)
    if improved:
        ordered = {cost: dict(sorted(flights.items(), key=_number)) for cost, flights in known.items()}
        write_atomically(file, json.dumps(ordered, indent=1) + "\n")
    return sorted(set(improved))


def is_steady(problem: Problem, vector: Floats) -> bool:
    """Return whether the cost of a decision vector (D,) stays when its last digits change."""
    cost = problem.evaluate(vector)[0]
    low, high = problem.bounds
    moves = np.random.default_rng(0).uniform(-1.0, 1.0, (CHANGES, len(vector)))
    others = [problem.evaluate(vector + LAST_DIGITS * (high - low) * move)[0] for move in moves]
    return bool(np.allclose(others, cost, rtol=1e-6, atol=0.0))


def _number(item: tuple[str, Flight]) -> tuple[str, int]:
    family, _, number = item[0].rpartition(":")
    return family, int(number) if number.isdecimal() else 0


def _read(file: Path) -> dict[str, dict[str, Flight]]:
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
