"""Planned flights: cheap, different, the same in every call, and past threats on several sides."""

from itertools import pairwise, product

import numpy as np
import pytest

from helpers.terrains import rolling_terrain
from swarm_gym.problem import TerrainProblem
from swarm_gym.problem.terrain.cost import PENALTY
from swarm_gym.reference import layered_flights
from swarm_gym.reference.layered_flights import LEAST_DIFFERENCE, MOST_COST, flight_ways, layered_flight
from swarm_gym.scenarios import TerrainScenario


def flat(**parts):
    ends = {"start": (10.0, 500.0, 150.0), "goal": (990.0, 500.0, 150.0)}
    return TerrainScenario("flat", **{"heights": np.zeros((101, 101)), "cell": 10.0, **ends, **parts})


def test_the_straight_line_is_found_where_nothing_is_in_the_way():
    problem = TerrainProblem(flat())
    flight = flight_ways(problem, 1)[0]
    assert problem.evaluate(flight)[0] <= 1.001 * problem.lower_bound


def test_flights_pass_a_threat_on_both_sides():
    problem = TerrainProblem(flat(threats=[[500.0, 500.0, np.inf, 80.0]]))
    flights = flight_ways(problem, 4)
    assert all(problem.evaluate(flight)[1] == 0.0 for flight in flights)
    middles = {float(np.sign(flight[4] + flight[5])) for flight in flights}
    assert middles == {-1.0, 1.0}


def test_a_narrow_gap_between_threats_is_found():
    middle, wide = 316.0, 34.0
    below = np.arange(middle - wide / 2 - 90.0, -100.0, -90.0)
    above = np.arange(middle + wide / 2 + 90.0, 1_100.0, 90.0)
    at = 10.0 + 980.0 * 5 / 11  # of the fifth waypoint
    threats = [[at, y, np.inf, 90.0] for y in (*below, *above)]
    problem = TerrainProblem(flat(threats=threats, drone_size=0.0, danger_distance=0.0))
    assert problem.evaluate(flight_ways(problem, 1)[0])[1] == 0.0


def test_a_ridge_is_crossed_at_its_gap():
    heights = np.zeros((101, 101))
    heights[:, 45:56] = 2_000.0
    heights[75:85, 45:56] = 0.0
    problem = TerrainProblem(flat(heights=heights))
    flight = flight_ways(problem, 1)[0]
    assert problem.evaluate(flight)[1] == 0.0
    points = problem.points(flight)
    ys = [
        y0 + (y1 - y0) * (500.0 - x0) / (x1 - x0)
        for (x0, y0), (x1, y1) in pairwise(points.tolist())
        if x0 <= 500.0 <= x1
    ]
    assert all(750.0 <= y <= 850.0 for y in ys)


def planned_anew(problem, most):
    layered_flights._planned.clear()
    return flight_ways(problem, most)


def test_flights_differ_and_are_in_the_order_of_their_costs():
    for seed in range(3):
        problem = TerrainProblem(rolling_terrain(seed))
        flights = flight_ways(problem, 4)
        np.testing.assert_array_equal(flights, planned_anew(problem, 4))
        costs = [problem.evaluate(flight)[0] for flight in flights]
        assert costs == sorted(costs)
        assert costs[-1] < MOST_COST * costs[0] * MOST_COST
        low, high = problem.bounds
        assert ((flights >= low - 1e-9) & (flights <= high + 1e-9)).all()
        sideways = flights[:, :10]
        for k, flight in enumerate(sideways):
            for other in sideways[:k]:
                assert abs(flight - other).max() > LEAST_DIFFERENCE * problem.table.width
        rng = np.random.default_rng(seed)
        drawn = [problem.evaluate(rng.uniform(low, high))[0] for _ in range(300)]
        assert costs[0] < min(drawn)


def test_encodings_have_the_same_flights():
    scenario = rolling_terrain(1)
    for cost in ("documented", "metabox"):
        one = flight_ways(TerrainProblem(scenario, cost=cost), 2)
        other = planned_anew(TerrainProblem(scenario, "spherical", cost=cost), 2)
        np.testing.assert_array_equal(one, other)


def test_flights_are_planned_once_for_each_problem_and_number(monkeypatch):
    problem, calls = TerrainProblem(rolling_terrain(2)), []

    def counted(*given):
        calls.append(1)
        return layered_flight(*given)

    monkeypatch.setattr(layered_flights, "_planned", {})
    monkeypatch.setattr(layered_flights, "layered_flight", counted)
    first = flight_ways(problem, 2)
    planned = len(calls)
    first[:] = np.nan
    again = flight_ways(TerrainProblem(rolling_terrain(2), "spherical"), 2)
    assert len(calls) == planned > 0
    assert np.isfinite(again).all()
    flight_ways(problem, 1)
    flight_ways(TerrainProblem(rolling_terrain(2), cost="metabox"), 2)
    assert len(calls) > planned + 1


def test_flights_have_the_terms_of_the_cost():
    """A wall costs `metabox` one penalty, and the documented cost one for each segment and metre in it."""
    heights = np.zeros((101, 101))
    heights[20:81, 30:70] = 2_000.0
    documented, metabox = (TerrainProblem(flat(heights=heights), cost=c) for c in ("documented", "metabox"))
    around, through = flight_ways(documented, 1)[0], flight_ways(metabox, 1)[0]
    assert documented.costs(around) < documented.costs(through)
    assert metabox.costs(through) < metabox.costs(around)


@pytest.mark.parametrize("seed", [0, 1, 5, 6, 7])
@pytest.mark.parametrize("penalty", [0.0, 1e9])
def test_the_cheapest_flight_of_a_small_graph_is_found_where_no_angle_costs(penalty, seed):
    goal = (790.0, 760.0, 150.0)
    terrain = rolling_terrain(seed, largest_turn=180.0, largest_climb=90.0, goal=goal)
    problem = TerrainProblem(terrain, num_waypoints=4, cost="metabox")
    n, rng = 4, np.random.default_rng(seed)
    low, high = problem.bounds
    sideways = np.sort(rng.uniform(0.5 * low[:n, None], 0.5 * high[:n, None], (n, 4)), axis=1)
    tolls = rng.uniform(0.0, 500.0, (n, 4))
    found = layered_flight(problem.table, sideways, np.array([0.5]), tolls, penalty)
    flights = np.array([(*offsets, *found[n:]) for offsets in product(*sideways)])
    is_below = np.array([problem.terms(flight)["ground"] > 0.0 for flight in flights])
    paid = np.array(list(product(*tolls))).sum(axis=1)
    costs = problem.costs(flights) - PENALTY * is_below + paid
    assert 0 < is_below.sum() < len(flights)
    best = costs.min() if penalty == 0.0 else costs[~is_below].min()
    at = (flights == found).all(axis=1)
    assert costs[at] == pytest.approx([best], rel=1e-12)
