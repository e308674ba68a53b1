"""Graded maps: values of map_server and of Nav2's cost maps, unknown cells, terrain of Moving AI."""

import math
from fractions import Fraction

import numpy as np
import pytest

from helpers.refusals import refused
from swarm_gym.errors import ScenarioError, SettingError, UnknownNameError
from swarm_gym.scenarios import GridMap
from swarm_gym.scenarios.formats.moving_ai import read_graded_map, read_map
from swarm_gym.scenarios.formats.ros_map import read_graded_ros_map, read_ros_map
from swarm_gym.scenarios.graded_map import GradedMap, Grading

Image = pytest.importorskip("PIL.Image", reason="needs the extra `maps`")
pytest.importorskip("yaml", reason="needs the extra `maps`")

RAMP = np.arange(256, dtype=np.uint8).reshape(2, 128)
UNKNOWN = None


def described(folder, image, mode, negate=0, free="0.196", occupied="0.65"):
    path = folder / "floor.yaml"
    path.write_text(
        f"image: {image}\nresolution: 0.5\norigin: [1, 2, 0]\nnegate: {negate}\noccupied_thresh: {occupied}\n"
        f"free_thresh: {free}\nmode: {mode}\n"
    )
    return path


def published(grey, mode, negate, free, occupied, is_opaque=True):
    """Return the value that the documentation of map_server gives a pixel, in exact arithmetic."""
    if not is_opaque:
        return UNKNOWN
    if mode == "raw":
        return grey if grey <= 100 else UNKNOWN
    p = Fraction(grey if negate else 255 - grey, 255)
    if p > Fraction(occupied):
        return 100
    if p < Fraction(free):
        return 0
    if mode == "trinary":
        return UNKNOWN
    return math.floor(99 * (p - Fraction(free)) / (Fraction(occupied) - Fraction(free)))


@pytest.mark.parametrize(
    ("mode", "negate"), [("trinary", 0), ("trinary", 1), ("scale", 0), ("scale", 1), ("raw", 0)]
)
@pytest.mark.parametrize("unknown", ["blocked", "free", "dear"])
def test_each_grey_means_what_map_server_documents(tmp_path, mode, negate, unknown):
    alpha = np.where(np.arange(256).reshape(RAMP.shape) % 7 == 3, 128, 255).astype(np.uint8)
    Image.merge("LA", [Image.fromarray(RAMP), Image.fromarray(alpha)]).save(tmp_path / "floor.png")
    read = read_graded_ros_map(described(tmp_path, "floor.png", mode, negate), Grading(unknown=unknown))
    for grey in range(256):
        value = published(grey, mode, negate, "0.196", "0.65", grey % 7 != 3)
        row, column = divmod(grey, 128)
        is_blocked = unknown == "blocked" if value is UNKNOWN else value >= 100
        assert read.grid.blocked[row, column] == is_blocked, (grey, value)
        dear = {"dear": 1.0}.get(unknown, 0.0)
        cost = dear if value is UNKNOWN else 0.0 if is_blocked else value / 100
        assert read.costs[row, column] == pytest.approx(cost, abs=1e-12)


def test_maps_of_free_and_blocked_cells_are_as_without_grades(tmp_path):
    Image.fromarray(RAMP).save(tmp_path / "floor.png")
    path = described(tmp_path, "floor.png", "trinary")
    assert read_graded_ros_map(path, Grading()).grid == read_ros_map(path)
    assert read_ros_map(path).blocked.any()
    assert not read_ros_map(path).blocked.all()


@pytest.mark.parametrize(("lethal", "first"), [(None, 253), (254, 254), (100, 100)])
def test_cost_maps_are_read_from_pictures_and_arrays(tmp_path, lethal, first):
    Image.fromarray(RAMP).save(tmp_path / "costs.png")
    np.save(tmp_path / "costs.npy", RAMP[::-1])
    grading = Grading(unknown="dear", lethal=lethal)
    maps = [
        read_graded_ros_map(described(tmp_path, name, "costmap"), grading)
        for name in ("costs.png", "costs.npy")
    ]
    assert maps[0].grid == maps[1].grid
    np.testing.assert_array_equal(maps[0].costs, maps[1].costs)
    costs, blocked = maps[0].costs.ravel(), maps[0].grid.blocked.ravel()
    np.testing.assert_array_equal(np.flatnonzero(blocked), np.arange(first, 255))
    np.testing.assert_allclose(costs[:first], np.arange(first) / 252)
    assert costs[255] == 1.0


def test_a_cost_map_needs_no_thresholds_and_is_a_map_without_grades_too(tmp_path):
    np.save(tmp_path / "costs.npy", RAMP)
    path = tmp_path / "floor.yaml"
    path.write_text("image: costs.npy\nresolution: 0.5\norigin: [1, 2, 0]\nmode: costmap\n")
    np.testing.assert_array_equal(read_ros_map(path).blocked[::-1].ravel(), np.arange(256) >= 253)


def test_the_data_of_a_message_has_its_lowest_row_first(tmp_path):
    data = np.array([[0, 50, 100], [-1, 0, 99]], dtype=np.int8)
    np.save(tmp_path / "floor.npy", data)
    read = read_graded_ros_map(described(tmp_path, "floor.npy", "raw"), Grading())
    made = GradedMap.of_values("made", data, "occupancy", 0.5, (1.0, 2.0))
    assert made.grid == read.grid
    np.testing.assert_array_equal(made.costs, read.costs)
    assert made.grid.extent == (1.0, 2.0, 2.5, 3.0)
    np.testing.assert_array_equal(made.grid.blocked, [[True, False, False], [False, False, True]])
    np.testing.assert_array_equal(made.costs, [[0.0, 0.0, 0.99], [0.0, 0.5, 0.0]])
    assert not made.costs.flags.writeable


@pytest.mark.parametrize(
    ("name", "array", "mode", "words"),
    [
        ("floor.npy", np.zeros((2, 2), np.int16), "raw", ["int8 or uint8", "int16"]),
        ("floor.npy", np.zeros((2, 2, 3), np.uint8), "costmap", ["(height, width)", "(2, 2, 3)"]),
        ("floor.npy", np.zeros((2, 2), np.uint8), "trinary", ["image must be a picture in mode trinary"]),
        ("floor.png", np.zeros((2, 2, 3), np.uint8), "costmap", ["costs from 0 to 255", "colours"]),
        ("floor.npy", np.zeros((2, 2), np.uint8), "lethal", ["mode must be one of", "costmap", "'lethal'"]),
        ("floor.npy", b"no array", "raw", ["cannot be read as an array"]),
        ("floor.npy", np.zeros((1, 5000), np.uint8), "raw", ["4096 cells"]),
    ],
)
def test_cells_of_another_scale_are_refused(tmp_path, name, array, mode, words):
    if isinstance(array, bytes):
        (tmp_path / name).write_bytes(array)
    elif name.endswith(".npy"):
        np.save(tmp_path / name, array)
    else:
        Image.fromarray(array).save(tmp_path / name)
    refused(lambda: read_graded_ros_map(described(tmp_path, name, mode), Grading()), *words)


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: Grading(unknown="maybe"), SettingError, "unknown must be one of blocked, free, dear.*maybe"),
        (lambda: Grading(lethal=0), SettingError, r"lethal must lie in \[1, 254\]"),
        (lambda: Grading(terrain=3), SettingError, "terrain must be costs by letter"),
        (lambda: of_values([[0, 300]]), ScenarioError, r"occupancy values lie in \[0, 100\].*300"),
        (lambda: of_values([[0, -2]], "costmap"), ScenarioError, "costmap values.*-2"),
        (lambda: of_values([[0.5]]), ScenarioError, "integers"),
        (lambda: of_values([[0]], "grey"), UnknownNameError, "scale of a map 'grey'"),
        (lambda: of_values([[0]], grading=Grading(lethal=200)), SettingError, r"\[1, 100\] on a map of occ"),
        (
            lambda: of_values([[0]], grading=Grading(terrain={})),
            SettingError,
            "terrain: expected a map of Mov",
        ),
        (
            lambda: GradedMap(GridMap("a", np.zeros((2, 2), bool)), [[0.0]]),
            ScenarioError,
            "shape of the cells",
        ),
        (lambda: GradedMap(GridMap("a", np.zeros((1, 1), bool)), [[-1.0]]), ScenarioError, "at least 0"),
        (lambda: GradedMap(GridMap("a", np.zeros((1, 1), bool)), [[np.nan]]), ScenarioError, "at least 0"),
    ],
)
def test_grades_that_do_not_fit_are_refused(make, error, words):
    with pytest.raises(error, match=words):
        make()


def of_values(values, scale="occupancy", grading=None):
    return GradedMap.of_values("made", values, scale, 1.0, (0.0, 0.0), grading)


def test_letters_of_moving_ai_have_the_costs_that_are_given(tmp_path):
    path = tmp_path / "small.map"
    path.write_text("type octile\nheight 2\nwidth 4\nmap\n.GSW\n@OT.\n")
    usual = read_graded_map(path, Grading(terrain={}))
    assert usual.grid == read_map(path)
    assert not usual.costs.any()
    read = read_graded_map(path, Grading(terrain={"S": 1.5, "W": 3, "G": math.inf}))
    np.testing.assert_array_equal(read.grid.blocked, [[False, True, False, False], [True, True, True, False]])
    np.testing.assert_array_equal(read.costs, [[0.0, 0.0, 1.5, 3.0], [0.0, 0.0, 0.0, 0.0]])
    for terrain, words in (
        ({"S": -1.0}, "cost of 'S' must be a number from 0 on, got -1.0"),
        ({"S": math.nan}, "cost of 'S'"),
        ({"S": "dear"}, "cost of 'S'"),
        ({"X": 1.0}, "letters among .GS@OTW, got 'X'"),
        ({"": 1.0}, "letters among"),
    ):
        with pytest.raises(SettingError, match=words):
            read_graded_map(path, Grading(terrain=terrain))
    with pytest.raises(SettingError, match="cells of map 'small' are letters"):
        read_graded_map(path, Grading(unknown="free"))
