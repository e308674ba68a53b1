import sys
import tracemalloc
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.mutations import fuzzed, mutated
from helpers.public_maps import needed
from helpers.refusals import refused
from helpers.slow import slow_but
from swarm_gym.errors import MissingExtraError, ScenarioError
from swarm_gym.scenarios import expand_name, make_scenario
from swarm_gym.scenarios.formats.ros_map import read_graded_ros_map, read_ros_map, read_yaml
from swarm_gym.scenarios.graded_map import Grading

Image = pytest.importorskip("PIL.Image", reason="needs the extra `maps`")
pytest.importorskip("yaml", reason="needs the extra `maps`")

YAML = """image: small.pgm
resolution: 0.5
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""

# Free, free, unknown, occupied; the lower row is free.
PIXELS = [[254, 250, 205, 0], [254, 254, 254, 254]]
PGM = b"P5\n# made\n4 2\n255\n" + bytes([*PIXELS[0], *PIXELS[1]])

INSERTIONS = (b"\n", b"- ", b"9" * 30, b"[", b"{", b"&a ", b"!!int ", b": ")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path))
    (tmp_path / "small.pgm").write_bytes(PGM)
    (tmp_path / "small.yaml").write_text(YAML)
    return tmp_path


def described(folder, *changes):
    """Write the YAML file with some texts replaced, each (old, new)."""
    text = YAML
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "small.yaml"
    path.write_text(text)
    return path


def image(folder, pixels, name="small.png", mode="L"):
    Image.fromarray(np.array(pixels, np.uint8)).convert(mode).save(folder / name)
    return described(folder, ("small.pgm", name))


# Maps.


def test_what_is_occupied_or_unknown_is_blocked(folder):
    assert read_ros_map(folder / "small.yaml").blocked.tolist() == [[False, False, True, True], [False] * 4]


def test_the_origin_is_the_outer_corner_of_the_lower_left_pixel(folder):
    made = read_ros_map(folder / "small.yaml")
    assert made.extent == (-1.0, 2.0, 1.0, 3.0)
    assert made.cell_of((-0.9, 2.1)) == (0, 1)
    assert made.cell_of((0.9, 2.9)) == (3, 0)


@pytest.mark.parametrize("yaw", ["1.2e-17", "-1e-6", "6.283185307179586"])
def test_a_yaw_that_is_a_rounding_error_is_none(folder, yaw):
    path = described(folder, ("2.0, 0.0]", f"2.0, {yaw}]"))
    assert read_ros_map(path) == read_ros_map(described(folder))


# Easting and northing of UTM, and the largest coordinates there are.
@pytest.mark.parametrize("origin", [(388096.5, 5948996.25), (-3e6, 9.9e6), (1e9 - 10.0, -1e9)])
@pytest.mark.parametrize("side", [0.05, 0.1, 1.0])
def test_a_map_far_from_the_origin_is_the_map_moved(folder, origin, side):
    for number in (0, 1):
        x, y = origin if number else (0.0, 0.0)
        moved = (("[-1.0, 2.0, 0.0]", f"[{x}, {y}, 0]"), ("0.5", str(side)))
        made = read_ros_map(described(folder, *moved))
        corner = np.array([x, y])
        centres = corner + side * np.array([[0.5, 1.5], [3.5, 0.5], [1.5, 0.5]])
        assert [made.cell_of(tuple(centre)) for centre in centres.tolist()] == [(0, 0), (3, 1), (1, 1)]
        np.testing.assert_allclose(made.to_map([(0, 0), (3, 1)]), centres[:2], rtol=0, atol=1e-6)
        np.testing.assert_allclose(
            made.extent, [*corner, *(corner + side * np.array([4, 2]))], rtol=0, atol=1e-6
        )


def test_a_negated_map_is_free_where_it_is_dark(folder):
    path = described(folder, ("negate: 0", "negate: 1"))
    assert read_ros_map(path).blocked.tolist() == [[True, True, True, False], [True] * 4]


@pytest.mark.parametrize(("grey", "blocked"), [(204, True), (205, True), (206, False), (127, True)])
def test_a_pixel_is_free_below_the_threshold(folder, grey, blocked):
    # (255 - 205) / 255 = 0.19608 is the grey that map_server saves for unknown cells.
    path = image(folder, [[grey, 254]])
    assert read_ros_map(path).blocked.tolist() == [[blocked, False]]


@pytest.mark.parametrize("mode", ["L", "1"])
def test_a_png_is_read_like_a_pgm(folder, mode):
    path = image(folder, [[255, 0, 255], [255, 255, 0]], mode=mode)
    assert read_ros_map(path).blocked.tolist() == [[False, True, False], [False, False, True]]


def test_a_pgm_may_be_in_ascii(folder):
    (folder / "small.pgm").write_bytes(b"P2\n2 1\n255\n254 0\n")
    assert read_ros_map(folder / "small.yaml").blocked.tolist() == [[False, True]]


def test_numbers_and_mode_may_be_written_as_map_server_takes_them(folder):
    path = described(
        folder,
        ("0.5", "5e-1"),
        ("negate: 0", "negate: false\nmode: trinary"),
        ("[-1.0, 2.0, 0.0]", "[-1, 2, 0]"),
    )
    assert read_ros_map(path) == read_ros_map(described(folder))


def test_the_image_may_be_in_a_sub_folder_or_absolute(folder):
    expected = read_ros_map(folder / "small.yaml")
    (folder / "images").mkdir()
    (folder / "small.pgm").rename(folder / "images/other.pgm")
    for name in ("images/other.pgm", folder / "images/other.pgm"):
        assert read_ros_map(described(folder, ("small.pgm", str(name)))) == expected


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("image: small.pgm\n", "", ["image", "missing"]),
        ("small.pgm", "../small.pgm", ["image", "folder", "'../small.pgm'"]),
        ("small.pgm", "[a, b]", ["image", "['a', 'b']"]),
        ("small.pgm", '""', ["image", "''"]),
        ("small.pgm", '"a\\0b"', ["image"]),
        ("resolution: 0.5\n", "", ["resolution", "missing"]),
        ("0.5", "0", ["resolution", "'0'"]),
        ("0.5", "-0.05", ["resolution", "'-0.05'"]),
        ("0.5", "nan", ["resolution", "'nan'"]),
        ("0.5", "1e999", ["resolution", "'1e999'"]),
        ("0.5", "1.2.3", ["resolution", "'1.2.3'"]),
        ("[-1.0, 2.0, 0.0]", "[-1.0, 2.0, 0.1]", ["origin", "5.72958 degrees counter-clockwise", "'0.1'"]),
        ("[-1.0, 2.0, 0.0]", "[-1.0, 2.0, 1.1e-6]", ["origin", "'1.1e-6'"]),
        ("[-1.0, 2.0, 0.0]", "[-1.0, 1.1e9, 0]", ["origin", "at most 1e+09", "'1.1e9'"]),
        ("[-1.0, 2.0, 0.0]", "[-1.0, 2.0]", ["origin", "['-1.0', '2.0']"]),
        ("[-1.0, 2.0, 0.0]", "[-1.0, .inf, 0]", ["origin", "'.inf'"]),
        ("[-1.0, 2.0, 0.0]", "[-1.0, [2.0], 0]", ["origin", "[2.0]"[1:4]]),
        ("origin: [-1.0, 2.0, 0.0]\n", "", ["origin", "missing"]),
        ("negate: 0", "negate: maybe", ["negate", "'maybe'"]),
        ("negate: 0", "negate: 0\nmode: grey", ["mode", "trinary, scale, raw", "'grey'"]),
        ("0.65", "65", ["occupied_thresh", "'65'"]),
        ("0.65", "0.1", ["free_thresh", "occupied_thresh", "0.1"]),
        ("0.196", "-0.1", ["free_thresh", "'-0.1'"]),
    ],
)
def test_a_malformed_entry_is_refused_with_file_key_and_value(folder, old, new, expected):
    path = described(folder, (old, new))
    refused(lambda: read_ros_map(path), str(path), *expected)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"- 1\n- 2\n",
        b"{",
        b"image: \xff\xfe",
        b"\0",
        b"[" * 5000,
        b"a: &a [*a]",
        b"#" * 70_000,
        b"? [1]\n: 2",
    ],
)
def test_a_file_that_is_no_description_of_a_map_is_refused(folder, content):
    path = folder / "small.yaml"
    path.write_bytes(content)
    refused(lambda: read_yaml(path), str(path))


def test_a_missing_file_is_refused(folder):
    refused(lambda: read_yaml(folder / "none.yaml"), "none.yaml", "no such file")
    refused(lambda: read_ros_map(described(folder, ("small.pgm", "none.pgm"))), "none.pgm")
    refused(lambda: read_ros_map(described(folder, ("small.pgm", "n" * 5000))), "nnn")


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (PGM[:-1], "truncated"),
        (PGM[:9], "PGM, PNG, BMP or JPEG"),
        (b"", "PGM, PNG, BMP or JPEG"),
        (b"GIF89a" + bytes(30), "PGM, PNG, BMP or JPEG"),
        (b"P5\n5000 2\n255\n" + bytes(10_000), "5000 x 2"),
        (b"P5\n0 2\n255\n", "small.pgm"),
        (b"P6\n1 1\n255\n" + bytes(2), "truncated"),
        (b"P0CMYK\n1 1\n255\n" + bytes(4), "'CMYK'"),
    ],
)
def test_a_malformed_image_is_refused_with_its_file(folder, content, expected):
    (folder / "small.pgm").write_bytes(content)
    refused(lambda: read_ros_map(folder / "small.yaml"), "small.pgm", expected)


@pytest.mark.parametrize("size", ["9000 9000", "12000 12000", "90000 90000"])
def test_pixels_of_a_map_that_is_too_large_are_not_decoded(folder, size):
    (folder / "small.pgm").write_bytes(f"P5\n{size}\n255\n".encode() + bytes(100))
    tracemalloc.start()
    refused(lambda: read_ros_map(folder / "small.yaml"), "small.pgm")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2**22


@given(content=mutated(YAML.encode(), *INSERTIONS) | st.binary(max_size=60))
@fuzzed
def test_a_description_of_any_bytes_is_read_or_refused(folder, content):
    path = folder / "small.yaml"
    path.write_bytes(content)
    made = None
    with suppress(ScenarioError):
        made = read_ros_map(path)
    assert made is None or made.blocked.shape == (2, 4)


@pytest.mark.parametrize("kind", slow_but(["pgm", "png"], ["pgm", "png", "bmp", "jpg"]))
@pytest.mark.fuzzed
def test_an_image_of_any_bytes_is_read_or_refused(folder, kind):
    path = image(folder, PIXELS, name=f"small.{kind}")
    whole = (folder / f"small.{kind}").read_bytes()

    @given(content=mutated(whole, *INSERTIONS))
    @fuzzed
    def check(content):
        (folder / f"small.{kind}").write_bytes(content)
        made = None
        with suppress(ScenarioError):
            made = read_ros_map(path)
        assert made is None or made.blocked.size <= 4096**2

    check()


# Names.


def test_start_and_goal_are_in_metres(folder):
    name = "ros:small?start=-0.75,2.75&goal=0.9,2.1"
    made = make_scenario(name)
    assert (made.name, made.start, made.target) == (name, (-0.75, 2.75), (0.9, 2.1))
    assert made.workspace == (-1.0, 2.0, 1.0, 3.0)
    assert expand_name(name) == (name,)
    assert make_scenario(f"ros:{folder}/small.yaml?start=-0.75,2.75&goal=0.9,2.1").map == made.map


def test_a_map_can_be_inflated_by_a_radius_in_metres(folder):
    made = make_scenario("ros:small?start=-0.75,2.75&goal=-0.75,2.25&inflate=0.3")
    assert made.map == read_ros_map(folder / "small.yaml").inflated(0.3)
    assert made.map.blocked.sum() > read_ros_map(folder / "small.yaml").blocked.sum()


@pytest.mark.parametrize(
    ("choices", "grading"),
    [
        ("&unknown=dear", Grading(unknown="dear")),
        ("&lethal=100", Grading()),
        ("&unknown=free&lethal=50", Grading("free", 50)),
    ],
)
def test_a_name_can_choose_what_grades_mean(folder, choices, grading):
    made = make_scenario(f"ros:small?start=-0.75,2.75&goal=-0.75,2.25{choices}")
    assert made.ground == read_graded_ros_map(folder / "small.yaml", grading)
    assert made.map == made.ground.grid
    grown = make_scenario(f"ros:small?start=-0.75,2.75&goal=-0.75,2.25&inflate=0.3{choices}")
    assert grown.map == made.map.inflated(0.3)
    assert (grown.ground.costs == np.where(grown.map.blocked, 0.0, made.ground.costs)).all()
    assert make_scenario("ros:small?start=-0.75,2.75&goal=-0.75,2.25").ground is None


def test_an_image_that_changed_is_read_again(folder):
    before = read_ros_map(folder / "small.yaml")
    (folder / "small.pgm").write_bytes(PGM.replace(bytes([205, 0]), bytes([254, 254])) + b"\n")
    assert read_ros_map(folder / "small.yaml") != before


NO_ENDS = (
    "",
    "&goal=1",
    "&goal=1,nan",
    "&goal=1,1e3",
    "&goal=1,1&inflate=-1",
    "&goal=1,1&radius=1",
    "&goal=1,1&unknown=maybe",
    "&goal=1,1&lethal=-1",
)
NO_NAMES = ["ros:small", "ros:?start=0,0&goal=1,1", "ros:/small?start=0,0&goal=1,1"]


@pytest.mark.parametrize("name", [*NO_NAMES, *(f"ros:small?start=0,0{end}" for end in NO_ENDS)])
def test_a_name_of_another_form_is_refused(folder, name):
    refused(lambda: expand_name(name), repr(name), "expected" if "/" not in name else ".yaml")


def test_a_start_in_a_wall_and_a_missing_map_are_reported_with_their_place(folder):
    start, cell = "(0.9, 2.9)", "cell (3, 0)"
    refused(lambda: make_scenario("ros:small?start=0.9,2.9&goal=0.9,2.1"), start, cell, "'small'")
    refused(lambda: make_scenario("ros:other?start=0,0&goal=1,1"), "other.yaml", str(folder))


@pytest.mark.parametrize(("module", "library"), [("yaml", "PyYAML"), ("PIL", "Pillow")])
def test_a_missing_library_is_reported_with_the_extra(folder, monkeypatch, module, library):
    monkeypatch.setitem(sys.modules, module, None)
    (folder / "small.pgm").write_bytes(PGM + b"\n" * len(module))  # so that it is no file from the cache
    with pytest.raises(MissingExtraError, match=rf"{library}.*swarm_gym\[maps\]"):
        read_ros_map(folder / "small.yaml")


@pytest.mark.parametrize(
    ("name", "shape", "free"), [("turtlebot3_world", (384, 384), 7939), ("playground", (194, 231), 43488)]
)
def test_a_published_map_is_read(name, shape, free):
    made = read_ros_map(needed(f"{name}.yaml"))
    assert made.blocked.shape == shape
    assert (~made.blocked).sum() == free


@pytest.mark.parametrize("name", ["small.yml", "other.YAML", "OTHER.Yml"])
def test_a_description_may_have_another_ending(folder, name):
    expected = read_ros_map(folder / "small.yaml")
    (folder / "small.yaml").rename(folder / name)
    for place in (name, str(folder / name)):
        scenario = f"ros:{place}?start=-0.5,2.25&goal=0.25,2.25"
        assert make_scenario(scenario).map == expected
        assert make_scenario(scenario).name == scenario


@pytest.mark.parametrize("given", ["small", "small.yaml"])
def test_a_map_has_one_name_however_it_is_written(folder, given):
    name = f" ros: {given} ? start = -0.5, 2.25 & goal = 0.25, 2.25"
    assert expand_name(name) == ("ros:small?start=-0.5,2.25&goal=0.25,2.25",)
    assert make_scenario(name).name == "ros:small?start=-0.5,2.25&goal=0.25,2.25"


def test_spaces_inside_the_path_of_a_map_stay(folder):
    for file in ("small.pgm", "small.yaml"):
        (folder / file).rename(folder / file.replace("small.yaml", "floor 2, b = c.yaml"))
    made = make_scenario("ros: floor 2, b = c.yaml ? start = -0.5, 2.25 & goal = 0.25, 2.25 ")
    assert made.name == "ros:floor 2, b = c?start=-0.5,2.25&goal=0.25,2.25"


def test_a_map_may_lie_in_a_folder_of_the_data_folder(folder):
    (folder / "house").mkdir()
    for file in ("small.pgm", "small.yaml"):
        (folder / file).rename(folder / "house" / file)
    made = make_scenario("ros:house/small.yaml?start=-0.5,2.25&goal=0.25,2.25")
    assert made.name == "ros:house/small?start=-0.5,2.25&goal=0.25,2.25"
    assert made.map == read_ros_map(folder / "house" / "small.yaml")
