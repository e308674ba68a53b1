"""Planned flights over terrain, through different valleys and past threats on other sides.

A flight leads over a coarse graph: offsets at each waypoint, in the middle of the band, with the terms of the
problem's cost. Dynamic programming goes from one waypoint to the next. A turn, or a change of climb, at a
node follows from the best flight to that node. So a flight is good and not always the best one of the graph.
A graph of finer offsets and of altitudes around the flight then improves it. The cost `metabox` has one
penalty for all samples below the ground: one flight is planned with it on each segment, and one without it.

Further flights are found in the same way when a toll lies around a waypoint of a flight that is known.
"""

import math

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
NODES = 50  # offsets at a waypoint; with 25, gaps between threats were missed
SHARES = (0.5,)  # of the band, at which nodes lie
FINE_NODES = 15  # offsets at a waypoint, around a flight
FINE_REACH = 2.0  # how far they reach on each side, in distances between offsets
FINE_SHARES = (0.1, 0.3, 0.5, 0.7, 0.9)
TOLL = 1e4  # as much as a contact
REACHES = (0.04, 0.15)  # least and greatest reach of a toll, as shares of the width of the map
LEAST_DIFFERENCE = 0.05  # of offsets at a waypoint, as a share of the width, that makes another flight
MOST_COST = 1.5  # of another flight, in costs of the first
# Columns of nodes: place, the best flight to it, and the last step of that flight.
_X, _Y, _ABOVE, _Z, _COST, _DX, _DY, _RISE, _CLIMB = range(9)
_LENGTH, _THREATS, _ALTITUDE, _ANGLES, _GROUND, _BAND, _LIMITS = WEIGHTS

# Flights that were planned in this process, by the identity of the problem and their largest number. Each
# validation of a training asks for the same ones; they take less than a kilobyte.
_planned: dict[tuple[object, ...], Floats] = {}


def flight_ways(problem: TerrainProblem, most: int) -> Floats:
    """Return planned flights, (K, 2 n), as offsets sideways and upwards, the cheapest first.

    They are the same in every call; only the first one plans them.

    Args:
        problem: the problem, of any encoding and cost.
        most: largest number of flights.
    """
    by_offsets = TerrainProblem(problem.scenario, "waypoints", problem.num_waypoints, problem.cost)
    asked = (*by_offsets.identity, most)
    if asked not in _planned:
        _planned[asked] = _plan(by_offsets, most)
    return _planned[asked].copy()


def _plan(by_offsets: TerrainProblem, most: int) -> Floats:
    """Return the planned flights of a problem of waypoints."""
    table, n = by_offsets.table, by_offsets.num_waypoints
    sideways = np.linspace(table.lower[:n], table.upper[:n], NODES, axis=1)
    penalties = (PENALTY, 0.0) if by_offsets.cost == "metabox" else (PENALTY,)

    def planned(tolls: Floats) -> tuple[Floats, float]:
        found = []
        for penalty in penalties:
            flight = layered_flight(table, sideways, np.array(SHARES), tolls, penalty)
            found += [flight, _finer(table, flight, penalty)]
        costs = by_offsets.costs(found)
        return found[costs.argmin()], costs.min()

    rng, (first, cost) = np.random.default_rng(0), planned(np.zeros((n, NODES)))
    flights, costs = [first], [cost]
    for _ in range(ATTEMPTS):
        if len(flights) == most:
            break
        known, at = flights[rng.integers(len(flights))], rng.integers(n)
        tolls = np.zeros((n, NODES))
        reach = rng.uniform(*REACHES) * table.width
        tolls[at] = np.where(abs(sideways[at] - known[at]) < reach, TOLL, 0.0)
        flight, cost = planned(tolls)
        differences = [abs(flight[:n] - other[:n]).max() for other in flights]
        if min(differences) > LEAST_DIFFERENCE * table.width and cost < MOST_COST * costs[0]:
            flights.append(flight)
            costs.append(cost)
    return np.array(flights)[np.argsort(costs, kind="stable")]


def _finer(table: TerrainTable, flight: Floats, penalty: float) -> Floats:
    """Return a flight through nodes that lie closely around this one, (2 n,)."""
    n = len(flight) // 2
    least, most = table.lower[:n, None], table.upper[:n, None]
    reach = FINE_REACH * (most - least) / (NODES - 1)
    sideways = np.clip(flight[:n, None] + reach * np.linspace(-1.0, 1.0, FINE_NODES), least, most)
    return layered_flight(table, sideways, np.array(FINE_SHARES), np.zeros((n, FINE_NODES)), penalty)


@entry
def layered_flight(
    table: TerrainTable, sideways: Floats, upwards: Floats, tolls: Floats, penalty: float
) -> Floats:
    """Return offsets sideways and upwards, (2 n,), of a flight of small cost through nodes of a graph.

    Args:
        table: the problem table, with n waypoints; its encoding does not matter.
        sideways: (n, M) offsets of the nodes of each waypoint.
        upwards: (A,) shares of the band at which nodes lie.
        tolls: (n, M) what it costs to pass a node, besides the terms.
        penalty: number added for each segment below the ground, if the cost is `metabox`.
    """
    n, width = sideways.shape
    num_nodes = width * upwards.shape[0]
    nodes = np.zeros((n, num_nodes, 9))
    origins = np.zeros((n, num_nodes), np.int64)
    start, goal = np.zeros(9), np.zeros(9)
    _place(table, start, table.ends[0, X], table.ends[0, Y], table.ends[0, ABOVE])
    _place(table, goal, table.ends[1, X], table.ends[1, Y], table.ends[1, ABOVE])
    band = table.band[HIGHEST] - table.band[LOWEST]
    middle = 0.5 * (table.band[LOWEST] + table.band[HIGHEST])
    for k in range(n):
        along = (k + 1) * table.spacing
        order = np.argsort(nodes[max(k - 1, 0), :, _COST])
        for i in range(num_nodes):
            offset = sideways[k, i % width]
            x = table.ends[0, X] + along * table.forward[X] - offset * table.forward[Y]
            y = table.ends[0, Y] + along * table.forward[Y] + offset * table.forward[X]
            above = table.band[LOWEST] + band * upwards[i // width]
            node = nodes[k, i]
            _place(table, node, x, y, above)
            if k == 0:
                _reach(table, node, start, False, penalty)
            else:
                origins[k, i] = _reach_best(table, node, nodes[k - 1], order, penalty)
            node[_COST] += tolls[k, i % width] + _ALTITUDE * abs(above - middle)
    last = _reach_best(table, goal, nodes[n - 1], np.argsort(nodes[n - 1, :, _COST]), penalty)
    return _offsets(table, nodes, origins, sideways, last)


@kernel
def _offsets(table: TerrainTable, nodes: Floats, origins: Integers, sideways: Floats, last: int) -> Floats:
    """Return the offsets of the flight that ends with a node of the last waypoint."""
    n, width = sideways.shape
    found = np.empty(2 * n)
    for k in range(n - 1, -1, -1):
        share = (k + 1) / (n + 1)
        line = table.ends[0, ABOVE] + (table.ends[1, ABOVE] - table.ends[0, ABOVE]) * share
        found[k], found[n + k] = sideways[k, last % width], nodes[k, last, _ABOVE] - line
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
    """Reach a node from the best of the nodes before, (N, 8), in the order of their costs; return which."""
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
    if cost >= node[_COST]:
        return cost
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
