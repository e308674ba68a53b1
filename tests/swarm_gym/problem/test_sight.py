"""Sight on grid maps, which jumps, against the traversal, which does not."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_traversal import lattice_points, points_anywhere

from helpers.builders import random_grid_scenario
from helpers.compiled import compiled
from helpers.grids import frozen, grid, grids
from swarm_gym.problem.geometry.sight import (
    cast_shadow,
    hidden_at,
    is_in_shadow,
    sees,
    share_blocked,
    tabulate_rooms,
)
from swarm_gym.problem.geometry.traversal import blocked_share, segment_is_free

SIDE = 24


@st.composite
def open_grids(draw):
    """A few blocked rectangles, with corners that touch, on a map with room between them."""
    blocked = np.zeros((draw(st.integers(9, SIDE)), draw(st.integers(9, SIDE))), np.bool_)
    side = st.integers(0, SIDE)
    for row, column in draw(st.lists(st.tuples(side, side), max_size=6)):
        height, width = draw(st.integers(1, 9)), draw(st.integers(1, 9))
        blocked[row : row + height, column : column + width] = True
        blocked[row + height : row + height + 2, column + width : column + width + 2] = True
    return frozen(blocked)


maps = st.one_of(grids(), open_grids()).filter(lambda blocked: not blocked.all())
points = st.one_of(lattice_points(SIDE), points_anywhere(SIDE))


def assert_as_traversed(blocked, p, q):
    rooms = tabulate_rooms(blocked)
    assert compiled(sees)(blocked, rooms, *p, *q) == segment_is_free(blocked, *p, *q)
    expected = compiled(blocked_share)(blocked, *p, *q, 1.0)
    share = compiled(share_blocked)(blocked, rooms, *p, *q)
    assert share == pytest.approx(expected, abs=1e-9)
    assert (share == 0.0) == (expected == 0.0)
    assert 0.0 <= share <= 1.0


@settings(deadline=None)
@given(maps, points, points)
def test_segments_are_free_and_blocked_as_the_traversal_says(blocked, p, q):
    assert_as_traversed(blocked, p, q)


@settings(deadline=None)
@given(maps, st.data())
def test_sight_through_corners_and_along_edges_of_blocked_cells_is_that_of_traversal(blocked, data):
    """Check segments for which free and blocked are a rounding error apart."""
    height, width = blocked.shape
    corner = st.tuples(st.integers(0, width), st.integers(0, height)).map(
        lambda at: (at[0] - 0.5, at[1] - 0.5)
    )
    (x, y), (dx, dy) = data.draw(corner), data.draw(st.tuples(*[st.integers(-9, 9)] * 2))
    before, after = data.draw(st.integers(0, 3)), data.draw(st.integers(1, 3))
    assert_as_traversed(blocked, (x - before * dx, y - before * dy), (x + after * dx, y + after * dy))


@pytest.mark.parametrize("seed", range(3))
def test_sight_on_a_larger_map_is_that_of_traversal(seed):
    blocked = random_grid_scenario(seed, (80, 120), rock=0.2).map.blocked
    rooms = tabulate_rooms(blocked)
    ends = np.random.default_rng(seed).uniform(-0.5, (119.5, 79.5, 119.5, 79.5), (3000, 4))
    found = [compiled(sees)(blocked, rooms, *pair) for pair in ends]
    assert found == [segment_is_free(blocked, *pair) for pair in ends]
    assert 0 < sum(found) < len(found)


@settings(deadline=None)
@given(maps)
def test_rooms_are_cells_around_of_the_same_kind(blocked):
    height, width = blocked.shape
    ringed = np.pad(blocked, SIDE + 2, constant_values=True)
    for (row, column), room in np.ndenumerate(tabulate_rooms(blocked)):
        around = room if room >= 0 else -1 - room
        centre = row + SIDE + 2, column + SIDE + 2
        for reach, are_alike in ((around, True), (around + 1, False)):
            window = ringed[
                max(centre[0] - reach, 0) : centre[0] + reach + 1,
                max(centre[1] - reach, 0) : centre[1] + reach + 1,
            ]
            assert (window == blocked[row, column]).all() == are_alike
    assert (tabulate_rooms(blocked) < 0).tolist() == blocked.tolist()
    assert (height, width) == tabulate_rooms(blocked).shape


@settings(deadline=None)
@given(maps, points, points, points, points)
def test_whoever_looks_through_a_shadow_sees_nothing(blocked, p, q, r, s):
    """Check also that a blocked cell hides whatever is not seen, and may cast a shadow."""
    rooms, shadow = tabulate_rooms(blocked), np.full(3, -1.0)
    share = compiled(hidden_at)(blocked, rooms, *p, *q)
    assert (share < 0.0) == segment_is_free(blocked, *p, *q)
    assert not compiled(is_in_shadow)(shadow, *p, *q)
    if share >= 0.0:
        compiled(cast_shadow)(rooms, *(a + share * (b - a) for a, b in zip(p, q, strict=True)), shadow)
        if compiled(is_in_shadow)(shadow, *r, *s):
            assert not segment_is_free(blocked, *r, *s)


def test_a_block_hides_what_is_behind_it_and_its_shadow_says_so():
    blocked = grid(*["........................"] * 8, *["......############......"] * 8, *["." * 24] * 8)
    rooms, shadow = tabulate_rooms(blocked), np.full(3, -1.0)
    share = compiled(hidden_at)(blocked, rooms, 11.0, 1.0, 12.0, 22.0)
    assert 0.3 < share < 0.7
    compiled(cast_shadow)(rooms, 11.0 + share, 1.0 + 21.0 * share, shadow)
    assert shadow[2] > 2.0
    assert compiled(is_in_shadow)(shadow, 10.0, 2.0, 13.0, 20.0)
    assert not compiled(is_in_shadow)(shadow, 2.0, 2.0, 2.0, 20.0)
    assert compiled(hidden_at)(blocked, rooms, 2.0, 2.0, 2.0, 20.0) == -1.0
    assert compiled(share_blocked)(blocked, rooms, 11.0, 1.0, 11.0, 21.0) == pytest.approx(8 / 20)


def test_everything_outside_the_map_is_blocked():
    blocked = frozen(np.zeros((12, 12), np.bool_))
    rooms = tabulate_rooms(blocked)
    assert compiled(sees)(blocked, rooms, -0.5, -0.5, 11.5, 11.5)
    assert not compiled(sees)(blocked, rooms, 5.0, 5.0, 5.0, 11.6)
    assert not compiled(sees)(blocked, rooms, -math.pi, 5.0, 15.0, 5.0)
    assert compiled(share_blocked)(blocked, rooms, 5.5, -12.5, 5.5, 11.5) == pytest.approx(0.5)


def test_a_jump_does_not_end_in_a_closed_gap():
    """Check two rooms that touch at a corner, where the free cells around a point end."""
    blocked = np.ones((10, 10), np.bool_)
    blocked[:5, :5] = blocked[5:, 5:] = False
    rooms = tabulate_rooms(frozen(blocked))
    assert rooms[2, 2] == 2
    for p, q in (((2.0, 2.0), (7.0, 7.0)), ((1.0, 1.0), (8.0, 8.0)), ((2.5, 1.5), (6.5, 7.5))):
        assert not compiled(sees)(blocked, rooms, *p, *q)
        assert not compiled(sees)(blocked, rooms, *q, *p)
        assert not segment_is_free(blocked, *p, *q)
        assert compiled(share_blocked)(blocked, rooms, *p, *q) == 0.0
