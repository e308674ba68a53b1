"""Funnels: the shortest path through a row of doors, which are segments between convex rooms.

The funnel of a start and some doors is the bundle of shortest paths to the last door. The paths share points
up to the apex, and bend from there around the ends of doors, on two chains (D. T. Lee, F. P. Preparata,
Networks 14(3), 1984). A door may lie on one line with the one before, as where a path turns around a wall.
There, equal directions are told apart by distance.
"""

import math
from dataclasses import dataclass, replace

Point = tuple[float, float]


@dataclass(frozen=True)
class Funnel:
    """The shortest paths from a start to the points of a door; unchangeable, so that searches can branch.

    Attributes:
        apex: last point that all these paths share.
        length: length of the path to the apex.
        left: points where paths bend to the left end of the door, behind the apex; that end is last.
        right: points where paths bend to the right end, in the same way.
        shared: points of the path before the apex, the last first, as nested pairs.
    """

    apex: Point
    length: float = 0.0
    left: tuple[Point, ...] = ()
    right: tuple[Point, ...] = ()
    shared: "tuple[Point, object] | None" = None

    def through(self, left: Point, right: Point) -> "Funnel":
        """Return the funnel behind one more door, whose ends are to the left and right of who passes it."""
        return self._with_end(right, -1.0)._with_end(left, 1.0)

    def to(self, point: Point) -> "Funnel":
        """Return the funnel whose door is a point in the room behind the last door: its apex is the point."""
        narrow = self.through(point, point)
        onward = narrow.left or narrow.right
        for place in onward:
            narrow = narrow._moved_to(place)
        return replace(narrow, left=(), right=())

    def points(self) -> list[Point]:
        """Return the points of the path from the start to the apex."""
        found, rest = [self.apex], self.shared
        while rest is not None:
            found.append(rest[0])
            rest = rest[1]  # type: ignore[assignment]
        return found[::-1]

    def _moved_to(self, apex: Point) -> "Funnel":
        if apex == self.apex:
            return self
        length = self.length + math.dist(self.apex, apex)
        return replace(self, apex=apex, length=length, shared=(self.apex, self.shared))

    def _with_end(self, end: Point, side: float) -> "Funnel":
        """Return the funnel with another end of its door: left for a side of 1, right for -1."""
        chain, other = (self.left, self.right) if side > 0.0 else (self.right, self.left)
        while chain:
            before = chain[-2] if len(chain) > 1 else self.apex
            if side * _turn(before, chain[-1], end) > 0.0:
                break  # the path still bends around the last point of the chain
            chain = chain[:-1]
        funnel = self
        if not chain:
            while other and _is_crossed(funnel.apex, other[0], end, side):
                funnel, other = funnel._moved_to(other[0]), other[1:]
        if end != (chain[-1] if chain else funnel.apex):
            chain = (*chain, end)
        left, right = (chain, other) if side > 0.0 else (other, chain)
        return replace(funnel, left=left, right=right)


def _is_crossed(apex: Point, first: Point, end: Point, side: float) -> bool:
    """Return whether the way from the apex to the end of a door leads around the first point of a chain."""
    turn = side * _turn(apex, first, end)
    if turn != 0.0:
        return turn < 0.0
    along = (first[0] - apex[0]) * (end[0] - apex[0]) + (first[1] - apex[1]) * (end[1] - apex[1])
    return along > 0.0 and math.dist(apex, end) >= math.dist(apex, first)


def _turn(before: Point, here: Point, onward: Point) -> float:
    """Return twice the area of a triangle: above 0 if the way turns to the left, with y upwards."""
    return (here[0] - before[0]) * (onward[1] - before[1]) - (here[1] - before[1]) * (onward[0] - before[0])
