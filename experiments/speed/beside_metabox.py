"""The published cost of flights beside the code that publishes it: MetaBox's, in NumPy, and the kernel here.

MetaBox computes the cost of a population at once, so that its time for a flight depends on the population.
`pip install --no-deps metaevobox` brings its code. Its packages import all of its optimizers and what these
need, so only the module of the cost is imported.
"""

import sys
import time
from collections.abc import Callable
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
from experiments.speed.peers.cost import compiled_cost
from experiments.tables import Table
from experiments.tables.cell import Entry, number
from swarm_gym.problem import TerrainProblem
from swarm_gym.problem.terrain.as_coded import PENALTY
from swarm_gym.scenarios import TerrainScenario, make_scenario

Floats = NDArray[np.float64]

PACKAGE, MODULE = "metaevobox", "environment.problem.SOO.UAV.uav_numpy"
TERRAINS = ("terrain:test:0", "terrain:test:28")  # the first with few threats, and the first with many
POPULATIONS = (1, 50, 1000)
NUM_FLIGHTS = 1000  # of a repeat, in as many populations as that makes; 20 populations at most
MOST_POPULATIONS, REPEATS = 20, 5


def table_beside_metabox() -> Table:
    """Return the table of times, measured now; both costs of all flights are compared before.

    Raises:
        ValueError: if the package of MetaBox is not installed, or a cost differs by more than 1e-9 of itself.
    """
    rows = []
    _module()
    for terrain in tqdm(TERRAINS, desc="beside MetaBox", unit="terrain"):
        scenario = make_scenario(terrain)
        if not isinstance(scenario, TerrainScenario):
            raise TypeError(f"{terrain}: not a terrain")
        ours = compiled_cost(TerrainProblem(scenario, "spherical", 10, "metabox"))
        theirs = _published(scenario)
        rng = np.random.default_rng(0)
        for size in POPULATIONS:
            count = min(NUM_FLIGHTS // size, MOST_POPULATIONS)
            populations = rng.uniform(theirs.lb, theirs.ub, (count, size, theirs.dim))
            _require_same(populations, ours.of_many, theirs.func)
            slow, fast = (_microseconds(cost, populations) for cost in (theirs.func, ours.of_many))
            row: dict[str, Entry] = {
                "terrain": terrain,
                "flights at once": number(size, ",.0f"),
                "MetaBox, µs a flight": number(slow, ",.1f"),
                "swarm_gym, µs a flight": number(fast, ".1f"),
                "times": number(slow / fast, ",.0f"),
            }
            rows.append(row)
    found = machine()
    caption = (
        f"Processor time of the cost `metabox` of a flight by MetaBox's code ({PACKAGE} {version(PACKAGE)}, "
        f"NumPy {found['numpy']}) and by the kernel here, on one core ({found['processor']}). Flights are "
        f"uniform in the bounds; medians of {REPEATS} repeats over the same populations, {MOST_POPULATIONS} "
        "of them, or one of 1,000. The kernel here also measures the exact degree of collision"
    )
    return Table.of("beside-metabox", caption, rows)


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


def _require_same(populations: Floats, *costs: Callable[[Floats], Floats]) -> None:
    for population in populations:
        ours, theirs = (cost(population) for cost in costs)
        if (worst := np.max(np.abs(ours / theirs - 1.0))) > 1e-9:
            raise ValueError(f"costs of a flight differ from those of {PACKAGE} by {worst:.1e} of themselves")


def _microseconds(cost: Callable[[Floats], Floats], populations: Floats) -> float:
    """Return the median processor time for a flight."""
    found = []
    for _ in range(REPEATS):
        begin = time.process_time()
        for population in populations:
            cost(population)
        found.append(time.process_time() - begin)
    return float(np.median(found)) / (populations.shape[0] * populations.shape[1]) * 1e6
