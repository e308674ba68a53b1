"""Costs of the best flights of this study's rows, in files that a later call goes on from."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from experiments.studies.libraries import run_peer
from experiments.studies.terrain.controllers_of_terrain import controller_of
from experiments.studies.terrain.rows import AnyRow, ControlledRow, PeerRow, PlannedRow, Row
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import Controller
from swarm_gym.files import write_atomically
from swarm_gym.optimizers import get_optimizer
from swarm_gym.problem import Problem, TerrainProblem
from swarm_gym.reference.layered_flights import flight_ways
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.provenance import provenance
from swarm_gym.runs.seeds import TEST
from swarm_gym.scenarios import make_scenario
from swarm_gym.simulation import Simulation
from swarm_gym.worlds import make_problem

Floats = NDArray[np.float64]
Flights = Iterator[tuple[float, Floats]]  # costs of runs, and the vectors of their best flights


class Asked(NamedTuple):
    """Runs of each row on each terrain.

    Attributes:
        cost: name of the cost.
        evaluations: evaluation budgets, each of which has runs of its own.
        runs: number of runs of a row.
        peer_runs: number of runs of a row of another library.
        policy_runs: number of runs of each policy of a row; None is as many as `runs`.
    """

    cost: str
    evaluations: tuple[int, ...]
    runs: int
    peer_runs: int
    policy_runs: int | None = None

    def runs_of(self, row: AnyRow) -> int:
        """Return the number of runs of each controller of a row."""
        if isinstance(row, PlannedRow):
            return 1
        if isinstance(row, PeerRow):
            return self.peer_runs
        return self.policy_runs if row.is_learned and self.policy_runs else self.runs

    def in_words(self, *, peers: bool = False) -> str:
        """Return the numbers of runs as a caption names them, with those of other libraries or without."""
        others = [f"{self.policy_runs} of each policy"] if self.policy_runs else []
        if peers and self.peer_runs != self.runs:
            others.append(f"{self.peer_runs} of other libraries")
        each = "" if self.policy_runs else ", of each policy where there are several"
        listed = f" ({', '.join(others)})" if others else ""
        return f"{self.runs} runs{listed}{each}"


class _Found(NamedTuple):
    """Known results of a row on a terrain with one evaluation budget.

    Attributes:
        runs: number of runs of each controller.
        costs: costs of the best flights, one controller after the other.
        vector: decision vector of the flight of the least cost.
    """

    runs: int
    costs: list[float]
    vector: list[float]


def measure(row: AnyRow, terrain: str, asked: Asked, folder: Path, used: set[Path] | None = None) -> Floats:
    """Return the best costs, (budgets, runs), of a row on a terrain.

    Known ones are read from the folder. Where it has fewer runs than asked for, the others are added to them.
    A file of more runs is not used. Costs of a budget that the row is not for are NaN. A file has the flight
    of the least cost, too.

    Args:
        row: the row.
        terrain: name of the terrain.
        asked: cost, budgets and numbers of runs.
        folder: folder that keeps the costs of all runs.
        used: the files of these runs are added to it.
    """
    scenario = make_scenario(terrain)
    problem = make_problem(scenario, encoding=row.encoding, cost=asked.cost)
    runs = asked.runs_of(row)
    found: list[list[float]] = []
    for evaluations in asked.evaluations:
        if isinstance(row, ControlledRow) and not row.is_for(evaluations):
            found.append([np.nan] * runs * len(row.controllers))
            continue
        identity = _identity(row, problem, evaluations)
        name = _file_name(row, terrain, asked.cost, evaluations)
        known, files = _read(folder, name, identity, runs)
        if known.runs < runs:
            seeds = TEST[known.runs : runs]
            known = _added(known, _flights(row, problem, terrain, asked.cost, evaluations, seeds), len(seeds))
            content = {"terrain": terrain, "cost": asked.cost, "row": row.name, "evaluations": evaluations}
            flight = {"encoding": row.encoding, "vector": known.vector}
            folder.mkdir(parents=True, exist_ok=True)
            found_now = {"costs": known.costs, "flight": flight, "provenance": provenance()}
            whole = {"asked": {**identity, "runs": runs}, **content, **found_now}
            files.append(write_atomically(folder / f"{name}-{runs}.json", json.dumps(whole) + "\n"))
        if used is not None:
            used.update(files)
        found.append(known.costs)
    return np.array(found)


def measure_all(
    chosen: Iterable[AnyRow],
    terrains: Sequence[str],
    asked: Asked,
    folder: Path,
    used: set[Path] | None = None,
) -> dict[str, Floats]:
    """Return the best costs, (terrains, budgets, runs), of all rows by name; see `measure`.

    The maps are made once for all rows: one terrain follows the other.
    """
    found: dict[str, list[Floats]] = {}
    every = list(chosen)
    for terrain in tqdm(terrains, desc="terrains", unit="terrain"):
        for row in every:
            found.setdefault(row.name, []).append(measure(row, terrain, asked, folder, used))
    return {name: np.stack(parts) for name, parts in found.items()}


def _file_name(row: AnyRow, terrain: str, cost: str, evaluations: int) -> str:
    """Return the name of a file without its number of runs."""
    parts = (terrain.replace(":", "-"), cost, row.name, str(evaluations))
    return "-".join(parts).replace(", ", "-").replace(" ", "-")


def _identity(row: AnyRow, problem: Problem, evaluations: int) -> dict[str, object]:
    whole: dict[str, object] = {"row": row.name, "problem": repr(problem.identity)}
    if isinstance(row, ControlledRow):
        controllers = [_controller(row, name, evaluations).identity() for name in row.controllers]
        whole["iterations"] = row.iterations and row.iterations_of(evaluations)
        whole["controllers"] = repr(controllers)
    return whole


@cache
def _controller(row: ControlledRow, name: str, evaluations: int) -> Controller:
    return controller_of(row, name, evaluations)


def _read(folder: Path, name: str, identity: Mapping[str, object], runs: int) -> tuple[_Found, list[Path]]:
    """Return what is stored with the most runs, but no more than these, and the files that it came from.

    A file to which runs were added is among these, since it has the commit of the first ones.
    """
    known, files = _Found(0, [], []), []
    for number in range(1, runs + 1):
        file = folder / f"{name}-{number}.json"
        if file.is_file():
            stored = json.loads(file.read_text(encoding="utf-8"))
            if stored["asked"] == {**identity, "runs": number}:
                known = _Found(number, stored["costs"], stored["flight"]["vector"])
                files.append(file)
    return known, files


def _added(known: _Found, flights: Flights, runs: int) -> _Found:
    """Return what is known with further runs, of which flights come in the same order of controllers."""
    further, vectors = zip(*flights, strict=True)
    controllers = len(further) // runs
    both = np.reshape(known.costs, (controllers, known.runs)), np.reshape(further, (controllers, runs))
    costs = np.concatenate(both, axis=1)
    is_better = min(further) < min(known.costs, default=np.inf)
    vector = vectors[int(np.argmin(further))].tolist() if is_better else known.vector
    return _Found(known.runs + runs, costs.ravel().tolist(), vector)


def _flights(
    row: AnyRow, problem: Problem, terrain: str, cost: str, evaluations: int, seeds: range
) -> Flights:
    """Yield the cost and the vector of the best flight of each run, one controller after the other."""
    if isinstance(row, PlannedRow):
        ways = flight_ways(cast(TerrainProblem, problem), 4)
        yield min(((problem.evaluate(way)[0], way) for way in ways), key=lambda flight: flight[0])
    elif isinstance(row, PeerRow):
        for seed in seeds:
            found = run_peer(row.peer, problem, evaluations, seed)
            yield float(found.best), found.vector
    else:
        for name in row.controllers:
            yield from _episodes(row, name, terrain, cost, evaluations, seeds)


def _episodes(
    row: Row | ControlledRow, name: str, terrain: str, cost: str, evaluations: int, seeds: range
) -> Flights:
    """Yield the flights of the runs of one controller, side by side."""
    controlled = isinstance(row, ControlledRow)
    ended: list[Any] = []

    def look(simulation: Simulation) -> None:
        ended[:] = [simulation.swarms.best_fitness, simulation.swarms.best_position, simulation.dimension]

    run_episodes(
        _controller(row, name, evaluations) if controlled else make_controller(name),
        terrain,
        seeds,
        row.optimizer,
        look,
        **_options(row, evaluations),
        cost=cost,
        source=row.source,
        max_evaluations=evaluations,
    )
    costs, places, dimension = ended
    for value, place in zip(costs.tolist(), places, strict=True):
        yield value, place[:dimension].copy()


def _options(row: Row | ControlledRow, evaluations: int) -> dict[str, Any]:
    """Return further options of the environments of a row."""
    if isinstance(row, Row):
        return {"encoding": row.encoding, "iterations": evaluations}
    smallest = max(2, get_optimizer(row.optimizer).smallest_population)
    iterations = row.iterations_of(evaluations)
    return {"encoding": row.encoding, "iterations": iterations, "min_population_size": smallest}
