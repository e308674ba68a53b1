"""Planned flights: cheap, different, the same in every call, and past threats on several sides."""

from itertools import pairwise, product

import numpy as np
import pytest

from helpers.loops import looped
from helpers.terrains import rolling_terrain
from swarm_gym.problem import TerrainProblem
from swarm_gym.problem.terrain.cost import PENALTY
from swarm_gym.reference import layered_flights
from swarm_gym.reference.layered_flights import LEAST_DIFFERENCE, MOST_COST, flight_ways, layered_flight
from swarm_gym.scenarios import TerrainScenario


def flat(**parts):
    ends = {"start": (10.0, 500.0, 150.0), "goal": (990.0, 500.0, 150.0)}
    return TerrainScenario("flat", **{"heights": np.zeros((101, 101)), "cell": 10.0, **ends, **parts})


by_offsets = looped("encoding", ("waypoints", "shifted"))


@by_offsets
def test_the_straight_line_is_found_where_nothing_is_in_the_way(encoding):
    problem = TerrainProblem(flat(), encoding)
    flight = flight_ways(problem, 1)[0]
    assert problem.evaluate(flight)[0] <= 1.001 * problem.lower_bound


@by_offsets
def test_flights_pass_a_threat_on_both_sides(encoding):
    problem = TerrainProblem(flat(threats=[[500.0, 500.0, np.inf, 80.0]]), encoding)
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


def test_shifted_waypoints_save_a_way_round_two_walls():
    """Between the walls lies no even waypoint: they are at 150, 290, 430, 570, 710 and 850."""
    x, y = np.meshgrid(np.arange(0.0, 1001.0, 10.0), np.arange(0.0, 1001.0, 10.0))
    heights = 2_000.0 * (((abs(x - 450.0) < 15.0) & (y < 700.0)) | ((abs(x - 550.0) < 15.0) & (y > 300.0)))
    even, shifted = (
        TerrainProblem(flat(heights=heights, largest_turn=180.0, largest_climb=90.0), encoding, 6)
        for encoding in ("waypoints", "shifted")
    )
    (cost, _), (less, collision) = (p.evaluate(flight_ways(p, 1)[0]) for p in (even, shifted))
    assert collision == 0.0
    assert less < 0.75 * cost


@by_offsets
def test_a_ridge_is_crossed_at_its_gap(encoding):
    heights = np.zeros((101, 101))
    heights[:, 45:56] = 2_000.0
    heights[75:85, 45:56] = 0.0
    problem = TerrainProblem(flat(heights=heights), encoding)
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


@looped(("encoding", "seeds"), [("waypoints", 3), ("shifted", 1)])
def test_flights_differ_and_are_in_the_order_of_their_costs(encoding, seeds):
    for seed in range(seeds):
        problem = TerrainProblem(rolling_terrain(seed), encoding)
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


SMALL_GRAPHS = [("waypoints", 4, 4, 1, 0.5, seed) for seed in (0, 1, 5, 6, 7)]
SMALL_GRAPHS += [("shifted", 6, 2, 2, 0.3, seed) for seed in (31, 37, 38)]


@pytest.mark.parametrize(("encoding", "n", "offsets", "shifts", "reach", "seed"), SMALL_GRAPHS)
@pytest.mark.parametrize("penalty", [0.0, 1e9])
def test_the_cheapest_flight_of_a_small_graph_is_found_where_no_angle_costs(
    penalty, encoding, n, offsets, shifts, reach, seed
):
    goal = (790.0, 760.0, 150.0)
    terrain = rolling_terrain(seed, largest_turn=180.0, largest_climb=90.0, goal=goal)
    problem, rng = TerrainProblem(terrain, encoding, n, cost="metabox"), np.random.default_rng(seed)
    low, high = problem.table.initial_lower[:n, None], problem.table.initial_upper[:n, None]
    sideways = np.sort(rng.uniform(reach * low, reach * high, (n, offsets)), axis=1)
    forwards = 0.1 * problem.table.spacing * rng.uniform(-1.0, 1.0, (n, shifts)) * (shifts > 1)
    tolls = rng.uniform(0.0, 500.0, (n, offsets))
    found = layered_flight(problem.table, sideways, np.array([0.5]), forwards, tolls, penalty)
    nodes = [[*product(*both)] for both in zip(sideways, forwards, strict=True)]
    flights = np.array(
        [
            (*(side for side, _ in flight), *found[n : 2 * n], *(ahead for _, ahead in flight))
            for flight in product(*nodes)
        ]
    )
    vectors = flights[:, : problem.dimension]
    is_below = np.array([problem.terms(vector)["ground"] > 0.0 for vector in vectors])
    paid = np.array(list(product(*(np.repeat(row, shifts) for row in tolls)))).sum(axis=1)
    costs = problem.costs(vectors) - PENALTY * is_below + paid
    assert 0 < is_below.sum() < len(flights)
    best = costs.min() if penalty == 0.0 else costs[~is_below].min()
    at = (flights == found).all(axis=1)
    assert costs[at] == pytest.approx([best], rel=1e-12)
