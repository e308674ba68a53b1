"""Occupancy grids: maps of cells, each free or blocked."""

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.obstacles import Point

Cell = tuple[int, int]

# Maximum number of cells along a side of a map.
MAX_SIDE = 4096
# Limits of the side of a cell and of coordinates, in map units, where doubles tell cells apart.
MIN_RESOLUTION, MAX_RESOLUTION, MAX_ORIGIN = 1e-6, 1e6, 1e9


@dataclass(frozen=True, eq=False)
class GridMap:
    """A map of square cells, each free or blocked; maps of the same content are equal, whatever their names.

    Cells are (column, row), with row 0 on top. Cell coordinates are real numbers. Cell (c, r) covers columns
    from c - 0.5 to c + 0.5 and rows likewise, without the upper bounds.

    Attributes:
        name: name of the map in messages.
        blocked: bool, or integers 0 (free) and 1 (blocked), shape (height, width), at most `MAX_SIDE` along a
            side; a read-only copy is kept, as bool.
        resolution: side of a cell in map units, in [`MIN_RESOLUTION`, `MAX_RESOLUTION`].
        origin: map coordinates (x, y) of the centre of cell (0, 0), at most `MAX_ORIGIN` in size.
        y_up: whether y grows upwards, opposite to the rows.

    Raises:
        ScenarioError: if an attribute is malformed; the message names the attribute and its value.
    """

    name: str
    blocked: NDArray[np.bool_] = field(repr=False)
    resolution: float = 1.0
    origin: Point = (0.0, 0.0)
    y_up: bool = False

    def __post_init__(self) -> None:
        given = np.asarray(self.blocked)
        if given.dtype.kind not in "biu" or given.ndim != 2 or given.size == 0:
            raise ScenarioError(
                f"map {shown(self.name)}: blocked must be bool, or integers 0 and 1, of shape "
                f"(height, width), not empty, got {given.dtype} of shape {given.shape}"
            )
        if max(given.shape) > MAX_SIDE:
            height, width = given.shape
            raise ScenarioError(
                f"map {shown(self.name)}: expected at most {MAX_SIDE} cells along a side, got "
                f"{width} x {height}"
            )
        if given.dtype.kind != "b" and not np.isin(given, (0, 1)).all():
            raise ScenarioError(
                f"map {shown(self.name)}: integers in blocked must be 0 (free) or 1 (blocked), got values "
                f"from {given.min()} to {given.max()}"
            )
        blocked = np.array(given, dtype=np.bool_, order="C")
        blocked.setflags(write=False)
        object.__setattr__(self, "blocked", blocked)
        resolution = self._number("resolution", self.resolution, MIN_RESOLUTION, MAX_RESOLUTION)
        object.__setattr__(self, "resolution", resolution)
        try:
            x, y = self.origin
        except (TypeError, ValueError) as error:
            raise ScenarioError(
                f"map {shown(self.name)}: origin must be (x, y), got {self.origin!r}"
            ) from error
        origin = tuple(self._number("origin", value, -MAX_ORIGIN, MAX_ORIGIN) for value in (x, y))
        object.__setattr__(self, "origin", origin)
        object.__setattr__(self, "y_up", bool(self.y_up))

    @property
    def width(self) -> int:
        """Number of columns."""
        return self.blocked.shape[1]

    @property
    def height(self) -> int:
        """Number of rows."""
        return self.blocked.shape[0]

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max) of the area of all cells, in map units."""
        corners = self.to_map([(-0.5, -0.5), (self.width - 0.5, self.height - 0.5)])
        (x_min, y_min), (x_max, y_max) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        return x_min, y_min, x_max, y_max

    @cached_property
    def digest(self) -> str:
        """SHA-256 of cells and geometry, without the name, as 64 hexadecimal digits."""
        digest = hashlib.sha256(repr((self.blocked.shape, *self._geometry())).encode())
        digest.update(np.packbits(self.blocked).tobytes())
        return digest.hexdigest()

    @cached_property
    def components(self) -> NDArray[np.int32]:
        """Numbers of the connected components of the free cells, shape (height, width); 0 where blocked.

        A path steps to one of the eight neighbours, and diagonally only between two free cells. Two straight
        steps replace such a diagonal step, so the components are the same with steps to four neighbours.
        """
        from scipy import ndimage

        labels, _ = ndimage.label(~self.blocked)
        labels.setflags(write=False)
        return labels

    def to_map(self, cells: ArrayLike) -> NDArray[np.float64]:
        """Return the map coordinates (x, y) of cell coordinates (column, row), both of shape (..., 2)."""
        return np.asarray(self.origin) + np.asarray(cells, dtype=np.float64) * self._scale()

    def to_cells(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the cell coordinates (column, row) of map coordinates (x, y), both of shape (..., 2)."""
        return (np.asarray(points, dtype=np.float64) - np.asarray(self.origin)) / self._scale()

    def cell_of(self, point: Point) -> Cell:
        """Return the (column, row) of the cell of a point in finite map coordinates, on the map or not."""
        column, row = np.floor(self.to_cells(point) + 0.5).tolist()
        return int(column), int(row)

    def is_free(self, cell: Cell) -> bool:
        """Return True if the cell (column, row) is on the map and not blocked."""
        column, row = cell
        return 0 <= column < self.width and 0 <= row < self.height and not self.blocked[row, column]

    def disc(self, centre: ArrayLike, radius: float) -> NDArray[np.bool_]:
        """Return the cells (height, width) whose centres lie in a disc.

        Args:
            centre: (2,) cell coordinates (column, row) of its centre, which need not be whole numbers.
            radius: radius in cells.
        """
        column, row = np.asarray(centre, dtype=np.float64)
        columns, rows = np.arange(self.width), np.arange(self.height)[:, None]
        return (columns - column) ** 2 + (rows - row) ** 2 <= radius**2

    def inflated(self, radius: float) -> "GridMap":
        """Return the map for a robot of that radius, in map units.

        In the new map a cell is also blocked if its centre is closer than `radius` to the area of a blocked
        cell. The area outside the map counts as free.

        Raises:
            ScenarioError: if the radius is negative or not a finite number.
        """
        from scipy import ndimage

        radius = self._number("radius", radius, 0.0, MAX_ORIGIN)
        blocked = self.blocked
        if radius > 0 and blocked.any():
            # Distances are measured on a grid of half cells, because the point of a cell's area that is
            # closest to the centre of another cell is a corner or the middle of an edge.
            areas = np.zeros((2 * self.height + 1, 2 * self.width + 1), dtype=np.bool_)
            areas[1::2, 1::2] = blocked
            areas = ndimage.binary_dilation(areas, np.ones((3, 3), dtype=np.bool_))
            half_cells = ndimage.distance_transform_edt(~areas)[1::2, 1::2]
            blocked = blocked | (half_cells / 2 * self.resolution < radius)
        name = f"{self.name} inflated by {radius:g}"
        return GridMap(name, blocked, self.resolution, self.origin, self.y_up)

    def cut(self, rows: slice, columns: slice) -> "GridMap":
        """Return the part of the map in these rows and columns; its cells keep their map coordinates."""
        first = self.to_map((range(self.width)[columns][0], range(self.height)[rows][0]))
        x, y = first.tolist()
        return GridMap(self.name, self.blocked[rows, columns], self.resolution, (x, y), self.y_up)

    def __eq__(self, other: object) -> bool:
        return self.digest == other.digest if isinstance(other, GridMap) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.digest)

    # Pickling calls the constructor again, since an unpickled array would no longer be read-only.
    def __reduce__(self) -> tuple[object, ...]:
        return GridMap, (self.name, self.blocked, self.resolution, self.origin, self.y_up)

    def _geometry(self) -> tuple[float | bool, ...]:
        return self.resolution, *self.origin, self.y_up

    def _scale(self) -> NDArray[np.float64]:
        return np.array([self.resolution, -self.resolution if self.y_up else self.resolution])

    def _number(self, part: str, value: Any, low: float, high: float) -> float:
        try:
            number = float(value)
        except (TypeError, ValueError, OverflowError) as error:
            raise ScenarioError(f"map {shown(self.name)}: {part} must be a number, got {value!r}") from error
        if not low <= number <= high:
            raise ScenarioError(
                f"map {shown(self.name)}: {part} must lie in [{low:g}, {high:g}], got {value!r}"
            )
        return number + 0.0  # turns -0.0 into 0.0, since the digest would differ
