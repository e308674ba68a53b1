"""Routes of the IAFSA paper on our maps: runs, paths of A*, and the shortest path of each."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from experiments.runs.outcomes import Floats
from experiments.runs.run import Run, feasible_lengths
from swarm_gym.problem.geometry.clearance import clearance
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import GridPath, shortest_grid_path, shortest_path, smooth
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario
from swarm_gym.scenarios.papers.iafsa import read_site_map

A_STAR, SMOOTHED = "A*", "A*, smoothed"


@dataclass(frozen=True)
class Route:
    """A route and its runs; lengths in metres.

    Attributes:
        site: key of its map in `SITES`.
        pair: letters of its ends.
        scenario: task on the inflated map.
        runs: runs by optimizer.
    """

    site: str
    pair: str
    scenario: GridScenario
    runs: Mapping[str, list[Run]]

    @property
    def label(self) -> str:
        """Name of the route as tables print it."""
        return f"{self.site} {self.pair}"

    @cached_property
    def raw(self) -> GridMap:
        """The map without the robot."""
        return read_site_map(self.site)

    @cached_property
    def shortest(self) -> tuple[float, Floats]:
        """The shortest path at any angle on the inflated map: its length, and its points (k, 2)."""
        return shortest_path(self.scenario)

    @cached_property
    def a_star(self) -> GridPath:
        """The path that A* finds on the inflated map."""
        grid = self.scenario.map
        ends = (grid.cell_of(point) for point in (self.scenario.start, self.scenario.target))
        return shortest_grid_path(grid.blocked, *ends)

    @cached_property
    def cell_paths(self) -> dict[str, Floats]:
        """(k, 2) paths of A* in map coordinates, as found and smoothed, by method."""
        grid, cells = self.scenario.map, self.a_star.cells
        return {A_STAR: grid.to_map(cells), SMOOTHED: grid.to_map(smooth(grid.blocked, cells))}

    def mean(self, method: str) -> float:
        """Return the mean length of an optimizer's feasible runs, or of a path of cells; NaN without one."""
        lengths = self.lengths(method) if method in self.runs else length_of(self.cell_paths[method])
        return float(np.mean(lengths)) if np.size(lengths) else np.nan

    def lengths(self, optimizer: str) -> Floats:
        """Return the lengths of the feasible runs."""
        return feasible_lengths(self.runs[optimizer])

    def clearances(self, optimizer: str) -> Floats:
        """Return the least distance of every run's best path from an obstacle."""
        return np.array([self.clearance(run.best_path) for run in self.runs[optimizer]])

    def clearance(self, path: Floats) -> float:
        """Return the least distance of a path in map coordinates from an obstacle."""
        return clearance(self.raw.blocked, self.raw.to_cells(path)) * self.raw.resolution


def make_route(name: str, runs: Mapping[str, list[Run]]) -> Route:
    """Return the route of a scenario, with runs by optimizer."""
    scenario = make_scenario(name)
    assert isinstance(scenario, GridScenario)
    site, _, pair = name.partition(":")[2].partition("-")
    return Route(site, pair, scenario, runs)


@cache
def length_of_planner(name: str, method: str) -> float:
    """Return the length of A*'s path on a route, `A_STAR`, or of that path smoothed, `SMOOTHED`."""
    return make_route(name, {}).mean(method)
