"""Generators of fields of obstacles: scattered obstacles, and walls with gaps.

Every field has a solution by construction. Scattered obstacles keep a clearance from each other. There is
free space after the start, before the target and along both sides of the workspace. Walls have gaps, and two
walls are far enough apart to change from one gap to the next. In both kinds of fields there is a path without
collision, also one with 23 or more evenly spaced waypoints. A field is drawn again until it fits and its
obstacles block the straight line.

Random numbers are integers, and coordinates are rounded to integers, so a field is the same on every machine.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from swarm_gym.scenarios.obstacles import Circle, Obstacle, Point, Polygon
from swarm_gym.scenarios.scenario import Scenario

# Distance between the border of the workspace and start or target, in map units.
BORDER = 20
# Free space along the line after the start and before the target, as a fraction of the line.
FREE_END = 1 / 24
# Number of places that are tried for the obstacles of one field before the field is begun again.
PLACES = 300

Interval = tuple[int, int]


@dataclass(frozen=True)
class Scatter:
    """A generator of fields of scattered obstacles. Intervals are inclusive, lengths are in map units.

    Attributes:
        count: interval of the number of obstacles.
        size: interval of the typical radius of the obstacles of a field; the radii of single obstacles vary
            around it.
        clearance: smallest distance between obstacles.
        workspace: width and height.
        reach: largest distance between the line from start to target and any point of an obstacle.
        initial_reach: largest distance between that line and the first waypoints.
        blocking: smallest number of obstacles that the straight line crosses.
        turned: whether the line crosses the workspace at a random angle; by default it is horizontal.
    """

    count: Interval = (10, 20)
    size: Interval = (34, 52)
    clearance: int = 16
    workspace: tuple[int, int] = (1000, 600)
    reach: int = 220
    initial_reach: int = 180
    blocking: int = 3
    turned: bool = False

    def draw(self, name: str, rng: np.random.Generator) -> Scenario:
        """Draw a field and return it as the scenario of that name."""
        start, target = self._ends(rng)
        line = _Line.between(start, target)
        blocks: list[_Block] = []
        while not self._is_accepted(blocks, line):
            blocks = self._place(line, rng)
        return Scenario(
            name,
            start,
            target,
            tuple(block.obstacle() for block in blocks),
            (0.0, 0.0, *self.workspace),
            (-self.initial_reach, self.initial_reach),
        )

    def _ends(self, rng: np.random.Generator) -> tuple[Point, Point]:
        width, height = self.workspace
        if not self.turned:
            return (BORDER, height // 2), (width - BORDER, height // 2)
        # Half-angle formulas: they need no function whose last bit differs between machines.
        t = drawn(rng, (-100, 100)) / 100
        cosine, sine = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        dx, dy = _round(480 * cosine), _round(480 * sine)
        x, y = width // 2, height // 2
        return (x - dx, y - dy), (x + dx, y + dy)

    def _place(self, line: "_Line", rng: np.random.Generator) -> list["_Block"]:
        """Return as many obstacles as were drawn, or none if there is no place for that many."""
        kinds = ((True,), (False,), (True, False))[drawn(rng, (0, 2))]
        count, size = drawn(rng, self.count), drawn(rng, self.size)
        blocks: list[_Block] = []
        for _ in range(PLACES):
            # The sum of two uniform numbers puts more obstacles near the line.
            across = drawn(rng, (-self.reach, self.reach)) + drawn(rng, (-self.reach, self.reach))
            centre = line.point(drawn(rng, (0, math.floor(line.length))), across / 2)
            is_circle = kinds[drawn(rng, (0, len(kinds) - 1))]
            block = _draw_circle(centre, size, rng) if is_circle else _draw_rectangle(centre, size, rng)
            if self._fits(block, line) and all(block.gap(other) >= self.clearance for other in blocks):
                blocks.append(block)
            if len(blocks) == count:
                return blocks
        return []

    def _fits(self, block: "_Block", line: "_Line") -> bool:
        begin, end, low, high = line.extent(block)
        free = FREE_END * line.length
        return free <= begin and end <= line.length - free and -self.reach <= low and high <= self.reach

    def _is_accepted(self, blocks: list["_Block"], line: "_Line") -> bool:
        extents = map(line.extent, blocks)
        return sum(low < 0 < high for _, _, low, high in extents) >= self.blocking


@dataclass(frozen=True)
class Walls:
    """A generator of fields of walls across the line, each with one or two gaps.

    Intervals are inclusive, lengths are in map units.

    Attributes:
        count: interval of the number of walls.
        thickness: interval of the extent of a wall along the line.
        gap: interval of the width of a gap.
        gap_reach: largest distance between the line and the lower end of a gap.
        room: smallest distance between walls.
        workspace: width and height; walls go on beyond it, so that no path leads around them.
        initial_reach: largest distance between the line and the first waypoints.
        blocking: smallest number of walls that the straight line crosses.
    """

    count: Interval = (3, 5)
    thickness: Interval = (20, 40)
    gap: Interval = (30, 60)
    gap_reach: int = 160
    room: int = 80
    workspace: tuple[int, int] = (1000, 600)
    initial_reach: int = 180
    blocking: int = 2

    def draw(self, name: str, rng: np.random.Generator) -> Scenario:
        """Draw a field and return it as the scenario of that name."""
        width, height = self.workspace
        obstacles: list[Obstacle] = []
        blocking = 0
        while blocking < self.blocking:
            obstacles, blocking = [], 0
            count = drawn(rng, self.count)
            free = math.ceil(FREE_END * (width - 2 * BORDER))
            slot = (width - 2 * BORDER - 2 * free) // count
            for number in range(count):
                thickness = drawn(rng, self.thickness)
                x = BORDER + free + number * slot + drawn(rng, (0, slot - self.room - thickness))
                gaps = self._draw_gaps(rng)
                blocking += not any(low < height // 2 < high for low, high in gaps)
                edges = [-height, *(y for gap in gaps for y in gap), 2 * height]
                for bottom, top in zip(edges[::2], edges[1::2], strict=True):
                    obstacles.append(Polygon.rectangle(x, bottom, x + thickness, top))
        return Scenario(
            name,
            (BORDER, height // 2),
            (width - BORDER, height // 2),
            tuple(obstacles),
            (0.0, 0.0, width, height),
            (-self.initial_reach, self.initial_reach),
        )

    def _draw_gaps(self, rng: np.random.Generator) -> list[Interval]:
        """Return the gaps of a wall, from below; a second gap that overlaps the first is left out."""
        gaps: list[Interval] = []
        for _ in range(drawn(rng, (1, 2))):
            low = self.workspace[1] // 2 + drawn(rng, (-self.gap_reach, self.gap_reach))
            high = low + drawn(rng, self.gap)
            if all(high < other_low or other_high < low for other_low, other_high in gaps):
                gaps.append((low, high))
        return sorted(gaps)


class _Block(NamedTuple):
    """A circle, whose half extents are 0, or an axis-parallel rectangle, whose radius is 0; in map units."""

    x: int
    y: int
    half_width: int
    half_height: int
    radius: int

    def gap(self, other: "_Block") -> float:
        """Return the distance to another block; it is not positive if they touch."""
        dx = max(abs(self.x - other.x) - self.half_width - other.half_width, 0)
        dy = max(abs(self.y - other.y) - self.half_height - other.half_height, 0)
        return math.sqrt(dx * dx + dy * dy) - self.radius - other.radius

    def obstacle(self) -> Obstacle:
        if self.radius > 0:
            return Circle(self.x, self.y, self.radius)
        w, h = self.half_width, self.half_height
        return Polygon.rectangle(self.x - w, self.y - h, self.x + w, self.y + h)


class _Line(NamedTuple):
    """The line from start to target: its first point, its direction, and its length in map units."""

    start: Point
    cosine: float
    sine: float
    length: float

    @classmethod
    def between(cls, start: Point, target: Point) -> "_Line":
        dx, dy = target[0] - start[0], target[1] - start[1]
        length = math.sqrt(dx * dx + dy * dy)
        return cls(start, dx / length, dy / length, length)

    def point(self, along: float, across: float) -> tuple[int, int]:
        """Return integer coordinates next to the point that far along the line and to its left."""
        x = self.start[0] + along * self.cosine - across * self.sine
        y = self.start[1] + along * self.sine + across * self.cosine
        return _round(x), _round(y)

    def extent(self, block: _Block) -> tuple[float, float, float, float]:
        """Return the extent of a block along the line and across it: (begin, end, low, high)."""
        x, y = block.x - self.start[0], block.y - self.start[1]
        along, across = x * self.cosine + y * self.sine, y * self.cosine - x * self.sine
        cosine, sine = abs(self.cosine), abs(self.sine)
        length = block.radius + block.half_width * cosine + block.half_height * sine
        height = block.radius + block.half_width * sine + block.half_height * cosine
        return along - length, along + length, across - height, across + height


def _draw_circle(centre: tuple[int, int], size: int, rng: np.random.Generator) -> _Block:
    return _Block(*centre, 0, 0, size * drawn(rng, (70, 140)) // 100)


def _draw_rectangle(centre: tuple[int, int], size: int, rng: np.random.Generator) -> _Block:
    """Draw a slim rectangle; three of four stand upright."""
    slim, long = size * drawn(rng, (25, 55)) // 100, size * drawn(rng, (80, 150)) // 100
    upright = drawn(rng, (0, 3)) > 0
    return _Block(*centre, slim, long, 0) if upright else _Block(*centre, long, slim, 0)


def drawn(rng: np.random.Generator, interval: Interval) -> int:
    """Draw an integer from an interval, both ends included."""
    return int(rng.integers(interval[0], interval[1], endpoint=True))


def _round(value: float) -> int:
    return math.floor(value + 0.5)
