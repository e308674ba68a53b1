"""The least fitness of a problem in the waypoint encoding, by dynamic programming.

Source: R. Bellman, Dynamic Programming (1957). The fitness is a sum over segments, and each depends
on its two waypoints only. So, with the offsets of every waypoint restricted to a finite set of
candidates, the best of all paths is found exactly, colliding ones included. The candidates are a
grid over the whole workspace first, then ever finer ones around the best path so far.

`python -m swarm_gym.reference.waypoint_optimum NAME ...` computes the optima of scenarios and stores them for
later use; with `--ship` instead of names it writes those that ship with the package.
"""

import argparse
import json
import math
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import require_integer
from swarm_gym.compiler.jit import entry
from swarm_gym.errors import SettingError, SwarmGymError, shown
from swarm_gym.files import write_atomically
from swarm_gym.problem import AnalyticProblem, GridProblem, Problem
from swarm_gym.problem.analytic.cost import segment_collision
from swarm_gym.problem.analytic.table import WaypointTable
from swarm_gym.reference.optima import FIELD_FILES, digest, known_optimum, store_optimum
from swarm_gym.reference.shortest import shortest_path
from swarm_gym.scenarios import SCENARIOS, make_scenario, make_scenarios, require_analytic, worlds_of

Floats = NDArray[np.float64]

# Candidates on either side of the best path while it is refined, in steps.
REFINEMENT_REACH = 12
# The grid is refined down to this step, in map units. At a contact with an obstacle the fitness
# grows linearly, so this is the error of the fitness too, up to a factor of the number of contacts.
FINEST_STEP = 1e-8
# Of these the optima ship, with the default encoding and weight; of maps that change, as they are at the end.
PACKAGED_SCENARIOS = (
    *sorted(SCENARIOS),
    *(f"dynamic:{name}-{event}@1" for event in ("gate", "block") for name in sorted(SCENARIOS)),
)

Progress = Callable[[int, int], None]


def optimum(problem: AnalyticProblem, coarse_step: float = 1.0) -> tuple[float, Floats]:
    """Return the least fitness in the workspace, and a decision vector that has it, (num_waypoints,).

    Args:
        problem: the problem; time grows with (extent of the workspace / coarse_step)^2.
        coarse_step: step of the grid over the whole workspace, in map units. The result is a local
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


def _best_on_grid(problem: AnalyticProblem, middle: Floats, step: float, reach: int) -> Floats:
    """Return the best decision vector in the bounds with offsets `middle` (n,) plus -reach .. reach steps."""
    lower, upper = problem.bounds
    grid = middle[:, np.newaxis] + step * np.arange(-reach, reach + 1)
    grid = np.clip(grid, lower[:, np.newaxis], upper[:, np.newaxis])
    return best_path(problem.table, np.pad(grid, ((1, 1), (0, 0))))[1:-1]


@entry
def best_path(table: WaypointTable, candidates: Floats) -> Floats:
    """Find the path of least fitness, shape (n + 2,), among all of given candidate offsets.

    Args:
        table: the problem table, with n waypoints.
        candidates: (n + 2, K) offsets that each waypoint can have; 0 for start and target.
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


def ensure_optima(
    problems: Sequence[Problem], num_threads: int = 1, progress: Progress | None = None
) -> list[float]:
    """Return the least fitness of each problem, in map units; unknown ones are computed and stored.

    On a grid map that is the length of the shortest path at any angle, which a curve may not reach. The
    optimum of a test function is known.

    Args:
        problems: any number; about a fifth of a second for each that is not known.
        num_threads: number of threads that share the computation.
        progress: is called with the number of problems done and the number of all.

    Raises:
        SettingError: if the number of threads is not positive, or if wishes besides the length have weights.
    """
    require_integer("num_threads", num_threads, 1)
    with ThreadPoolExecutor(num_threads) as pool:
        optima = []
        for fitness in pool.map(_ensure_optimum, problems):
            optima.append(fitness)
            if progress is not None:
                progress(len(optima), len(problems))
    return optima


def compute_optimum(problem: Problem) -> float:
    """Return the least fitness of a problem on a map, in map units; see `ensure_optima`."""
    if isinstance(problem, GridProblem) and problem.wishes:
        weights = ", ".join(f"{name} {weight:g}" for name, weight in problem.wishes.items())
        raise SettingError(
            f"{weights}: the least fitness on map "
            f"{shown(problem.scenario.name)} is unknown, and no method here computes it; choose a reward or "
            "measure without optima, such as progress"
        )
    return optimum(problem)[0] if isinstance(problem, AnalyticProblem) else shortest_path(problem.scenario)[0]


def _ensure_optimum(problem: Problem) -> float:
    fitness = known_optimum(problem)
    if math.isnan(fitness):
        fitness = compute_optimum(problem)
        store_optimum(problem, fitness)
    return fitness


def write_optima(file: Path) -> None:
    """Write the optima of `PACKAGED_SCENARIOS` with the default encoding and weight, as JSON.

    All lengths are in map units, to 1e-6.
    """
    entries = []
    for name in PACKAGED_SCENARIOS:
        problem = AnalyticProblem(require_analytic(worlds_of(make_scenario(name))[-1].scenario))
        name_of_problem, fitness, length = _solve(problem)
        entries.append(
            {
                "name": name,
                "num_waypoints": problem.num_waypoints,
                "length_weight": problem.length_weight,
                "digest": name_of_problem,
                "fitness": fitness,
                "shortest_path": length,
            }
        )
    write_atomically(file, json.dumps(entries, indent=2) + "\n")


def write_field_optima(file: Path, names: Sequence[str], progress: Progress) -> None:
    """Write the optima of fields as JSON: by name the digest of the problem, fitness and shortest path.

    The encoding and weight are the default, and all lengths in map units, to 1e-6. Of a field that changes,
    every world has an entry, whose name ends in the iteration from which it is in force: `...:7@0`.
    """
    worlds = {}
    for field in (field for name in names for field in make_scenarios(name)):
        found = worlds_of(field)
        for world in found:
            name = f"{field.name}@{world.iteration}" if len(found) > 1 else field.name
            worlds[name] = require_analytic(world.scenario)
    lines = []
    for name, scenario in worlds.items():
        lines.append(f"{json.dumps(name)}: {json.dumps(_solve(AnalyticProblem(scenario)))}")
        progress(len(lines), len(worlds))
    write_atomically(file, "{\n" + ",\n".join(lines) + "\n}\n")


def _solve(problem: AnalyticProblem) -> tuple[str, float, float]:
    """Return digest, least fitness and length of the shortest path of a problem."""
    return digest(problem), round(optimum(problem)[0], 6), round(shortest_path(problem.scenario)[0], 6)


def main() -> None:
    """Compute the optima that the command line names."""
    parser = argparse.ArgumentParser(
        prog="python -m swarm_gym.reference.waypoint_optimum",
        description="Compute the true optima of scenarios and store them in the user's cache.",
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="scenarios, as in random-fields:test:0-199")
    parser.add_argument("--num-waypoints", type=int, default=AnalyticProblem.num_waypoints, metavar="N")
    parser.add_argument("--length-weight", type=float, default=AnalyticProblem.length_weight, metavar="MU")
    parser.add_argument("--threads", type=int, default=1, metavar="N")
    parser.add_argument("--ship", action="store_true", help="write the files that ship with the package")
    options = parser.parse_args()
    if options.ship == bool(options.names):
        parser.error("expected names of scenarios, or --ship")
    if options.ship:
        write_optima(Path(__file__).with_name("optima.json"))
        for file, names in FIELD_FILES.items():
            write_field_optima(Path(__file__).with_name(file), names, _ProgressBar())
        return
    try:
        problems = [
            AnalyticProblem(require_analytic(world.scenario), options.num_waypoints, options.length_weight)
            for name in options.names
            for scenario in make_scenarios(name)
            for world in worlds_of(scenario)
        ]
        ensure_optima(problems, options.threads, _ProgressBar())
    except SwarmGymError as error:
        parser.error(str(error))


class _ProgressBar:
    """A progress bar with the remaining time, on one line of the error output."""

    WIDTH = 40

    def __init__(self) -> None:
        self.began = time.monotonic()

    def __call__(self, done: int, total: int) -> None:
        left = (time.monotonic() - self.began) / done * (total - done)
        bar = "#" * (self.WIDTH * done // total)
        end = "\n" if done == total else ""
        print(
            f"\r[{bar:{self.WIDTH}}] {done}/{total}, {left:4.0f} s left", end=end, file=sys.stderr, flush=True
        )


if __name__ == "__main__":
    main()
