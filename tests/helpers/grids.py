"""Occupancy grids: drawn by hand, and of any kind for Hypothesis."""

import numpy as np
import shapely
from hypothesis import strategies as st
from scipy import ndimage

from swarm_gym.problem import WalkProblem
from swarm_gym.scenarios import GridMap, GridScenario


def frozen(blocked):
    """Make an array read-only, as the cells of maps are, since kernels are compiled again for others."""
    blocked.flags.writeable = False
    return blocked


def grid(*rows):
    """Return the blocked cells of a map drawn in rows of characters, in which # is blocked."""
    return frozen(np.array([[character == "#" for character in row] for row in rows]))


def area_of(cells):
    """Return the area, in cells, of those that are True."""
    rows, columns = np.nonzero(cells)
    return shapely.union_all(shapely.box(columns - 0.5, rows - 0.5, columns + 0.5, rows + 0.5))


def posts_of(blocked):
    """Return a cell (column, row) of each obstacle, by scipy's own labels."""
    labels, number = ndimage.label(blocked, np.ones((3, 3)))
    return [tuple(np.argwhere(labels == k)[0][::-1].tolist()) for k in range(1, number + 1)]


def points_in_obstacles(scenario):
    """Return a point (x, y) in each obstacle of a map of cells."""
    cells = np.array(posts_of(scenario.map.blocked))
    return [tuple(point) for point in scenario.map.to_map(cells).tolist()]


def random_blocks(rng, height, width, count):
    """Return cells with rectangles that are blocked, apart from the border."""
    blocked = np.zeros((height, width), dtype=bool)
    for _ in range(count):
        row, column = rng.integers(1, height - 4), rng.integers(2, width - 5)
        blocked[row : row + rng.integers(1, 4), column : column + rng.integers(1, 4)] = True
    return blocked


def drawn_problem(*rows, start, target, **geometry):
    """Return the problem of walks on a map of rows of characters; start and target are in cells."""
    drawn = GridMap("drawn", grid(*rows), **geometry)
    return WalkProblem(GridScenario("drawn", drawn, *map(tuple, drawn.to_map([start, target]).tolist())))


@st.composite
def grids(draw, most=7):
    """Draw a small grid, each cell of which is blocked or free."""
    width, height = draw(st.integers(1, most)), draw(st.integers(1, most))
    cells = draw(st.lists(st.booleans(), min_size=width * height, max_size=width * height))
    return frozen(np.array(cells).reshape(height, width))
