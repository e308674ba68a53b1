"""Problems of flights over terrain: the flight of least cost from a start to a goal."""

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.checks import look_up, require_integer
from swarm_gym.problem.padding import columns
from swarm_gym.problem.problem import Problem
from swarm_gym.problem.terrain.bends import NUM_MORE_NUMBERS, NUM_NUMBERS
from swarm_gym.problem.terrain.cost import TERMS, WEIGHTS, costs_entry, terms_entry
from swarm_gym.problem.terrain.table import COSTS, ENCODINGS, SIZES, TerrainTable, tabulate
from swarm_gym.problem.terrain.waypoints import flights
from swarm_gym.scenarios import TerrainScenario

Floats = NDArray[np.float64]

# Smallest numbers of waypoints, for which random numbers of a member suffice for its bends, and the largest.
MIN_WAYPOINTS, MIN_SHIFTED, MAX_WAYPOINTS = 4, 6, 300
assert columns(2 * MIN_WAYPOINTS) >= NUM_NUMBERS
assert columns(3 * MIN_SHIFTED) >= NUM_NUMBERS + NUM_MORE_NUMBERS


@dataclass(frozen=True)
class TerrainProblem(Problem):
    """Find the flight of least cost over terrain, through waypoints above ground.

    Attributes:
        scenario: the map and the task.
        encoding: a name in `swarm_gym.problem.terrain.table.ENCODINGS`.
        num_waypoints: n, number of waypoints between start and goal.
        cost: a name in `swarm_gym.problem.terrain.table.COSTS`.
        ways: (K, 2 n) the flights that smooth new members lie next to. They are offsets sideways and upwards
            from the start-goal line in any encoding, and (K, 3 n) with those forwards for `shifted`. None is
            the line.
    """

    scenario: TerrainScenario
    encoding: str = "waypoints"
    num_waypoints: int = 10
    cost: str = "documented"
    ways: Floats | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        look_up("encoding", self.encoding, ENCODINGS)
        look_up("cost", self.cost, COSTS)
        least = MIN_SHIFTED if self.encoding == "shifted" else MIN_WAYPOINTS
        require_integer("num_waypoints", self.num_waypoints, least, MAX_WAYPOINTS)

    @property
    def dimension(self) -> int:
        """Length of a decision vector."""
        return SIZES[ENCODINGS[self.encoding]] * self.num_waypoints

    @cached_property
    def table(self) -> TerrainTable:
        """The problem as the kernels read it."""
        encoding, cost = ENCODINGS[self.encoding], COSTS[self.cost]
        return tabulate(self.scenario, encoding, cost, self.num_waypoints, self.ways)

    @property
    def lower_bound(self) -> float:
        """A lower bound of the fitness: the straight line, with the weight of the length."""
        ends = np.array([self.scenario.start[:2], self.scenario.goal[:2]])
        if self.cost == "documented":
            return WEIGHTS[0] * self.scenario.straight_line
        level = math.hypot(*np.subtract(ends[1], ends[0]).tolist())
        return WEIGHTS[0] * level  # heights below waypoints come from the nearest cells

    @property
    def collision_bound(self) -> float:
        """An upper bound of the degree of collision, in metres."""
        x_min, y_min, x_max, y_max = self.scenario.workspace
        heights, (lowest, highest) = self.scenario.heights, self.scenario.band
        climb = float(heights.max() - heights.min()) + highest - lowest
        longest = (self.num_waypoints + 1) * math.hypot(x_max - x_min, y_max - y_min, climb)
        return longest * (1.0 + len(self.scenario.threats))

    @property
    def identity(self) -> tuple[object, ...]:
        """The task and the choices that the fitness depends on."""
        return "terrain", self.scenario.digest, self.encoding, self.num_waypoints, self.cost

    def points(self, vectors: ArrayLike) -> Floats:
        """Return the flights, seen from above, (..., n + 2, 2) in map coordinates, of decision vectors."""
        return self.flights(vectors)[..., :2]

    def flights(self, vectors: ArrayLike) -> Floats:
        """Return flights, (..., n + 2, 4), of decision vectors (..., D): their waypoints from start to goal.

        Each has x, y, height (from the zero of the map) and altitude above ground, in metres.

        Raises:
            ValueError: if vectors have another length, or components that are not finite.
        """
        given = self._checked(vectors)
        paths = np.zeros((math.prod(given.shape[:-1]), columns(self.dimension) + 1))
        paths[:, 1 : self.dimension + 1] = given.reshape(-1, self.dimension)
        found = flights(self.table, paths)
        return found.reshape(*given.shape[:-1], *found.shape[1:])

    def costs(self, vectors: ArrayLike) -> Floats:
        """Return the fitness, (...,), of decision vectors, (..., D), which is minimised.

        The numbers are those of `evaluate`. The cost `metabox` takes less time here, since its degree of
        collision is not measured.

        Raises:
            ValueError: if vectors have another length, or components that are not finite.
        """
        given = self._checked(vectors)
        found = np.empty(given.shape[:-1])
        path = np.zeros(columns(self.dimension) + 1)
        costs_entry(self.table, given.reshape(-1, self.dimension), path, found.reshape(-1))
        return found

    def _checked(self, vectors: ArrayLike) -> Floats:
        """Return vectors, (..., D), as contiguous floats."""
        given = np.ascontiguousarray(vectors, dtype=np.float64)
        if given.shape[-1:] != (self.dimension,):
            raise ValueError(f"expected vectors of {self.dimension} components, got shape {given.shape}")
        if not np.isfinite(given).all():
            raise ValueError("decision vectors must be finite, got NaN or infinity in some component")
        return given

    def terms(self, vector: ArrayLike) -> dict[str, float]:
        """Return the terms of the cost of a decision vector by name, weighted: the fitness is their sum."""
        found = terms_entry(self.table, self._path(vector))
        return {name: weight * term for name, weight, term in zip(TERMS, WEIGHTS, found, strict=True)}
