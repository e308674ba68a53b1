import itertools
import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from helpers.loops import looped
from helpers.refusals import refused
from swarm_gym.errors import ScenarioError, UnknownNameError
from swarm_gym.scenarios import (
    SCENARIOS,
    Circle,
    Polygon,
    Scenario,
    make_scenario,
    make_scenarios,
    sample_names,
)

FROM, TO = (20.0, 300.0), (980.0, 300.0)
NAN, INF = math.nan, math.inf


def scenario(start=FROM, target=TO, obstacles=(), **options):
    return Scenario("made", start, target, obstacles, **options)


def circles(case):
    return [(o.x, o.y, o.radius) for o in make_scenario(case).obstacles if isinstance(o, Circle)]


def rectangles(case):
    """Return (x_min, y_min, x_max, y_max) of the polygons, all of which have to be rectangles."""
    found = []
    for obstacle in make_scenario(case).obstacles:
        if isinstance(obstacle, Polygon):
            xs, ys = (sorted({x for x, _ in obstacle.vertices}), sorted({y for _, y in obstacle.vertices}))
            assert set(obstacle.vertices) == set(itertools.product(xs, ys))
            found.append((xs[0], ys[0], xs[-1], ys[-1]))
    return found


def checksums(shapes):
    """Return sums, and sums weighted by position in the list, which reveal that two entries are swapped."""
    return (
        [sum(column) for column in zip(*shapes, strict=True)],
        [sum(k * v for k, v in enumerate(column, 1)) for column in zip(*shapes, strict=True)],
    )


# The three cases as printed in the SPSFA paper.


@pytest.mark.parametrize(
    ("case", "shapes", "number", "some", "sums", "weighted_sums"),
    [
        ("case1", circles, 14, {0: (100, 250, 40), 7: (500, 320, 80), 13: (860, 280, 40)},
         [6680, 4100, 710], [63440, 30380, 5330]),
        ("case1", rectangles, 0, {}, [], []),
        ("case2", circles, 0, {}, [], []),
        ("case2", rectangles, 15,
         {0: (100, 260, 130, 380), 7: (490, 120, 520, 260), 14: (900, 280, 930, 380)},
         [7070, 3740, 7520, 5510], [72530, 30140, 76200, 45150]),
        ("case3", circles, 5, {0: (100, 280, 40), 4: (820, 320, 40)}, [2430, 1690, 240], [8990, 5200, 710]),
        ("case3", rectangles, 10, {0: (200, 150, 230, 270), 9: (900, 300, 930, 400)},
         [5430, 2590, 5750, 3770], [36760, 14880, 38580, 21200]),
    ],
)  # fmt: skip
def test_the_cases_have_the_printed_circles_and_rectangles(case, shapes, number, some, sums, weighted_sums):
    found = shapes(case)
    assert len(found) == number
    assert {position: found[position] for position in some} == some
    assert checksums(found) == (sums, weighted_sums)


@pytest.mark.parametrize("case", ["case1", "case2", "case3"])
def test_the_cases_have_the_printed_start_target_and_workspace(case):
    made = make_scenario(case)
    assert made.name == case
    assert len(made.obstacles) == len(circles(case)) + len(rectangles(case))
    assert made.start == (20, 300)
    assert made.target == (980, 300)
    assert made.workspace == (0, 0, 1000, 600)
    assert made.straight_line == 960
    # y in [120, 480], from the line at y = 300.
    assert made.initial_range == (-180, 180)


@pytest.mark.parametrize("name", sample_names())
def test_a_registered_scenario_is_filed_under_its_name_and_equal_each_time(name):
    made = make_scenario(name)
    assert made.name == name
    assert made == make_scenario(name)
    assert hash(made) == hash(make_scenario(name))
    assert make_scenarios(name) == (made,)


@pytest.mark.parametrize("name", ["case4", "", "CASE1", None, ["case1"], 3])
def test_an_unknown_name_is_refused_with_the_valid_ones(name):
    with pytest.raises(UnknownNameError) as caught:
        make_scenario(name)
    assert repr(name) in str(caught.value)
    assert {*SCENARIOS} <= {*caught.value.valid}


# Errors: the message names the part and its value.


@pytest.mark.parametrize("radius", [0, 0.0, -0.0, -1, -1e-300])
def test_a_radius_that_is_not_positive_is_refused(radius):
    refused(lambda: Circle(1, 2, radius), "radius", repr(radius), "x=1")


@looped("position", [0, 1, 2])
@pytest.mark.parametrize("value", [NAN, INF, -INF, None, "wide"])
def test_a_circle_of_other_than_finite_numbers_is_refused(position, value):
    numbers = [1.0, 2.0, 3.0]
    numbers[position] = value
    refused(lambda: Circle(*numbers), "Circle", repr(value))


@pytest.mark.parametrize("value", [NAN, INF, -INF])
@looped("vertex", [0, 2])
@looped("axis", [0, 1])
def test_a_polygon_with_a_coordinate_that_is_not_finite_is_refused(value, vertex, axis):
    vertices = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    vertices[vertex][axis] = value
    refused(lambda: Polygon(tuple(map(tuple, vertices))), "Polygon", repr(value))


@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_polygon_needs_three_vertices(count):
    vertices = ((0.0, 0.0), (7.0, 5.0))[:count]
    refused(lambda: Polygon(vertices), "at least 3 vertices", f"got {count}", repr(vertices))


@pytest.mark.parametrize(
    "vertices",
    [
        ((0, 0), (5, 0), (5, 5), (5, 5), (0, 5)),  # twice in a row
        ((0, 0), (5, 0), (5, 5), (0, 5), (0, 0)),  # closed explicitly
        ((0, 0), (5, 0), (0, 0), (0, 5)),
        ((0, 0), (5, 0), (-0.0, 0.0)),
    ],
)
def test_a_repeated_vertex_is_refused(vertices):
    refused(lambda: Polygon(vertices), "Polygon", "twice", repr(vertices))


@pytest.mark.parametrize(
    ("shape", "vertices"),
    [
        ("an arrowhead", ((0, 0), (4, -3), (2, 0), (4, 3))),
        ("a notch", ((0, 0), (6, 0), (6, 6), (3, 5), (0, 6))),
        ("an L", ((0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4))),
        ("three on a line", ((0, 0), (1, 1), (2, 2))),
        ("four on a line", ((0, 0), (1, 0), (3, 0), (2, 0))),
        ("a straight corner", ((0, 0), (2, 0), (4, 0), (4, 4), (0, 4))),
        ("a spike", ((0, 0), (4, 0), (4, 4), (8, 8), (0, 4))),
        ("a bowtie", ((0, 0), (4, 4), (4, 0), (0, 4))),
        ("a lopsided bowtie", ((0, 0), (6, 4), (4, 0), (0, 3))),
    ],
)
@pytest.mark.parametrize("clockwise", [False, True])
def test_a_polygon_that_is_not_strictly_convex_is_refused(shape, vertices, clockwise):
    given_in_order = vertices[::-1] if clockwise else vertices
    refused(lambda: Polygon(given_in_order), "Polygon", "not strictly convex at vertex")


@pytest.mark.parametrize(("points", "step"), [(5, 2), (7, 2), (7, 3), (5, 3), (11, 4)])
def test_a_star_turns_left_at_every_corner_and_is_refused(points, step):
    corners = [
        (100 * math.cos(math.tau * step * k / points), 100 * math.sin(math.tau * step * k / points))
        for k in range(points)
    ]
    refused(lambda: Polygon(tuple(corners)), "Polygon", "crosses itself")


@pytest.mark.parametrize(
    "extremes", [(5, 0, 5, 1), (0, 5, 1, 5), (3, 3, 3, 3), (2, 0, 1, 1), (0, 2, 1, 1), (0, 0, NAN, 1)]
)
def test_a_degenerate_rectangle_is_refused(extremes):
    values = ", ".join(str(value) for value in extremes)
    refused(lambda: Polygon.rectangle(*extremes), f"rectangle ({values})")


@pytest.mark.parametrize(
    "obstacle", [Circle(400, 300, 50), Polygon.rectangle(350, 250, 450, 350), Circle(400, 300.5, 0.6)]
)
@pytest.mark.parametrize("role", ["start", "target"])
def test_a_start_or_target_inside_an_obstacle_is_refused(obstacle, role):
    apart = Circle(700, 100, 10)
    refused(
        lambda: scenario(**{role: (400.0, 300.0)}, obstacles=(apart, obstacle)),
        "'made'",
        f"{role} (400.0, 300.0) lies inside obstacle 1",
        repr(obstacle),
    )


@pytest.mark.parametrize(
    ("obstacle", "point"),
    [
        (Circle(400, 300, 50), (450.0, 300.0)),
        (Circle(400, 300, 50), (430.0, 340.0)),
        (Polygon.rectangle(350, 250, 450, 350), (350.0, 300.0)),
        (Polygon.rectangle(350, 250, 450, 350), (450.0, 350.0)),
        (Polygon(((350, 250), (450, 300), (350, 350))), (400.0, 275.0)),
    ],
)
@pytest.mark.parametrize("role", ["start", "target"])
def test_a_start_or_target_may_touch_an_obstacle(obstacle, point, role):
    assert getattr(scenario(**{role: point}, obstacles=(obstacle,)), role) == point


@pytest.mark.parametrize("point", [(-1.0, 300.0), (1000.5, 300.0), (20.0, -0.1), (20.0, 601.0)])
@pytest.mark.parametrize("role", ["start", "target"])
def test_a_start_or_target_outside_the_workspace_is_refused(point, role):
    workspace = (0.0, 0.0, 1000.0, 600.0)
    refused(lambda: scenario(**{role: point}, workspace=workspace), f"{role} {point}", str(workspace))


def test_start_and_target_may_be_on_the_border_of_the_workspace_but_not_the_same():
    assert scenario((0.0, 0.0), (1000.0, 600.0)).straight_line == math.hypot(1000, 600)
    refused(lambda: scenario((5.0, 7.0), (5.0, 7.0)), "'made'", "start and target", "(5.0, 7.0)")


@pytest.mark.parametrize("value", [NAN, INF, -INF, None, "x"])
@pytest.mark.parametrize("part", ["start", "target", "workspace", "initial_range"])
def test_a_scenario_with_other_than_finite_numbers_is_refused(part, value):
    parts = {
        "start": (20.0, value),
        "target": (value, 300.0),
        "workspace": (0.0, 0.0, value, 600.0),
        "initial_range": (-10.0, value),
    }
    refused(lambda: scenario(**{part: parts[part]}), "'made'", repr(value))


@pytest.mark.parametrize(
    ("part", "message", "value"),
    [
        ("workspace", "workspace needs x_min < x_max", (0.0, 0.0, 0.0, 600.0)),
        ("workspace", "workspace needs x_min < x_max", (0.0, 0.0, 1000.0, 0.0)),
        ("workspace", "workspace needs x_min < x_max", (1000.0, 0.0, 0.0, 600.0)),
        ("workspace", "workspace needs x_min < x_max", (0.0, 600.0, 1000.0, 0.0)),
        ("initial_range", "initial_range", (5.0, 5.0)),
        ("initial_range", "initial_range", (1.0, -1.0)),
    ],
)
def test_an_empty_workspace_or_initial_range_is_refused(part, message, value):
    refused(lambda: scenario(**{part: value}), message, str(value))


@pytest.mark.parametrize("obstacle", [(100, 250, 40), None, "circle", 7, Circle])
def test_an_obstacle_of_another_type_is_refused(obstacle):
    refused(lambda: scenario(obstacles=(Circle(500, 100, 10), obstacle)), "obstacle 1", repr(obstacle))


@pytest.mark.parametrize(
    "make",
    [
        pytest.param(lambda: Polygon((("a", 0), (1, 0), (0, 1))), id="text in a vertex"),
        pytest.param(lambda: Polygon(((0, 0, 0), (1, 0), (0, 1))), id="vertex of three"),
        pytest.param(lambda: scenario(start=(20.0, 300.0, 0.0)), id="start of three"),
        pytest.param(lambda: scenario(start=(20.0,)), id="start of one"),
        pytest.param(lambda: scenario(workspace=(0.0, 0.0, 9.0)), id="workspace of three"),
        pytest.param(lambda: scenario(initial_range=(5.0,)), id="range of one"),
        pytest.param(lambda: scenario(start=[20, 300], target=(20, 300)), id="list and tuple"),
        pytest.param(lambda: Circle(1, 1, 10**400), id="radius beyond floats"),
        pytest.param(lambda: Polygon(None), id="no vertices"),
        pytest.param(lambda: scenario(obstacles=None), id="no obstacles"),
        pytest.param(lambda: scenario(start=None), id="no start"),
    ],
)
def test_a_part_of_the_wrong_shape_or_type_is_refused(make):
    refused(make)
    assert Polygon(((0, 0), (1, 0), (0, 1))).depth((0.2, 0.2)) == pytest.approx(0.2)
    assert scenario(start=[20, 300], workspace=[0, 0, 1000, 600], initial_range=[-5, 5]).start == (20, 300)


def test_parts_may_be_arrays_and_lists_and_a_scenario_is_returned_as_it_is():
    made = scenario(np.array(FROM), np.array(TO))
    assert made == scenario()
    assert hash(made) == hash(scenario())
    assert make_scenario(made) is made
    assert scenario(obstacles=[Circle(500, 100, 10)]) == scenario(obstacles=(Circle(500, 100, 10),))


# Convex polygons.

coordinates = st.tuples(st.integers(-50, 50), st.integers(-50, 50))


def hull(points):
    """Return the counter-clockwise corners of the convex hull of integer points, without straight corners."""
    shape = shapely.MultiPoint(points).convex_hull
    assume(shape.geom_type == "Polygon")
    ring = shapely.geometry.polygon.orient(shape.simplify(0)).exterior.coords[:-1]
    # `simplify` keeps the first point even where the outline is straight.
    (xa, ya), (xb, yb), (xc, yc) = ring[-1], ring[0], ring[1]
    if (xb - xa) * (yc - yb) == (yb - ya) * (xc - xb):
        ring = ring[1:]
    return tuple(ring)


@given(points=st.lists(coordinates, min_size=3, max_size=12), start=st.integers(0, 11))
@settings(deadline=None, derandomize=True)
def test_a_convex_polygon_is_accepted_in_either_direction_from_any_vertex(points, start):
    corners = hull(points)
    start %= len(corners)
    begun = corners[start:] + corners[:start]
    polygon = Polygon(begun)
    assert polygon.vertices == begun
    assert Polygon(begun[::-1]) == polygon


@given(points=st.lists(coordinates, min_size=4, max_size=9), order=st.randoms(use_true_random=False))
@settings(deadline=None, derandomize=True)
def test_the_vertices_of_a_convex_polygon_in_any_other_order_are_refused(points, order):
    corners = hull(points)
    shuffled = list(corners)
    order.shuffle(shuffled)
    begin = shuffled.index(corners[0])
    from_first = tuple(shuffled[begin:] + shuffled[:begin])
    assume(from_first not in (corners, corners[:1] + corners[:0:-1]))
    with pytest.raises(ScenarioError):
        Polygon(tuple(shuffled))


@given(points=st.lists(coordinates, min_size=3, max_size=12), point=coordinates)
@settings(deadline=None, derandomize=True)
def test_a_polygon_contains_what_lies_in_its_open_interior(points, point):
    corners = hull(points)
    expected = shapely.Polygon(corners).contains(shapely.Point(point))
    assert Polygon(corners).contains(point) == expected


@given(radius=st.integers(1, 60), point=coordinates)
@settings(deadline=None, derandomize=True)
def test_a_circle_contains_what_lies_in_its_open_disc(radius, point):
    inside = (point[0] - 3) ** 2 + (point[1] + 4) ** 2 < radius**2
    assert Circle(3, -4, radius).contains(point) == inside
