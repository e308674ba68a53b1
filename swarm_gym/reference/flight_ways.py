"""Planned flights over terrain, through different valleys and past threats on other sides.

The first is a good flight over a coarse graph (`swarm_gym.reference.layered_flights`). The others are such
flights when a toll lies around a waypoint of a flight that is known.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.problem import TerrainProblem
from swarm_gym.reference.layered_flights import layered_flight

Floats = NDArray[np.float64]

ATTEMPTS = 8  # to find another flight
NODES = 25  # offsets at a waypoint
SHARES = (0.25, 0.5, 0.75)  # of the band, at which nodes lie
TOLL = 1e4  # as much as a contact
REACHES = (0.04, 0.15)  # least and greatest reach of a toll, as shares of the width of the map
LEAST_DIFFERENCE = 0.05  # of offsets at a waypoint, as a share of the width, that makes another flight
MOST_COST = 1.5  # of another flight, in costs of the first


def flight_ways(problem: TerrainProblem, most: int) -> Floats:
    """Return planned flights, (K, 2 n), as offsets sideways and upwards, the cheapest first.

    They are the same in every call.

    Args:
        problem: the problem, of any encoding and cost.
        most: largest number of flights.
    """
    exact = TerrainProblem(problem.scenario, "waypoints", problem.num_waypoints)
    table, n = exact.table, problem.num_waypoints
    sideways = np.linspace(table.lower[:n], table.upper[:n], NODES, axis=1)
    rng, upwards = np.random.default_rng(0), np.array(SHARES)
    flights = [layered_flight(table, sideways, upwards, np.zeros((n, NODES)))]
    costs = [exact.evaluate(flights[0])[0]]
    for _ in range(ATTEMPTS):
        if len(flights) == most:
            break
        known, at = flights[rng.integers(len(flights))], rng.integers(n)
        tolls = np.zeros((n, NODES))
        reach = rng.uniform(*REACHES) * table.width
        tolls[at] = np.where(abs(sideways[at] - known[at]) < reach, TOLL, 0.0)
        flight = layered_flight(table, sideways, upwards, tolls)
        cost = exact.evaluate(flight)[0]
        differences = [abs(flight[:n] - other[:n]).max() for other in flights]
        if min(differences) > LEAST_DIFFERENCE * table.width and cost < MOST_COST * costs[0]:
            flights.append(flight)
            costs.append(cost)
    return np.array(flights)[np.argsort(costs, kind="stable")]
