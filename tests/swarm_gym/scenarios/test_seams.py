"""Seams: what lies between two obstacles that share an edge is closed, checked by shapely's union."""

import numpy as np
import pytest
import shapely

from helpers.loops import looped
from helpers.shapes import shape
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.problem import AnalyticProblem
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import Circle, Polygon, Scenario

WORKSPACE = (-20.0, -20.0, 30.0, 20.0)
LOWER, UPPER = Polygon.rectangle(3, -5, 6, 0), Polygon.rectangle(3, 0, 6, 5)


def scenario_of(*obstacles, start=(0.0, 0.0), target=(9.0, 0.0)):
    return Scenario("seams", start, target, obstacles, WORKSPACE)


def union_of(obstacles):
    return shapely.union_all([shape(obstacle, 256) for obstacle in obstacles])


@pytest.mark.parametrize(
    ("obstacles", "count"),
    [
        ((LOWER, UPPER), 1),
        ((UPPER, LOWER), 1),
        ((LOWER, Polygon.rectangle(4, 0, 5, 5)), 1),
        ((LOWER, Polygon.rectangle(5, 0, 12, 5)), 1),
        ((LOWER, Polygon.rectangle(3, 1e-12, 6, 5)), 1),
        ((LOWER, Polygon.rectangle(3, 1e-6, 6, 5)), 0),
        ((LOWER, Polygon.rectangle(6, 0, 12, 5)), 0),
        ((LOWER, Polygon.rectangle(3, -1, 6, 5)), 0),
        ((LOWER, Polygon.rectangle(4, -4, 5, 0)), 0),
        ((Circle(3, 0, 1), Circle(5, 0, 1), LOWER), 0),
        ((LOWER, UPPER, Polygon.rectangle(6, -5, 8, 5)), 3),
    ],
)
def test_only_shared_edges_have_seams(obstacles, count):
    scenario = scenario_of(*obstacles, start=(-9.0, 9.0), target=(9.0, 9.0))
    seams = scenario.solids[len(obstacles) :]
    assert len(seams) == count
    union = union_of(obstacles)
    for seam in seams:
        assert shape(seam, 4).difference(union.buffer(1e-9)).is_empty


def test_no_path_leads_along_a_shared_edge():
    length, path = shortest_path(scenario_of(LOWER, UPPER))
    assert length == pytest.approx(2.0 * np.hypot(3.0, 5.0) + 3.0, rel=1e-12)
    assert not shapely.LineString(path).relate_pattern(union_of((LOWER, UPPER)), "T********")
    straight = AnalyticProblem(scenario_of(LOWER, UPPER), num_waypoints=8)
    assert straight.evaluate(np.zeros(8))[1] > 0.1
    assert not straight.is_clear(straight.points(np.zeros(8)))


def test_a_path_may_pass_through_a_point_where_obstacles_touch():
    corners = scenario_of(Polygon.rectangle(3, -5, 5, 0), Polygon.rectangle(5, 0, 7, 5))
    assert shortest_path(corners)[0] == 9.0
    circles = scenario_of(Circle(4.5, 2.0, 2.0), Circle(4.5, -2.0, 2.0))
    assert shortest_path(circles)[0] == 9.0
    problem = AnalyticProblem(circles, num_waypoints=8)
    assert problem.evaluate(np.zeros(8))[1] == 0.0


def test_walls_that_share_edges_all_around_separate_the_ends():
    frame = [(-2, 2, 2, 3), (-2, -3, 2, -2), (-3, -3, -2, 3), (2, -3, 3, 3)]
    with pytest.raises(NoPathError, match="separate"):
        shortest_path(scenario_of(*(Polygon.rectangle(*box) for box in frame)))


def test_an_end_on_a_shared_edge_is_refused():
    with pytest.raises(ScenarioError, match=r"start \(4.0, 0.0\) lies between obstacles"):
        scenario_of(LOWER, UPPER, start=(4.0, 0.0))
    assert scenario_of(LOWER, UPPER, start=(3.0, 0.0)).solids


@looped("seed", range(20))
def test_random_triangulations_are_as_closed_as_the_polygon(seed):
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, rng.integers(5, 12)))
    radii = rng.uniform(1.0, 5.0, len(angles))
    whole = shapely.Polygon(np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=-1)).buffer(0)
    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(whole))
    pieces = [Polygon(tuple(map(tuple, np.array(part.exterior.coords)[:3].tolist()))) for part in parts]
    scenario = scenario_of(*pieces, start=(-9.0, 0.0), target=(9.0, 0.0))
    problem = AnalyticProblem(scenario, num_waypoints=15)
    inside = whole.buffer(-1e-7)
    for edge in shapely.get_parts(shapely.delaunay_triangles(whole, only_edges=True)):
        begin, end = np.array(edge.coords)
        expected = not edge.intersects(inside)
        if edge.difference(whole.buffer(1e-7)).is_empty or expected:
            assert problem.is_clear(np.array([begin, end])) == expected
    for _ in range(200):
        offsets = rng.uniform(-6.0, 6.0, 15)
        entered = shapely.LineString(problem.points(offsets)).intersects(inside)
        assert (problem.evaluate(offsets)[1] > 1e-9) >= entered
