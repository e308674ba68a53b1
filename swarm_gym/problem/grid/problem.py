"""Problems on grid maps: Bezier curves or waypoints among blocked cells.

Waypoints stand at growing distances along the straight line from start to target. So they cannot follow a
path that turns back on its way; `warn_of_winding` finds maps on which every path does.
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.checks import look_up, require_integer, require_number
from swarm_gym.errors import SettingError, shown
from swarm_gym.problem.geometry.curves import nearest_curves
from swarm_gym.problem.geometry.rotated_axes import resampled
from swarm_gym.problem.grid import encoding
from swarm_gym.problem.grid.encoding import Encoding
from swarm_gym.problem.grid.nearness import nearness
from swarm_gym.problem.grid.table import GridTable, tabulate
from swarm_gym.problem.map_problem import GridMapProblem
from swarm_gym.problem.problem import Problem
from swarm_gym.scenarios import GridScenario

Floats = NDArray[np.float64]

# Most control points or waypoints: binomial coefficients of more do not fit into double precision.
MAX_POINTS = 1000

# Weights of what a path shall keep low besides its length.
WISH_WEIGHTS = ("distance_weight", "ground_weight", "curvature_weight")

# Encodings by name.
ENCODINGS = {"bezier": encoding.bezier, "waypoints": encoding.waypoints}


@dataclass(frozen=True)
class GridProblem(GridMapProblem):
    """Find the path of least fitness on a grid map.

    Attributes:
        scenario: the map and the task.
        encoding: a name in `ENCODINGS`.
        num_points: free control points of a Bezier curve, or waypoints.
        penalty: lambda, the fitness that each of `table.num_pieces` equal parts of a path costs if blocked.
        distance_weight: weight of the cost of nearness to blocked cells, see `nearness`.
        ground_weight: weight of the costs of ground, which the scenario needs for it.
        curvature_weight: weight, in map units squared, of the squared curvature, see `cost`.
        ways: (K, D) the paths that smooth new members lie next to; None is the straight line.
    """

    scenario: GridScenario
    encoding: str = "bezier"
    num_points: int = 4
    penalty: float = 500.0
    distance_weight: float = 0.0
    ground_weight: float = 0.0
    curvature_weight: float = 0.0
    ways: Floats | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        look_up("encoding", self.encoding, ENCODINGS)
        require_integer("num_points", self.num_points, 1, MAX_POINTS)
        require_number("penalty", self.penalty, 0.0, 1e9)
        for name in WISH_WEIGHTS:
            require_number(name, getattr(self, name), 0.0, 1e6)
        if self.ground_weight > 0.0 and self.scenario.ground is None:
            raise SettingError(
                f"ground_weight {self.ground_weight:g}: map {shown(self.scenario.name)} has no costs of "
                "ground; choose a scenario with `ground`, or leave the option out"
            )

    @property
    def dimension(self) -> int:
        """Length of a decision vector."""
        return len(self.curve.lower)

    @cached_property
    def curve(self) -> Encoding:
        """The encoding, which turns decision vectors into paths."""
        return ENCODINGS[self.encoding](self.scenario, self.num_points)

    @cached_property
    def table(self) -> GridTable:
        """The problem as the kernels read it."""
        grid, ground = self.scenario.map, self.scenario.ground
        costs = []
        if self.distance_weight > 0.0:
            costs.append(self.distance_weight * nearness(grid, 0.0))
        if self.ground_weight > 0.0 and ground is not None:
            costs.append(self.ground_weight * ground.costs)
        total = np.sum(costs, axis=0) if costs else None
        return tabulate(grid, self.curve, self.penalty, self.ways, total, self.curvature_weight)

    @property
    def wishes(self) -> dict[str, float]:
        """The weights that are not 0, by name: what a path shall keep low besides its length."""
        return {name: getattr(self, name) for name in WISH_WEIGHTS if getattr(self, name) > 0.0}

    @property
    def lower_bound(self) -> float:
        """A lower bound of the fitness: the straight line, also where wishes have a weight."""
        return self.scenario.straight_line

    @property
    def collision_bound(self) -> float:
        """An upper bound of the degree of collision: the length of the longest path inside the bounds."""
        low, high = (self.curve.control_points(bound) for bound in self.bounds)
        # No curve is longer than the polygon of its control points.
        sides = np.maximum(low, high).max(axis=0) - np.minimum(low, high).min(axis=0)
        extent = math.sqrt(np.square(sides).sum())
        return float(extent * (len(low) - 1) * (1.0 + 1.0 / self.table.num_pieces))

    @property
    def collision_bound_anywhere(self) -> float:
        """An upper bound of the degree of collision for any start on the map, in map units."""
        x_min, y_min, x_max, y_max = self.scenario.workspace
        num_legs = len(self.curve.base) - 1
        return math.hypot(x_max - x_min, y_max - y_min) * num_legs * (1.0 + 1.0 / self.table.num_pieces)

    def carried_over(self, vectors: Floats, before: Problem) -> Floats:
        """Return the offsets of the same paths from the new line; control points stay in place."""
        return vectors if self.encoding == "bezier" else self.along(before.points(vectors))

    def along(self, paths: Floats) -> Floats:
        """Return decision vectors, (m, D), along polylines, (m, k, 2); Bezier curves by least squares."""
        found = (
            nearest_curves(paths, self.num_points)
            if self.encoding == "bezier"
            else resampled(paths, self.scenario, self.num_points)
        )
        return np.clip(found, *self.bounds)

    @property
    def identity(self) -> tuple[object, ...]:
        """The map, the ends and the parameters that the fitness depends on."""
        scenario = self.scenario
        ends = [float(number) for number in (*scenario.start, *scenario.target)]
        found: tuple[object, ...] = (
            scenario.map.digest,
            ends,
            self.encoding,
            int(self.num_points),
            float(self.penalty),
        )
        if self.distance_weight > 0.0:
            found += (float(self.distance_weight),)
        if self.ground_weight > 0.0 and scenario.ground is not None:
            found += ("ground", float(self.ground_weight), scenario.ground.digest)
        if self.curvature_weight > 0.0:
            found += ("curvature", float(self.curvature_weight))
        return found

    def points(self, vectors: ArrayLike) -> Floats:
        """Return the paths, (..., k, 2) in map coordinates, of decision vectors (..., dimension)."""
        return self.curve.points(vectors)


def warn_of_winding(scenarios: Sequence[GridScenario]) -> None:
    """Warn once if there are scenarios whose paths all turn back on their way."""
    winding = [scenario.name for scenario in scenarios if not has_forward_path(scenario)]
    if winding:
        others = f", and on {len(winding) - 1} more of {len(scenarios)}" if len(winding) > 1 else ""
        warnings.warn(
            f"scenario {shown(winding[0])}{others}: every path turns back on its way, and paths of waypoints "
            "cannot; choose encoding 'bezier', or plan with swarm_gym.plan",
            stacklevel=2,
        )


@lru_cache(maxsize=1024)
def has_forward_path(scenario: GridScenario) -> bool:
    """Return whether steps between free neighbouring cells lead to the target, none of them away from it.

    Away means back along the straight line from start to target.
    """
    from scipy.ndimage import binary_propagation

    (column, row), (to_column, to_row) = map(scenario.map.cell_of, (scenario.start, scenario.target))
    rows, columns = np.mgrid[-1:2, -1:2]
    forward = rows * (to_row - row) + columns * (to_column - column) >= 0
    reached = np.zeros_like(scenario.map.blocked)
    reached[row, column] = True
    reached = binary_propagation(reached, forward, mask=~scenario.map.blocked)
    return bool(reached[to_row, to_column])
