"""The published cost of flights beside the code that publishes it: MetaBox's, in NumPy, and the kernels here.

One kernel computes the cost alone, as MetaBox's code does. The other also measures the degree of collision.
MetaBox computes the cost of a population at once, so that its time for a flight depends on the population.
`pip install --no-deps metaevobox` brings its code. Its packages import all of its optimizers and what these
need, so only the module of the cost is imported.
"""

import sys
import time
from collections.abc import Callable, Sequence
from functools import cache
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from experiments.speed.measurement import machine
from experiments.tables import Table
from experiments.tables.cell import Entry, number
from swarm_gym.compiler.jit import entry
from swarm_gym.problem import TerrainProblem
from swarm_gym.problem.padding import columns
from swarm_gym.problem.tables import evaluate
from swarm_gym.problem.terrain.as_coded import PENALTY
from swarm_gym.problem.terrain.table import TerrainTable
from swarm_gym.scenarios import TerrainScenario, make_scenario

Floats = NDArray[np.float64]

PACKAGE, MODULE = "metaevobox", "environment.problem.SOO.UAV.uav_numpy"
TERRAINS = ("terrain:test:0", "terrain:test:28")  # the first with few threats, and the first with many
POPULATIONS = (1, 50, 1000)
NUM_FLIGHTS = 1000  # of a repeat, in as many populations as that makes; 20 populations at most
MOST_POPULATIONS, REPEATS = 20, 9

Cost = Callable[[Floats], Floats]


def table_beside_metabox() -> Table:
    """Return the table of times, measured now; the costs of the first flights are compared before.

    Raises:
        ValueError: if the package of MetaBox is not installed, or a cost differs by more than 1e-9 of itself.
    """
    rows = []
    _module()
    for terrain in tqdm(TERRAINS, desc="beside MetaBox", unit="terrain"):
        scenario = make_scenario(terrain)
        if not isinstance(scenario, TerrainScenario):
            raise TypeError(f"{terrain}: not a terrain")
        problem = TerrainProblem(scenario, "spherical", 10, "metabox")
        theirs = _published(scenario)
        costs = (theirs.func, problem.costs, _with_collision(problem))
        rng = np.random.default_rng(0)
        for size in POPULATIONS:
            count = min(NUM_FLIGHTS // size, MOST_POPULATIONS)
            populations = rng.uniform(theirs.lb, theirs.ub, (REPEATS + 1, count, size, theirs.dim))
            for cost in costs[1:]:
                _require_same(populations[0], cost, theirs.func)
            published, alone, measured = _microseconds(costs, populations)
            row: dict[str, Entry] = {
                "terrain": terrain,
                "flights at once": number(size, ",.0f"),
                "MetaBox, µs a flight": number(published, ",.1f"),
                "cost alone, µs a flight": number(alone, ".1f"),
                "times": number(published / alone, ",.0f"),
                "cost and collision, µs a flight": number(measured, ".1f"),
                "times, with collision": number(published / measured, ",.0f"),
            }
            rows.append(row)
    found = machine()
    caption = (
        f"Processor time of the cost `metabox` of a flight by MetaBox's code ({PACKAGE} {version(PACKAGE)}, "
        f"NumPy {found['numpy']}) and by the kernels here, on one core ({found['processor']}). Cost alone is "
        "`TerrainProblem.costs`, which computes what MetaBox's code does; the kernel of swarms also measures "
        f"the exact degree of collision. Flights are uniform in the bounds; medians of {REPEATS} repeats, of "
        f"new populations each, {MOST_POPULATIONS} of them, or one of 1,000. The three take turns, and begin "
        "each turn with populations that are not timed"
    )
    return Table.of("beside-metabox", caption, rows)


def _with_collision(problem: TerrainProblem) -> Cost:
    """Return the cost of flights, (m, D), by the kernel of swarms, which also measures their collision."""
    table, path = problem.table, np.zeros(columns(problem.dimension) + 1)

    def cost(vectors: Floats) -> Floats:
        found = np.empty((len(vectors), 2))
        _evaluate_all(table, np.ascontiguousarray(vectors), path, found)
        return found[:, 0]

    return cost


@entry
def _evaluate_all(table: TerrainTable, vectors: Floats, path: Floats, found: Floats) -> None:
    """Write fitness and degree of collision, (m, 2), of decision vectors, (m, D); `path` is workspace."""
    for i in range(vectors.shape[0]):
        for k in range(vectors.shape[1]):
            path[k + 1] = vectors[i, k]
        found[i, 0], found[i, 1] = evaluate(table, path)


def _published(scenario: TerrainScenario) -> Any:
    """Return the problem of MetaBox for a terrain."""
    x_min, y_min, x_max, y_max = scenario.workspace
    model = {
        "n": 10,
        "J_pen": PENALTY,
        "H": scenario.heights,
        "start": np.array(scenario.start),
        "end": np.array(scenario.goal),
        "threats": np.asarray(scenario.threats),
        "drone_size": scenario.drone_size,
        "danger_dist": scenario.danger_distance,
        **{"xmin": x_min, "ymin": y_min, "xmax": x_max, "ymax": y_max},
        **dict(zip(("zmin", "zmax"), scenario.band, strict=True)),
        **{"MAPSIZE_X": scenario.heights.shape[1], "MAPSIZE_Y": scenario.heights.shape[0]},
    }
    return _module().Terrain(model, scenario.name)


@cache
def _module() -> ModuleType:
    """Import the module of the cost, with empty modules in place of the packages around it.

    Raises:
        ValueError: if the package is not installed.
    """
    found = find_spec(PACKAGE)
    if found is None or not found.submodule_search_locations:
        raise ValueError(f"{PACKAGE} is not installed: pip install --no-deps {PACKAGE}")
    name, folder = PACKAGE, Path(found.submodule_search_locations[0])
    for part in (*MODULE.split(".")[:-1], ""):
        if name not in sys.modules:
            package = ModuleType(name)
            package.__path__ = [str(folder)]
            sys.modules[name] = package
        name, folder = f"{name}.{part}", folder / part
    return import_module(f"{PACKAGE}.{MODULE}")


def _require_same(populations: Floats, *costs: Cost) -> None:
    for population in populations:
        ours, theirs = (cost(population) for cost in costs)
        if (worst := np.max(np.abs(ours / theirs - 1.0))) > 1e-9:
            raise ValueError(f"costs of a flight differ from those of {PACKAGE} by {worst:.1e} of themselves")


def _microseconds(costs: Sequence[Cost], repeats: Floats) -> list[float]:
    """Return the median processor time of each cost for a flight, over repeats in which they take turns.

    Args:
        costs: functions of a population, (m, D).
        repeats: (repeats + 1, populations, m, D) flights. Those of the repeat before warm up the caches.
    """
    found = np.empty((len(costs), len(repeats) - 1))
    for k, populations in enumerate(repeats[1:]):
        for c, cost in enumerate(costs):
            for population in repeats[k]:
                cost(population)
            begin = time.process_time()
            for population in populations:
                cost(population)
            found[c, k] = time.process_time() - begin
    num_flights = repeats.shape[1] * repeats.shape[2]
    return [float(median) for median in np.median(found, axis=1) / num_flights * 1e6]
