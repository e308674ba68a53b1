"""Grid maps that grow by a margin, against distances of areas by shapely."""

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from helpers.grids import area_of, frozen, grid
from helpers.robot_maps import door_map, office_map
from swarm_gym.errors import NoPathError, ScenarioError
from swarm_gym.scenarios import GridMap, GridScenario, grown

SEEDS = st.integers(0, 2**32 - 1)


@given(seed=SEEDS)
@settings(max_examples=10, deadline=None)
def test_a_small_cell_is_blocked_exactly_if_a_point_of_it_is_too_close(seed):
    rng = np.random.default_rng(seed)
    blocked = rng.random(rng.integers(3, 15, 2)) < 0.1
    blocked[0, :2] = False
    resolution = float(rng.choice([0.05, 1.0, 2.0]))
    cells = float(rng.choice([0.25, 0.5, 1.0]) if rng.random() < 0.5 else rng.uniform(0.1, 2.0))
    made = GridMap("made", frozen(blocked), resolution, (3.0, -1.0), y_up=bool(rng.integers(2)))
    ends = made.to_map([(-0.4, 0.0), (1.4, 0.0)])
    assume(blocked.any())
    try:
        small = grown(GridScenario("made", made, *map(tuple, ends.tolist())), cells * resolution).map
    except ScenarioError:  # an end is too close, or there is no path
        assume(False)
    rows, columns = (part.ravel() for part in np.indices(small.blocked.shape))
    low, high = (
        made.to_cells(small.to_map(np.stack([columns + side, rows + side], axis=-1))) for side in (-0.5, 0.5)
    )
    assert low.min() == pytest.approx(-0.5)
    assert high.max(axis=0) == pytest.approx(np.array(blocked.shape[::-1]) - 0.5)
    distances = shapely.distance(shapely.box(*low.T, *high.T), area_of(blocked))
    points = shapely.points(made.to_cells(ends))
    opened = shapely.distance(shapely.box(*low.T, *high.T)[:, None], points) < 2.0 * cells + 2.0
    sure = (np.abs(distances - cells) > 1e-9) & ~opened.any(axis=1)
    near_an_end = small.blocked.ravel() <= (distances < cells + 1e-9)
    np.testing.assert_array_equal(small.blocked.ravel()[sure], (distances < cells)[sure])
    assert near_an_end.all()


def is_open(cells, margin):
    """Return whether a door of so many cells of 0.05 m is open on the grown map."""
    try:
        grown(GridScenario("door", door_map(cells), (-1.5, 0.2), (1.5, 0.2)), margin)
    except NoPathError:
        return False
    return True


@pytest.mark.parametrize("cells", [5, 9, 10, 12])
def test_a_door_is_open_that_is_wider_than_the_robot_by_a_cell_over_eight_parts(cells):
    """Three small cells are needed at most, of which a side of a cell has eight."""
    width = 0.05 * cells
    for share in (3.0 / 8.0, 0.5, 0.9):
        assert is_open(cells, (width - 0.05 * share) / 2.0 - 1e-9)
    assert not is_open(cells, width / 2.0)
    assert not is_open(cells, width / 2.0 - 1e-4)


def test_doors_that_are_hardly_wider_than_the_robot_are_open():
    assert is_open(9, 0.22)
    assert is_open(10, 0.22)
    office = GridScenario("office", office_map(), (-1.0, 0.8), (15.2, 11.0))
    assert grown(office, 0.25).map.blocked.shape == office.map.blocked.shape


@pytest.mark.parametrize("end", [(1.0, 0.62), (1.3, 0.6), (1.4, 0.6), (2.6, 1.6)])
def test_an_end_that_keeps_the_margin_is_open_though_its_small_cell_does_not(end):
    room = np.zeros((20, 20), dtype=np.bool_)
    room[[0, -1]] = room[:, [0, -1]] = True
    room[1, 3:5] = True
    made = GridMap("room", room, 1.0, (-0.5, -0.5))  # walls end at 0 and begin at 18
    scenario = GridScenario("room", made, end, (15.0, 9.0))
    small = grown(scenario, 0.6).map
    assert small.is_free(small.cell_of(end))


def test_an_end_that_is_too_close_is_refused_with_its_distance():
    scenario = GridScenario("door", door_map(10), (-1.5, 0.2), (0.15, 1.5))
    message = r"target \(0.15, 1.5\) is 0.1 from the nearest blocked cell, expected at least 0.22; choose"
    with pytest.raises(ScenarioError, match=message):
        grown(scenario, 0.22)


def test_small_cells_along_a_known_way_are_open():
    scenario = GridScenario("door", door_map(10), (-1.5, 0.2), (1.5, 0.2))
    with pytest.raises(NoPathError, match=r"obstacles have grown by 0.25"):
        grown(scenario, 0.25)
    way = np.array([scenario.start, (0.0, 0.225), (0.05, 0.225), scenario.target])
    small = grown(scenario, 0.25, way).map
    along = np.concatenate([np.linspace(*pair, 500) for pair in pairwise(way)])
    assert all(small.is_free(small.cell_of(tuple(point))) for point in along.tolist())


def test_a_map_without_blocked_cells_does_not_grow():
    scenario = GridScenario("empty", GridMap("empty", grid("...")), (0.0, 0.0), (2.0, 0.0))
    assert grown(scenario, 5.0) == scenario


def test_small_cells_are_few_on_large_maps():
    large = np.zeros((2048, 2048), dtype=np.bool_)
    large[1000, 1000] = True
    scenario = GridScenario("large", GridMap("large", large), (2.0, 2.0), (5.0, 5.0))
    assert grown(scenario, 0.1).map.blocked.size == large.size
    assert math.isclose(grown(scenario, 3.0).map.resolution, 1.0)
