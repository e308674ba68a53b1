"""Runs: rows of neighbouring free cells, the convex rooms of a grid map, with doors between rows.

Two runs in neighbouring rows share a door where their columns overlap. Rooms and doors make a graph that has
the corridors of the map: each path leads through a row of rooms. Paths that can be moved into each other lead
through the same row. Ways into a room and back through the same door are left out first.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.funnel import Funnel, Point

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Runs:
    """The runs of a grid, and the doors between them.

    Attributes:
        number: (height, width) number of the run of each cell; -1 where it is blocked.
        row: row of each run.
        first: first column of each run.
        last: last column of each run.
    """

    number: NDArray[np.int32]
    row: NDArray[np.int32]
    first: NDArray[np.int32]
    last: NDArray[np.int32]

    @classmethod
    def of(cls, blocked: NDArray[np.bool_]) -> "Runs":
        """Return the runs of a grid, (height, width), row 0 on top."""
        free = ~blocked
        begins, ends = free.copy(), free.copy()
        begins[:, 1:] &= blocked[:, :-1]
        ends[:, :-1] &= blocked[:, 1:]
        number = np.cumsum(begins.ravel(), dtype=np.int32).reshape(free.shape) - 1
        number[blocked] = -1
        row, first = np.nonzero(begins)
        last = np.nonzero(ends)[1]
        return cls(number, row.astype(np.int32), first.astype(np.int32), last.astype(np.int32))

    @cached_property
    def neighbours(self) -> tuple[list[int], list[int]]:
        """Numbers of the runs next to each run, one run after the other, and where the numbers of each begin.

        Flat lists, since many small ones keep the garbage collector busy.
        """
        above, below = self.number[:-1], self.number[1:]
        both = (above >= 0) & (below >= 0)
        pairs = np.stack([above[both], below[both]], axis=-1)
        # The columns of a door lie side by side, so that equal pairs follow each other.
        pairs = pairs[np.append(True, (np.diff(pairs, axis=0) != 0).any(axis=1))[: len(pairs)]]
        begins, ends = np.concatenate([pairs, pairs[:, ::-1]]).T
        order = np.argsort(begins, kind="stable")
        first = np.concatenate([[0], np.cumsum(np.bincount(begins, minlength=len(self.row)))])
        return ends[order].tolist(), first.tolist()

    def door(self, run: int, onward: int) -> tuple[Point, Point]:
        """Return the left and the right end of the door from one run to another, with rows upwards."""
        begin = max(int(self.first[run]), int(self.first[onward])) - 0.5
        end = min(int(self.last[run]), int(self.last[onward])) + 0.5
        row, next_row = int(self.row[run]), int(self.row[onward])
        y = (row + next_row) / 2.0
        return ((begin, y), (end, y)) if next_row > row else ((end, y), (begin, y))

    def rooms_of(self, cells: Integers) -> list[int]:
        """Return the numbers of the runs that a path of steps over free cells, (k, 2), needs to pass.

        Ways into a run and back are left out. Diagonal steps must lead between two free cells.
        """
        rooms: list[int] = []
        for column, row in cells.tolist():
            run = int(self.number[row, column])
            if rooms and rooms[-1] == run:
                continue
            if rooms and abs(row - int(self.row[rooms[-1]])) != 1:
                raise AssertionError("a step leads over more than one row")
            if len(rooms) > 1 and rooms[-2] == run:
                rooms.pop()
            else:
                rooms.append(run)
        return rooms

    def tightened(self, start: Point, rooms: list[int], goal: Point) -> list[Point]:
        """Return the shortest path through runs from a point in the first to one in the last, exactly."""
        funnel = Funnel(start)
        for run, onward in pairwise(rooms):
            funnel = funnel.through(*self.door(run, onward))
        return funnel.to(goal).points()
