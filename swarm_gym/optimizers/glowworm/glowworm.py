"""Glowworm swarm: points that walk towards brighter points in sight; the first of them is the robot.

Sources: K. N. Krishnanand, D. Ghose, "Glowworm swarm optimization for simultaneous capture of multiple local
optima of multimodal functions", Swarm Intelligence 3:87-124, 2009; in the form of M. Brand, X.-H. Yu,
"Autonomous robot path optimization using firefly algorithm", ICMLC 2013, eq. 1-5. A member is a place on a
grid map. The path is the trajectory of the robot, from the start until it is at the target. Brand and Yu do
not print what makes a place bright, nor most parameters; readings are in docs/readings.md.
"""

import math
from typing import Annotated, NamedTuple

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
    NUM_COLUMNS,
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
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter, choice
from swarm_gym.population import Swarms, Workspace, is_spent
from swarm_gym.problem.tables import Tables
from swarm_gym.problem.walk.table import WalkTable, is_visible

# Rounding error of a position, as a share of a step: a member that moves one step away and comes back is at
# its former place, without a further move of nearly no length.
MARGIN = 1e-9
# Named options, by their index in `Parameter.choices`.
BRIGHTEST, PROPORTIONAL = range(2)
FIXED, ADAPTIVE = range(2)
STRAIGHT, ANYWHERE = range(2)
# From Krishnanand and Ghose: desired number of neighbours in a range, and beta for steps of 0.03.
NEIGHBOURS, ADAPTATION = 5, 0.08 / 0.03


class GlowwormParameters(NamedTuple):
    """Parameters of the glowworm swarm."""

    decay: Annotated[
        float, Parameter(0.4, 0.0, 1.0, "rho", "share of its luciferin that a member loses in an iteration")
    ]
    gain: Annotated[float, Parameter(0.6, 0.0, 10.0, "a", "luciferin that a member gains at the best place")]
    absorption: Annotated[
        float, Parameter(2.0, 0.0, 1000.0, "gamma", "decay of light with distance, per side of the map")
    ]
    step: Annotated[
        float, Parameter(0.005, 1e-6, 1.0, "eta", "length of a move, in sides of the map", (0.001, 0.02))
    ]
    first_luciferin: Annotated[
        float, Parameter(5.0, 0.0, 1e6, "tau0", "luciferin of a member that has not moved yet")
    ]
    decision_range: Annotated[
        float, Parameter(2.0, 0.0, 10.0, "r", "how far a member looks, in sides of the map", (0.02, 2.0))
    ]
    glow: Annotated[
        float,
        choice(
            "what makes a place bright: a short path to the target over members in sight of each other, a "
            "short straight line to a target in sight, or a short distance from the target",
            "relay",
            "sight",
            "distance",
        ),
    ]
    selection: Annotated[float, choice("which neighbour a member follows", "brightest", "proportional")]
    levels: Annotated[float, choice("weights by which `proportional` draws", "raw", "differences")]
    dimming: Annotated[float, choice("how light fades: eq. 3 or eq. 2", "rational", "exponential")]
    range_rule: Annotated[
        float, choice("whether ranges adapt to the number of neighbours", "fixed", "adaptive")
    ]
    wandering: Annotated[
        float,
        choice(
            "where a member moves that sees no brighter one: straight on up to an obstacle, or at each step "
            "in a direction that is drawn",
            "straight",
            "anywhere",
        ),
    ]


@kernel
def shine(
    parameters: GlowwormParameters, swarms: Swarms, b: int, table: WalkTable, sight: Sight, absorption: float
) -> Glow:
    """Bring the luciferin of all members up to date."""
    decay, gain = parameters.decay, parameters.gain
    quality = qualities(table, sight, int(parameters.glow), absorption)
    size = swarms.size[b]
    luciferin = inert(size, -1.0)
    for i in range(size):
        before = swarms.memory[b, i, LUCIFERIN]
        if before == UNLIT:
            before = parameters.first_luciferin
        luciferin[i] = (1.0 - decay) * before + gain * quality[i]  # eq. 5
        swarms.memory[b, i, LUCIFERIN] = luciferin[i]
    luciferin[size] = gain / decay if decay > 0.0 else math.inf  # the fixed point of eq. 5 for J = 1
    return Glow(luciferin, absorption, int(parameters.dimming))


@kernel
def decide(
    parameters: GlowwormParameters,
    swarms: Swarms,
    b: int,
    i: int,
    table: WalkTable,
    work: Workspace,
    sight: Sight,
    glow: Glow,
    step: float,
) -> bool:
    """Write the next place of member i into `work.path`; return whether it moves at all."""
    longest = parameters.decision_range * map_side(table)
    reach = min(swarms.memory[b, i, RANGE], longest)
    if parameters.selection == BRIGHTEST:
        guess = min(int(swarms.memory[b, i, FOLLOWED]), swarms.size[b])
        chosen = find_brightest(sight, glow, i, reach, guess)
        swarms.memory[b, i, FOLLOWED] = max(chosen, 0)
    else:
        levels, stream = int(parameters.levels), swarms.stream[b]
        chosen = draw_neighbour(sight, glow, i, reach, levels, stream, work)
    if parameters.range_rule == ADAPTIVE:
        missing = NEIGHBOURS - count_neighbours(sight, glow, i, reach)
        swarms.memory[b, i, RANGE] = min(max(reach + ADAPTATION * step * missing, 0.0), longest)
    x, y = sight.x[i], sight.y[i]
    if chosen < 0:
        return wander(swarms, b, i, table, work, step, int(parameters.wandering))
    swarms.memory[b, i, HEADING] = NOWHERE
    length = distance(sight.x, sight.y, i, chosen)
    if length <= step * (1.0 + MARGIN):
        work.path[1], work.path[2] = sight.x[chosen], sight.y[chosen]
    else:
        work.path[1] = x + step * (sight.x[chosen] - x) / length  # eq. 4
        work.path[2] = y + step * (sight.y[chosen] - y) / length
    return length > 0.0


@kernel
def wander(
    swarms: Swarms, b: int, i: int, table: WalkTable, work: Workspace, step: float, wandering: int
) -> bool:
    """Write the place one step ahead into `work.path`.

    The direction is drawn if there is none yet, and at every step with the option ANYWHERE.

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
    """Return the longer side of the map, in map units."""
    return max(table.num_columns, table.num_rows) * table.resolution


@kernel
def iterate(
    parameters: GlowwormParameters,
    swarms: Swarms,
    b: int,
    table: WalkTable,
    work: Workspace,
    repair_degree: float,  # noqa: ARG001
) -> None:
    """Advance swarm `b` by one iteration: all members shine, then all move by what they saw before.

    No member is ever in an obstacle, so there is nothing to repair. When the evaluation budget is spent, the
    remaining members stay. The episode ends when the robot is within one step of the target and sees it.
    """
    side = map_side(table)
    step = parameters.step * side
    sight = look_around(swarms, b, table)
    glow = shine(parameters, swarms, b, table, sight, parameters.absorption / side)
    for i in range(swarms.size[b]):
        moves = decide(parameters, swarms, b, i, table, work, sight, glow, step)
        if moves and not is_spent(swarms, b):
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
    begins_with_robot = True
    parameter_class = GlowwormParameters
    kernels = loop.Kernels(iterate, begin, adopt, change_size, re_evaluate)

    @staticmethod
    def memory_columns(dimension: int) -> int:  # noqa: ARG004
        """Return the number of columns: luciferin, range, member followed, and heading."""
        return NUM_COLUMNS

    @staticmethod
    def walk_points(tables: Tables, iterations: int) -> int:  # noqa: ARG004
        """Return the most points: start, target, and two per iteration (a move, and a change of the map)."""
        return 2 * iterations + 2
