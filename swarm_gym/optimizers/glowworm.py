"""Glowworm swarm: points that walk towards what shines brighter in sight; the first of them is the robot.

Sources: K. N. Krishnanand, D. Ghose, "Glowworm swarm optimization for simultaneous capture of multiple local optima
of multimodal functions", Swarm Intelligence 3:87-124, 2009; in the form of C. Brand, X.-H. Yu, "Autonomous robot path
optimization using firefly algorithm", ICMLC 2013, eq. 1-5. A member is a place on a grid map, and the path is the
trajectory of the robot, from the start until it is at the target. What makes a place bright is not printed, nor
are most parameters; readings are in docs/readings.md.
"""

import math
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.jit import inlined_kernel, inner_kernel
from swarm_gym.optimizers import driver
from swarm_gym.optimizers.glow import (
    Glow,
    count_neighbours,
    draw_neighbour,
    find_brightest,
    qualities,
)
from swarm_gym.optimizers.optimizer import Knob, Optimizer, choice
from swarm_gym.optimizers.relay import Sight, distance, inert, look_around
from swarm_gym.optimizers.trajectory import (
    ROBOT,
    append_point,
    arrive,
    begin_trajectory,
    remember_path,
    revise_best,
    sees_target,
)
from swarm_gym.population import Swarms, Workspace, shrink
from swarm_gym.problem.sight import sees
from swarm_gym.problem.tables import Table, evaluate, repair
from swarm_gym.problem.walks import WalkTable, cell_of, to_cells, to_map
from swarm_gym.random_stream import fill_uniform

Floats = NDArray[np.float64]

# What is remembered of a member: its luciferin, its decision range in map units, and whom it followed.
LUCIFERIN, RANGE, FOLLOWED = range(3)
# The share of a step that rounding may be: who goes a step away and comes back is where it was, and does not have
# another move of nearly no length before it.
MARGIN = 1e-9
# Until the first luciferin is known, with the parameters of the next iteration.
UNLIT = -1.0
# Named options, by their index in `Knob.choices`.
BRIGHTEST, PROPORTIONAL = range(2)
FIXED, ADAPTIVE = range(2)
# Krishnanand and Ghose: how many neighbours a range is to hold, and beta for steps of 0.03.
NEIGHBOURS, ADAPTATION = 5, 0.08 / 0.03


class GlowwormRules(NamedTuple):
    """Stands for the kernels of this optimizer; see `driver`."""


@inlined_kernel
def is_spent(swarms: Swarms, b: int) -> bool:
    """Whether the evaluation budget is."""
    return swarms.evaluations[b] >= swarms.budget[b]


@inner_kernel
def evaluate_member(swarms: Swarms, b: int, i: int, table: WalkTable, work: Workspace) -> None:
    """Evaluate the point of `work.path`, and make it that of member i."""
    swarms.fitness[b, i], swarms.collision[b, i] = evaluate(table, work.path)
    swarms.evaluations[b] += 1
    for k in range(swarms.positions.shape[2]):
        swarms.positions[b, i, k] = work.path[k + 1]


@inner_kernel
def append_member(swarms: Swarms, b: int, table: WalkTable, work: Workspace, luciferin: float) -> None:
    """Append the point of `work.path` as a member that shines like this and looks as far as it may."""
    i = swarms.size[b]
    evaluate_member(swarms, b, i, table, work)
    kindle(swarms, b, i, luciferin)
    swarms.size[b] += 1


@inlined_kernel
def kindle(swarms: Swarms, b: int, i: int, luciferin: float) -> None:
    """Let member i shine like this, and look as far as it may."""
    swarms.memory[b, i, LUCIFERIN], swarms.memory[b, i, RANGE] = luciferin, math.inf
    swarms.memory[b, i, FOLLOWED] = 0.0


@inner_kernel
def draw_place(swarms: Swarms, b: int, table: WalkTable, work: Workspace) -> None:
    """Draw `work.path`, a point uniform in the free cells."""
    fill_uniform(swarms.stream[b], work.noise)
    number = int(work.noise[0] * table.num_free)
    column = table.free[number, 0] + work.noise[1] - 0.5
    row = table.free[number, 1] + work.noise[2] - 0.5
    work.path[1], work.path[2] = to_map(table, column, row)


@inner_kernel
def begin(
    rules: GlowwormRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    size: int,
    knobs: Floats,  # noqa: ARG001
) -> None:
    """Begin with the robot at the start, and the others on a square lattice as far as it goes."""
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


@inner_kernel
def adopt(
    rules: GlowwormRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    size: int,
) -> None:
    """Begin with given places; but the robot is at the start, and nobody in a blocked cell."""
    for i in range(size):
        place = table.start if i == ROBOT else swarms.positions[b, i]
        work.path[1], work.path[2] = place[0], place[1]
        repair(table, work.path, 1.0)
        append_member(swarms, b, table, work, UNLIT)
    begin_trajectory(swarms, b)


@inner_kernel
def change_size(
    rules: GlowwormRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    size: int,
) -> None:
    """Grow anywhere in free cells, since a swarm that goes one way is a line, or shrink; the robot stays."""
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


@inner_kernel
def re_evaluate(
    rules: GlowwormRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
) -> None:
    """Begin anew from where the robot is, on a map that changed: a swarm that goes one way lights nothing else."""
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
    # Before the best so far is known on this map, the robot's path is not held against it.
    append_point(swarms, b)
    revise_best(swarms, b, table)


@inner_kernel
def shine(swarms: Swarms, b: int, table: WalkTable, sight: Sight, absorption: float, knobs: Floats) -> Glow:
    """Bring the luciferin of all up to date."""
    decay, gain, glow, dimming = knobs[0], knobs[1], int(knobs[6]), int(knobs[9])
    quality = qualities(table, sight, glow, absorption)
    size = swarms.size[b]
    luciferin = inert(size, -1.0)
    for i in range(size):
        before = swarms.memory[b, i, LUCIFERIN]
        if before == UNLIT:
            before = knobs[4]
        luciferin[i] = (1.0 - decay) * before + gain * quality[i]  # eq. 5
        swarms.memory[b, i, LUCIFERIN] = luciferin[i]
    luciferin[size] = gain / decay if decay > 0.0 else math.inf  # where eq. 5 stays at J = 1
    return Glow(luciferin, absorption, dimming)


@inner_kernel
def decide(
    swarms: Swarms,
    b: int,
    i: int,
    table: WalkTable,
    work: Workspace,
    sight: Sight,
    glow: Glow,
    step: float,
    knobs: Floats,
) -> bool:
    """Find out where member i goes, into `work.path`, and whether it goes at all."""
    longest = knobs[5] * map_side(table)
    reach = min(swarms.memory[b, i, RANGE], longest)
    if knobs[7] == BRIGHTEST:
        guess = min(int(swarms.memory[b, i, FOLLOWED]), swarms.size[b])
        chosen = find_brightest(sight, glow, i, reach, guess)
        swarms.memory[b, i, FOLLOWED] = max(chosen, 0)
    else:
        chosen = draw_neighbour(sight, glow, i, reach, int(knobs[8]), swarms.stream[b], work)
    if knobs[10] == ADAPTIVE:
        missing = NEIGHBOURS - count_neighbours(sight, glow, i, reach)
        swarms.memory[b, i, RANGE] = min(max(reach + ADAPTATION * step * missing, 0.0), longest)
    x, y = sight.x[i], sight.y[i]
    if chosen < 0:
        return wander(swarms, b, table, work, x, y, step)
    way = distance(sight.x, sight.y, i, chosen)
    if way <= step * (1.0 + MARGIN):
        work.path[1], work.path[2] = sight.x[chosen], sight.y[chosen]
    else:
        work.path[1] = x + step * (sight.x[chosen] - x) / way  # eq. 4
        work.path[2] = y + step * (sight.y[chosen] - y) / way
    return way > 0.0


@inner_kernel
def wander(
    swarms: Swarms, b: int, table: WalkTable, work: Workspace, x: float, y: float, step: float
) -> bool:
    """Draw a place a step away, into `work.path`, and find out whether it can be reached."""
    fill_uniform(swarms.stream[b], work.noise)
    angle = 2.0 * math.pi * work.noise[0]
    work.path[1], work.path[2] = x + step * math.cos(angle), y + step * math.sin(angle)
    column, row = to_cells(table, x, y)
    to_column, to_row = to_cells(table, work.path[1], work.path[2])
    return sees(table.blocked, table.rooms, column, row, to_column, to_row)


@inlined_kernel
def map_side(table: WalkTable) -> float:
    """The longer side of the map, in map units."""
    return max(table.num_columns, table.num_rows) * table.resolution


@inner_kernel
def iterate(
    rules: GlowwormRules,  # noqa: ARG001
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    repair_degree: float,  # noqa: ARG001
    knobs: Floats,
) -> None:
    """One iteration of swarm `b`: all shine, and go by what they see, all at once.

    Nobody is ever in an obstacle, so that there is nothing to repair. Where the evaluation budget is spent, the
    others stay. The episode ends when the robot is at the target, which a step may not lead to through a wall.
    """
    side = map_side(table)
    step = knobs[3] * side
    sight = look_around(swarms, b, table)
    glow = shine(swarms, b, table, sight, knobs[2] / side, knobs)
    for i in range(swarms.size[b]):
        if decide(swarms, b, i, table, work, sight, glow, step, knobs) and not is_spent(swarms, b):
            evaluate_member(swarms, b, i, table, work)
    append_point(swarms, b)
    remember_path(swarms, b)
    dx, dy = table.target[0] - swarms.positions[b, ROBOT, 0], table.target[1] - swarms.positions[b, ROBOT, 1]
    if math.hypot(dx, dy) <= step * (1.0 + MARGIN) and sees_target(swarms, b, table):
        arrive(swarms, b, table)


class Glowworm(Optimizer):
    """The glowworms of Brand and Yu; lengths are shares of the longer side of the map."""

    name = "glowworm"
    encodings = ("walk",)
    smallest_population = 2
    knobs: ClassVar[dict[str, Knob]] = {
        "decay": Knob(0.4, 0.0, 1.0, "rho", "share of its luciferin that a member loses in an iteration"),
        "gain": Knob(0.6, 0.0, 10.0, "a", "luciferin that it gains where the place is best"),
        "absorption": Knob(5.0, 0.0, 1000.0, "gamma", "how light fades with distance, per side of the map"),
        "step": Knob(0.005, 1e-6, 1.0, "eta", "length of a move, in sides of the map", (0.001, 0.02)),
        "first_luciferin": Knob(5.0, 0.0, 1e6, "tau0", "luciferin of a member that has not moved yet"),
        "decision_range": Knob(
            2.0, 0.0, 10.0, "r", "how far a member looks, in sides of the map", (0.02, 2.0)
        ),
        "glow": choice(
            "what makes a place bright: the way to the target from one to the next in sight, the straight one "
            "where the target is in sight, or the distance of the target",
            "relay",
            "sight",
            "distance",
        ),
        "selection": choice("which neighbour a member follows", "brightest", "proportional"),
        "levels": choice("what `proportional` draws by", "raw", "differences"),
        "dimming": choice("how light fades: eq. 3 or eq. 2", "rational", "exponential"),
        "range_rule": choice("whether ranges adapt to the number of neighbours", "fixed", "adaptive"),
    }
    rules = GlowwormRules
    kernels = driver.Kernels(iterate, begin, adopt, change_size, re_evaluate)

    @staticmethod
    def memory_columns(dimension: int) -> int:  # noqa: ARG004
        """Luciferin, range, and whom it followed."""
        return 3

    @staticmethod
    def num_registers(capacity: int) -> int:  # noqa: ARG004
        """The number of points of the trajectory."""
        return 1

    @staticmethod
    def walk_points(tables: Table, iterations: int) -> int:  # noqa: ARG004
        """The start, the target, and where an iteration leads and a change of the map puts the robot."""
        return 2 * iterations + 2
