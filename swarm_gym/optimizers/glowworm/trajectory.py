"""The trajectory of a robot, which is the first member of its swarm, and its best path so far.

`Swarms.walk` holds the points of the trajectory, `Swarms.walked` their number. A path is the trajectory up to
a point, then the straight line to the target. The best path so far begins with a piece of the trajectory.
"""

import math

from swarm_gym.compiler.jit import kernel
from swarm_gym.optimizers.best_walk import length_of_walk, re_evaluate_walk
from swarm_gym.population import Swarms, is_spent
from swarm_gym.problem.walk.table import WalkTable, is_visible

ROBOT = 0


@kernel
def begin_trajectory(swarms: Swarms, b: int) -> None:
    """Begin the trajectory at the position of the robot."""
    swarms.walked[b] = 0
    append_point(swarms, b)
    remember_path(swarms, b)


@kernel
def append_point(swarms: Swarms, b: int) -> None:
    """Append the position of the robot to the trajectory, unless it is the last point already."""
    number = swarms.walked[b]
    x, y = swarms.positions[b, ROBOT, 0], swarms.positions[b, ROBOT, 1]
    if number == 0 or swarms.walk[b, number - 1, 0] != x or swarms.walk[b, number - 1, 1] != y:
        swarms.walk[b, number, 0], swarms.walk[b, number, 1] = x, y
        swarms.walked[b] = number + 1


@kernel
def remember_path(swarms: Swarms, b: int) -> None:
    """Remember the trajectory with the straight line to the target, if it is the best path so far."""
    number = swarms.walked[b]
    fitness = length_of_walk(swarms, b, number) + swarms.fitness[b, ROBOT]
    if fitness < swarms.best_fitness[b]:
        swarms.best_fitness[b] = fitness
        swarms.best_collision[b] = swarms.collision[b, ROBOT]
        swarms.best_walk[b] = number
        for k in range(swarms.best_position.shape[1]):
            swarms.best_position[b, k] = swarms.positions[b, ROBOT, k]


@kernel
def sees_target(swarms: Swarms, b: int, table: WalkTable) -> bool:
    """Return whether the robot sees the target."""
    x, y = swarms.positions[b, ROBOT, 0], swarms.positions[b, ROBOT, 1]
    return is_visible(table, x, y, table.target[0], table.target[1])


@kernel
def arrive(swarms: Swarms, b: int, table: WalkTable) -> None:
    """Put the robot at the target and end the episode, since nothing is left to be planned."""
    swarms.positions[b, ROBOT, 0], swarms.positions[b, ROBOT, 1] = table.target[0], table.target[1]
    swarms.fitness[b, ROBOT] = swarms.collision[b, ROBOT] = 0.0
    append_point(swarms, b)
    remember_path(swarms, b)
    swarms.budget[b] = swarms.evaluations[b]


@kernel
def revise_best(swarms: Swarms, b: int, table: WalkTable) -> None:
    """Evaluate the whole best path so far on a map that has changed.

    The path of the robot replaces it if that is better, or if no evaluation is left.
    """
    swarms.best_fitness[b] = math.inf
    if not is_spent(swarms, b):
        re_evaluate_walk(swarms, b, table)
    remember_path(swarms, b)
