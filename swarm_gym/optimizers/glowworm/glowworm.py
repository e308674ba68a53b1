"""Glowworm swarm: points that walk towards what shines brighter in sight; the first of them is the robot.

Sources: K. N. Krishnanand, D. Ghose, "Glowworm swarm optimization for simultaneous capture of multiple local
optima of multimodal functions", Swarm Intelligence 3:87-124, 2009; in the form of C. Brand, X.-H. Yu,
"Autonomous robot path optimization using firefly algorithm", ICMLC 2013, eq. 1-5. A member is a place on a
grid map, and the path is the trajectory of the robot, from the start until it is at the target. What makes a
place bright is not printed, nor are most parameters; readings are in docs/readings.md.
"""

import math
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.optimizers import loop
from swarm_gym.optimizers.glowworm.glow import (
    Glow,
    count_neighbours,
    draw_neighbour,
    find_brightest,
    qualities,
)
from swarm_gym.optimizers.glowworm.members import (
    FOLLOWED,
    HEADING,
    LUCIFERIN,
    NOWHERE,
    RANGE,
    UNLIT,
    adopt,
    begin,
    change_size,
    evaluate_member,
    re_evaluate,
)
from swarm_gym.optimizers.glowworm.relay import Sight, distance, inert, look_around
from swarm_gym.optimizers.glowworm.trajectory import ROBOT, append_point, arrive, remember_path, sees_target
from swarm_gym.optimizers.optimizer import Knob, Optimizer, choice
from swarm_gym.population import Swarms, Workspace, is_spent
from swarm_gym.problem.tables import Table
from swarm_gym.problem.walk.table import WalkTable, is_visible

Floats = NDArray[np.float64]

# The share of a step that rounding may be: who goes a step away and comes back is where it was, and does not
# have another move of nearly no length before it.
MARGIN = 1e-9
# Named options, by their index in `Knob.choices`.
BRIGHTEST, PROPORTIONAL = range(2)
FIXED, ADAPTIVE = range(2)
STRAIGHT, ANYWHERE = range(2)
# Krishnanand and Ghose: how many neighbours a range is to hold, and beta for steps of 0.03.
NEIGHBOURS, ADAPTATION = 5, 0.08 / 0.03


class GlowwormRules(NamedTuple):
    """Stands for the kernels of this optimizer; see `driver`."""


@kernel
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


@kernel
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
        return wander(swarms, b, i, table, work, step, int(knobs[11]))
    swarms.memory[b, i, HEADING] = NOWHERE
    way = distance(sight.x, sight.y, i, chosen)
    if way <= step * (1.0 + MARGIN):
        work.path[1], work.path[2] = sight.x[chosen], sight.y[chosen]
    else:
        work.path[1] = x + step * (sight.x[chosen] - x) / way  # eq. 4
        work.path[2] = y + step * (sight.y[chosen] - y) / way
    return way > 0.0


@kernel
def wander(
    swarms: Swarms, b: int, i: int, table: WalkTable, work: Workspace, step: float, wandering: int
) -> bool:
    """Go a step on, or where that does not lead anywhere, in a direction that is drawn, into `work.path`.

    Returns:
        Whether the place can be reached.
    """
    if swarms.memory[b, i, HEADING] == NOWHERE or wandering == ANYWHERE:
        fill_uniform(swarms.stream[b], work.noise)
        swarms.memory[b, i, HEADING] = 2.0 * math.pi * work.noise[0]
    x, y, angle = swarms.positions[b, i, 0], swarms.positions[b, i, 1], swarms.memory[b, i, HEADING]
    work.path[1], work.path[2] = x + step * math.cos(angle), y + step * math.sin(angle)
    is_free = is_visible(table, x, y, work.path[1], work.path[2])
    if not is_free:
        swarms.memory[b, i, HEADING] = NOWHERE
    return is_free


@kernel(inline="late")
def map_side(table: WalkTable) -> float:
    """The longer side of the map, in map units."""
    return max(table.num_columns, table.num_rows) * table.resolution


@kernel
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

    Nobody is ever in an obstacle, so that there is nothing to repair. Where the evaluation budget is spent,
    the others stay. The episode ends when the robot is at the target, which a step may not lead to through a
    wall.
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
    is_on_its_way = True
    knobs: ClassVar[dict[str, Knob]] = {
        "decay": Knob(0.4, 0.0, 1.0, "rho", "share of its luciferin that a member loses in an iteration"),
        "gain": Knob(0.6, 0.0, 10.0, "a", "luciferin that it gains where the place is best"),
        "absorption": Knob(2.0, 0.0, 1000.0, "gamma", "how light fades with distance, per side of the map"),
        "step": Knob(0.005, 1e-6, 1.0, "eta", "length of a move, in sides of the map", (0.001, 0.02)),
        "first_luciferin": Knob(5.0, 0.0, 1e6, "tau0", "luciferin of a member that has not moved yet"),
        "decision_range": Knob(
            2.0, 0.0, 10.0, "r", "how far a member looks, in sides of the map", (0.02, 2.0)
        ),
        "glow": choice(
            "what makes a place bright: a short way to the target from one to the next in sight, a short "
            "straight one where the target is in sight, or a target that is near",
            "relay",
            "sight",
            "distance",
        ),
        "selection": choice("which neighbour a member follows", "brightest", "proportional"),
        "levels": choice("what `proportional` draws by", "raw", "differences"),
        "dimming": choice("how light fades: eq. 3 or eq. 2", "rational", "exponential"),
        "range_rule": choice("whether ranges adapt to the number of neighbours", "fixed", "adaptive"),
        "wandering": choice(
            "where a member goes that sees nobody brighter: on until something is in the way, or each step "
            "in a direction that it draws",
            "straight",
            "anywhere",
        ),
    }
    rules = GlowwormRules
    kernels = loop.Kernels(iterate, begin, adopt, change_size, re_evaluate)

    @staticmethod
    def memory_columns(dimension: int) -> int:  # noqa: ARG004
        """Luciferin, range, whom it followed, and where it wanders to."""
        return 4

    @staticmethod
    def walk_points(tables: Table, iterations: int) -> int:  # noqa: ARG004
        """The start, the target, and where an iteration leads and a change of the map puts the robot."""
        return 2 * iterations + 2
