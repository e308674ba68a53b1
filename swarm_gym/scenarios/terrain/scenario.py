"""A flight over terrain: a height map with threats, an altitude band and limits; checked when it is made."""

import hashlib
import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.obstacles import MAX_COORDINATE, Point, require_numbers

Floats = NDArray[np.float64]
Point3 = tuple[float, float, float]

# Limits of the number of heights along a side of a map.
MIN_SIDE, MAX_SIDE = 2, 8192
# Limits of the distance between neighbouring heights, in metres.
MIN_CELL, MAX_CELL = 1e-3, 1e6
MIN_ANGLE = 1e-6  # smallest limit of turn or climb, in degrees
# Largest height above or below zero, in metres.
MAX_HEIGHT = 1e5
# Light of pictures, from the north-west, 45 degrees above the horizon, as cartographers have it.
LIGHT = (-0.5, 0.5, math.sqrt(0.5))
# Columns of threats.
X, Y, TOP, RADIUS = range(4)


class EndError(ScenarioError):
    """A start or a goal that cannot be.

    Attributes:
        role: "start" or "goal".
        fault: words on what is wrong with it, which follow its coordinates in the message.
        in_threat: whether it lies in a threat.
    """

    def __init__(self, where: str, role: str, point: Point3, fault: str, in_threat: bool = False):
        super().__init__(f"{where}: {role} {point} {fault}")
        self.role, self.fault, self.in_threat = role, fault, in_threat


@dataclass(frozen=True, eq=False)
class TerrainScenario:
    """The task to fly from a start to a goal over ground, in metres; scenarios of equal content are equal.

    Between heights the ground is bilinear. Threats are upright cylinders. A top is measured from the zero
    of the heights: what flies higher is not in the cylinder. The top `inf` blocks every
    altitude, as in published costs, which ignore tops.

    Attributes:
        name: name under which results are filed.
        heights: (rows, columns) heights of the ground, rows along y and columns along x, at least
            `MIN_SIDE` and at most `MAX_SIDE` of each, all finite; a read-only copy is kept.
        start: (x, y, height above ground) where the flight begins.
        goal: (x, y, height above ground) where it ends.
        cell: distance between neighbouring heights.
        origin: (x, y) of `heights[0, 0]` in map coordinates.
        threats: (k, 4) x, y, top and radius of each cylinder; a read-only copy is kept.
        band: lowest and highest altitude above ground that is allowed.
        largest_turn: largest turn at a waypoint, seen from above, in degrees, at most 180.
        largest_climb: largest angle of a climb or descent, in degrees, at most 90.
        drone_size: distance from a cylinder that counts as contact, since the drone has a size.
        danger_distance: width of the zone around it in which a flight is not blocked, but costs.

    Raises:
        ScenarioError: if the task is malformed; the message names the part and its value.
    """

    name: str
    heights: Floats = field(repr=False)
    start: Point3
    goal: Point3
    cell: float = 1.0
    origin: Point = (0.0, 0.0)
    threats: Floats = field(default_factory=lambda: np.empty((0, 4)), repr=False)
    band: tuple[float, float] = (100.0, 200.0)
    largest_turn: float = 45.0
    largest_climb: float = 45.0
    drone_size: float = 1.0
    danger_distance: float = 10.0

    def __post_init__(self) -> None:
        self._set("heights", self._checked_heights())
        self._set("origin", require_numbers(self._where, "origin", self.origin, 2))
        for name, low, high in (
            ("cell", MIN_CELL, MAX_CELL),
            ("largest_turn", MIN_ANGLE, 180.0),
            ("largest_climb", MIN_ANGLE, 90.0),
            ("drone_size", 0.0, MAX_HEIGHT),
            ("danger_distance", 0.0, MAX_HEIGHT),
        ):
            self._set(name, self._number(name, getattr(self, name), low, high))
        self._set("band", require_numbers(self._where, "band", self.band, 2))
        if not 0.0 <= self.band[0] < self.band[1] <= MAX_HEIGHT:
            raise ScenarioError(
                f"{self._where}: band needs 0 <= lowest < highest <= {MAX_HEIGHT:g} metres above ground, "
                f"got {self.band}"
            )
        self._set("threats", self._checked_threats())
        for role in ("start", "goal"):
            self._set(role, require_numbers(self._where, role, getattr(self, role), 3))
            self._require_free(role, getattr(self, role))
        if self.start[:2] == self.goal[:2]:
            raise ScenarioError(
                f"{self._where}: start and goal must be different points of the map, both are at "
                f"{self.start[:2]}"
            )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TerrainScenario):
            return NotImplemented
        return self.name == other.name and self.digest == other.digest

    def __hash__(self) -> int:
        return hash((self.name, self.digest))

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all numbers of the task, without the name, as 64 hexadecimal digits."""
        numbers = (
            *(*self.start, *self.goal, self.cell, *self.origin, *self.band),
            *(self.largest_turn, self.largest_climb, self.drone_size, self.danger_distance),
        )
        digest = hashlib.sha256(repr((self.heights.shape, *numbers)).encode())
        digest.update(self.heights.astype("<f8").tobytes())
        digest.update(self.threats.astype("<f8").tobytes())
        return digest.hexdigest()

    @property
    def workspace(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max) of the map: between its outermost heights."""
        rows, columns = self.heights.shape
        x, y = self.origin
        return x, y, x + self.cell * (columns - 1), y + self.cell * (rows - 1)

    @property
    def view(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max) of the area that pictures show: the map."""
        return self.workspace

    @property
    def y_up(self) -> bool:
        """True, since y grows upwards in pictures."""
        return True

    @property
    def target(self) -> Point:
        """(x, y) of the goal."""
        return self.goal[:2]

    @property
    def straight_line(self) -> float:
        """Distance in metres from start to goal, with their heights over the ground: no flight is shorter."""
        (x, y, z), (goal_x, goal_y, goal_z) = self.start, self.goal
        low, high = self.ground([(x, y), (goal_x, goal_y)]).tolist()
        return math.hypot(goal_x - x, goal_y - y, (goal_z + high) - (z + low))

    def ground(self, points: ArrayLike) -> Floats:
        """Return the heights of the ground, (...,), at points (..., 2) of the map; beyond it, at its edge."""
        places = (np.asarray(points, dtype=np.float64) - self.origin) / self.cell
        rows, columns = self.heights.shape
        x, y = np.clip(places[..., 0], 0, columns - 1), np.clip(places[..., 1], 0, rows - 1)
        i, j = np.minimum(x.astype(int), columns - 2), np.minimum(y.astype(int), rows - 2)
        right, up = x - i, y - j
        below = self.heights[j, i] * (1.0 - right) + self.heights[j, i + 1] * right
        above = self.heights[j + 1, i] * (1.0 - right) + self.heights[j + 1, i + 1] * right
        return below * (1.0 - up) + above * up

    @property
    def _where(self) -> str:
        return f"scenario {shown(self.name)}"

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _number(self, name: str, value: object, low: float, high: float) -> float:
        is_number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
        if not is_number or not low <= value <= high:  # type: ignore[operator]
            raise ScenarioError(
                f"{self._where}: {name} must be a number in [{low:g}, {high:g}], got {shown(value)}"
            )
        return float(value)  # type: ignore[arg-type]

    def _array(self, name: str, values: object, expected: str) -> Floats:
        """Return values as a read-only copy of floats with two axes."""
        try:
            if isinstance(values, np.ma.MaskedArray):  # as rasterio reads cells without data
                values = np.ma.filled(values.astype(np.float64), np.nan)
            array = np.array(values, dtype=np.float64, order="C")
        except (TypeError, ValueError) as error:
            raise ScenarioError(f"{self._where}: {name} must be {expected}, got {shown(values)}") from error
        if array.ndim != 2:
            raise ScenarioError(
                f"{self._where}: {name} must be {expected}, got an array of shape {array.shape}"
            )
        array.setflags(write=False)
        return array

    def _checked_heights(self) -> Floats:
        expected = f"numbers of shape (rows, columns), {MIN_SIDE} to {MAX_SIDE} of each"
        heights = self._array("heights", self.heights, expected)
        if min(heights.shape) < MIN_SIDE or max(heights.shape) > MAX_SIDE:
            raise ScenarioError(
                f"{self._where}: heights must be {expected}, got an array of shape {heights.shape}"
            )
        bad = ~(np.abs(heights) <= MAX_HEIGHT)  # NaN compares as false
        if bad.any():
            row, column = np.argwhere(bad)[0].tolist()
            raise ScenarioError(
                f"{self._where}: heights must be finite and at most {MAX_HEIGHT:g} metres in size, but "
                f"{np.count_nonzero(bad)} of {heights.size} are not, the first {heights[row, column]} in row "
                f"{row}, column {column}; fill these cells or cut the map to those that are known"
            )
        return heights

    def _checked_threats(self) -> Floats:
        expected = "numbers of shape (k, 4): x, y, top and radius of each cylinder"
        none = isinstance(self.threats, list | tuple) and not self.threats
        threats = self._array("threats", np.empty((0, 4)) if none else self.threats, expected)
        if threats.shape[1] != 4:
            raise ScenarioError(
                f"{self._where}: threats must be {expected}, got an array of shape {threats.shape}"
            )
        for number, (x, y, top, radius) in enumerate(threats.tolist()):
            where = f"{self._where}: threat {number} at ({x}, {y})"
            if not (abs(x) <= MAX_COORDINATE and abs(y) <= MAX_COORDINATE):
                raise ScenarioError(f"{where}: expected finite coordinates of its centre")
            if not 0.0 < radius <= MAX_COORDINATE:
                raise ScenarioError(f"{where}: expected a positive radius in metres, got {radius}")
            if not (top == math.inf or abs(top) <= MAX_HEIGHT):
                raise ScenarioError(
                    f"{where}: expected the height of its top, at most {MAX_HEIGHT:g} metres in size, or inf "
                    f"for a cylinder that blocks every altitude, got {top}"
                )
        return threats

    def _require_free(self, role: str, point: Point3) -> None:
        """Raise a ScenarioError if an end lies off the map, outside the band or in contact with a threat."""
        x, y, above = point
        x_min, y_min, x_max, y_max = self.workspace
        if not (x_min <= x <= x_max and y_min <= y <= y_max):
            raise ScenarioError(
                f"{self._where}: {role} {point} lies outside the map, whose x is {x_min} to {x_max} and y "
                f"{y_min} to {y_max}; are its coordinates in another system?"
            )
        lowest, highest = self.band
        if not lowest <= above <= highest:
            fault = f"is {above} metres above ground, expected the altitude band, {lowest} to {highest}"
            raise EndError(self._where, role, point, fault)
        altitude = float(self.ground((x, y))) + above
        for number, (threat_x, threat_y, top, radius) in enumerate(self.threats.tolist()):
            distance = math.hypot(x - threat_x, y - threat_y)
            if distance < radius + self.drone_size and altitude < top + self.drone_size:
                fault = (
                    f"lies inside threat {number}, {distance:.1f} metres from its centre; expected at least "
                    f"its radius {radius} plus the size of the drone, {self.drone_size}"
                )
                raise EndError(self._where, role, point, fault, in_threat=True)


def hill_shade(scenario: TerrainScenario, most: int = 512) -> NDArray[np.float64]:
    """Return brightness in [0, 1] of the ground, with y along rows and x along columns.

    Args:
        scenario: the map.
        most: largest number of rows and columns; larger maps are thinned out.
    """
    stride = math.ceil(max(scenario.heights.shape) / most)
    heights = scenario.heights[::stride, ::stride]
    along_y, along_x = np.zeros_like(heights), np.zeros_like(heights)
    if heights.shape[0] > 1:
        along_y = np.gradient(heights, scenario.cell * stride, axis=0)
    if heights.shape[1] > 1:
        along_x = np.gradient(heights, scenario.cell * stride, axis=1)
    facing = LIGHT[2] - along_x * LIGHT[0] - along_y * LIGHT[1]
    return np.clip(facing / np.sqrt(1.0 + along_x**2 + along_y**2), 0.0, 1.0)
