"""A run made again, iteration by iteration, for a replay: same seed, same bits; nothing had to be stored."""

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

# Their populations are made anew when sizes change: there is nothing to follow from one to the next.
WITHOUT_MEMBERS_THAT_LAST = ("ant-colony", "multivariate")
# Of a longer run, frames are this many iterations apart or more, evenly.
MOST_FRAMES = 201


class ReplayError(RuntimeError):
    """A run cannot be replayed; the message names it and the reason."""


@dataclass(frozen=True)
class Frame:
    """A population after an iteration, in map coordinates.

    Attributes:
        iteration: which; 0 is the first population.
        paths: (members, k, 2); members that are points have k = 1.
        feasible: (members,) which do not collide.
        new: (members,) which were added in this iteration.
        removed: (members of the population before, whatever frame shows it,) which it lost in this iteration.
        best_path: (j, 2) best so far.
        best_feasible: whether that collides nowhere.
        robot: (2,) where the robot is; None where it stays at the start.
        scenario: the map as it was when the members were evaluated.
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
        run: what is stored of it.
        frames: by iteration, from the first population to the last.
        are_points: whether members are points and no paths.
    """

    run: Run
    frames: list[Frame]
    are_points: bool


def record(run: Run, suite: Suite) -> Recording:
    """Make a run of a suite again.

    Raises:
        ReplayError: if it cannot be made, or ends otherwise than what is stored, which another version or
            machine made.
    """
    key: RunKey = (run.controller, run.scenario, run.seed)
    try:
        episode = Episode(key, suite)
    except (ValueError, OSError) as error:  # a policy or a map that is elsewhere
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
    trace = simulation.history[0]
    if simulation.columns != run.columns or not np.array_equal(trace, run.trace, equal_nan=True):
        raise ReplayError(
            f"{run.controller} on {run.scenario}, seed {run.seed}, ends at {_trace_end(trace)} here, while "
            f"the stored run, of swarm_gym {run.provenance.get('swarm_gym', 'unknown')}, commit "
            f"{run.provenance.get('commit', 'unknown')[:10]}, ended at {run.final_fitness:.6g}"
        )


def _trace_end(trace: Floats) -> str:
    """The last best fitness of a trace."""
    ended = trace[~np.isnan(trace[:, 0])]
    return f"{ended[-1, 3]:.6g}"


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
    """What is shown of paths (m, k, 2): all, where they begin, or of a test function the plane's point."""
    if isinstance(scene.scenario, FunctionScenario):
        values = paths[:, :, 1]
        plane = np.zeros((len(values), 1, 2))
        plane[:, 0, : values.shape[1]] = values[:, :2]
        return plane
    return paths[:, :1] if scene.are_points else paths


@dataclass(frozen=True)
class _Members:
    """How good the members of a population are, which decides who is deleted."""

    fitness: Floats
    collision: Floats

    @classmethod
    def of(cls, simulation: Simulation) -> "_Members":
        size = simulation.swarms.size[0]
        return cls(simulation.swarms.fitness[0, :size].copy(), simulation.swarms.collision[0, :size].copy())

    def changes_to(self, later: "_Members", simulation: Simulation) -> tuple[Flags, Flags]:
        """Which members of the population after an iteration are new, and which of this one were deleted."""
        size, before = len(later.fitness), len(self.fitness)
        new, removed = np.zeros(size, dtype=np.bool_), np.zeros(before, dtype=np.bool_)
        if simulation.iteration[0] > 0 and simulation.optimizer.name not in WITHOUT_MEMBERS_THAT_LAST:
            new[before:] = True
            if size < before:
                removed[:] = True
                removed[self.survivors(size)] = False
        return new, removed

    def survivors(self, size: int) -> NDArray[np.int64]:
        """(size,) which members the population keeps when it shrinks."""
        stand_in: Any = Swarms.allocate(1, len(self.fitness), 1)
        stand_in.size[0] = len(self.fitness)
        stand_in.fitness[0], stand_in.collision[0] = self.fitness, self.collision
        stand_in.positions[0, :, 0] = np.arange(len(self.fitness))
        shrink(stand_in, 0, size)
        return stand_in.positions[0, :size, 0].astype(np.int64)
