"""Generated grid maps: the scenarios `rooms:<seed>` and `caves:<seed>`.

Rooms resemble a floor of a building: a corridor, rooms with doors on both sides of it, and furniture. Caves
resemble maps of games: halls of irregular shape connected by passages, from a cellular automaton. Start and
target are far apart and connected, and the straight line between them is blocked. A map without such a pair
is drawn again.

Only integers are drawn, so a map is the same on every machine. Map coordinates are cells: x is the column, y
is the row, and y grows downwards.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.family import Family, parse_numbers
from swarm_gym.scenarios.grid_map import Cell, GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario

Blocked = NDArray[np.bool_]

WIDTH, HEIGHT = 128, 96
NUM_SEEDS = 1_000_000

# Smallest number of columns between start and target.
APART = 80
# Distance up to which the cells around start and target are free.
ROOM_TO_STAND = 2
# Number of pairs of start and target that are tried before a map is drawn again.
PAIRS = 50


# Percentage of the first cells of a cave that are rock.
ROCK = 47


class _Rooms:
    """A floor of a building: walls as rectangles of cells, with doors in them."""

    WALL = 2
    CORRIDOR = (7, 9)
    DOOR = (5, 8)
    # A region is split as long as both parts have at least this length.
    SHORTEST = 15
    # A wall of this length has a second door.
    LONG = 48
    PIECES_OF_FURNITURE = 60
    FURNITURE = (2, 7)
    FURNITURE_CLEARANCE = 5

    def __init__(self, rng: np.random.Generator):
        self._rng = rng
        self._free = np.ones((HEIGHT, WIDTH), dtype=np.bool_)

    def draw(self) -> Blocked:
        free, wall = self._free, self.WALL
        free[:wall] = free[-wall:] = False
        free[:, :wall] = free[:, -wall:] = False
        corridor = self._draw(self.CORRIDOR)
        top = self._draw((HEIGHT // 3, HEIGHT * 2 // 3 - corridor))
        for first in (top - wall, top + corridor):
            self._build_wall(free, first, wall, WIDTH - wall)
        self._split(wall, wall, top - wall, WIDTH - wall)
        self._split(top + corridor + wall, wall, HEIGHT - wall, WIDTH - wall)
        for _ in range(self.PIECES_OF_FURNITURE):
            self._furnish()
        return ~free

    def _split(self, top: int, left: int, bottom: int, right: int) -> None:
        """Build walls inside a region of free cells; `bottom` and `right` are the first outside it."""
        is_wide = right - left >= bottom - top
        # The grid is transposed where needed, so that the new wall lies along a row.
        free = self._free.T if is_wide else self._free
        begin, end, low, high = (left, right, top, bottom) if is_wide else (top, bottom, left, right)
        first, last = begin + self.SHORTEST, end - self.SHORTEST - self.WALL
        # The ends of a wall must meet walls and not doors, since such a door would be blocked.
        places = [
            row
            for row in range(first, last + 1)
            if not free[row - 1 : row + self.WALL + 1, [low - 1, high]].any()
        ]
        if not places:
            return
        row = places[self._draw((0, len(places) - 1))]
        self._build_wall(free, row, low, high)
        for part_begin, part_end in ((begin, row), (row + self.WALL, end)):
            if is_wide:
                self._split(top, part_begin, bottom, part_end)
            else:
                self._split(part_begin, left, part_end, right)

    def _build_wall(self, free: Blocked, row: int, low: int, high: int) -> None:
        """Build a wall from column `low` to before `high`, with one door in each of its equal parts."""
        free[row : row + self.WALL, low:high] = False
        num_doors = 1 + (high - low) // self.LONG
        length = (high - low) // num_doors
        for part in range(num_doors):
            door = self._draw(self.DOOR)
            begin = low + part * length + self._draw((1, length - door - 1))
            free[row : row + self.WALL, begin : begin + door] = True

    def _furnish(self) -> None:
        """Place a piece of furniture unless an obstacle is too close; one can walk all around it."""
        height, width = self._draw(self.FURNITURE), self._draw(self.FURNITURE)
        top, left = self._draw((0, HEIGHT - height)), self._draw((0, WIDTH - width))
        room = self.FURNITURE_CLEARANCE
        if self._free[
            max(top - room, 0) : top + height + room, max(left - room, 0) : left + width + room
        ].all():
            self._free[top : top + height, left : left + width] = False

    def _draw(self, interval: tuple[int, int]) -> int:
        return int(self._rng.integers(*interval, endpoint=True))


def _draw_caves(rng: np.random.Generator) -> Blocked:
    """Return the largest cave of a cellular automaton."""
    # The automaton runs on blocks of 2 x 2 cells first, and then on single cells, which is smoother.
    free = rng.integers(0, 100, size=(HEIGHT // 2, WIDTH // 2)) >= ROCK
    for _ in range(4):
        free = _majority(free)
    free = free.repeat(2, axis=0).repeat(2, axis=1)
    for _ in range(2):
        free = _majority(free)
    # Passages that are narrower than three cells become rock.
    free = _count_around(_count_around(free) == 9) > 0
    labels = GridMap("caves", ~free).components
    sizes = np.bincount(labels.ravel(), minlength=2)[1:]
    return labels != sizes.argmax() + 1


def _majority(free: Blocked) -> Blocked:
    """Return the state of the majority of the nine cells around each cell; outside the map is rock."""
    return _count_around(free) >= 5


def _count_around(cells: Blocked) -> NDArray[np.int64]:
    """Return the number of true cells in the 3 x 3 block around each cell; cells off the map are false."""
    padded = np.pad(cells, 1).astype(np.int64)
    rows = padded[:-2] + padded[1:-1] + padded[2:]
    return rows[:, :-2] + rows[:, 1:-1] + rows[:, 2:]


def _draw_ends(grid: GridMap, rng: np.random.Generator) -> tuple[Cell, Cell] | None:
    """Draw start and target; return None if no pair is found."""
    spacious = ~grid.blocked
    for _ in range(ROOM_TO_STAND):
        spacious = _count_around(spacious) == 9
    rows, columns = np.nonzero(spacious)
    if len(rows) == 0:
        return None
    for _ in range(PAIRS):
        first, second = rng.integers(0, len(rows), size=2).tolist()
        start, target = sorted((int(columns[k]), int(rows[k])) for k in (first, second))
        connected = grid.components[start[1], start[0]] == grid.components[target[1], target[0]]
        if connected and target[0] - start[0] >= APART and _is_line_blocked(grid, start, target):
            return start, target
    return None


def _is_line_blocked(grid: GridMap, start: Cell, target: Cell) -> bool:
    """Return True if the line from a cell to a cell further right crosses a blocked cell mid-column."""
    (x, y), (to_x, to_y) = start, target
    dx, dy = to_x - x, to_y - y
    k = np.arange(dx + 1)
    rows = (2 * (y * dx + k * dy) + dx) // (2 * dx)  # floor(row + 1/2) in integers
    return bool(grid.blocked[rows, x + k].any())


def _family(name: str, number: int, draw: Callable[[np.random.Generator], Blocked]) -> Family:
    """Return a family of maps; families of different numbers use different random generators."""
    usage = f"{name}:<seed>"

    def expand(given: str) -> tuple[str, ...]:
        """Return the names of the single maps that a name stands for; `...:0-9` stands for ten maps.

        Raises:
            ScenarioError: if the name has another form or a seed is too large.
        """
        seeds = parse_numbers(given.removeprefix(f"{name}:"), given)
        if not seeds or seeds[-1] >= NUM_SEEDS:
            raise ScenarioError(
                f"scenario {shown(given)}: expected {usage}, a number from 0 to {NUM_SEEDS - 1} or a range "
                "of them such as 0-9"
            )
        return tuple(f"{name}:{seed}" for seed in seeds)

    def make(given: str) -> GridScenario:
        """Return the single map of that name."""
        rng = np.random.Generator(np.random.PCG64([number, int(given.removeprefix(f"{name}:"))]))
        ends = None
        while ends is None:
            grid = GridMap(given, draw(rng))
            ends = _draw_ends(grid, rng)
        return GridScenario(given, grid, *ends)

    return Family(usage, (f"{name}:0", f"{name}:1"), expand, make)


# Never change the number or the generator of a family: results refer to these maps.
ROOMS = _family("rooms", 0, lambda rng: _Rooms(rng).draw())
CAVES = _family("caves", 1, _draw_caves)
