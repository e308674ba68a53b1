"""Scenes: the state of one swarm, as pictures show it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem import FunctionProblem, Problem, WalkProblem
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.scenarios import StaticScenario
from swarm_gym.simulation import Simulation

Floats = NDArray[np.float64]

# Maximum number of segments of a path; a curve of more samples looks the same.
MOST_SEGMENTS = 100


@dataclass(frozen=True, eq=False)
class Scene:
    """The state of one swarm that a picture shows; lengths in map units, paths as in `Problem.points`.

    Attributes:
        scenario: task, on the present map.
        paths: (members, k, 2) paths of the members; if members are points, the remaining paths from there.
        are_points: whether members are points, as in walks, and not whole paths.
        feasible: (members,) which paths do not collide.
        best_path: (k, 2) best path so far.
        trajectory: (j, 2) points that the robot has passed; empty if it does not drive.
        best_fitness: best fitness so far; infinite before the first evaluation.
        best_feasible: whether the best path so far does not collide.
        iteration: iterations done in this episode.
        iterations: iterations of an episode.
        evaluations: evaluations in this episode.
        max_population_size: largest population size that an action can ask for.
        courses: columns of the history by name, (iteration + 1,) each.
    """

    scenario: StaticScenario
    paths: Floats
    are_points: bool
    feasible: NDArray[np.bool_]
    best_path: Floats
    trajectory: Floats
    best_fitness: float
    best_feasible: bool
    iteration: int
    iterations: int
    evaluations: int
    max_population_size: int
    courses: dict[str, Floats]

    @classmethod
    def of(cls, simulation: Simulation, row: int = 0) -> "Scene":
        """Copy the present state of one swarm."""
        swarms, problem = simulation.swarms, simulation.problem_of(row)
        iteration = int(simulation.iteration[row])
        return cls(
            scenario=problem.scenario,
            paths=_shown(problem, problem.points(simulation.positions(row))),
            are_points=isinstance(problem, WalkProblem),
            feasible=swarms.collision[row, : swarms.size[row]] <= FEASIBILITY_TOLERANCE,
            best_path=_shown(problem, simulation.paths.best_of(row)),
            trajectory=simulation.trajectory(row),
            best_fitness=float(swarms.best_fitness[row]),
            best_feasible=bool(swarms.best_collision[row] <= FEASIBILITY_TOLERANCE),
            iteration=iteration,
            iterations=simulation.settings.iterations,
            evaluations=int(swarms.evaluations[row]),
            max_population_size=simulation.settings.max_population_size,
            courses=dict(
                zip(simulation.columns, simulation.history[row, : iteration + 1].T.copy(), strict=True)
            ),
        )


def _shown(problem: Problem, paths: Floats) -> Floats:
    """Return paths (..., k, 2) with at most about `MOST_SEGMENTS` segments; first and last point are kept.

    For a test function, return the first two components.
    """
    if isinstance(problem, FunctionProblem):
        return paths[..., :2, :]
    stride = max(1, (paths.shape[-2] - 1) // MOST_SEGMENTS)
    return np.concatenate([paths[..., :-1:stride, :], paths[..., -1:, :]], axis=-2)
