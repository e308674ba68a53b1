"""Costs of the best flights of this study's rows, in files that a later call goes on from."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from experiments.studies.terrain.peers import best_cost
from experiments.studies.terrain.rows import PLANNED, SIZES, AnyRow, PeerRow, Row
from swarm_gym.controllers import make_controller
from swarm_gym.files import write_atomically
from swarm_gym.problem import TerrainProblem
from swarm_gym.reference.flight_ways import flight_ways
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.provenance import provenance
from swarm_gym.runs.seeds import TEST
from swarm_gym.scenarios import make_scenario
from swarm_gym.worlds import make_problem

Floats = NDArray[np.float64]


class Asked(NamedTuple):
    """Runs of each row on each terrain.

    Attributes:
        cost: name of the cost.
        evaluations: evaluation budgets, each of which has runs of its own.
        runs: number of runs.
    """

    cost: str
    evaluations: tuple[int, ...]
    runs: int


def measure(row: AnyRow, terrain: str, asked: Asked, folder: Path) -> Floats:
    """Return the best costs, (budgets, runs), of a row on a terrain; known ones are read from the folder."""
    scenario = make_scenario(terrain)
    problem = make_problem(scenario, encoding=row.encoding, cost=asked.cost)
    identity = {"row": list(row), "runs": asked.runs, "problem": repr(problem.identity)}
    found = []
    for evaluations in asked.evaluations:
        parts = (terrain.replace(":", "-"), asked.cost, *row, str(evaluations), f"{asked.runs}.json")
        name = "-".join(parts).replace(" ", "-")
        stored = _read(folder / name, identity)
        if stored is None:
            if isinstance(row, PeerRow):
                stored = [best_cost(row.peer, problem, evaluations, seed) for seed in TEST[: asked.runs]]
            else:
                stored = _run(row, terrain, asked, evaluations)
            content = {"asked": identity, "costs": stored, "provenance": provenance()}
            folder.mkdir(parents=True, exist_ok=True)
            write_atomically(folder / name, json.dumps(content) + "\n")
        found.append(stored)
    return np.array(found)


def measure_all(
    chosen: Iterable[AnyRow], terrains: Sequence[str], asked: Asked, folder: Path
) -> dict[str, Floats]:
    """Return the best costs, (terrains, budgets, runs), of all rows by name, planned flights among them.

    The maps are made once for all rows: one terrain follows the other.
    """
    found: dict[str, list[Floats]] = {}
    every = list(chosen)
    for terrain in tqdm(terrains, desc="terrains", unit="terrain"):
        for row in every:
            found.setdefault(row.name, []).append(measure(row, terrain, asked, folder))
        planned = np.full((len(asked.evaluations), asked.runs), planned_cost(terrain, asked.cost))
        found.setdefault(PLANNED, []).append(planned)
    return {name: np.stack(parts) for name, parts in found.items()}


def planned_cost(terrain: str, cost: str) -> float:
    """Return the cost of the best planned flight, which no swarm has improved."""
    problem = cast(TerrainProblem, make_problem(make_scenario(terrain), cost=cost))
    return min(problem.evaluate(flight)[0] for flight in flight_ways(problem, 4))


def _read(file: Path, identity: Mapping[str, object]) -> list[float] | None:
    if not file.is_file():
        return None
    stored = json.loads(file.read_text(encoding="utf-8"))
    return stored["costs"] if stored["asked"] == identity else None


def _run(row: Row, terrain: str, asked: Asked, evaluations: int) -> list[float]:
    size = SIZES[row.optimizer]
    episodes = run_episodes(
        make_controller(f"fixed:{size}"),
        terrain,
        TEST[: asked.runs],
        row.optimizer,
        encoding=row.encoding,
        cost=asked.cost,
        source=row.source,
        iterations=evaluations,
        max_evaluations=evaluations,
    )
    return episodes.final_fitness.tolist()
