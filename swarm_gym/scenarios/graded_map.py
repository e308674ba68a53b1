"""Graded maps: cells that are free at a cost of ground, blocked, or unknown.

The cost of ground c of a cell is at least 0: a metre of path there costs as much as 1 + w c metres of plain
ground, with the weight w of the wish `ground`. Two scales of values are read:

| scale | free | graded, c | blocked | unknown |
|---|---|---|---|---|
| `occupancy`, of nav_msgs/OccupancyGrid | 0 | 1 to 99, v / 100 | from `lethal`, 100 by default | -1 |
| `costmap`, of Nav2's cost maps | 0 | 1 to 252, v / 252 | from `lethal`, 253 (inscribed) by default | 255 |
"""

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.checks import look_up, require_integer
from swarm_gym.errors import ScenarioError, SettingError, shown
from swarm_gym.scenarios.grid_map import GridMap
from swarm_gym.scenarios.obstacles import Point

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

UNKNOWN_CELLS = ("blocked", "free", "dear")
DEAR = 1.0  # cost of ground of unknown cells that are dear: that of the dearest cells that are known


class CellScale(NamedTuple):
    """A scale of values of cells.

    Attributes:
        dearest: value at which the cost of ground is 1.
        lethal: value from which cells are blocked, by default.
        most: largest value that a known cell can have.
        unknown: value of unknown cells.
    """

    dearest: int
    lethal: int
    most: int
    unknown: int


SCALES = {"occupancy": CellScale(100, 100, 100, -1), "costmap": CellScale(252, 253, 254, 255)}


@dataclass(frozen=True)
class Grading:
    """Choices of what the grades of a map mean.

    Attributes:
        unknown: meaning of unknown cells, one of `UNKNOWN_CELLS`; "dear" is free at the cost `DEAR`.
        lethal: value from which cells are blocked, in the scale of the map; None takes it from `SCALES`.
        terrain: cost of ground by letter, for maps of Moving AI; infinite for blocked. Letters that are left
            out mean what they do without it.

    Raises:
        SettingError: for another value.
    """

    unknown: str = "blocked"
    lethal: int | None = None
    terrain: Mapping[str, float] | None = None

    def __post_init__(self) -> None:
        if self.unknown not in UNKNOWN_CELLS:
            raise SettingError(
                f"unknown must be one of {', '.join(UNKNOWN_CELLS)}, got {shown(self.unknown)}"
            )
        if self.lethal is not None:
            require_integer("lethal", self.lethal, 1, max(scale.most for scale in SCALES.values()))
        if self.terrain is not None and not isinstance(self.terrain, Mapping):
            raise SettingError(
                f"terrain must be costs by letter, e.g. {{'S': 2.0}}, got {shown(self.terrain)}"
            )

    @property
    def is_usual(self) -> bool:
        """True if nothing is chosen: cells are free or blocked then."""
        return self == Grading()


@dataclass(frozen=True, eq=False)
class GradedMap:
    """A grid map with a cost of ground for each cell.

    Attributes:
        grid: the blocked cells, and their place.
        costs: cost of ground of each cell, (height, width), at least 0; 0 in blocked cells; read-only.

    Raises:
        ScenarioError: if the costs have another shape, or one is negative or not finite.
    """

    grid: GridMap
    costs: Floats = field(repr=False)

    def __post_init__(self) -> None:
        costs = np.array(self.costs, dtype=np.float64)
        where = f"map {shown(self.grid.name)}"
        if costs.shape != self.grid.blocked.shape:
            raise ScenarioError(
                f"{where}: costs must have the shape of the cells, {self.grid.blocked.shape}, "
                f"got {costs.shape}"
            )
        costs[self.grid.blocked] = 0.0
        bad = ~(costs >= 0.0) | np.isinf(costs)
        if bad.any():
            raise ScenarioError(f"{where}: costs must be finite and at least 0, got {costs[bad][0]}")
        costs.setflags(write=False)
        object.__setattr__(self, "costs", costs)

    def __eq__(self, other: object) -> bool:
        return self.digest == other.digest if isinstance(other, GradedMap) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.digest)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of cells, geometry and costs, without the name, as 64 hexadecimal digits."""
        return hashlib.sha256(self.grid.digest.encode() + self.costs.tobytes()).hexdigest()

    def on(self, grid: GridMap) -> "GradedMap":
        """Return the same ground on a map whose cells are these, or parts of these, in the same place."""
        parts = grid.height // self.grid.height
        return GradedMap(grid, np.repeat(np.repeat(self.costs, parts, axis=0), parts, axis=1))

    @classmethod
    def of_values(
        cls,
        name: str,
        values: ArrayLike,
        scale: str,
        resolution: float,
        corner: Point,
        grading: Grading | None = None,
    ) -> "GradedMap":
        """Return the map of the data of a message nav_msgs/OccupancyGrid or nav2_msgs/Costmap.

        Args:
            name: name of the map, for messages.
            values: (height, width) values of the cells; row 0 is the lowest one, as in the messages.
            scale: meaning of the values, a name in `SCALES`.
            resolution: side of a cell in map units.
            corner: map coordinates of the outer corner of the lower left cell.
            grading: meaning of the grades; by default, unknown cells are blocked.

        Raises:
            ScenarioError: for values that the scale does not have, or a malformed map.
            UnknownNameError: for another scale.
        """
        x, y = corner
        given = np.asarray(values)
        if given.ndim != 2 or given.size == 0 or given.dtype.kind not in "iu":
            raise ScenarioError(
                f"map {shown(name)}: values must be integers of shape (height, width), got {given.dtype} of "
                f"shape {given.shape}"
            )
        half = resolution / 2.0
        empty = np.zeros(given.shape, dtype=np.bool_)
        origin = (x + half, y + (len(given) - 0.5) * resolution)
        return graded(GridMap(name, empty, resolution, origin, y_up=True), given[::-1], scale, grading)


def graded(grid: GridMap, values: ArrayLike, scale: str, grading: Grading | None = None) -> GradedMap:
    """Return the graded map whose cells have these values.

    Args:
        grid: place and size of the cells; which of them are blocked does not matter.
        values: (height, width) values of the cells, row 0 on top.
        scale: meaning of the values, a name in `SCALES`.
        grading: meaning of the grades; by default, unknown cells are blocked.

    Raises:
        ScenarioError: for a value that the scale does not have.
        SettingError: for a lethal value that the scale does not have.
    """
    kind, choice = look_up("scale of a map", scale, SCALES), grading or Grading()
    if choice.terrain is not None:
        raise SettingError(f"terrain: expected a map of Moving AI, map {shown(grid.name)} has {scale} values")
    if choice.lethal is not None and choice.lethal > kind.most:
        raise SettingError(
            f"lethal must lie in [1, {kind.most}] on a map of {scale} values, got {choice.lethal}"
        )
    given: Integers = np.asarray(values).astype(np.int64)
    is_unknown = given == kind.unknown
    wrong = ~is_unknown & ((given < 0) | (given > kind.most))
    if wrong.any():
        raise ScenarioError(
            f"map {shown(grid.name)}: {scale} values lie in [0, {kind.most}] or are {kind.unknown} for "
            f"unknown, got {given[wrong][0]}; name the scale that the map has, one of {', '.join(SCALES)}"
        )
    lethal = kind.lethal if choice.lethal is None else choice.lethal
    blocked = ~is_unknown & (given >= lethal)
    if choice.unknown == "blocked":
        blocked |= is_unknown
    costs = np.where(is_unknown, DEAR if choice.unknown == "dear" else 0.0, given / kind.dearest)
    return GradedMap(GridMap(grid.name, blocked, grid.resolution, grid.origin, grid.y_up), costs)


def terrain_map(grid: GridMap, letters: NDArray[np.uint8], known: bytes, grading: Grading) -> GradedMap:
    """Return the graded map of a map of letters.

    Args:
        grid: the map without grades.
        letters: (height, width) letter of each cell, as a byte.
        known: all letters that cells can have.
        grading: costs of terrain, and no other choice.

    Raises:
        SettingError: for another letter, a cost that is negative or no number, or another choice.
    """
    if grading.unknown != "blocked" or grading.lethal is not None:
        raise SettingError(
            f"unknown, lethal: expected a map of values, the cells of map {shown(grid.name)} are letters; "
            "choose costs by terrain"
        )
    blocked, costs = grid.blocked.copy(), np.zeros(grid.blocked.shape)
    for letter, cost in (grading.terrain or {}).items():
        if not isinstance(letter, str) or len(letter) != 1 or letter not in known.decode():
            raise SettingError(f"terrain: expected letters among {known.decode()}, got {shown(letter)}")
        if isinstance(cost, bool) or not isinstance(cost, int | float) or not cost >= 0.0:
            raise SettingError(
                f"terrain: the cost of {letter!r} must be a number from 0 on, got {shown(cost)}"
            )
        here = letters == ord(letter)
        blocked[here] = math.isinf(cost)
        costs[here] = 0.0 if math.isinf(cost) else cost
    return GradedMap(GridMap(grid.name, blocked, grid.resolution, grid.origin, grid.y_up), costs)
