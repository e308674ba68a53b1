"""Costs of the best flights of this study's rows, in files that a later call goes on from."""

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from experiments.studies.libraries import run_peer
from experiments.studies.terrain.controllers_of_terrain import controller_of
from experiments.studies.terrain.library_runs import kept_runs
from experiments.studies.terrain.rows import AnyRow, ControlledRow, PeerRow, PlannedRow, Row, Setting
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

    Known ones are read from the folder, and those of libraries from the file of `library_runs`, too. Where
    these are fewer than asked for, further runs are added to them. A file of more runs in the folder is not
    used. Files in the folder have the flight of the least cost, too; runs from the file of `library_runs`
    come without flights. Runs have the same seeds on all terrains, those for validation among them.

    Args:
        row: the row.
        terrain: name of the terrain.
        asked: cost, budgets and numbers of runs.
        folder: folder that keeps the costs of all runs.
        used: the files of these runs are added to it.
    """
    problem = make_problem(make_scenario(terrain), encoding=row.encoding, cost=asked.cost)
    runs = asked.runs_of(row)
    found: list[list[float]] = []
    for evaluations in asked.evaluations:
        setting = Setting(row.name, asked.cost, evaluations, terrain)
        costs, files = _measure(row, problem, setting, runs, folder)
        found.append(costs)
        if used is not None:
            used.update(files)
    return np.array(found)


def _measure(
    row: AnyRow, problem: Problem, setting: Setting, runs: int, folder: Path
) -> tuple[list[float], list[Path]]:
    """Return the best costs of a row in a setting, and the files of these runs."""
    identity = _identity(row, problem, setting.evaluations)
    name = _file_name(setting)
    known, files = _read(folder, name, identity, runs)

    def store(found: _Found, origin: Mapping[str, object]) -> Path:
        flight = {"encoding": row.encoding, "vector": found.vector}
        content = {"costs": found.costs, "flight": flight, "provenance": origin}
        whole = {"asked": {**identity, "runs": found.runs}, **setting._asdict(), **content}
        folder.mkdir(parents=True, exist_ok=True)
        return write_atomically(folder / f"{name}-{found.runs}.json", json.dumps(whole) + "\n")

    kept = None
    if known.runs < runs and isinstance(row, PeerRow):
        kept = kept_runs(setting, problem)
    if kept is not None and known.runs < min(runs, len(kept.costs)):
        known = _Found(min(runs, len(kept.costs)), kept.costs[:runs], [])
        files = [store(known, {"commit": kept.commit})]
    if known.runs < runs:
        flights = _flights(row, problem, setting, TEST[known.runs : runs])
        known = _added(known, flights, runs - known.runs)
        files.append(store(known, provenance()))
    return known.costs, files


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


def _file_name(setting: Setting) -> str:
    """Return the name of a file without its number of runs."""
    name = "-".join((setting.terrain, setting.cost, setting.row, str(setting.evaluations)))
    return re.sub(r", |[ :/\\]", "-", name)


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


def _flights(row: AnyRow, problem: Problem, setting: Setting, seeds: range) -> Flights:
    """Yield the cost and the vector of the best flight of each run, one controller after the other."""
    if isinstance(row, PlannedRow):
        ways = flight_ways(cast(TerrainProblem, problem), 4)
        yield min(((problem.evaluate(way)[0], way) for way in ways), key=lambda flight: flight[0])
    elif isinstance(row, PeerRow):
        for seed in seeds:
            found = run_peer(row.peer, problem, setting.evaluations, seed)
            yield float(found.best), found.vector
    else:
        for name in row.controllers:
            yield from _episodes(row, name, setting, seeds)


def _episodes(row: Row | ControlledRow, name: str, setting: Setting, seeds: range) -> Flights:
    """Yield the flights of the runs of one controller, side by side."""
    controlled = isinstance(row, ControlledRow)
    ended: list[Any] = []

    def look(simulation: Simulation) -> None:
        ended[:] = [simulation.swarms.best_fitness, simulation.swarms.best_position, simulation.dimension]

    run_episodes(
        _controller(row, name, setting.evaluations) if controlled else make_controller(name),
        setting.terrain,
        seeds,
        row.optimizer,
        look,
        **_options(row, setting.evaluations),
        cost=setting.cost,
        source=row.source,
        max_evaluations=setting.evaluations,
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
