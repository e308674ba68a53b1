"""The least fitness of a problem in the waypoint encoding, by dynamic programming.

Source: R. Bellman, Dynamic Programming (1957). The fitness is a sum over segments, and each depends
on its two waypoints only. So, with the offsets of every waypoint restricted to a finite set of
candidates, the best of all paths is found exactly, colliding ones included. The candidates are a
grid over the whole workspace first, then ever finer ones around the best path so far.

`python -m swarm_gym.reference.waypoint_optimum` writes the optima that ship with the package.
"""

import json
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swarm_gym.files import write_atomically
from swarm_gym.jit import kernel
from swarm_gym.problem import Problem
from swarm_gym.problem.collision import segment_collision
from swarm_gym.problem.waypoints import WaypointTable
from swarm_gym.reference.optima import digest
from swarm_gym.reference.visibility import shortest_path
from swarm_gym.scenarios import SCENARIOS, make_scenario

Floats = NDArray[np.float64]

# Candidates on either side of the best path while it is refined, in steps.
REFINEMENT_REACH = 12
# The grid is refined down to this step, in map units. At a contact with an obstacle the fitness
# grows linearly, so this is the error of the fitness too, up to a factor of the number of contacts.
FINEST_STEP = 1e-8


def optimum(problem: Problem, coarse_step: float = 0.5) -> tuple[float, Floats]:
    """Least fitness in the workspace, and a decision vector that has it, shape (num_waypoints,).

    Args:
        problem: what is to be solved; time grows with (extent of the workspace / coarse_step)^2.
        coarse_step: of the grid over the whole workspace, in map units. The result is a local
            optimum, and the global one unless the best path of this grid is in another corridor.
    """
    lower, upper = problem.bounds
    middle = (lower + upper) / 2.0
    reach = math.ceil((upper - lower).max() / 2.0 / coarse_step)
    offsets = _best_on_grid(problem, middle, coarse_step, reach)
    best, step = problem.evaluate(offsets)[0], coarse_step
    while step > FINEST_STEP:
        candidate = _best_on_grid(problem, offsets, step, REFINEMENT_REACH)
        fitness = problem.evaluate(candidate)[0]
        if fitness < best:
            best, offsets = fitness, candidate
        else:
            step /= 2.0
    return best, offsets


def _best_on_grid(problem: Problem, middle: Floats, step: float, reach: int) -> Floats:
    """Best decision vector with offsets `middle` (n,) plus -reach .. reach steps, in the bounds."""
    lower, upper = problem.bounds
    grid = middle[:, np.newaxis] + step * np.arange(-reach, reach + 1)
    grid = np.clip(grid, lower[:, np.newaxis], upper[:, np.newaxis])
    return best_path(problem.table, np.pad(grid, ((1, 1), (0, 0))))[1:-1]


@kernel
def best_path(table: WaypointTable, candidates: Floats) -> Floats:
    """Find the path of least fitness, shape (n + 2,), among all of given candidate offsets.

    Args:
        table: the problem, with n waypoints.
        candidates: shape (n + 2, K), offsets that each waypoint can have; 0 for start and target.
    """
    stations, columns = candidates.shape
    spacing = table.spacing
    origin = np.zeros((stations, columns), dtype=np.int64)
    fitness = np.zeros(columns)  # of the best path that ends at a candidate
    for station in range(1, stations):
        before = fitness.copy()
        for k in range(columns):
            right = candidates[station, k]
            least, source = np.inf, 0
            for i in range(columns):
                left = candidates[station - 1, i]
                length = math.sqrt(spacing * spacing + (right - left) * (right - left))
                total = before[i] + table.length_weight * length
                if total < least:  # collision can only add to it
                    collision = segment_collision(table, station - 1, left, right, length)
                    total += (1.0 - table.length_weight) * collision
                    if total < least:
                        least, source = total, i
            fitness[k], origin[station, k] = least, source
    path = np.zeros(stations)
    k = 0  # every candidate of the target is the target
    for station in range(stations - 1, 0, -1):
        path[station] = candidates[station, k]
        k = origin[station, k]
    return path


def write_optima(file: Path) -> None:
    """Write the optima of all registered scenarios with the default encoding and weight, as JSON.

    All lengths are in map units, to 1e-6.
    """
    entries = []
    for name in sorted(SCENARIOS):
        problem = Problem(make_scenario(name))
        entries.append(
            {
                "name": name,
                "num_waypoints": problem.num_waypoints,
                "length_weight": problem.length_weight,
                "digest": digest(problem),
                "fitness": round(optimum(problem)[0], 6),
                "shortest_path": round(shortest_path(problem.scenario)[0], 6),
            }
        )
    write_atomically(file, json.dumps(entries, indent=2) + "\n")


def main() -> None:
    """Write `optima.json`, which ships with the package."""
    write_optima(Path(__file__).with_name("optima.json"))


if __name__ == "__main__":
    main()
