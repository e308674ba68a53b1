"""Polygons grow exactly: compared with shapely's buffers, and by paths among grown polygons."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.builders import random_polygon
from helpers.shapes import shape
from swarm_gym.errors import ScenarioError
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import Circle, Polygon, Scenario, grown

SEEDS = st.integers(0, 2**32 - 1)
FINE = 512  # segments per quarter of shapely's circles
WIDE = (-300.0, -300.0, 300.0, 300.0)


def among(*obstacles, margin=0.0):
    made = Scenario("made", (-250.0, 0.0), (250.0, 0.0), obstacles, WIDE)
    return made if margin == 0.0 else grown(made, margin)


def clusters(seed, count=4):
    """Polygons around the straight line; neighbours may overlap."""
    rng = np.random.default_rng(seed)
    centres = [(x, rng.normal(0.0, 30.0)) for x in np.linspace(-150.0, 150.0, count)]
    return [random_polygon(rng, centre, rng.uniform(10.0, 60.0)) for centre in centres]


@settings(max_examples=12, deadline=None)
@given(seed=SEEDS, margin=st.floats(1e-3, 100.0))
def test_a_grown_polygon_is_what_a_disc_around_its_points_covers(seed, margin):
    before = random_polygon(np.random.default_rng(seed), (0.0, 0.0), 50.0)
    after = among(before, margin=margin).obstacles
    outline, *rounds = after
    assert len(outline.vertices) == 2 * len(before.vertices)
    assert rounds == [Circle(x, y, margin) for x, y in before.vertices]
    exact = shapely.Polygon(before.vertices).buffer(margin, quad_segs=FINE)
    made = shapely.union_all([shape(obstacle, FINE) for obstacle in after])
    sag = margin * (1.0 - math.cos(math.pi / (4 * FINE)))
    assert shapely.hausdorff_distance(exact, made) <= 2.0 * sag + 1e-9


def test_corners_that_polygons_share_have_one_circle():
    houses = [Polygon.rectangle(x, -5.0, x + 10.0, 5.0) for x in (0.0, 10.0, 20.0)]
    after = among(*houses, margin=2.0).obstacles
    assert [type(obstacle) for obstacle in after].count(Circle) == 8
    assert len(after) == len(set(after)) == 11
    assert after == among(*houses, houses[1], margin=2.0).obstacles


@settings(max_examples=100, deadline=None)
@given(seed=SEEDS, bend=st.floats(-17.0, -6.0), margin=st.floats(-4.0, 3.0), far=st.booleans())
def test_polygons_grow_where_they_hardly_bend(seed, bend, margin, far):
    """Moved ends of edges are so close to each other there that rounding decides how the outline turns."""
    rng = np.random.default_rng(seed)
    angles, offset, margin = np.sort(rng.uniform(0.0, math.tau, 5)), 4e6 * far, 10.0**margin
    around = 50.0 * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    ahead = np.roll(around, -1, axis=0) - around
    between = around + 0.5 * ahead + 10.0**bend * np.stack([ahead[:, 1], -ahead[:, 0]], axis=-1)
    corners = np.stack([around, between], axis=1).reshape(-1, 2) + offset
    try:
        before = Polygon(tuple(map(tuple, corners.tolist())))
    except ScenarioError:
        before = Polygon(tuple(map(tuple, (around + offset).tolist())))
    grown_outline = grown(Scenario("far", (1e3, 9e6), (9e6, 1e3), (before,), (0.0, 0.0, 1e7, 1e7)), margin)
    outline = shapely.Polygon(np.array(grown_outline.obstacles[0].vertices) - offset)
    for one, other in before.edges():
        side = np.subtract(other, one)
        out = margin * np.array([side[1], -side[0]]) / np.linalg.norm(side)
        ends = np.array([one, other]) + out - offset
        assert shapely.distance(outline, shapely.points(ends)).max() <= 1e-12 * (50.0 + margin) + 1e-8 * far


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, margin=st.floats(1.0, 40.0))
def test_paths_are_feasible_exactly_if_they_keep_the_margin(seed, margin):
    polygons = clusters(seed)
    problem = AnalyticProblem(among(*polygons, margin=margin), 16)
    area = shapely.union_all([shapely.Polygon(polygon.vertices) for polygon in polygons])
    rng = np.random.default_rng(seed)
    seen = set()
    for height in (*np.linspace(-140.0, 140.0, 57), *rng.uniform(-140.0, 140.0, 20)):
        bends = rng.normal(0.0, 10.0, 16) * (rng.random() < 0.5)
        offsets = np.clip(height + bends, *problem.bounds)
        distance = shapely.LineString(problem.points(offsets)).distance(area)
        feasible = problem.evaluate(offsets)[1] <= FEASIBILITY_TOLERANCE
        if abs(distance - margin) > 1e-6:
            assert feasible is bool(distance > margin)
        seen.add(feasible)
    assert False in seen


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, margin=st.floats(1.0, 40.0))
def test_the_shortest_path_among_grown_polygons_keeps_the_margin_and_touches_it(seed, margin):
    polygons = clusters(seed)
    length, points = shortest_path(among(*polygons, margin=margin))
    path = shapely.LineString(points)
    distance = path.distance(shapely.union_all([shapely.Polygon(p.vertices) for p in polygons]))
    assert distance >= margin - 1e-9
    assert length == 500.0 or distance == pytest.approx(margin, rel=1e-9)
    assert length - 1e-9 <= path.length <= length * (1.0 + 1e-5)


def test_the_shortest_path_around_a_grown_square_is_that_of_its_closed_form():
    square = Polygon.rectangle(-10.0, -10.0, 10.0, 30.0)
    length, _ = shortest_path(among(square, margin=5.0))
    # Below: a tangent to the circle at a corner, an arc, along the lower edge, and the same again.
    across, down = 240.0, 10.0
    distance = math.hypot(across, down)
    arc = math.atan2(down, across) + math.asin(5.0 / distance)
    expected = 2.0 * (math.sqrt(distance**2 - 25.0) + 5.0 * arc + 10.0)
    assert length == pytest.approx(expected, rel=1e-12)
