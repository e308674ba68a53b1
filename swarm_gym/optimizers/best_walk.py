"""The best walk so far, of optimizers whose members are the ends of walks.

`Swarms.walk` begins with its points, `Swarms.best_walk` in number; then the path is straight to the target.
"""

import math

from swarm_gym.compiler.jit import kernel
from swarm_gym.population import Swarms
from swarm_gym.problem.walk.table import WalkTable, share_blocked_between


@kernel
def length_of_walk(swarms: Swarms, b: int, number: int) -> float:
    """Return the length of the first points of the walk, in map units."""
    walk, length = swarms.walk[b], 0.0
    for k in range(1, number):
        length += math.hypot(walk[k, 0] - walk[k - 1, 0], walk[k, 1] - walk[k - 1, 1])
    return length


@kernel
def re_evaluate_walk(swarms: Swarms, b: int, table: WalkTable) -> None:
    """Evaluate the whole best path so far on a map that has changed."""
    swarms.evaluations[b] += 1
    number, length, collision = swarms.best_walk[b], 0.0, 0.0
    for k in range(number):
        x, y = swarms.walk[b, k, 0], swarms.walk[b, k, 1]
        end = swarms.walk[b, k + 1] if k + 1 < number else table.target
        leg = math.hypot(end[0] - x, end[1] - y)
        length += leg
        collision += leg * share_blocked_between(table, x, y, end[0], end[1])
    swarms.best_fitness[b] = length + table.penalty * collision / table.resolution
    swarms.best_collision[b] = collision
