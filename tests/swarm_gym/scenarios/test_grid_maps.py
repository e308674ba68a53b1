import copy
import itertools
import math
import os
import pickle

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from helpers.refusals import refused
from swarm_gym.problem import AnalyticProblem
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario, make_scenarios
from swarm_gym.scenarios.formats.data_files import data_folder, find_data_file
from swarm_gym.scenarios.grid_map import MAX_SIDE

NAN, INF = math.nan, math.inf

FLOOR = """
.....
.##..
...#.
"""

grids = arrays.arrays(np.bool_, st.tuples(st.integers(1, 7), st.integers(1, 7)))
checked = settings(deadline=None, derandomize=True)


def cells(drawing):
    """Return an array of blocked cells, drawn with '#' and '.'."""
    return np.array([[character == "#" for character in row] for row in drawing.split()])


def grid(drawing=FLOOR, **geometry):
    return GridMap("made", cells(drawing), **geometry)


def steps(blocked, cell):
    """Return the cells that a path without cut corners can reach from a free cell in one step."""
    height, width = blocked.shape

    def free(column, row):
        return 0 <= column < width and 0 <= row < height and not blocked[row, column]

    column, row = cell
    for dx, dy in itertools.product((-1, 0, 1), repeat=2):
        if free(column + dx, row + dy) and free(column + dx, row) and free(column, row + dy):
            yield column + dx, row + dy


def reachable(blocked, cell):
    found, edge = {cell}, [cell]
    while edge:
        new = set(steps(blocked, edge.pop())) - found
        found |= new
        edge.extend(new)
    return found


# Geometry.


def test_without_geometry_map_coordinates_are_those_of_cells():
    made = grid()
    assert made.to_map((3, 1)).tolist() == [3.0, 1.0]
    assert made.extent == (-0.5, -0.5, 4.5, 2.5)


def test_with_y_upwards_the_top_row_is_highest():
    made = grid(resolution=0.5, origin=(10.0, 20.0), y_up=True)
    assert made.to_map([(0, 0), (4, 2)]).tolist() == [[10.0, 20.0], [12.0, 19.0]]
    assert made.extent == (9.75, 18.75, 12.25, 20.25)


@given(
    points=arrays.arrays(np.float64, st.sampled_from([(2,), (4, 2), (2, 3, 2)]), elements=st.floats(-50, 50)),
    resolution=st.sampled_from([0.05, 1.0, 7.5]),
    y_up=st.booleans(),
)
@checked
def test_cells_of_map_coordinates_are_the_cells_they_came_from(points, resolution, y_up):
    made = grid(resolution=resolution, origin=(-3.2, 8.1), y_up=y_up)
    assert made.to_cells(made.to_map(points)) == pytest.approx(points, abs=1e-9)
    assert made.to_map(points).shape == points.shape


@pytest.mark.parametrize(
    ("point", "cell"), [((0.49, -0.5), (0, 0)), ((0.5, 0.0), (1, 0)), ((-0.51, 2.4), (-1, 2))]
)
def test_a_cell_covers_half_a_side_around_its_centre(point, cell):
    assert grid().cell_of(point) == cell


def test_cells_are_free_on_the_map_where_they_are_not_blocked():
    made = grid()
    free = {cell for cell in itertools.product(range(-2, 7), repeat=2) if made.is_free(cell)}
    expected = {(c, r) for r, row in enumerate(FLOOR.split()) for c, kind in enumerate(row) if kind == "."}
    assert free == expected


@given(blocked=grids)
@checked
def test_components_are_what_paths_that_cut_no_corner_connect(blocked):
    components = GridMap("made", blocked).components
    for row, column in np.argwhere(~blocked).tolist():
        same = components == components[row, column]
        assert {(c, r) for r, c in np.argwhere(same).tolist()} == reachable(blocked, (column, row))
    assert (components[blocked] == 0).all()


@given(blocked=grids, radius=st.floats(0.01, 8.0), resolution=st.sampled_from([0.5, 1.0, 2.0]))
@checked
def test_inflation_blocks_what_lies_closer_to_the_area_of_a_blocked_cell(blocked, radius, resolution):
    made = GridMap("made", blocked, resolution, (3.0, 4.0), y_up=True)
    obstacles = shapely.unary_union(
        [
            shapely.box(*(made.to_map((column, row)) + resolution * np.array([[-0.5], [0.5]])).ravel())
            for row, column in np.argwhere(blocked).tolist()
        ]
    )
    inflated = made.inflated(radius)
    for row, column in np.ndindex(blocked.shape):
        distance = shapely.Point(made.to_map((column, row))).distance(obstacles) if blocked.any() else INF
        if abs(distance - radius) > 1e-9:
            assert inflated.blocked[row, column] == (distance < radius)


def test_an_inflated_map_has_the_geometry_of_the_map():
    made = grid(resolution=0.5, origin=(1.0, 2.0), y_up=True)
    assert made.inflated(0.3).extent == made.extent
    assert made.inflated(0.0) == made
    assert "0.3" in made.inflated(0.3).name


@pytest.mark.parametrize("y_up", [False, True])
def test_a_part_of_a_map_lies_where_it_lay(y_up):
    rng = np.random.default_rng(0)
    made = GridMap("made", rng.random((7, 9)) < 0.5, 0.5, (1.0, 2.0), y_up)
    part = made.cut(slice(2, 6), slice(3, 8))
    assert (part.height, part.width) == (4, 5)
    for point in rng.uniform(*np.reshape(part.extent, (2, 2)), (50, 2)).tolist():
        assert part.is_free(part.cell_of(point)) == made.is_free(made.cell_of(point))
    assert made.cut(slice(None), slice(None)) == made


@pytest.mark.parametrize("radius", [-1.0, NAN, INF, "wide"])
def test_a_radius_that_is_none_is_refused(radius):
    refused(lambda: grid().inflated(radius), "'made'", "radius", repr(radius))


# Identity.


def test_maps_of_the_same_content_are_equal_whatever_their_names():
    other = GridMap("other", cells(FLOOR))
    assert other == grid()
    assert hash(other) == hash(grid())
    assert len(other.digest) == 64


@pytest.mark.parametrize(
    "other",
    [
        grid("." * 15),
        grid("....."),
        grid(FLOOR.replace("#", ".", 1)),
        grid(resolution=2.0),
        grid(origin=(0.0, 1.0)),
        grid(y_up=True),
        "made",
    ],
)
def test_maps_of_other_content_differ(other):
    assert grid() != other


def test_a_map_does_not_change_with_the_array_it_was_made_of():
    given_cells = np.asfortranarray(cells(FLOOR))
    made = GridMap("made", given_cells)
    given_cells[:] = True
    assert made == grid()
    assert made.blocked.flags["C_CONTIGUOUS"]


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda m: pickle.loads(pickle.dumps(m))])
def test_copies_of_a_map_are_equal_and_read_only(duplicate):
    made = duplicate(grid(resolution=0.5, y_up=True))
    assert made == grid(resolution=0.5, y_up=True)
    assert made.name == "made"
    with pytest.raises(ValueError, match="read-only"):
        made.blocked[0, 0] = True


@pytest.mark.parametrize(
    "blocked",
    [np.zeros((3, 3)), np.zeros(4, bool), np.zeros((0, 4), bool), None, np.zeros((2, 2, 2), bool)],
)
def test_cells_that_are_no_bools_in_rows_are_refused(blocked):
    refused(lambda: GridMap("made", blocked), "'made'", "blocked", "bool")


@pytest.mark.parametrize("dtype", [np.uint8, np.int8, np.int64, np.uint64])
def test_integers_0_and_1_stand_for_free_and_blocked(dtype):
    blocked = np.array([[0, 1, 0], [0, 0, 1]], dtype=dtype)
    assert GridMap("made", blocked) == GridMap("made", blocked.astype(bool))
    assert GridMap("made", blocked.tolist()) == GridMap("made", blocked.astype(bool))
    refused(lambda: GridMap("made", blocked * 3), "'made'", "0 (free) or 1 (blocked)", "from 0 to 3")


@pytest.mark.parametrize("shape", [(MAX_SIDE + 1, 2), (2, MAX_SIDE + 1)])
def test_a_map_larger_than_documented_is_refused(shape):
    assert GridMap("made", np.zeros(np.minimum(shape, MAX_SIDE), dtype=bool)).width
    refused(lambda: GridMap("made", np.zeros(shape, dtype=bool)), "'made'", f"at most {MAX_SIDE}", "4097")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *(("resolution", value) for value in (0.0, -1.0, NAN, 1e300, "fine")),
        *(("origin", value) for value in ((INF, 0.0), (0.0, None), (1.0,), 3.0)),
    ],
)
def test_geometry_that_is_none_is_refused(name, value):
    refused(lambda: grid(**{name: value}), "'made'", name)


# Scenarios.


def test_a_scenario_has_the_line_from_start_to_target_and_the_extent_of_its_map():
    made = GridScenario("task", grid(), (0, 0), np.array([4.0, 1.0]))
    assert made.straight_line == pytest.approx(math.sqrt(17))
    assert made.workspace == grid().extent
    assert made == GridScenario("task", grid(), (0.0, 0.0), (4.0, 1.0))
    assert hash(made) == hash(pickle.loads(pickle.dumps(made)))
    assert make_scenario(made) is made
    assert make_scenarios(made) == (made,)


@pytest.mark.parametrize(
    ("start", "target", "expected"),
    [
        ((0, 0), (1, 1), ["target", "(1.0, 1.0)", "cell (1, 1)"]),
        ((2.4, 0.6), (4, 0), ["start", "(2.4, 0.6)", "cell (2, 1)"]),
        ((0, 0), (4.6, 0), ["target", "(4.6, 0.0)", "outside"]),
        ((0, 2.5), (4, 0), ["start", "(0.0, 2.5)"]),
        ((0, -1e9), (4, 0), ["start", "outside"]),
        ((0, -1e308), (4, 0), ["start", "at most 1e+12"]),
        ((NAN, 0), (4, 0), ["start", "finite"]),
        ((0, 0), (0, INF), ["target", "finite"]),
        ((0, 0, 0), (4, 0), ["start", "(0, 0, 0)"]),
        (None, (4, 0), ["start", "None"]),
        ((0, 0), (0, 0), ["must be different points", "(0.0, 0.0)"]),
    ],
)
def test_a_malformed_task_is_refused(start, target, expected):
    refused(lambda: GridScenario("task", grid(), start, target), "'task'", "'made'", *expected)


def test_a_task_without_a_path_or_a_map_is_refused():
    made = grid(".#\n#.")  # the path would cut a corner
    refused(lambda: GridScenario("task", made, (0, 0), (1, 1)), "no path", "cell (0, 0)", "cell (1, 1)")
    refused(lambda: GridScenario("task", cells(FLOOR), (0, 0), (1, 1)), "'task'", "GridMap")


@pytest.mark.parametrize("y_up", [False, True])
def test_pictures_show_what_can_be_reached_and_a_little_around_it(y_up):
    blocked = np.full((40, 50), True)
    blocked[20:23, 10:16] = False
    blocked[2, 2] = False  # cannot be reached
    made = GridMap("island", blocked, 0.5, (1.0, -2.0), y_up)
    start, target = made.to_map([(10, 20), (15, 22)]).tolist()
    scenario = GridScenario("task", made, start, target)
    assert scenario.window == (slice(17, 26), slice(7, 19))
    ends = made.to_map([(6.5, 16.5), (18.5, 25.5)])
    assert scenario.view == (*ends.min(axis=0), *ends.max(axis=0))


def test_a_grid_is_no_map_of_circles_and_polygons():
    refused(lambda: AnalyticProblem(GridScenario("task", grid(), (0, 0), (4, 1))), "'task'", "grid")


# Files.


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    return tmp_path


def put(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("here")
    return path


def test_the_data_folder_is_the_users_where_none_is_set(monkeypatch):
    monkeypatch.delenv("SWARM_GYM_DATA", raising=False)
    assert data_folder().is_absolute()
    assert "swarm_gym" in str(data_folder())


def test_files_are_found_in_the_folder_before_its_sub_folders(folder):
    places = [folder / "zoo/a.map", folder / "ros/a.map", folder / "movingai/a.map", folder / "a.map"]
    for place in places:
        put(place)
        assert find_data_file("a.map") == place


def test_the_first_of_several_names_that_is_there_is_found(folder):
    second = put(folder / "movingai/a.scen")
    assert find_data_file("a.map.scen", "a.scen") == second
    first = put(folder / "zoo/a.map.scen")
    assert find_data_file("a.map.scen", "a.scen") == first


def test_an_absolute_name_is_found_where_it_is(folder, tmp_path_factory):
    elsewhere = put(tmp_path_factory.mktemp("elsewhere") / "a.map")
    assert find_data_file(str(elsewhere)) == elsewhere


def test_a_missing_file_is_reported_with_the_places_and_the_download(folder, monkeypatch):
    put(folder / "zoo/deep/a.map")  # two levels deep
    refused(lambda: find_data_file("a.map"), "a.map", str(folder), "python -m swarm_gym.scenarios.download")
    os.mkdir(folder / "a.map")  # no file
    for name in ("a.map", "a" * 5000):
        refused(lambda name=name: find_data_file(name), "no file")
    monkeypatch.setenv("SWARM_GYM_DATA", str(folder / "none"))
    refused(lambda: find_data_file("a.map"), str(folder / "none"))


@pytest.mark.parametrize("name", ["../a.map", "zoo/../../a.map", "zoo/../a.map", "..", "a\0.map", "a\n.map"])
def test_a_name_that_leads_out_of_the_folder_is_refused(folder, name):
    put(folder.parent / "a.map")
    put(folder / "a.map")
    refused(lambda: find_data_file(name), repr(name))


@pytest.mark.parametrize(("centre", "radius"), [((2.0, 1.0), 1.0), ((0.3, -0.6), 1.7), ((9.0, 9.0), 2.0)])
def test_a_disc_has_the_cells_whose_centres_lie_in_it(centre, radius):
    made = grid()
    expected = [
        [math.dist((column, row), centre) <= radius for column in range(made.width)]
        for row in range(made.height)
    ]
    assert made.disc(centre, radius).tolist() == expected
