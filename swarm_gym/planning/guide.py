"""Guides on grid maps: paths of A*, and first populations of Bezier curves around them."""

import numpy as np
from numpy.typing import NDArray
from scipy.special import comb

from swarm_gym.errors import NoPathError
from swarm_gym.problem import GridProblem
from swarm_gym.reference import shortest_grid_path, smooth
from swarm_gym.scenarios import GridScenario

Floats = NDArray[np.float64]

SAMPLES = 200  # of the way, to which a curve is fitted
BLOCKS = (0.01, 0.1)  # smallest and largest radius of blocks on a way, as shares of the map's longer side
WIDEST = 0.1  # standard deviation of the control points of the widest member, as a share of the map's width


def way_of_a_star(scenario: GridScenario, blocked: NDArray[np.bool_] | None = None) -> Floats:
    """Return the smoothed path of A* from start to target, (k, 2), in map units.

    Args:
        scenario: the task.
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

    It often passes obstacles on another side. The block is a disc of drawn place and size.
    """
    grid = scenario.map
    at = _resampled(way, SAMPLES)[rng.integers(1, SAMPLES - 1)]
    radius = rng.uniform(*BLOCKS) * max(grid.width, grid.height)
    column, row = grid.to_cells(at)
    columns, rows = np.arange(grid.width), np.arange(grid.height)[:, None]
    disc = (columns - column) ** 2 + (rows - row) ** 2 <= radius**2
    for end in (scenario.start, scenario.target):
        end_column, end_row = grid.cell_of(end)
        disc[end_row, end_column] = False
    try:
        return way_of_a_star(scenario, grid.blocked | disc)
    except NoPathError:
        return None


def guided_population(problem: GridProblem, way: Floats, size: int, seed: int) -> Floats:
    """Return decision vectors, (size, dimension), around a way from start to target, (k, 2).

    The first member is the Bezier curve nearest to the way, by least squares; the others have their control
    points moved at random, the later the farther.
    """
    control = _nearest_curve(_resampled(way, SAMPLES), problem.num_points)
    low, high = problem.bounds
    rng = np.random.default_rng(seed)
    widths = WIDEST * (high - low).max() * np.arange(size)[:, None] / max(size - 1, 1)
    return np.clip(control.T.ravel() + widths * rng.normal(size=(size, control.size)), low, high)


def _nearest_curve(points: Floats, num_free: int) -> Floats:
    """Return the free control points, (n, 2), of the Bezier curve nearest to points, (m, 2)."""
    degree = num_free + 1
    t, k = np.linspace(0.0, 1.0, len(points))[:, None], np.arange(degree + 1)
    weights = comb(degree, k) * t**k * (1.0 - t) ** (degree - k)
    fixed = weights[:, [0, -1]] @ points[[0, -1]]
    return np.linalg.lstsq(weights[:, 1:-1], points - fixed, rcond=None)[0]


def _resampled(way: Floats, number: int) -> Floats:
    """Return points at even distances along a polyline, (number, 2)."""
    ends = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
    at = np.linspace(0.0, ends[-1], number)
    return np.stack([np.interp(at, ends, coordinates) for coordinates in way.T], axis=-1)
