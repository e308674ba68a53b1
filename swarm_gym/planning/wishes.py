"""Wishes: what a path on a map of cells shall keep low besides its length, as one sum with weights.

The sum of a path is the integral of 1 + ground c(x) + distance e(x) along it, in map units. Here c is the
cost of ground, see `swarm_gym.scenarios.graded_map`. The cost of nearness e = exp(-(d - margin) / decay)
decays with the distance d from blocked cells, as Nav2's inflation layer does. It is 1 where the path is as
close as the margin, see `swarm_gym.problem.grid.nearness`. Both are constant within each cell of the map as
given.

The wish `curvature` is for drivable curves alone, see `swarm_gym.planning.drive_costs`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import require_number
from swarm_gym.errors import SettingError, UnknownNameError, shown
from swarm_gym.planning.tasks import Task
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.problem.grid.nearness import nearness
from swarm_gym.scenarios import GridScenario

Floats = NDArray[np.float64]

FIELDS = ("ground", "distance")  # wishes whose integrand depends on the place alone
WISHES = (*FIELDS, "curvature")
MOST_CELLS = 2**22  # for which the search takes 0.2 gigabytes
EDGE = 1e-9  # how far beside a border between cells a path counts as on it, in cells


def require_wishes(wishes: object) -> dict[str, float]:
    """Return the weights of wishes by name.

    Raises:
        SettingError: if it is no mapping, or a weight is negative or no number.
        UnknownNameError: for a name that is not in `WISHES`.
    """
    if not isinstance(wishes, Mapping):
        raise SettingError(f"wishes must be weights by name, e.g. {{'distance': 2.0}}, got {shown(wishes)}")
    for name, weight in wishes.items():
        if name not in WISHES:
            raise UnknownNameError("wish", name, WISHES)
        require_number(f"wishes: weight of {name}", weight, 0.0, 1e6)
    return {name: float(wishes.get(name, 0.0)) for name in WISHES}


@dataclass(frozen=True, eq=False)
class WishedTask:
    """A task on a map of cells, and the wishes for its path.

    Attributes:
        task: the task.
        weights: weight of each name in `WISHES`.

    Raises:
        SettingError: if the map has no cells or too many, or no costs of ground though these have a weight.
    """

    task: Task
    weights: Mapping[str, float]

    def __post_init__(self) -> None:
        if not isinstance(self.task.given, GridScenario):
            raise SettingError(
                f"wishes: expected a map of cells, map {shown(self.task.given.name)} has circles and "
                "polygons; leave the option out"
            )
        cells = self.task.given.map.blocked.size
        if cells > MOST_CELLS:
            raise SettingError(
                f"wishes: expected a map of at most {MOST_CELLS:,} cells, map {shown(self.task.given.name)} "
                f"has {cells:,}; plan on the part around start and goal, or on larger cells"
            )
        require_ground(self.task, self.weights)

    @property
    def scenario(self) -> GridScenario:
        """The map as it is given."""
        assert isinstance(self.task.given, GridScenario)
        return self.task.given

    @cached_property
    def parts(self) -> dict[str, Floats]:
        """Cost of each cell of the map as given by the name of the wish, (height, width) each."""
        grid = self.scenario.map
        ground = np.zeros(grid.blocked.shape) if self.task.costs is None else self.task.costs
        near = nearness(grid, self.task.margin)
        return {"ground": ground, "distance": near}

    @cached_property
    def field(self) -> Floats:
        """Cost of a unit of length in each cell of the map as given, (height, width), at least 1.

        A path may touch blocked cells, which cost least.
        """
        found = np.ones(self.scenario.map.blocked.shape)
        for name in FIELDS:
            found += self.weights[name] * self.parts[name]
        return found

    def costs_of(self, path: Floats) -> dict[str, float]:
        """Return length, integral of each wish without its weight, and sum of a path in map units."""
        grid = self.scenario.map
        cells = grid.to_cells(path)
        found = {"length": length_of(path)}
        for name in FIELDS:
            found[name] = integral(self.parts[name], cells) * grid.resolution
        found["sum"] = found["length"] + math.fsum(self.weights[name] * found[name] for name in FIELDS)
        return found

    def sum_of(self, cells: Floats) -> float:
        """Return the sum of a path in cells (column, row), (k, 2), in cells."""
        return integral(self.field, cells)


def require_ground(task: Task, weights: Mapping[str, float]) -> None:
    """Raise an error if costs of ground have a weight on a map without them.

    Raises:
        SettingError: saying so.
    """
    if weights["ground"] > 0.0 and task.costs is None:
        raise SettingError(
            f"wishes: map {shown(task.given.name)} has no costs of ground; choose what grades mean "
            "(unknown, lethal, terrain), or leave `ground` out"
        )


def integral(field: Floats, cells: Floats) -> float:
    """Return the integral of a field along a polyline, (k, 2) cells (column, row), in cells.

    The field is constant in each cell. On a border between cells, the larger value counts.

    Args:
        field: (height, width) values from 0 on.
        cells: the polyline, on the map.
    """
    return math.fsum(_along(field, *begin, *end) for begin, end in pairwise(cells.tolist()))


def _along(field: Floats, x0: float, y0: float, x1: float, y1: float) -> float:
    """Return the integral of a field along a segment, in cells.

    Plain Python, since most segments cross a few cells only.
    """
    dx, dy = x1 - x0, y1 - y0
    length = math.hypot(dx, dy)
    if length == 0.0:
        return 0.0
    cuts = sorted([0.0, *_crossings(x0, x1), *_crossings(y0, y1), 1.0])
    # The middle of a piece is near a border only if all of the segment runs along it.
    sides_x = (-EDGE, EDGE) if _is_border(x0, dx) else (0.0,)
    sides_y = (-EDGE, EDGE) if _is_border(y0, dy) else (0.0,)
    height, width = field.shape
    total = 0.0
    for here, there in pairwise(cuts):
        middle = (here + there) / 2.0
        x, y = x0 + middle * dx + 0.5, y0 + middle * dy + 0.5
        total += (there - here) * max(
            field.item(min(max(int(y + beside_y), 0), height - 1), min(max(int(x + beside_x), 0), width - 1))
            for beside_x in sides_x
            for beside_y in sides_y
        )
    return length * total


def _is_border(begin: float, change: float) -> bool:
    return abs(change) < EDGE and abs(begin + 0.5 - round(begin + 0.5)) < EDGE


def _crossings(begin: float, end: float) -> list[float]:
    """Return the shares of a segment where it crosses borders between cells, in one coordinate."""
    change = end - begin
    if abs(change) < EDGE:
        return []
    low, high = min(begin, end), max(begin, end)
    lines = range(math.ceil(low - 0.5), math.floor(high - 0.5) + 1)
    return [min(max((line + 0.5 - begin) / change, 0.0), 1.0) for line in lines]
