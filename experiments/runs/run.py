"""Records of finished runs, and measures of their convergence, trajectories and paths."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swarm_gym.history import HISTORY
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.scenarios.obstacles import Point

Floats = NDArray[np.float64]
RunKey = tuple[str, str, int]  # controller, scenario, seed


@dataclass(frozen=True)
class Snapshot:
    """A stored population.

    Attributes:
        iteration: iteration after which it was stored; 0 is the first population.
        paths: (members, n + 2, 2) in map coordinates.
        collisions: (members,) degree of collision of each path.
    """

    iteration: int
    paths: Floats
    collisions: Floats


@dataclass(frozen=True)
class Run:
    """A finished run.

    Attributes:
        controller: name of the controller.
        scenario: name of the scenario.
        seed: seed of the environment and of the controller.
        final_fitness: best fitness of the run.
        final_collision: degree of collision of the best path; 0 is feasible.
        evaluations: number of calls of the cost function.
        seconds: processor time of the run, without compilation; of runs side by side, its share.
        best_path: (n + 2, 2) in map coordinates.
        trace: (iterations + 1, columns) values that the run recorded in each iteration.
        provenance: versions and commit that the run was made with.
        snapshots: populations that were kept.
        columns: names of the columns of the trace.
        trajectory: (k, 2) points that the robot has passed, in map coordinates; empty if it does not move.
    """

    controller: str
    scenario: str
    seed: int
    final_fitness: float
    final_collision: float
    evaluations: int
    seconds: float
    best_path: Floats
    trace: Floats
    provenance: Mapping[str, str]
    snapshots: tuple[Snapshot, ...] = field(default=())
    columns: tuple[str, ...] = HISTORY
    trajectory: Floats = field(default_factory=lambda: np.empty((0, 2)))

    def course(self, name: str) -> Floats:
        """Return one column of the trace, (iterations + 1,), by its name."""
        return self.trace[:, self.columns.index(name)]


def trajectory_of(run: Run) -> Floats:
    """Return the trajectory of the robot, (k, 2); if it does not move, the best path."""
    return run.trajectory if len(run.trajectory) else run.best_path


def arrives(run: Run, target: Point) -> bool:
    """Return whether the robot reached the target; if it does not move, whether the best path is feasible."""
    if len(run.trajectory):
        return bool((run.trajectory[-1] == target).all())
    return run.final_collision <= FEASIBILITY_TOLERANCE


def feasible_lengths(runs: Iterable[Run]) -> Floats:
    """Return the lengths of the best paths that are feasible; the fitness of such a path is its length."""
    return np.array([run.final_fitness for run in runs if run.final_collision <= FEASIBILITY_TOLERANCE])


def turning_of(path: Floats) -> float:
    """Return the sum of all turns of a polyline, (k, 2), to either side, in degrees."""
    steps = np.diff(path, axis=0)
    steps = steps[(steps != 0.0).any(axis=1)]
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    turns = (np.diff(headings) + np.pi) % (2.0 * np.pi) - np.pi
    return float(np.degrees(np.abs(turns).sum()))


STILL_TO_COME = 1e-3


def convergence_iteration(course: Floats) -> int:
    """Return the first iteration t with best(t) - best(T) <= 1e-3 (best(0) - best(T)).

    Args:
        course: (T + 1,) best fitness so far; NaN after the end of a run whose budget was spent before.
    """
    course = course[~np.isnan(course)]
    return int(np.argmax(course - course[-1] <= STILL_TO_COME * (course[0] - course[-1])))
