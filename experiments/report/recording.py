"""Recordings of runs that are run again for a replay: the same seed gives the same bits."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.runs.episode import Episode
from experiments.runs.run import Floats, Run, RunKey
from experiments.runs.suite import Suite
from swarm_gym.population import Swarms, shrink
from swarm_gym.rendering import Scene
from swarm_gym.scenarios import FunctionScenario, StaticScenario
from swarm_gym.simulation import Simulation

Flags = NDArray[np.bool_]

# These optimizers replace whole populations, so that no member can be followed from one to the next.
WITHOUT_MEMBERS_THAT_LAST = ("ant-colony", "multivariate")
# Most frames of a recording; frames of longer runs are several iterations apart, evenly.
MOST_FRAMES = 201


class ReplayError(RuntimeError):
    """A run cannot be replayed; the message names the run and the reason."""


@dataclass(frozen=True)
class Frame:
    """A frame of a replay: a population after an iteration, in map coordinates.

    Attributes:
        iteration: number of the iteration; 0 is the first population.
        paths: (members, k, 2) paths of the members; members that are points have k = 1.
        feasible: (members,) true for members that do not collide.
        new: (members,) true for members that were added in this iteration.
        removed: (members of the population before this iteration,) true for those that it lost.
        best_path: (j, 2) best path so far.
        best_feasible: whether the best path collides nowhere.
        robot: (2,) position of the robot; None if it does not move.
        scenario: scenario with the map on which the members were evaluated.
    """

    iteration: int
    paths: Floats
    feasible: Flags
    new: Flags
    removed: Flags
    best_path: Floats
    best_feasible: bool
    robot: Floats | None
    scenario: StaticScenario


@dataclass(frozen=True)
class Recording:
    """A run with its populations.

    Attributes:
        run: stored run.
        frames: frames from the first population to the last.
        are_points: whether members are points, not paths.
    """

    run: Run
    frames: list[Frame]
    are_points: bool


def record(run: Run, suite: Suite) -> Recording:
    """Run a stored run of a suite again and record it.

    Raises:
        ReplayError: if the run cannot be made, or ends otherwise than the stored one, which another version
            or another machine made.
    """
    key: RunKey = (run.controller, run.scenario, run.seed)
    try:
        episode = Episode(key, suite)
    except (ValueError, OSError) as error:  # a policy or a map is missing here
        raise ReplayError(f"{run.controller} on {run.scenario}: {error}") from error
    done = int((~np.isnan(run.course("population_size"))).sum()) - 1
    stride = max(1, math.ceil(done / (MOST_FRAMES - 1)))
    frames = []
    before = _Members.of(episode.simulation)
    are_points = False
    for simulation in episode:
        now = _Members.of(simulation)
        if simulation.iteration[0] % stride == 0 or not simulation.running[0]:
            scene = Scene.of(simulation)
            are_points = scene.are_points or isinstance(scene.scenario, FunctionScenario)
            frames.append(_frame(scene, *before.changes_to(now, simulation)))
        before = now
    _check(run, episode.simulation)
    return Recording(run, frames, are_points)


def _check(run: Run, simulation: Simulation) -> None:
    """Raise ReplayError if the trace of a simulation differs from that of the stored run."""
    trace = simulation.history[0]
    if simulation.columns != run.columns or not np.array_equal(trace, run.trace, equal_nan=True):
        raise ReplayError(
            f"{run.controller} on {run.scenario}, seed {run.seed}, ends at {_last_fitness(simulation)} here, "
            f"while the stored run, of swarm_gym {run.provenance.get('swarm_gym', 'unknown')}, commit "
            f"{run.provenance.get('commit', 'unknown')[:10]}, ended at {run.final_fitness:.6g}"
        )


def _last_fitness(simulation: Simulation) -> str:
    """Return the last best fitness of a simulation, as text."""
    course = simulation.history[0][:, simulation.columns.index("best_fitness")]
    return f"{course[~np.isnan(course)][-1]:.6g}"


def _frame(scene: Scene, new: Flags, removed: Flags) -> Frame:
    return Frame(
        iteration=scene.iteration,
        paths=_shown(scene, scene.paths),
        feasible=scene.feasible,
        new=new,
        removed=removed,
        best_path=_shown(scene, scene.best_path[None])[0] if not scene.are_points else scene.best_path,
        best_feasible=scene.best_feasible,
        robot=scene.trajectory[-1] if len(scene.trajectory) else None,
        scenario=scene.scenario,
    )


def _shown(scene: Scene, paths: Floats) -> Floats:
    """Return what is shown of paths, (m, k, 2): all points, the first, or two components of a function."""
    if isinstance(scene.scenario, FunctionScenario):
        values = paths[:, :, 1]
        plane = np.zeros((len(values), 1, 2))
        plane[:, 0, : values.shape[1]] = values[:, :2]
        return plane
    return paths[:, :1] if scene.are_points else paths


@dataclass(frozen=True)
class _Members:
    """Fitness and collision of the members of a population, which decide who is deleted."""

    fitness: Floats
    collision: Floats

    @classmethod
    def of(cls, simulation: Simulation) -> "_Members":
        size = simulation.swarms.size[0]
        return cls(simulation.swarms.fitness[0, :size].copy(), simulation.swarms.collision[0, :size].copy())

    def changes_to(self, later: "_Members", simulation: Simulation) -> tuple[Flags, Flags]:
        """Return which members of the later population are new, and which of this one were deleted."""
        size, before = len(later.fitness), len(self.fitness)
        new, removed = np.zeros(size, dtype=np.bool_), np.zeros(before, dtype=np.bool_)
        if simulation.iteration[0] > 0 and simulation.optimizer.name not in WITHOUT_MEMBERS_THAT_LAST:
            new[before:] = True
            if size < before:
                removed[:] = True
                removed[self.survivors(size)] = False
        return new, removed

    def survivors(self, size: int) -> NDArray[np.int64]:
        """Return the indices, (size,), of the members that the population keeps when it shrinks."""
        stand_in: Any = Swarms.allocate(1, len(self.fitness), 1)
        stand_in.size[0] = len(self.fitness)
        stand_in.fitness[0], stand_in.collision[0] = self.fitness, self.collision
        stand_in.positions[0, :, 0] = np.arange(len(self.fitness))
        shrink(stand_in, 0, size)
        return stand_in.positions[0, :size, 0].astype(np.int64)
