"""Planned ways: short paths of A* through different corridors, which new members can lie around.

Two ways differ if something blocked lies between them. The first way is the path of A*, pulled tight. The
others are such paths when a block lies somewhere on a way that is known, a disc of drawn place and size. Maps
of circles and polygons are converted to cells before. Over terrain, ways are flights over a coarse graph, see
`swarm_gym.reference.layered_flights`.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.problem import AnalyticProblem, GridProblem, Problem, TerrainProblem
from swarm_gym.problem.geometry.polylines import evenly_spaced, length_of
from swarm_gym.reference import shortest_grid_path, smooth
from swarm_gym.scenarios import GridScenario, MapScenario, rasterised

Floats = NDArray[np.float64]

NUM_WAYS = 4  # at most, of a map
ATTEMPTS = 40  # to find another way
PLACES = 200  # on a way, of which a block lies on one
BLOCKS = (0.01, 0.1)  # smallest and largest radius of a block, as shares of the map's longer side
CELLS = 250  # on the longer side of a map of circles and polygons


def with_ways(problem: Problem) -> Problem:
    """Return the same problem, in which smooth new members lie around planned ways.

    Where there are fewer than `NUM_WAYS`, they repeat, so that all problems have as many.
    """
    if isinstance(problem, TerrainProblem):
        from swarm_gym.reference.layered_flights import flight_ways  # loads what environments else do without

        vectors = flight_ways(problem, NUM_WAYS)
        return replace(problem, ways=vectors[np.arange(NUM_WAYS) % len(vectors)])
    assert isinstance(problem, AnalyticProblem | GridProblem)
    ways = planned_ways(problem.scenario)
    vectors = np.concatenate([problem.along(way[None]) for way in ways])
    return replace(problem, ways=vectors[np.arange(NUM_WAYS) % len(vectors)])


def planned_ways(scenario: MapScenario, most: int = NUM_WAYS) -> list[Floats]:
    """Return ways from start to target, (k, 2) each, between any two of which something blocked lies.

    They are the same in every call. The first is the shortest one that A* finds; the others follow by their
    lengths. If no path leads through free cells, the only one is the exact shortest path.

    Args:
        scenario: the map and the task.
        most: largest number of ways.
    """
    try:
        on_cells = _on_cells(scenario)
    except ScenarioError:
        from swarm_gym.reference import shortest_path  # loads what environments else do without

        return [shortest_path(scenario)[1]]
    rng, inside = np.random.default_rng(0), _inside_blocks(on_cells)
    ways = [shortest_way(on_cells)]
    for _ in range(ATTEMPTS):
        if len(ways) == most:
            break
        way = other_way(on_cells, ways[rng.integers(len(ways))], rng)
        if way is not None and all(differ(way, known, inside) for known in ways):
            ways.append(way)
    return [ways[0], *sorted(ways[1:], key=length_of)]


def shortest_way(scenario: GridScenario, blocked: NDArray[np.bool_] | None = None) -> Floats:
    """Return the path of A* from start to target, pulled tight, (k, 2), in map units.

    Args:
        scenario: the map and the task.
        blocked: (height, width) cells to stay out of, with all that are blocked; by default only those.

    Raises:
        NoPathError: if there is none.
    """
    grid = scenario.map
    cells = grid.blocked if blocked is None else blocked
    found = shortest_grid_path(cells, grid.cell_of(scenario.start), grid.cell_of(scenario.target))
    middle = grid.to_map(smooth(cells, found.cells))[1:-1]
    return np.vstack([scenario.start, middle, scenario.target])


def other_way(scenario: GridScenario, way: Floats, rng: np.random.Generator) -> Floats | None:
    """Return the path of A* when a block lies somewhere on a way, (k, 2); None if there is none then.

    It often passes obstacles on another side.
    """
    grid = scenario.map
    at = evenly_spaced(way, PLACES)[rng.integers(1, PLACES - 1)]
    radius = rng.uniform(*BLOCKS) * max(grid.width, grid.height)
    disc = grid.disc(grid.to_cells(at), radius)
    for end in (scenario.start, scenario.target):
        end_column, end_row = grid.cell_of(end)
        disc[end_row, end_column] = False
    try:
        return shortest_way(scenario, grid.blocked | disc)
    except ScenarioError:
        return None


def differ(way: Floats, other: Floats, inside: Floats) -> bool:
    """Return whether an obstacle lies between two ways, (k, 2) and (l, 2), with the same ends.

    Args:
        way: a way.
        other: another way.
        inside: (m, 2) a point inside each obstacle.
    """
    loop = np.concatenate([way, other[-2::-1]])
    turns = np.zeros(len(inside), dtype=np.int64)
    x, y = inside.T
    for (x0, y0), (x1, y1) in pairwise(loop):
        # How often the loop winds around a point: crossings of the ray from it to the right, upwards minus
        # downwards.
        left = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
        turns += (y0 <= y) & (y1 > y) & (left > 0.0)
        turns -= (y0 > y) & (y1 <= y) & (left < 0.0)
    return bool(turns.any())


def _on_cells(scenario: MapScenario) -> GridScenario:
    """Return a map as cells.

    Raises:
        ScenarioError: if no path leads through free cells.
    """
    if isinstance(scenario, GridScenario):
        return scenario
    x_min, y_min, x_max, y_max = scenario.workspace
    return rasterised(scenario, max(x_max - x_min, y_max - y_min) / CELLS)


def _inside_blocks(scenario: GridScenario) -> Floats:
    """Return the centre of a cell of each set of connected blocked cells, (m, 2)."""
    from scipy import ndimage

    grid = scenario.map
    labels, _ = ndimage.label(grid.blocked, structure=np.ones((3, 3)))
    _, first = np.unique(labels[grid.blocked], return_index=True)
    rows, columns = np.nonzero(grid.blocked)
    return grid.to_map(np.stack([columns[first], rows[first]], axis=-1))
