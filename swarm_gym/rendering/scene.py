"""What a picture shows: the state of one swarm."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem import FunctionProblem, Problem, WalkProblem
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.scenarios import StaticScenario
from swarm_gym.simulation import Simulation

Floats = NDArray[np.float64]

# Of a path; a curve that is sampled more densely looks the same.
MOST_SEGMENTS = 100


@dataclass(frozen=True, eq=False)
class Scene:
    """What one picture shows of one swarm; lengths in map units, paths as in `Problem.points`.

    Of members that are points and not whole paths, `paths` are what is left to go from there.
    """

    scenario: StaticScenario
    paths: Floats  # (members, k, 2)
    are_points: bool  # whether members are points
    feasible: NDArray[np.bool_]  # (members,) which paths do not collide
    best_path: Floats  # (k, 2) best so far
    trajectory: Floats  # (j, 2) where the robot has driven; empty where it does not drive
    best_fitness: float  # infinite before the first evaluation
    best_feasible: bool
    iteration: int
    iterations: int
    evaluations: int
    max_population_size: int
    courses: dict[str, Floats]  # (iteration + 1,) each, the columns of the history

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
            best_path=_shown(problem, simulation.best_path(row)),
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
    """Paths (..., k, 2) with fewer points, the first and the last of them kept, where there are very many.

    Of a test function, the first two components.
    """
    if isinstance(problem, FunctionProblem):
        return paths[..., :2, :]
    stride = max(1, (paths.shape[-2] - 1) // MOST_SEGMENTS)
    return np.concatenate([paths[..., :-1:stride, :], paths[..., -1:, :]], axis=-2)
