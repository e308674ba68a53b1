"""Smooth bends: their modes, how large they are, how smooth, and that they lie inside the bounds."""

import math

import numpy as np
import pytest
import shapely

from helpers.builders import make_problem, problem_of, small_grid_problem
from helpers.newcomers import drawn, naively_drawn
from oracles.naive_sources import Source, covariance
from swarm_gym.problem import AnalyticProblem, GridProblem, TerrainProblem
from swarm_gym.problem.geometry.bends import BENDS, HARMONICS, NUM_MODES, STOMP, modes, modes_of_components
from swarm_gym.scenarios import GridMap, GridScenario, Scenario, TerrainScenario

# A square of which the line is the middle: no bend of half the width is clipped.
OPEN = Scenario("open", (100.0, 500.0), (900.0, 500.0), (), (0.0, 0.0, 1000.0, 1000.0))
kinds = pytest.mark.parametrize("bends", BENDS)


def open_grid(angle=0.0):
    """Return a large free grid map whose line has this direction."""
    grid = GridMap("open", np.zeros((400, 400), dtype=np.bool_))
    way = 60.0 * math.cos(angle), 60.0 * math.sin(angle)
    ends = (200.0 - way[0], 200.0 - way[1]), (200.0 + way[0], 200.0 + way[1])
    return GridScenario("open", grid, *ends)


def grid_problem(scenario, encoding="bezier", num_points=4):
    return GridProblem(scenario, encoding, num_points)


def second_differences(paths):
    """Return the root mean square of second differences relative to that of the offsets, path by path."""
    whole = np.pad(paths, ((0, 0), (1, 1)))
    return np.sqrt((np.diff(whole, 2, axis=1) ** 2).mean(axis=1) / (paths**2).mean(axis=1))


def distance_from_uniform(values):
    """Return the statistic of Kolmogorov and Smirnov for numbers that should be uniform in [0, 1]."""
    ordered, n = np.sort(values), len(values)
    steps = np.arange(n + 1) / n
    return max((steps[1:] - ordered).max(), (ordered - steps[:-1]).max())


# Modes.


def test_harmonics_are_sines_whose_height_falls_with_their_frequency():
    root = math.sqrt(0.5)
    second, third = 2**-1.5, 3**-1.5
    expected = [[root, 1.0, root], [second, 0.0, -second], [third * root, -third, third * root]]
    np.testing.assert_allclose(modes(3)[HARMONICS, :3], expected, atol=1e-15)
    assert (modes(3)[HARMONICS, 3:] == 0).all()


@pytest.mark.parametrize("count", [1, 2, 3, 5, 6])
def test_few_points_have_all_modes_of_stomp_and_these_have_its_covariance(count):
    found = modes(count)[STOMP]
    assert (found[count:] == 0).all()
    expected = covariance(count) / np.linalg.eigvalsh(covariance(count)).max()
    np.testing.assert_allclose(found.T @ found, expected, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("count", [7, 31, 60])
def test_modes_of_stomp_are_the_six_widest_principal_components(count):
    found, variances = modes(count)[STOMP], np.linalg.eigvalsh(covariance(count))[::-1]
    products = found @ found.T
    np.testing.assert_allclose(products, np.diag(variances[:NUM_MODES] / variances[0]), atol=1e-9)
    np.testing.assert_allclose(
        found @ covariance(count), found * variances[:NUM_MODES, None], rtol=1e-6, atol=1e-6 * variances[0]
    )


@pytest.mark.parametrize("count", [1, 2, 7, 31, 100])
def test_every_mode_begins_with_a_positive_offset_whatever_the_library(count):
    assert (modes(count)[STOMP, : min(count, NUM_MODES), 0] > 0).all()


def test_both_coordinates_of_a_control_point_have_its_modes_and_padding_has_none():
    found = modes_of_components(np.array([0, 1, 2, 0, 1, 2]), 3)
    assert found.shape == (2, NUM_MODES, 8)
    np.testing.assert_array_equal(found[..., :3], modes(3))
    np.testing.assert_array_equal(found[..., 3:6], modes(3))
    assert (found[..., 6:] == 0).all()


def test_modes_cannot_be_changed_for_later_problems():
    with pytest.raises(ValueError, match="read-only"):
        modes(3)[0, 0, 0] = 1.0


# How large and how smooth.


@kinds
@pytest.mark.parametrize("amplitude", [0.1, 0.5])
def test_the_largest_offset_is_uniform_up_to_the_amplitude(bends, amplitude):
    problem, count = AnalyticProblem(OPEN, 15), 1500
    positions, smooth, _ = drawn(problem, Source(1.0, amplitude, bends), count)
    assert smooth.all()
    shares = np.abs(positions).max(axis=1) / (amplitude * 1000.0)
    assert shares.max() <= 1.0 + 1e-12
    assert distance_from_uniform(shares) < 1.63 / math.sqrt(count)  # at the level of 1 %


@kinds
def test_around_planned_flights_the_largest_offset_has_the_law_of_a_third_power(bends):
    flat = TerrainScenario(
        "flat", np.zeros((101, 101)), (10.0, 500.0, 150.0), (990.0, 500.0, 150.0), cell=10.0
    )
    count, n = 1500, 10
    for ways, power in ((None, 1), (np.zeros((4, 2 * n)), 3)):
        problem = TerrainProblem(flat, ways=ways)
        positions, _, _ = drawn(problem, Source(1.0, 0.1, bends), count)
        for offsets, largest in ((positions[:, :n], 0.1 * problem.table.width), (positions[:, n:], 10.0)):
            shares = np.abs(offsets).max(axis=1) / largest
            assert shares.max() <= 1.0 + 1e-12
            assert distance_from_uniform(shares ** (1 / power)) < 1.63 / math.sqrt(count)


@kinds
@pytest.mark.parametrize("num_waypoints", [15, 31])
def test_bends_are_far_smoother_than_uniform_members(bends, num_waypoints):
    problem = AnalyticProblem(OPEN, num_waypoints)
    bent, _, _ = drawn(problem, Source(1.0, 0.5, bends), 200)
    uniform, _, _ = drawn(problem, Source(), 200)
    assert np.median(second_differences(bent)) < 0.1 * np.median(second_differences(uniform))
    assert second_differences(bent).max() < 0.5 * second_differences(uniform).min()


@kinds
def test_bends_lie_on_both_sides_of_the_line_and_cross_it(bends):
    positions, _, _ = drawn(AnalyticProblem(OPEN, 15), Source(1.0, 0.5, bends), 1000)
    assert abs((positions[:, 7] > 0).mean() - 0.5) < 0.05
    crossing = (positions.min(axis=1) < 0) & (positions.max(axis=1) > 0)
    assert 0.2 < crossing.mean() < 0.95


@kinds
@pytest.mark.parametrize(
    "problem",
    [
        problem_of("random", 7),
        problem_of("random", 1, 5),
        make_problem("case2", 31),
        small_grid_problem("waypoints", 5),
        small_grid_problem("bezier", 3, seed=2),
    ],
    ids=["random", "one waypoint", "case2", "polyline", "curve"],
)
def test_bends_of_the_largest_amplitude_stay_inside_the_bounds(problem, bends):
    positions, _, _ = drawn(problem, Source(1.0, 1.0, bends), 300)
    low, high = problem.bounds
    assert (low <= positions).all()
    assert (positions <= high).all()
    assert ((positions == low) | (positions == high)).any()  # so that the bounds mattered


@kinds
@pytest.mark.parametrize("angle", [0.0, 0.3, 1.7, math.pi])
def test_control_points_of_curves_are_displaced_across_the_line(bends, angle):
    problem = grid_problem(open_grid(angle))
    offsets_problem = grid_problem(open_grid(angle), "waypoints")
    source = Source(1.0, 0.2, bends)
    positions, _, _ = drawn(problem, source, 50)
    start, target = np.array(problem.scenario.start), np.array(problem.scenario.target)
    way = target - start
    line = shapely.LineString([start - 10 * way, target + 10 * way])
    extent = problem.table.width
    assert extent == pytest.approx(offsets_problem.table.width)
    largest = []
    for position in positions:
        points = shapely.points(position.reshape(2, -1).T)
        distances, feet = shapely.distance(points, line), shapely.line_locate_point(line, points)
        places = (feet - 10 * np.linalg.norm(way)) / np.linalg.norm(way)
        np.testing.assert_allclose(places, np.arange(1, 5) / 5, atol=1e-9)
        assert distances.max() <= 0.2 * extent * (1 + 1e-12)
        largest.append(distances.max())
    assert max(largest) > 0.15 * extent


@kinds
def test_curves_and_polylines_of_the_same_numbers_have_the_same_offsets(bends):
    """Eight components and more than that advance the stream differently, so both have fewer."""
    scenario, source = open_grid(0.4), Source(1.0, 0.2, bends)
    curves, _, _ = drawn(grid_problem(scenario, num_points=3), source, 20)
    offsets, _, _ = drawn(grid_problem(scenario, "waypoints", 3), source, 20)
    line = shapely.LineString([scenario.start, scenario.target])
    for curve, offset in zip(curves, offsets, strict=True):
        points = shapely.points(curve.reshape(2, -1).T)
        np.testing.assert_allclose(shapely.distance(points, line), np.abs(offset), atol=1e-9)


@kinds
@pytest.mark.parametrize("amplitude", [0.01, 1.0])
def test_bends_are_the_naive_ones_at_both_ends_of_the_amplitude(bends, amplitude):
    problem, source = problem_of("random", 6), Source(1.0, amplitude, bends)
    positions, _, _ = drawn(problem, source, 30)
    np.testing.assert_allclose(positions, naively_drawn(problem, source, 30)[0], rtol=1e-9, atol=1e-9)
