"""What a run leaves behind: its numbers, its trace, its best path, and some of its populations."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from swarm_gym.simulation import HISTORY

Floats = NDArray[np.float64]
RunKey = tuple[str, str, int]  # controller, scenario, seed


@dataclass(frozen=True)
class Snapshot:
    """A population at one iteration: paths (members, n + 2, 2) in map coordinates, collisions (members,)."""

    iteration: int
    paths: Floats
    collisions: Floats


@dataclass(frozen=True)
class Run:
    """One finished run.

    Attributes:
        controller: its name.
        scenario: its name.
        seed: of the environment and the controller.
        final_fitness: best fitness of the run.
        final_collision: degree of collision of that path; 0 is feasible.
        evaluations: calls of the cost function.
        seconds: processor time of the run, compilation excluded.
        best_path: (n + 2, 2) in map coordinates.
        trace: (iterations + 1, columns) what the run recorded by iteration.
        provenance: versions and commit that made it.
        snapshots: populations that were kept.
        columns: names of the trace's columns.
        way: (k, 2) where the robot has gone, in map coordinates; empty where paths are only planned.
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
    way: Floats = field(default_factory=lambda: np.empty((0, 2)))

    def course(self, name: str) -> Floats:
        """(iterations + 1,) one column of the trace, by its name."""
        return self.trace[:, self.columns.index(name)]
