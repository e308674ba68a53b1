"""The plain-Python oracle of walks on a grid map: blocked shares of straight lines, and sight.

Everything is done in cells, (column, row) with centres at whole numbers, on lists. Blocked cells are open
squares, everything outside the map is blocked: a way may touch walls and run along them. It may not run along
the edge between two blocked cells, nor through the point where two of them touch at a corner.
"""

import itertools
import math

from oracles import naive, naive_grid

# In cells: that close to a free cell, a point touches it.
TOUCHING = 1e-9


class Problem:
    """The oracle of a `WalkProblem`."""

    dimension = 2

    def __init__(self, problem):
        scenario = problem.scenario
        self.map, self.penalty = scenario.map, problem.penalty
        self.start, self.target = list(scenario.start), list(scenario.target)
        self.width, self.height = self.map.width, self.map.height
        self.blocked = self.map.blocked.tolist()
        self.free_cells = [
            (column, row)
            for row in range(self.height)
            for column in range(self.width)
            if not self.blocked[row][column]
        ]
        x_min, y_min, x_max, y_max = self.map.extent
        self.lower, self.upper = [x_min, y_min], [x_max, y_max]
        self.side = max(self.width, self.height) * self.map.resolution
        self.diagonal = math.hypot(self.width, self.height) * self.map.resolution
        self.gaps = [
            (i - 0.5, j - 0.5)
            for i in range(1, self.width)
            for j in range(1, self.height)
            if self.is_gap(i, j)
        ]
        self._nearest = problem.table.nearest

    def is_free(self, column, row):
        return 0 <= column < self.width and 0 <= row < self.height and not self.blocked[row][column]

    def is_gap(self, i, j):
        """Return whether two blocked cells touch at a crossing whose other two cells are free."""
        falling = self.is_free(i - 1, j - 1), self.is_free(i, j)
        rising = self.is_free(i, j - 1), self.is_free(i - 1, j)
        return falling != rising and falling[0] == falling[1] and rising[0] == rising[1]

    # Points in map units.

    def cell_of(self, point):
        """Return the cell of a point; for a point on the far border, the cell beside it."""
        column, row = naive_grid.cell_of(self.map, *point)
        return naive.clip(column, 0, self.width - 1), naive.clip(row, 0, self.height - 1)

    def centre_of(self, cell):
        return list(naive_grid.centre_of(self.map, *cell))

    def freed(self, point):
        """Return the point, or the centre of the free cell that the package takes for the nearest one."""
        column, row = self.cell_of(point)
        if self.is_free(column, row):
            return list(point)
        return self.centre_of(self._nearest[row, column].tolist())

    def drawn(self, block):
        """Draw a point uniform in the free cells."""
        column, row = self.free_cells[math.floor(block[0] * len(self.free_cells))]
        return self.centre_of((column + block[1] - 0.5, row + block[2] - 0.5))

    def sees(self, here, there):
        return self.is_clear(self.in_cells(here), self.in_cells(there))

    def cost(self, point):
        """Return fitness and degree of collision of the straight line to the target."""
        return self.cost_of_path([point, self.target])

    def cost_of_path(self, points):
        """Return fitness and degree of collision of a polyline."""
        cells = sum(
            self.blocked_length(self.in_cells(a), self.in_cells(b)) for a, b in itertools.pairwise(points)
        )
        return length_of(points) + self.penalty * cells, cells * self.map.resolution

    # Points in cells.

    def in_cells(self, point):
        (left, top), side = self.map.origin, self.map.resolution
        x, y = point
        return (x - left) / side, ((top - y) if self.map.y_up else (y - top)) / side

    def touches_free(self, x, y):
        columns = {math.floor(x + 0.5 - TOUCHING), math.floor(x + 0.5 + TOUCHING)}
        rows = {math.floor(y + 0.5 - TOUCHING), math.floor(y + 0.5 + TOUCHING)}
        return any(self.is_free(column, row) for column in columns for row in rows)

    def blocked_length(self, here, there):
        """In cells; the middle of a piece between two grid lines stands for it."""
        (x, y), ways = here, (there[0] - here[0], there[1] - here[1])
        cuts = {0.0, 1.0}
        for begin, way, number in zip(here, ways, (self.width, self.height), strict=True):
            if way != 0:
                cuts |= {(line - 0.5 - begin) / way for line in range(number + 1)}
        share = 0.0
        for begin, end in itertools.pairwise(sorted(cut for cut in cuts if 0 <= cut <= 1)):
            middle = (begin + end) / 2
            if not self.touches_free(x + middle * ways[0], y + middle * ways[1]):
                share += end - begin
        return share * math.hypot(*ways)

    def is_clear(self, here, there):
        if here == there:
            return self.touches_free(*here)
        return self.blocked_length(here, there) == 0 and not any(
            lies_inside(gap, here, there) for gap in self.gaps
        )


def lies_inside(point, here, there):
    """Return whether a point lies on a segment, and not at its ends."""
    x, y = there[0] - here[0], there[1] - here[1]
    a, b = point[0] - here[0], point[1] - here[1]
    share = (a * x + b * y) / (x * x + y * y)
    beside = math.hypot(a - share * x, b - share * y)
    from_ends = min(share, 1 - share) * math.hypot(x, y)
    return beside <= TOUCHING < from_ends


def length_of(points):
    return naive.added(math.dist(a, b) for a, b in itertools.pairwise(points))
