"""Pictures of ROS maps: each form compared with a reading pixel by pixel, and what is refused."""

import io
import os
import warnings
import zlib
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from helpers.loops import looped
from helpers.pictures import HEIGHT, WIDTH, pictures
from helpers.refusals import refused
from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.formats import ros_image
from swarm_gym.scenarios.formats.ros_map import read_ros_map

Image = pytest.importorskip("PIL.Image", reason="needs the extra `maps`")
pytest.importorskip("yaml", reason="needs the extra `maps`")

YAML = "image: {image}\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: {negate}\noccupied_thresh: 0.65\n"
MADE = pictures()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return a folder for maps, which is not the data folder."""
    (tmp_path / "data").mkdir()
    (tmp_path / "site" / "maps").mkdir(parents=True)
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path / "data"))
    return tmp_path / "site" / "maps"


def described(folder, image, negate=0, free=0.196, mode="trinary", name="floor.yaml"):
    path = folder / name
    text = YAML.format(image=image, negate=negate)
    path.write_text(f"{text}free_thresh: {free}\nmode: {mode}\n")
    return path


def message_of(call):
    """Return the message of a refusal, which is one line."""
    with pytest.raises(ScenarioError) as caught:
        call()
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 500
    return message


def is_free(pixel, negate, free, mode):
    """Return whether a pixel is free: the rule in docs/scenarios-grids.md, in exact arithmetic."""
    *colours, opacity = (Fraction(value) for value in pixel)
    grey = sum(colours) / 3
    if opacity < 255:
        return False
    if mode == "raw":
        published = round(grey)
        return published <= 100 and published / 100 < free
    probability = float((grey if negate else 255 - grey) / 255)
    return probability <= free if mode == "scale" else probability < free


@pytest.mark.filterwarnings("ignore:.*usual for unknown cells")
@looped(
    ("negate", "free", "mode"),
    [
        (0, 0.196, "trinary"),
        (0, 0.25, "trinary"),
        (1, 0.25, "trinary"),
        (0, 0.0, "scale"),
        (1, 0.0, "scale"),
        (0, 0.2, "raw"),
    ],
)
@pytest.mark.parametrize("name", MADE)
def test_a_picture_of_any_form_is_read_like_its_pixels(folder, name, negate, free, mode):
    made = MADE[name]
    (folder / f"floor.{made.ending}").write_bytes(made.content)
    read = read_ros_map(described(folder, f"floor.{made.ending}", negate, free, mode))
    expected = [[not is_free(pixel, negate, free, mode) for pixel in row] for row in made.pixels]
    np.testing.assert_array_equal(read.blocked, expected)


def test_the_pictures_have_free_and_blocked_cells():
    for made in MADE.values():
        pixels = [pixel for row in made.pixels for pixel in row]
        assert len(pixels) == HEIGHT * WIDTH
        assert {is_free(pixel, negate, 0.25, "trinary") for pixel in pixels for negate in (0, 1)} == {
            True,
            False,
        }


@pytest.mark.parametrize("options", [{}, {"progressive": True}])
@pytest.mark.parametrize("mode", ["L", "RGB"])
def test_a_jpeg_is_read_where_its_cells_are_clear(folder, mode, options):
    cells = np.random.default_rng(1).choice([0, 254], (6, 8)).astype(np.uint8)
    image = Image.fromarray(np.kron(cells, np.ones((8, 8), np.uint8))).convert(mode)
    image.save(folder / "floor.jpg", quality=95, **options)
    read = read_ros_map(described(folder, "floor.jpg"))
    np.testing.assert_array_equal(read.blocked[4::8, 4::8], cells == 0)


def test_numbers_between_levels_of_a_pgm_are_scaled(folder):
    (folder / "floor.pgm").write_bytes(b"P5\n3 1\n4095\n" + np.array([4095, 3500, 0], ">u2").tobytes())
    for free, expected in ((0.146, [False, False, True]), (0.145, [False, True, True])):
        read = read_ros_map(described(folder, "floor.pgm", free=free))
        assert read.blocked.tolist() == [expected]


@pytest.mark.parametrize("mode", ["CMYK", "F"])
def test_a_picture_without_grey_values_is_refused_with_its_mode(folder, mode):
    if mode == "CMYK":
        Image.new("CMYK", (4, 4)).save(folder / "floor.jpg")
    else:
        (folder / "floor.jpg").write_bytes(b"Pf\n1 1\n-1.0\n" + np.zeros(1, "<f4").tobytes())
    message = message_of(lambda: read_ros_map(described(folder, "floor.jpg")))
    for word in (
        str(folder / "floor.jpg"),
        f"got Pillow's mode {mode!r}",
        "expected a grey or coloured image",
    ):
        assert word in message


def test_a_transparent_colour_of_16_bits_is_refused(folder):
    content = MADE["colours of 16 bits"].content
    key = b"\0\0\0\6tRNS" + bytes(6)
    key += zlib.crc32(key[4:]).to_bytes(4, "big")
    (folder / "floor.png").write_bytes(content[:33] + key + content[33:])
    assert "16 bits is declared transparent" in message_of(
        lambda: read_ros_map(described(folder, "floor.png"))
    )


def test_a_jpeg_with_thousands_of_scans_is_refused_before_it_is_decoded(folder):
    Image.new("L", (2048, 2048), 254).save(folder / "floor.jpg", progressive=True)
    content = (folder / "floor.jpg").read_bytes()
    last = content.rindex(b"\xff\xda")
    scans = content[:last] + content[last:-2] * 20_000 + content[-2:]
    (folder / "floor.jpg").write_bytes(scans)
    refused(lambda: read_ros_map(described(folder, "floor.jpg")), "floor.jpg", "100 scans", "PNG")


# Thresholds.


@pytest.mark.parametrize(
    ("greys", "negate", "free", "mode", "words"),
    [
        ([254, 205, 205, 0], 0, 0.25, "trinary", ["2 cells of grey 205", "from 0.25 to 0.196"]),
        ([1, 50, 255, 255], 1, 0.25, "trinary", ["1 cells of grey 50", "from 0.25 to 0.196"]),
        ([254, 128, 205, 0], 0, 0.6, "trinary", ["2 cells of grey 128 and 205", "from 0.6 to 0.196"]),
        ([254, 127, 0, 0], 0, 0.51, "trinary", ["1 cells of grey 127", "from 0.51 to 0.501"]),
        ([254, 205, 0, 0], 0, 0.2, "scale", ["1 cells of grey 205", "from 0.2 to 0.196"]),
    ],
)
def test_one_warning_counts_unknown_cells_that_are_free(folder, greys, negate, free, mode, words):
    Image.fromarray(np.array([greys], np.uint8)).save(folder / "floor.png")
    path = described(folder, "floor.png", negate, free, mode)
    with pytest.warns(UserWarning, match="usual for unknown cells") as caught:
        before = read_ros_map(path)
    message = str(caught[0].message)
    assert len(caught) == 1
    assert "\n" not in message
    for word in (str(path), "free_thresh", *words):
        assert word in message
    lower = float(message.partition(" to ")[2].split()[0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        after = read_ros_map(described(folder, "floor.png", negate, lower, mode))
    assert after.blocked.sum() - before.blocked.sum() == int(words[0].split()[0])


@pytest.mark.parametrize("mode", ["trinary", "scale"])
def test_nothing_is_warned_of_where_unknown_cells_are_blocked(folder, mode):
    Image.fromarray(np.array([[254, 205, 128, 0]], np.uint8)).save(folder / "floor.png")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        made = read_ros_map(described(folder, "floor.png", mode=mode))
    assert made.blocked.tolist() == [[False, True, True, True]]


def test_values_above_100_are_unknown_in_mode_raw(folder):
    Image.fromarray(np.array([[0, 19, 20, 100, 101, 255]], np.uint8)).save(folder / "floor.png")
    made = read_ros_map(described(folder, "floor.png", free=0.2, mode="raw"))
    assert made.blocked.tolist() == [[False, False, True, True, True, True]]
    path = described(folder, "floor.png", negate=1, mode="raw")
    refused(lambda: read_ros_map(path), str(path), "negate must be 0 in mode raw", "got '1'")


# Places.


def grey_at(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(np.array([[254, 0]], np.uint8)).save(path)


@pytest.mark.parametrize(
    "name", ["../floor.png", "../images/floor.png", "../images/deep/floor.PGM", "images/floor", "absolute"]
)
def test_a_picture_may_lie_below_the_parent_folder(folder, name):
    name = str(folder.parent / "images" / "floor.png") if name == "absolute" else name
    content = io.BytesIO()
    Image.fromarray(np.array([[254, 0]], np.uint8)).save(content, "PPM" if "PGM" in name else "PNG")
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content.getvalue())
    assert read_ros_map(described(folder, name)).blocked.tolist() == [[False, True]]


@pytest.mark.parametrize("target", ["beside.png", "../images/floor.png", "../../elsewhere/floor.png"])
def test_a_link_to_a_picture_is_followed(folder, target):
    grey_at(folder / target)
    (folder / "link.png").symlink_to(target)
    assert read_ros_map(described(folder, "link.png")).blocked.tolist() == [[False, True]]


def test_a_folder_whose_files_are_links_is_read(folder):
    # So do tools of ROS that build a workspace.
    source = folder.parent.parent / "source"
    grey_at(source / "floor.png")
    (source / "plan").symlink_to(source / "floor.png")  # without an ending
    described(source, "plan")
    for name in ("floor.yaml", "plan"):
        (folder / name).symlink_to(source / name)
    assert read_ros_map(folder / "floor.yaml").blocked.tolist() == [[False, True]]


@pytest.mark.parametrize(
    ("image", "words"),
    [
        ("../../elsewhere/floor.png", ["below its parent folder", "put a link to it there"]),
        ("/elsewhere/floor.png", ["below its parent folder", "got '/elsewhere/floor.png'"]),
        ("/elsewhere/beside.png", ["write image: beside.png"]),
        ("../secret.txt", ["a picture (.pgm, .png,", "secret.txt"]),
        ("/etc/passwd", ["a picture (.pgm, .png,", "got '/etc/passwd'"]),
        ("link", ["a picture (.pgm, .png,", "got 'link', which is "]),
        ("link.png", ["a picture (.pgm, .png,", "got 'link.png', which is "]),
        ("nowhere/../../../elsewhere/floor.png", ["below its parent folder"]),
        ("missing.png", ["image", "cannot be read: No such file"]),
        (".", ["a file name"]),
    ],
)
def test_other_places_are_refused(folder, image, words):
    grey_at(folder.parent.parent / "elsewhere" / "floor.png")
    grey_at(folder / "beside.png")
    (folder.parent / "secret.txt").write_text("secret")
    (folder / "link").symlink_to("/dev/zero")
    (folder / "link.png").symlink_to("/etc/passwd")
    path = described(folder, image)
    message = message_of(lambda: read_ros_map(path))
    for word in (str(path), *words):
        assert word in message
    assert "root:" not in message


@pytest.mark.parametrize("kind", [*(["fifo"] if hasattr(os, "mkfifo") else []), "folder", "loop", "text"])
def test_what_has_the_name_of_a_picture_only_is_refused(folder, kind):
    place = folder / "floor.png"
    if kind == "fifo":
        os.mkfifo(place)
    elif kind == "folder":
        place.mkdir()
    elif kind == "loop":
        place.symlink_to(place)
    else:
        place.write_text("secret words\n" * 9)
    message = message_of(lambda: read_ros_map(described(folder, "floor.png")))
    assert "floor.png" in message
    assert "secret" not in message


def test_the_parent_of_a_folder_at_the_top_is_not_searched():
    path = Path("/maps/floor.yaml")
    refused(lambda: ros_image.locate_picture(path, "../home/me/floor.png"), "parent folder")
    assert ros_image.locate_picture(path, "deep/floor.png") == Path("/maps/deep/floor.png")
