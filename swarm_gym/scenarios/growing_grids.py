"""Grid maps whose blocked cells have grown by a margin: a disc of that radius is a point on them.

A grown map has smaller cells. A small cell is blocked exactly if a point of its area is closer to the area of
a blocked cell than the margin. So a path through free small cells keeps the margin, and a passage is open if
a row of small cells fits through. The rounding to cells closes passages that are hardly wider than the disc.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.grid_map import MAX_SIDE, GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario

Floats = NDArray[np.float64]

FINE = 4.0  # small cells are as small as the margin over this, if the map is not too large then
MOST_PARTS = 8  # into which a side is cut, at most, to open a passage that is hardly wider than the disc
MOST_CELLS = 2**22
ROUNDING = 5e-10  # shares of a cell that count as rounding errors
SAMPLES = 4  # points per small cell of a line along which cells are opened
NEAREST = 64  # open small cells near an end that are tried
ON_LINE = 33  # points of the line to such a cell that must keep the margin


def grown_on_cells(
    scenario: GridScenario, margin: float, way: Floats | None = None, fine: float = FINE
) -> GridScenario:
    """Return the scenario on a map of small cells whose blocked cells have grown by a margin.

    A passage along rows or columns, k cells wide, is open if a row of small cells fits through: if
    p k >= 2 ceil(p m) + 1, for p small cells per cell and a margin of m cells. So it is open if it is wider
    than the disc by three small cells, and, where p m is a whole number, by one. The number p is such that
    the narrowest passage that is wider than the disc is open, if `MOST_PARTS` or `FINE` allow that.

    An end that keeps the margin may lie in a small cell that does not. Then small cells from there to an open
    one are opened along a straight line that keeps the margin: only in these, a path may be closer than the
    margin, by less than the diagonal of a small cell.

    Args:
        scenario: the map as it is, with start and target.
        margin: radius of the disc in map units.
        way: (k, 2) points of a path that is known to keep the margin, along which small cells are opened too.
        fine: number of small cells that the margin is as long as, at least, if the map is not too large then;
            0 for as few as open the narrowest passage.

    Raises:
        ScenarioError: if an end is closer to a blocked cell than the margin.
        NoPathError: if blocked small cells separate the ends.
    """
    grid = scenario.map
    require_room(scenario, margin)
    if not grid.blocked.any():
        return scenario
    parts = _parts(grid, margin, fine)
    side = grid.resolution / parts
    blocked = np.repeat(np.repeat(grid.blocked, parts, axis=0), parts, axis=1)
    closed = _gaps(blocked) < margin / side - ROUNDING
    first = 0.5 / parts - 0.5
    x, y = grid.to_map((first, first)).tolist()
    small = GridMap(grid.name, closed, side, (x, y), grid.y_up)
    opened = closed.copy()
    for end in (scenario.start, scenario.target):
        _open_along(opened, small, _line_to_open(grid, small, np.array(end), margin))
    if way is not None:
        _open_along(opened, small, way)
    name = f"{grid.name} grown by {margin:g}"
    return scenario.on(GridMap(name, opened, side, (x, y), grid.y_up))


def require_room(scenario: GridScenario, margin: float) -> None:
    """Raise an error if start or target is closer to a blocked cell than a margin, in map units.

    Raises:
        ScenarioError: if one is; the message has its distance.
    """
    grid = scenario.map
    for role, end in (("start", scenario.start), ("target", scenario.target)):
        distance = _distances(grid, np.array([end]), margin)[0]
        if distance < margin - ROUNDING * grid.resolution:
            raise ScenarioError(
                f"scenario {shown(scenario.name)} on map {grid.name!r}: {role} {end} is {distance:.6g} from "
                f"the nearest blocked cell, expected at least {margin:g}; choose another {role}, or a "
                "smaller radius or clearance"
            )


def _parts(grid: GridMap, margin: float, fine: float) -> int:
    """Return the number of small cells along the side of a cell."""
    most = min(MAX_SIDE // max(grid.width, grid.height), math.isqrt(MOST_CELLS // grid.blocked.size))
    cells = margin / grid.resolution
    fewest = max(1, min(math.ceil(fine / cells), most))
    narrowest = math.floor(2.0 * cells + ROUNDING) + 1
    for parts in range(fewest, max(min(MOST_PARTS, most), fewest) + 1):
        if parts * narrowest >= 2 * math.ceil(parts * cells - ROUNDING) + 1:
            return parts
    return fewest


def _gaps(blocked: NDArray[np.bool_]) -> Floats:
    """Return the least distance of each cell's area from the area of a blocked cell, in cells."""
    from scipy import ndimage

    # The gap between the areas of two cells is the distance from the centre of one to the nearest of the nine
    # centres around the other.
    around = ndimage.binary_dilation(blocked, np.ones((3, 3), dtype=np.bool_))
    gaps: Floats = ndimage.distance_transform_edt(~around)
    return gaps


def _distances(grid: GridMap, points: Floats, margin: float) -> Floats:
    """Return the distances of points, (k, 2), from the nearest blocked cells, in map units.

    Only blocked cells count that are closer than about the margin to one of the points.
    """
    cells = grid.to_cells(points)
    reach = margin / grid.resolution + 2.0
    first = np.clip(np.floor(cells.min(axis=0) - reach), 0, None).astype(np.int64)
    last = np.clip(np.ceil(cells.max(axis=0) + reach), 0, None).astype(np.int64)
    rows, columns = np.nonzero(grid.blocked[first[1] : last[1] + 1, first[0] : last[0] + 1])
    if not rows.size:
        return np.full(len(points), math.inf)
    offsets = np.abs(cells[:, None] - (np.stack([columns, rows], axis=-1) + first)) - 0.5
    distances: Floats = np.hypot(*np.moveaxis(np.maximum(offsets, 0.0), -1, 0)).min(axis=1)
    return distances * grid.resolution


def _line_to_open(grid: GridMap, small: GridMap, end: Floats, margin: float) -> Floats:
    """Return a line, (k, 2), from an end to the centre of an open small cell; the end if there is none."""
    if small.is_free(small.cell_of(tuple(end.tolist()))):
        return end[None]
    centre = small.to_cells(end)
    reach = math.ceil(margin / small.resolution) + 3
    first = np.maximum(np.rint(centre).astype(np.int64) - reach, 0)
    window = small.blocked[first[1] : first[1] + 2 * reach + 1, first[0] : first[0] + 2 * reach + 1]
    rows, columns = np.nonzero(~window)
    cells = np.stack([columns, rows], axis=-1) + first
    for k in np.argsort(np.hypot(*(cells - centre).T), kind="stable")[:NEAREST]:
        line = np.linspace(end, small.to_map(cells[k]), ON_LINE)
        if (_distances(grid, line, margin) >= margin - ROUNDING * grid.resolution).all():
            return line[[0, -1]]
    return end[None]


def _open_along(blocked: NDArray[np.bool_], small: GridMap, line: Floats) -> None:
    """Open the small cells along a line, (k, 2), in map units, so that steps to sides lead along it."""
    points = small.to_cells(line)
    for begin, end in pairwise(points):
        number = max(math.ceil(SAMPLES * float(np.abs(end - begin).max())), 1)
        columns, rows = np.floor(np.linspace(begin, end, number + 1) + 0.5).astype(np.int64).T
        _open(blocked, columns, rows)
        _open(blocked, columns[1:], rows[:-1])
    columns, rows = np.array([small.cell_of(tuple(point)) for point in line[[0, -1]].tolist()]).T
    _open(blocked, columns, rows)


def _open(blocked: NDArray[np.bool_], columns: NDArray[np.int64], rows: NDArray[np.int64]) -> None:
    height, width = blocked.shape
    blocked[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)] = False
