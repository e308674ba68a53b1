"""Segments on occupancy grids, against shapely and against exact fractions."""

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from helpers.compiled import compiled
from helpers.grids import area_of, frozen, grid, grids
from swarm_gym.problem.geometry.traversal import (
    TOLERANCE,
    blocked_length,
    is_gap,
    path_is_free,
    segment_is_free,
)

HALF = Fraction(1, 2)


def lattice_points(most=7):
    """Centres, corners and middles of edges, on the grid and around it."""
    halves = st.integers(-3, 2 * most + 3).map(lambda number: number / 2)
    return st.tuples(halves, halves)


def points_anywhere(most=7):
    coordinate = st.floats(-2.0, most + 2.0)
    return st.tuples(coordinate, coordinate)


def is_blocked(blocked, column, row):
    height, width = blocked.shape
    return not (0 <= column < width and 0 <= row < height) or bool(blocked[row, column])


def touches_free(blocked, x, y):
    return any(
        not is_blocked(blocked, column, row)
        for column in {math.floor(x + HALF), math.ceil(x + HALF) - 1}
        for row in {math.floor(y + HALF), math.ceil(y + HALF) - 1}
    )


def corner_is_gap(blocked, i, j):
    north_west, north_east = is_blocked(blocked, i - 1, j - 1), is_blocked(blocked, i, j - 1)
    south_west, south_east = is_blocked(blocked, i - 1, j), is_blocked(blocked, i, j)
    return north_west == south_east != north_east == south_west


def exact_pieces(blocked, p, q):
    """(blocked share, whether a gap is passed) of a segment, in fractions."""
    x, y, dx, dy = *map(Fraction, p), *(Fraction(b) - Fraction(a) for a, b in zip(p, q, strict=True))
    cuts = {Fraction(0), Fraction(1)}
    for start, change in ((x, dx), (y, dy)):
        if change:
            cuts |= {(line - HALF - start) / change for line in range(-5, 20)}
    inner = sorted(cut for cut in cuts if 0 <= cut <= 1)
    share = sum(
        end - begin
        for begin, end in pairwise(inner)
        if not touches_free(blocked, x + (begin + end) / 2 * dx, y + (begin + end) / 2 * dy)
    )
    passed = False
    for cut in inner[1:-1]:
        i, j = x + cut * dx + HALF, y + cut * dy + HALF
        passed |= i.denominator == j.denominator == 1 and corner_is_gap(blocked, int(i), int(j))
    return share, passed


@settings(deadline=None)
@given(grids(), lattice_points(), lattice_points())
def test_segments_between_corners_edges_and_centres_are_judged_as_in_fractions(blocked, p, q):
    share, passed = exact_pieces(blocked, p, q)
    inside = touches_free(blocked, Fraction(p[0]), Fraction(p[1])) if p == q else share == 0
    assert segment_is_free(blocked, *p, *q) == (inside and not passed)
    assert segment_is_free(blocked, *q, *p) == (inside and not passed)
    assert blocked_length(blocked, np.array([p, q])) == pytest.approx(
        float(share) * math.dist(p, q), abs=1e-12
    )


@settings(deadline=None)
@given(grids(), lattice_points(), lattice_points())
def test_segments_are_free_where_shapely_covers_them_and_no_gap_is_passed(blocked, p, q):
    covered = area_of(~blocked).covers(shapely.LineString([p, q]) if p != q else shapely.Point(p))
    assert segment_is_free(blocked, *p, *q) == (covered and not exact_pieces(blocked, p, q)[1])


@settings(deadline=None)
@given(grids(), st.lists(st.one_of(points_anywhere(), lattice_points()), min_size=2, max_size=5))
def test_blocked_length_is_that_of_what_shapely_leaves_outside_the_free_cells(blocked, points):
    """Up to the tolerance, over which a segment that is nearly along a wall may go on for long."""
    free = area_of(~blocked)
    least, most = (
        sum(shapely.LineString(ends).difference(room).length for ends in pairwise(points))
        for room in (free.buffer(margin, join_style="mitre") for margin in (2 * TOLERANCE, 1e-3 * TOLERANCE))
    )
    assert least - 1e-6 <= blocked_length(blocked, np.array(points)) <= most + 1e-6


@settings(deadline=None)
@given(grids(), points_anywhere(), points_anywhere())
def test_what_enters_blocked_cells_clearly_is_not_free_and_what_stays_off_them_is(blocked, p, q):
    assume(math.dist(p, q) > 1e-9)  # in some versions of GEOS nothing covers a shorter line
    free, line = area_of(~blocked), shapely.LineString([p, q])
    if free.buffer(-1e-6, join_style="mitre").covers(line):
        assert segment_is_free(blocked, *p, *q)
    if not free.buffer(1e-6, join_style="mitre").covers(line):
        assert not segment_is_free(blocked, *p, *q)


@settings(deadline=None)
@given(grids(), st.integers(-1, 8), st.integers(-1, 8))
def test_gaps_are_where_two_blocked_cells_touch_at_a_corner_and_the_others_are_free(blocked, i, j):
    assert compiled(is_gap)(blocked, i, j) == corner_is_gap(blocked, i, j)


DIAGONAL = grid(
    "...#",
    "..#.",
    ".#..",
    "....",
)


@pytest.mark.parametrize(
    ("ends", "free"),
    [
        (((0.0, 2.0), (0.5, 2.5)), True),  # up to the corner of one cell
        (((0.0, 2.0), (1.0, 3.0)), True),  # past it
        (((0.5, 0.5), (0.5, 3.5)), True),  # along one cell
        (((0.0, 0.0), (1.5, 1.5)), True),  # up to a gap
        (((1.5, 1.5), (3.0, 3.0)), True),  # away from it
        (((1.0, 1.0), (2.0, 2.0)), False),  # through it
        (((1.5, 0.5), (1.5, 2.5)), False),  # through it along the walls on both sides
        (((0.5, 1.5), (2.5, 1.5)), False),
        (((-0.5, -0.5), (-0.5, 3.5)), True),  # along the border
        (((2.5, -0.5), (3.5, -0.5)), False),  # along the border outside of a blocked cell
        (((-0.6, 0.0), (1.0, 0.0)), False),  # from outside
    ],
)
def test_walls_may_be_touched_and_gaps_not_passed(ends, free):
    (x0, y0), (x1, y1) = ends
    assert segment_is_free(DIAGONAL, x0, y0, x1, y1) == free
    assert segment_is_free(DIAGONAL, x1, y1, x0, y0) == free


def test_an_edge_between_two_blocked_cells_is_blocked():
    blocked = grid("....", ".##.", "....")
    assert not segment_is_free(blocked, 1.5, 0.0, 1.5, 2.0)
    assert not segment_is_free(blocked, 1.5, 0.5, 1.5, 1.5)
    assert blocked_length(blocked, np.array([[1.5, 0.0], [1.5, 2.0]])) == 1.0


@pytest.mark.parametrize("error", [0.0, 0.9 * TOLERANCE, -0.9 * TOLERANCE])
@pytest.mark.parametrize("wall", [0.5, 1.5])
def test_rounding_errors_of_a_path_along_a_wall_are_forgiven(wall, error):
    blocked = grid("...", ".#.", "...")
    assert segment_is_free(blocked, -0.5, wall + error, 2.5, wall + error)
    assert segment_is_free(blocked, -0.5, wall, 2.5, wall + error)
    assert segment_is_free(blocked, wall + error, -0.5, wall + error, 2.5)
    assert segment_is_free(blocked, wall, -0.5, wall + error, 2.5)
    assert not segment_is_free(blocked, 1.0, 0.0, 1.0, 0.5 + 1e-6)


@pytest.mark.parametrize("error", [0.9 * TOLERANCE, -0.9 * TOLERANCE])
def test_a_gap_is_not_passed_by_a_rounding_error(error):
    assert not segment_is_free(DIAGONAL, 1.0 + error, 1.0, 2.0, 2.0)


@pytest.mark.parametrize(
    ("points", "free"),
    [
        ([(0.0, 0.0), (1.0, 1.0), (0.0, 2.0)], True),
        ([(1.0, 1.0), (1.5, 1.5), (1.0, 0.0)], True),  # turns back in a gap
        ([(1.5, 0.5), (1.5, 1.5), (0.5, 1.5)], True),
        ([(1.0, 1.0), (1.5, 1.5), (2.0, 2.0)], False),  # passes it in two segments
        ([(1.5, 0.5), (1.5, 1.5), (2.5, 1.5)], False),
        ([(1.5, 0.5), (1.5, 1.5), (1.5, 1.5), (2.5, 1.5)], False),  # rests in between
        ([(0.5, 0.5), (1.25, 1.25), (1.375, 1.375)], True),  # turns before it
        ([(0.0, 0.0), (3.0, 0.0)], False),
        ([(3.0, 0.0)], False),
        ([(0.0, 0.0)], True),
    ],
)
def test_a_path_is_free_if_its_segments_are_and_it_does_not_turn_through_a_gap(points, free):
    for directed in (points, points[::-1]):
        assert path_is_free(DIAGONAL, np.array(directed)) == free
        assert (
            path_is_free(frozen(DIAGONAL[::-1].copy()), np.array(directed) * (1.0, -1.0) + (0.0, 3.0)) == free
        )


def test_far_and_infinite_points_are_outside():
    blocked = grid("..", "..")
    assert blocked_length(blocked, np.array([[0.0, 0.0], [1e12, 0.0]])) == pytest.approx(1e12)
    assert blocked_length(blocked, np.array([[-1e200, 7.0], [1e200, 7.0]])) == pytest.approx(2e200)
    for bad in (math.nan, math.inf):
        assert not segment_is_free(blocked, 0.0, 0.0, bad, 0.0)
        assert blocked_length(blocked, np.array([[0.0, 0.0], [bad, 0.0]])) == math.inf


def test_a_path_of_one_point_has_no_length():
    assert blocked_length(grid("#"), np.array([[0.0, 0.0]])) == 0.0
