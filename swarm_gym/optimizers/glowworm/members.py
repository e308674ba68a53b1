"""The members of a glowworm swarm: the robot, which is the first, and others anywhere in the free cells.

The sources are listed in `glowworm`. Brand and Yu place their members on a square lattice. How members are
added later is a reading, see docs/readings.md.
"""

import math

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers.glowworm.trajectory import ROBOT, append_point, begin_trajectory, revise_best
from swarm_gym.optimizers.parameter import Parameters
from swarm_gym.population import Swarms, Workspace, is_spent, shrink
from swarm_gym.problem.tables import evaluate, repair
from swarm_gym.problem.walk.table import WalkTable, cell_of, to_map

# Columns of `Swarms.memory`: luciferin, decision range in map units, number of the member that was followed,
# and the angle in which the member wanders.
NUM_COLUMNS = 4
LUCIFERIN, RANGE, FOLLOWED, HEADING = range(NUM_COLUMNS)
# Luciferin of a new member: its first value is a parameter of the next iteration.
UNLIT = -1.0
# Heading of a member that does not wander.
NOWHERE = math.inf


@kernel
def evaluate_member(swarms: Swarms, b: int, i: int, table: WalkTable, work: Workspace) -> None:
    """Evaluate the point of `work.path` and make it the position of member i."""
    swarms.fitness[b, i], swarms.collision[b, i] = evaluate(table, work.path)
    swarms.evaluations[b] += 1
    for k in range(swarms.positions.shape[2]):
        swarms.positions[b, i, k] = work.path[k + 1]


@kernel
def append_member(swarms: Swarms, b: int, table: WalkTable, work: Workspace, luciferin: float) -> None:
    """Append the point of `work.path` as a member with this luciferin; see `kindle`."""
    i = swarms.size[b]
    evaluate_member(swarms, b, i, table, work)
    kindle(swarms, b, i, luciferin)
    swarms.size[b] += 1


@kernel(inline="late")
def kindle(swarms: Swarms, b: int, i: int, luciferin: float) -> None:
    """Give member i this luciferin and the largest decision range; it follows and heads nowhere yet."""
    swarms.memory[b, i, LUCIFERIN], swarms.memory[b, i, RANGE] = luciferin, math.inf
    swarms.memory[b, i, FOLLOWED], swarms.memory[b, i, HEADING] = 0.0, NOWHERE


@kernel
def draw_place(swarms: Swarms, b: int, table: WalkTable, work: Workspace) -> None:
    """Draw `work.path` as a point uniform in the free cells."""
    fill_uniform(swarms.stream[b], work.noise)
    number = int(work.noise[0] * table.num_free)
    column = table.free[number, 0] + work.noise[1] - 0.5
    row = table.free[number, 1] + work.noise[2] - 0.5
    work.path[1], work.path[2] = to_map(table, column, row)


@kernel
def begin(
    _parameters: Parameters, swarms: Swarms, b: int, table: WalkTable, work: Workspace, size: int
) -> None:
    """Begin with the robot at the start, then the largest square lattice, then members in free cells."""
    work.path[1], work.path[2] = table.start[0], table.start[1]
    append_member(swarms, b, table, work, UNLIT)
    begin_trajectory(swarms, b)
    side = int(math.sqrt(size - 1.0))
    for number in range(size - 1):
        if is_spent(swarms, b):
            return
        if number < side * side:
            for k in range(2):
                share = ((number // side if k == 0 else number % side) + 0.5) / side
                work.path[k + 1] = table.lower[k] + share * (table.upper[k] - table.lower[k])
        column, row = cell_of(table, work.path[1], work.path[2])
        if number >= side * side or table.blocked[row, column]:
            draw_place(swarms, b, table, work)
        append_member(swarms, b, table, work, UNLIT)


@kernel
def adopt(
    _parameters: Parameters, swarms: Swarms, b: int, table: WalkTable, work: Workspace, size: int
) -> None:
    """Begin with given places, but with the robot at the start, and with no member in a blocked cell."""
    for i in range(size):
        place = table.start if i == ROBOT else swarms.positions[b, i]
        work.path[1], work.path[2] = place[0], place[1]
        repair(table, work.path, 1.0)
        append_member(swarms, b, table, work, UNLIT)
    begin_trajectory(swarms, b)


@kernel
def change_size(
    _parameters: Parameters, swarms: Swarms, b: int, table: WalkTable, work: Workspace, size: int
) -> None:
    """Add members anywhere in free cells, or delete members other than the robot.

    New members are not placed between the others, since a swarm that moves in one direction is a line.
    """
    before = swarms.size[b]
    if size > before:
        luciferin = 0.0
        for i in range(before):
            luciferin += swarms.memory[b, i, LUCIFERIN]
        for _ in range(min(size - before, swarms.budget[b] - swarms.evaluations[b])):
            draw_place(swarms, b, table, work)
            append_member(swarms, b, table, work, luciferin / before)
    elif size < before:
        fitness, collision = swarms.fitness[b, ROBOT], swarms.collision[b, ROBOT]
        swarms.fitness[b, ROBOT], swarms.collision[b, ROBOT] = -math.inf, 0.0
        shrink(swarms, b, size)
        swarms.fitness[b, ROBOT], swarms.collision[b, ROBOT] = fitness, collision


@kernel
def re_evaluate(_parameters: Parameters, swarms: Swarms, b: int, table: WalkTable, work: Workspace) -> None:
    """Keep the robot and place all others again, on a map that has changed.

    A swarm that moves in one direction would light no other path.
    """
    size = swarms.size[b]
    for i in range(size):
        if is_spent(swarms, b):
            swarms.size[b] = i
            break
        if i == ROBOT:
            work.path[1], work.path[2] = swarms.positions[b, i, 0], swarms.positions[b, i, 1]
            repair(table, work.path, 1.0)
        else:
            draw_place(swarms, b, table, work)
        evaluate_member(swarms, b, i, table, work)
        kindle(swarms, b, i, UNLIT)
    # The robot's path is compared with the best so far only when that is evaluated on this map.
    append_point(swarms, b)
    revise_best(swarms, b, table)
