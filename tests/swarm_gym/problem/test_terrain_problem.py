"""Flights over terrain: costs against plain Python, shapely, dense samples and numbers of published code."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from helpers.compiled import compiled
from helpers.loops import looped
from helpers.refusals import refused
from helpers.terrains import drawn_flights, published_terrain, rolling_terrain
from oracles import naive_flights
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.problem import TerrainProblem
from swarm_gym.problem.tables import draw_bend
from swarm_gym.problem.terrain.as_coded import _above
from swarm_gym.problem.terrain.ground import below_ground, in_blocks, share_below, unsure
from swarm_gym.scenarios import TerrainScenario
from swarm_gym.scenarios.terrain import generated, generator

PUBLISHED = Path(__file__).parents[2] / "data" / "metabox-flights.npz"
ENCODINGS = ("waypoints", "shifted", "spherical")
every_encoding = looped("encoding", ENCODINGS)


def low_threats(seed=1):
    """Hills twice as high, and cylinders above which flights pass."""
    hills = rolling_terrain(seed)
    threats = hills.threats.copy()
    threats[:, 2] = np.linspace(120.0, 220.0, len(threats))
    return replace(hills, threats=threats, heights=2.0 * hills.heights)


def flights_of(problem, count, seed=0):
    """Vectors near the middle of the bounds and anywhere in them."""
    rng = np.random.default_rng(seed)
    low, high = problem.bounds
    middle = (low + high) / 2
    for _ in range(count):
        yield middle + rng.choice([0.1, 0.4, 1.0]) * (rng.uniform(low, high) - middle)


def smooth_flights(problem, count, amplitude=0.3, seed=0):
    """Vectors of smooth members."""
    rng = np.random.default_rng(seed)
    width = problem.table.lower.shape[0]
    for k in range(count):
        path = np.zeros(width + 1)
        compiled(draw_bend)(problem.table, amplitude, k % 2, rng.random(width), path)
        yield path[1 : problem.dimension + 1]


@looped(("scenario", "encoding"), [(s, e) for s in (rolling_terrain(), low_threats()) for e in ENCODINGS])
def test_terms_and_collision_are_those_of_plain_python(scenario, encoding):
    problem = TerrainProblem(scenario, encoding, 7)
    for vector in flights_of(problem, 25):
        terms, collision = naive_flights.terms(scenario, encoding, vector)
        fitness, found = problem.evaluate(vector)
        assert problem.terms(vector) == pytest.approx(terms, rel=1e-9, abs=1e-6)
        assert fitness == pytest.approx(sum(terms.values()), rel=1e-9)
        assert found == pytest.approx(collision, rel=1e-9, abs=2e-6)
        assert fitness > problem.lower_bound
        assert found < problem.collision_bound


def test_no_flight_without_collision_touches_ground_or_threat():
    free = 0
    for scenario in (rolling_terrain(2, threats=3), low_threats(3)):
        for encoding in ENCODINGS:
            problem = TerrainProblem(scenario, encoding, 9)
            for vector in [*flights_of(problem, 30, seed=4), *smooth_flights(problem, 80)]:
                if problem.evaluate(vector)[1] > 0.0:
                    continue
                above, distance = naive_flights.worst(scenario, problem.flights(vector)[:, :3], samples=200)
                assert above > -1e-9
                assert distance > -1e-9
                free += 1
    assert free > 20


@looped("choice", range(3))
def test_the_share_below_zero_is_positive_where_anything_is_below(choice):
    rng = np.random.default_rng(choice)
    below = compiled(share_below)
    s = np.linspace(0.0, 1.0, 4001)
    for _ in range(300):
        begin, end, sag = rng.normal(size=3) * rng.choice([0.0, 1e-6, 1.0, 50.0], 3)
        values = begin + (end - begin) * s + sag * (s * s - s)
        share = below(begin, end, sag)
        assert share == pytest.approx((values < 0.0).mean(), abs=2e-3)
        assert share > 0.0 or values.min() >= -1e-15


def segments_over(scenario, count, seed=0):
    """Segments between points of the map, also on lines between cells, and the heights of their ends."""
    rng = np.random.default_rng(seed)
    rows, columns = scenario.heights.shape
    for _ in range(count):
        places = rng.uniform(0.0, 1.0, (2, 2)) * [columns - 1.0, rows - 1.0]
        length = rng.choice([0.0, 0.02, 0.1, 1.0])
        places[1] = places[0] + length * (places[1] - places[0])
        if rng.random() < 0.3:
            places = np.round(places / 8.0) * 8.0
        if rng.random() < 0.2:  # along an axis
            axis = rng.integers(2)
            places[1, axis] = places[0, axis]
        places = np.clip(places, 0.0, [columns - 1.0, rows - 1.0])
        altitudes = 150.0 + rng.uniform(-1.0, 1.0, 2) * rng.choice([10.0, 60.0, 200.0])
        heights = bilinear(scenario.heights, *places.T) + altitudes
        yield places, heights


@looped("band", [(0.0, math.inf), (20.0, 400.0)])
def test_parts_of_a_segment_that_are_left_out_lie_in_the_band(band):
    """Everywhere before the first share and after the second one, also above ground one cell further."""
    decided = 0
    for scenario in (rolling_terrain(3), low_threats(4), published_terrain()):
        table, (rows, columns) = TerrainProblem(scenario).table, np.array(scenario.heights.shape) - 1.0
        shares = np.linspace(0.0, 1.0, 401)
        for (one, other), (z, to_z) in segments_over(scenario, 150):
            begin, end = compiled(unsure)(table, *one, z, *(other - one), to_z - z, *band)
            out = (shares < begin) | (shares > end) if begin < end else np.full(shares.shape, True)
            decided += out.any()
            for further in (0.0, 1.0):
                u, v = ((one + shares[:, None] * (other - one)) + further).T
                inside = out & (u <= columns) & (v <= rows)
                if not inside.any():
                    continue
                ground = bilinear(scenario.heights, u[inside], v[inside])
                above = (z + shares * (to_z - z))[inside] - ground
                assert above.min() >= band[0]
                assert further or above.max() <= band[1]
    assert decided > 20


def bilinear(heights, u, v):
    """The ground at points in cells."""
    column = np.minimum(u.astype(int), heights.shape[1] - 2)
    row = np.minimum(v.astype(int), heights.shape[0] - 2)
    u, v = u - column, v - row
    low = heights[row, column] * (1.0 - u) + heights[row, column + 1] * u
    return low * (1.0 - v) + (heights[row + 1, column] * (1.0 - u) + heights[row + 1, column + 1] * u) * v


@looped("band", [(0.0, math.inf), (100.0, 200.0)])
def test_what_is_left_out_changes_no_bit(band):
    """All blocks of a segment give the numbers of those that may matter."""
    found = 0
    for scenario in (rolling_terrain(3), low_threats(4), published_terrain()):
        table, cell = TerrainProblem(scenario).table, scenario.cell
        origin = np.array(scenario.workspace[:2])
        for (one, other), (z, to_z) in segments_over(scenario, 300, seed=1):
            (x, y), (to_x, to_y) = origin + cell * one, origin + cell * other
            u, v, to_u, to_v = ((np.array([x, y, to_x, to_y]) - np.tile(origin, 2)) / cell).tolist()
            whole = compiled(in_blocks)(table, u, v, z, to_u - u, to_v - v, to_z - z, *band, 0.0, 1.0)
            assert compiled(below_ground)(table, x, y, z, to_x, to_y, to_z, *band) == whole
            found += whole[0] > 0.0
    assert found > 50


@looped("limit", [1e-3, 45.0, 89.999, 90.0, 135.0])
def test_an_angle_below_its_limit_is_left_out_and_no_other(limit):
    scenario = replace(rolling_terrain(), largest_turn=limit)
    table, rng = TerrainProblem(scenario).table, np.random.default_rng(2)
    near = math.radians(limit) * (
        1.0 + np.concatenate([rng.normal(size=50) * 1e-9, rng.uniform(-1.0, 0.3, 50)])
    )
    for angle in [*near.tolist(), 0.0, math.pi]:
        size = rng.uniform(0.1, 1e4)
        cross, dot = abs(size * math.sin(angle)), size * math.cos(angle)
        degrees = math.degrees(math.atan2(cross, dot))
        if abs(degrees - limit) > 1e-12 * limit:
            expected = degrees if degrees > limit else 0.0
            assert compiled(_above)(table, 0, cross, dot) == pytest.approx(expected, rel=1e-12)


@every_encoding
def test_costs_of_many_vectors_are_the_fitness_of_each(encoding):
    for cost in ("documented", "metabox"):
        problem = TerrainProblem(low_threats(5), encoding, 10, cost)
        vectors = np.array([*flights_of(problem, 24)])
        fitness = [problem.evaluate(vector)[0] for vector in vectors]
        assert problem.costs(vectors).tolist() == fitness
        np.testing.assert_array_equal(problem.costs(vectors.reshape(4, 6, -1)), np.reshape(fitness, (4, 6)))
        assert float(problem.costs(vectors[3])) == fitness[3]
        refused(lambda: problem.costs(vectors[:, 1:]), "components", str(problem.dimension), error=ValueError)  # noqa: B023
        refused(lambda: problem.costs(np.nan * vectors), "finite", error=ValueError)  # noqa: B023


def test_costs_are_those_of_published_code():
    """Published code made these costs; a third of the flights have waypoints that fall together."""
    problem = TerrainProblem(published_terrain(), "spherical", 10, "metabox")
    stored = np.load(PUBLISHED)["ridges"]
    flights = drawn_flights(problem, 7, len(stored))
    found = [problem.evaluate(flight)[0] for flight in flights]
    np.testing.assert_allclose(found, stored, rtol=1e-9)
    steps = np.diff(problem.points(flights), axis=1)
    assert (steps == 0.0).all(axis=2).any(axis=1).mean() > 0.3
    grounded = [problem.terms(flight)["ground"] > 0.0 for flight in flights[:100]]
    assert 0.2 < np.mean(grounded) < 0.9


@pytest.mark.slow
def test_costs_over_generated_terrains_are_those_of_published_code():
    """Published code made these 10,000 costs, over five terrains with 15 threats and five with 30."""
    stream, found = np.random.RandomState(3849), []
    for number, threats in enumerate([15] * 5 + [30] * 5):
        draws = generator.draw(stream, threats)
        terrain = generator.terrain_with(draws, generator.heights_of(draws))
        problem = TerrainProblem(generated.as_scenario("one", terrain), "spherical", 10, "metabox")
        flights = drawn_flights(problem, 1000 + number, 1000)
        found.append([problem.evaluate(flight)[0] for flight in flights])
    np.testing.assert_allclose(found, np.load(PUBLISHED)["generated"], rtol=1e-9)


def test_both_costs_have_the_same_collision_for_the_same_flight():
    scenario = low_threats(5)
    one, other = (TerrainProblem(scenario, "waypoints", 10, cost) for cost in ("documented", "metabox"))
    for vector in flights_of(one, 50):
        assert one.evaluate(vector)[1] == pytest.approx(other.evaluate(vector)[1], rel=1e-12)
        assert sum(other.terms(vector).values()) == pytest.approx(other.evaluate(vector)[0])


def test_headings_of_published_code_are_mirrored():
    scenario = rolling_terrain()
    vector = np.tile([30.0, 0.0, 0.9], 10)
    straight, mirrored = (
        TerrainProblem(scenario, "spherical", 10, cost).points(vector)[1] - scenario.start[:2]
        for cost in ("documented", "metabox")
    )
    assert straight == pytest.approx([30 * math.cos(0.9), 30 * math.sin(0.9)])
    assert mirrored == pytest.approx(straight[::-1])


@every_encoding
def test_repair_frees_most_flights_and_leaves_free_ones_alone(encoding):
    freed = colliding = 0
    for scenario in (rolling_terrain(6, threats=2), low_threats(7)):
        problem = TerrainProblem(scenario, encoding, 10)
        low, high = problem.bounds
        for vector in smooth_flights(problem, 40, amplitude=0.2):
            before = problem.evaluate(vector)[1]
            for degree in (0.5, 1.0):
                repaired = problem.repaired(vector, degree)
                assert (repaired >= low).all()
                assert (repaired <= high).all()
            if before == 0.0:
                np.testing.assert_array_equal(repaired, vector)
            else:
                colliding += 1
                freed += problem.evaluate(repaired)[1] < before
    assert colliding > 15
    assert freed > 0.7 * colliding


@every_encoding
def test_smooth_members_bend_both_ways_and_reach_the_amplitude(encoding):
    problem = TerrainProblem(rolling_terrain(threats=0), encoding, 11)
    flights = problem.flights(list(smooth_flights(problem, 200, amplitude=0.1, seed=3)))
    along = np.array([math.cos(math.atan2(780.0, 820.0)), math.sin(math.atan2(780.0, 820.0))])
    sideways = (flights[..., :2] - flights[:, :1, :2]) @ [-along[1], along[0]]
    upwards = flights[..., 3] - 150.0
    for offsets, largest in ((sideways, 0.1 * problem.table.width), (upwards, 10.0)):
        heights = abs(offsets).max(axis=1)
        assert heights.max() <= largest * (1.0 + 1e-9)
        assert heights.mean() == pytest.approx(largest / 2, rel=0.15)
    correlation = np.corrcoef(sideways[:, 5], upwards[:, 5])[0, 1]
    assert abs(correlation) < 0.25


def test_smooth_members_shift_waypoints_along_the_line_and_keep_their_order():
    problem = TerrainProblem(rolling_terrain(threats=0), "shifted", 11)
    flights = np.array([*smooth_flights(problem, 200, amplitude=0.1, seed=3)])
    forwards, spacing = flights[:, 22:], problem.table.spacing
    heights = abs(forwards).max(axis=1)
    assert heights.max() <= 0.4 * spacing * (1.0 + 1e-9)
    assert heights.mean() == pytest.approx(0.2 * spacing, rel=0.15)
    assert (forwards.min(axis=1) < 0.0).mean() > 0.3
    assert (np.diff(spacing * np.arange(1, 12) + forwards) > 0.0).all()
    for group in (flights[:, :11], flights[:, 11:22]):
        assert abs(np.corrcoef(group[:, 5], forwards[:, 5])[0, 1]) < 0.25


def test_waypoints_are_shifted_at_most_by_two_distances_and_never_past_an_end():
    problem = TerrainProblem(rolling_terrain(), "shifted", 6)
    spacing, (low, high) = problem.table.spacing, problem.bounds
    assert low[12:] == pytest.approx(spacing * np.array([-1.0, -2.0, -2.0, -2.0, -2.0, -2.0]))
    assert high[12:] == pytest.approx(spacing * np.array([2.0, 2.0, 2.0, 2.0, 2.0, 1.0]))
    table, even = problem.table, TerrainProblem(rolling_terrain(), "waypoints", 6).table
    np.testing.assert_array_equal(table.initial_lower[:12], even.lower[:12])
    np.testing.assert_array_equal(table.initial_upper[:12], even.upper[:12])
    assert table.initial_upper[12:18] == pytest.approx(np.full(6, 0.5 * spacing))
    assert (low <= table.initial_lower[:18]).all()
    assert (high >= table.initial_upper[:18]).all()
    assert problem.points(np.where(np.arange(18) < 12, 0.0, low))[1] == pytest.approx((30.0, 40.0))


def test_flights_without_shifts_are_those_of_even_waypoints():
    even, shifted = (TerrainProblem(low_threats(4), encoding, 9) for encoding in ("waypoints", "shifted"))
    for vector in flights_of(even, 20):
        assert shifted.evaluate(np.append(vector, np.zeros(9))) == even.evaluate(vector)


@pytest.mark.parametrize("method", ["points", "flights", "costs"])
def test_vectors_of_other_lengths_or_without_numbers_are_refused(method):
    problem = TerrainProblem(rolling_terrain(1), num_waypoints=6)
    for vectors in (np.zeros((2, 6)), np.zeros((12, 1)), np.zeros(24)):
        with pytest.raises(ValueError, match="expected vectors of 12 components"):
            getattr(problem, method)(vectors)
    with pytest.raises(ValueError, match="must be finite"):
        getattr(problem, method)(np.full(12, np.nan))


def test_problems_are_refused_with_what_is_valid():
    scenario = rolling_terrain()
    refused(lambda: TerrainProblem(scenario, "bezier"), "bezier", "spherical", error=UnknownNameError)
    refused(lambda: TerrainProblem(scenario, cost="free"), "free", "metabox", error=UnknownNameError)
    refused(lambda: TerrainProblem(scenario, num_waypoints=3), "[4, 300]", error=SettingError)
    assert TerrainProblem(scenario, num_waypoints=4).dimension == 8
    refused(lambda: TerrainProblem(scenario, "shifted", 5), "[6, 300]", error=SettingError)
    assert TerrainProblem(scenario, "shifted", 6).dimension == 18


def test_the_identity_is_that_of_the_content():
    one, other = TerrainProblem(rolling_terrain(1)), TerrainProblem(rolling_terrain(1))
    assert one.identity == other.identity
    assert one == other
    moved = TerrainProblem(rolling_terrain(1, goal=(849.0, 820.0, 150.0)))
    assert moved.identity != one.identity
    assert TerrainProblem(rolling_terrain(1), cost="metabox").identity != one.identity


def test_a_flat_flight_costs_what_one_can_count():
    flat = TerrainScenario("flat", np.zeros((20, 20)), (10.0, 90.0, 150.0), (170.0, 90.0, 150.0), cell=10.0)
    problem = TerrainProblem(flat, "waypoints", 7)
    assert problem.evaluate(np.zeros(14)) == (800.0, 0.0)
    upwards = np.append(np.zeros(7), np.full(7, 10.0))
    terms = problem.terms(upwards)
    climb = math.degrees(math.atan2(10.0, 20.0))
    assert terms["altitude"] == pytest.approx(700.0)
    assert terms["angles"] == pytest.approx(2.0 * climb)
    assert terms["length"] == pytest.approx(5.0 * (2.0 * math.hypot(20.0, 10.0) + 120.0))
    assert (terms["band"], terms["ground"], terms["threats"], terms["limits"]) == (0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("first", [False, True])
def test_a_step_without_length_hides_no_turn_and_no_change_of_climb(first):
    flat = TerrainScenario(
        "flat", np.zeros((101, 101)), (100.0, 500.0, 150.0), (900.0, 500.0, 150.0), cell=10.0
    )
    problem, turn = TerrainProblem(flat, "spherical", 5), math.pi / 4
    there, back, onwards = (150.0, 0.1, turn), (150.0, -0.1, -turn), (200.0, 0.0, 0.0)

    def terms(still):
        steps = [(still, 0.1, turn), there] if first else [there, (still, 0.1, turn)]
        return problem.terms(np.ravel([*steps, back, onwards, onwards]))

    nearly = terms(1e-7)
    assert nearly["limits"] == pytest.approx(100.0 * 45.0, rel=1e-6)
    assert terms(0.0) == pytest.approx(nearly, rel=1e-6)


@looped(
    ("cost", "stored"),
    [
        (
            "documented",
            [
                (94999.03131545373, 137.14212950585795),
                (98063.10358448686, 84.01685402765781),
                (92225.19589606373, 162.50151051775327),
            ],
        ),
        (
            "metabox",
            [
                (67445.75352215623, 381.03255803055333),
                (16110.985239639629, 5.496205102542009),
                (18452.94816457174, 16.33481399566898),
            ],
        ),
    ],
)
def test_costs_stay_the_same_bits(cost, stored):
    """A change of these numbers changes results; the changelog has to say so."""
    problem = TerrainProblem(published_terrain(), "spherical", 10, cost)
    assert [problem.evaluate(flight) for flight in drawn_flights(problem, 11, 3)] == stored
