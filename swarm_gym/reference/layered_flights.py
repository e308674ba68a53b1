"""Planned flights over terrain, through different valleys and past threats on other sides.

A flight leads over a coarse graph: offsets at each waypoint, in the middle of the band, with the terms of the
problem's cost. Dynamic programming goes from one waypoint to the next. A turn, or a change of climb, at a
node follows from the best flight to that node. So a flight is good and not always the best one of the graph.
Graphs of finer offsets and of altitudes around the flight then improve it. The cost `metabox` has one penalty
for all samples below the ground: one flight is planned with it on each segment, and one without it.

With the encoding `shifted`, nodes lie before and behind the even places, too: short segments go between
threats, and long ones save turns and climbs. Over eight terrains for validation, such flights cost 3 to 72
per cent less than others with the cost `metabox`, and 4 to 83 per cent less with `documented`.

Further flights are found in the same way when a toll lies around a waypoint of a flight that is known.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from swarm_gym.compiler.elementary import arctangent
from swarm_gym.compiler.jit import entry, kernel
from swarm_gym.problem import TerrainProblem
from swarm_gym.problem.padding import Floats, Integers
from swarm_gym.problem.terrain.as_coded import angles_as_coded, segment_as_coded
from swarm_gym.problem.terrain.cost import DEGREES, PENALTY, WEIGHTS, segment_terms, turn_between
from swarm_gym.problem.terrain.ground import height, height_as_coded
from swarm_gym.problem.terrain.table import ABOVE, CLIMB, HIGHEST, LOWEST, METABOX, TURN, TerrainTable, X, Y

ATTEMPTS = 8  # to find another flight
SHARES = (0.5,)  # of the band, at which nodes lie
FINE_REACH = 2.0  # how far finer offsets reach on each side, in distances between offsets
TOLL = 1e4  # as much as a contact
REACHES = (0.04, 0.15)  # least and greatest reach of a toll, as shares of the width of the map
LEAST_DIFFERENCE = 0.05  # of offsets at a waypoint, as a share of the width, that makes another flight
MOST_COST = 1.5  # of another flight, in costs of the first
# Columns of nodes: place, the best flight to it, and the last step of that flight.
_X, _Y, _ABOVE, _Z, _COST, _DX, _DY, _RISE, _CLIMB = range(9)
_SAMPLES, _SURELY = 7, 1e-6  # points, and metres below the ground that are no rounding
_LENGTH, _THREATS, _ALTITUDE, _ANGLES, _GROUND, _BAND, _LIMITS = WEIGHTS


class _Graph(NamedTuple):
    """Nodes at each waypoint, in the coarse graph and in the finer ones around its flight.

    Attributes:
        offsets: number of offsets sideways, from bound to bound.
        shifts: offsets forwards, in distances between waypoints.
        finer_graphs: number of finer graphs, one around the flight of the other. Each reaches half as far as
            the one before.
        fine_offsets: number of offsets sideways in them.
        fine_shifts: offsets forwards in them, in distances between waypoints, halved as well.
        fine_shares: altitudes in them, as shares of the band.
    """

    offsets: int
    shifts: tuple[float, ...]
    finer_graphs: int
    fine_offsets: int
    fine_shifts: tuple[float, ...]
    fine_shares: tuple[float, ...]


# With 25 offsets, gaps between threats were missed. Numbers of nodes with shifts are a compromise of time and
# costs on eight terrains for validation: 50 offsets saved at most 0.1 per cent, and farther shifts nothing.
_GRAPHS = {
    "waypoints": _Graph(50, (0.0,), 1, 15, (0.0,), (0.1, 0.3, 0.5, 0.7, 0.9)),
    "shifted": _Graph(40, (-1.0, -0.5, 0.0, 0.5, 1.0), 3, 9, (-0.5, 0.0, 0.5), (0.1, 0.5, 0.9)),
}

# Flights that were planned in this process, by the identity of the problem and their largest number. Each
# validation of a training asks for the same ones; they take less than a kilobyte.
_planned: dict[tuple[object, ...], Floats] = {}


def flight_ways(problem: TerrainProblem, most: int) -> Floats:
    """Return planned flights, the cheapest first, the same in every call; only the first one plans them.

    Args:
        problem: the problem, of any encoding and cost.
        most: largest number of flights.

    Returns:
        (K, 2 n) offsets sideways and upwards; with the encoding `shifted` (K, 3 n), the last n forwards.
    """
    encoding = problem.encoding if problem.encoding in _GRAPHS else "waypoints"
    by_offsets = TerrainProblem(problem.scenario, encoding, problem.num_waypoints, problem.cost)
    asked = (*by_offsets.identity, most)
    if asked not in _planned:
        _planned[asked] = _plan(by_offsets, most)
    return _planned[asked].copy()


def _plan(by_offsets: TerrainProblem, most: int) -> Floats:
    """Return the planned flights of a problem whose vectors are offsets."""
    table, n, graph = by_offsets.table, by_offsets.num_waypoints, _GRAPHS[by_offsets.encoding]
    sideways = np.linspace(table.initial_lower[:n], table.initial_upper[:n], graph.offsets, axis=1)
    forwards = _forwards(table, np.zeros((n, 1)), graph.shifts)
    penalties = (PENALTY, 0.0) if by_offsets.cost == "metabox" else (PENALTY,)

    def planned(tolls: Floats) -> tuple[Floats, float]:
        found = []
        for penalty in penalties:
            flight = layered_flight(table, sideways, np.array(SHARES), forwards, tolls, penalty)
            found += [flight, *_finer(table, graph, flight, penalty)]
        vectors = np.array(found)[:, : by_offsets.dimension]
        costs = by_offsets.costs(vectors)
        return vectors[costs.argmin()], costs.min()

    rng, (first, cost) = np.random.default_rng(0), planned(np.zeros((n, graph.offsets)))
    flights, costs = [first], [cost]
    for _ in range(ATTEMPTS):
        if len(flights) == most:
            break
        known, at = flights[rng.integers(len(flights))], rng.integers(n)
        tolls = np.zeros((n, graph.offsets))
        reach = rng.uniform(*REACHES) * table.width
        tolls[at] = np.where(abs(sideways[at] - known[at]) < reach, TOLL, 0.0)
        flight, cost = planned(tolls)
        differences = [abs(flight[:n] - other[:n]).max() for other in flights]
        if min(differences) > LEAST_DIFFERENCE * table.width and cost < MOST_COST * costs[0]:
            flights.append(flight)
            costs.append(cost)
    return np.array(flights)[np.argsort(costs, kind="stable")]


def _finer(table: TerrainTable, graph: _Graph, flight: Floats, penalty: float) -> list[Floats]:
    """Return flights, (3 n,), each through nodes close to the one before, and the first to this one."""
    n = len(flight) // 3
    least, most = table.initial_lower[:n, None], table.initial_upper[:n, None]
    reach = FINE_REACH * (most - least) / (graph.offsets - 1)
    found = []
    for number in range(graph.finer_graphs):
        steps = np.linspace(-1.0, 1.0, graph.fine_offsets)
        sideways = np.clip(flight[:n, None] + 0.5**number * reach * steps, least, most)
        forwards = _forwards(table, flight[2 * n :, None], np.multiply(0.5**number, graph.fine_shifts))
        tolls = np.zeros(sideways.shape)
        flight = layered_flight(table, sideways, np.array(graph.fine_shares), forwards, tolls, penalty)
        found.append(flight)
    return found


def _forwards(table: TerrainTable, middles: Floats, shifts: Sequence[float] | Floats) -> Floats:
    """Return offsets forwards, (n, F), around those of a flight, (n, 1), between the start and the goal."""
    places = table.spacing * np.arange(1, len(middles) + 1)[:, None]
    return np.clip(middles + np.multiply(shifts, table.spacing), -places, places[::-1])


@entry
def layered_flight(
    table: TerrainTable, sideways: Floats, upwards: Floats, forwards: Floats, tolls: Floats, penalty: float
) -> Floats:
    """Return offsets sideways, upwards and forwards, (3 n,), of a flight of small cost through a graph.

    Args:
        table: the problem table, with n waypoints; its encoding does not matter.
        sideways: (n, M) offsets of the nodes of each waypoint.
        upwards: (A,) shares of the band at which nodes lie.
        forwards: (n, F) offsets of nodes along the line from the even places.
        tolls: (n, M) what it costs to pass a node, besides the terms.
        penalty: number added for each segment below the ground, if the cost is `metabox`.
    """
    n, width = sideways.shape
    layer = width * upwards.shape[0]
    num_nodes = layer * forwards.shape[1]
    nodes = np.zeros((n, num_nodes, 9))
    origins = np.zeros((n, num_nodes), np.int64)
    start, goal = np.zeros(9), np.zeros(9)
    _place(table, start, table.ends[0, X], table.ends[0, Y], table.ends[0, ABOVE])
    _place(table, goal, table.ends[1, X], table.ends[1, Y], table.ends[1, ABOVE])
    band = table.band[HIGHEST] - table.band[LOWEST]
    middle = 0.5 * (table.band[LOWEST] + table.band[HIGHEST])
    for k in range(n):
        order = np.argsort(nodes[max(k - 1, 0), :, _COST])
        for i in range(num_nodes):
            along = (k + 1) * table.spacing + forwards[k, i // layer]
            offset = sideways[k, i % width]
            x = table.ends[0, X] + along * table.forward[X] - offset * table.forward[Y]
            y = table.ends[0, Y] + along * table.forward[Y] + offset * table.forward[X]
            above = table.band[LOWEST] + band * upwards[i % layer // width]
            node = nodes[k, i]
            _place(table, node, x, y, above)
            if k == 0:
                _reach(table, node, start, False, penalty)
            else:
                origins[k, i] = _reach_best(table, node, nodes[k - 1], order, penalty)
            node[_COST] += tolls[k, i % width] + _ALTITUDE * abs(above - middle)
    last = _reach_best(table, goal, nodes[n - 1], np.argsort(nodes[n - 1, :, _COST]), penalty)
    found = np.empty(3 * n)
    for k in range(n - 1, -1, -1):
        share = (k + 1) / (n + 1)
        line = table.ends[0, ABOVE] + (table.ends[1, ABOVE] - table.ends[0, ABOVE]) * share
        found[k], found[n + k] = sideways[k, last % width], nodes[k, last, _ABOVE] - line
        found[2 * n + k] = forwards[k, last // layer]
        last = origins[k, last]
    return found


@kernel
def _place(table: TerrainTable, node: Floats, x: float, y: float, above: float) -> None:
    """Place a node that no flight has reached yet."""
    x = min(max(x, table.extent[0]), table.extent[2])
    y = min(max(y, table.extent[1]), table.extent[3])
    ground = height_as_coded(table, x, y) if table.cost == METABOX else height(table, x, y)
    node[_X], node[_Y], node[_ABOVE], node[_Z] = x, y, above, ground + above
    node[_COST] = math.inf


@kernel
def _reach_best(table: TerrainTable, node: Floats, before: Floats, order: Integers, penalty: float) -> int:
    """Reach a node from the best of the nodes before, (N, 9), in the order of their costs; return which."""
    best = order[0]
    for k in range(order.shape[0]):
        other = before[order[k]]
        dx, dy, dz = node[_X] - other[_X], node[_Y] - other[_Y], node[_Z] - other[_Z]
        if other[_COST] >= node[_COST]:
            break
        least = other[_COST] + _LENGTH * math.sqrt(dx * dx + dy * dy + dz * dz)
        if least < node[_COST] and _reach(table, node, other, True, penalty):
            best = order[k]
    return best


@kernel
def _reach(table: TerrainTable, node: Floats, other: Floats, has_step: bool, penalty: float) -> bool:
    """Reach a node from another one if that is cheaper than before; return whether it is."""
    dx, dy, rise = node[_X] - other[_X], node[_Y] - other[_Y], node[_Z] - other[_Z]
    if table.cost == METABOX:
        cost = _step_as_coded(table, node, other, has_step, penalty)
    else:
        cost = _step(table, node, other, has_step)
    if cost >= node[_COST]:
        return False
    node[_COST], node[_DX], node[_DY], node[_RISE] = cost, dx, dy, rise
    node[_CLIMB] = DEGREES * arctangent(rise, math.sqrt(dx * dx + dy * dy))
    return True


@kernel
def _step(table: TerrainTable, node: Floats, other: Floats, has_step: bool) -> float:
    """Return the documented cost of a flight to a node by way of another one.

    It may lack terms where it is above the cost of the node without them.
    """
    dx, dy, rise = node[_X] - other[_X], node[_Y] - other[_Y], node[_Z] - other[_Z]
    climb = DEGREES * arctangent(rise, math.sqrt(dx * dx + dy * dy))
    cost = 0.0 if not has_step else other[_COST]
    over = max(abs(climb) - table.limits[CLIMB], 0.0)
    if has_step:
        turn = turn_between(other[_DX], other[_DY], dx, dy)
        over += max(turn - table.limits[TURN], 0.0)
        cost += _ANGLES * (turn + abs(climb - other[_CLIMB]))
    cost += _LIMITS * over
    straight = _LENGTH * math.sqrt(dx * dx + dy * dy + rise * rise)
    if cost + straight >= node[_COST]:
        return cost + straight
    if cost + straight + PENALTY >= node[_COST] and _goes_below(table, node, other):
        return cost + straight + PENALTY
    metres, threats, ground, band, _ = segment_terms(
        table, other[_X], other[_Y], other[_Z], node[_X], node[_Y], node[_Z]
    )
    return cost + _LENGTH * metres + _THREATS * threats + _GROUND * ground + _BAND * band


@kernel
def _step_as_coded(table: TerrainTable, node: Floats, other: Floats, has_step: bool, penalty: float) -> float:
    """Return the cost `metabox` of a flight to a node by way of another one, as `_step`."""
    dx, dy, rise = node[_X] - other[_X], node[_Y] - other[_Y], node[_Z] - other[_Z]
    level = math.sqrt(dx * dx + dy * dy)
    cost = _LENGTH * math.sqrt(level * level + rise * rise)
    if has_step:
        before = math.sqrt(other[_DX] ** 2 + other[_DY] ** 2)
        turn, change = angles_as_coded(
            table, other[_DX], other[_DY], before, other[_RISE], dx, dy, level, rise
        )
        cost += other[_COST] + _ANGLES * (turn + change)
    if cost >= node[_COST]:
        return cost
    threats, is_clear = segment_as_coded(table, other[_X], other[_Y], other[_Z], node[_X], node[_Y], node[_Z])
    return cost + _THREATS * threats + (0.0 if is_clear else penalty)


@kernel
def _goes_below(table: TerrainTable, node: Floats, other: Floats) -> bool:
    """Return whether one of seven points of the segment between two nodes lies below the ground."""
    dx, dy, rise = node[_X] - other[_X], node[_Y] - other[_Y], node[_Z] - other[_Z]
    for part in range(1, _SAMPLES + 1):
        share = part / (_SAMPLES + 1)
        ground = height(table, other[_X] + share * dx, other[_Y] + share * dy)
        if other[_Z] + share * rise < ground - _SURELY:
            return True
    return False
