"""Files of a plan: several at once, all checked before planning, and none of them half written."""

import io
import json
import re
import sys
from xml.etree import ElementTree

import numpy as np
import pytest

from swarm_gym.errors import SettingError
from swarm_gym.files import write_atomically
from swarm_gym.plan import main
from swarm_gym.planning import drawing, plan, writing
from swarm_gym.scenarios import GridMap

COMMAND = ["--map", "case1", "--budget", "500"]


@pytest.fixture
def unplanned(monkeypatch):
    """Fail if anything is planned."""

    def planned(*_, **__):
        raise AssertionError("a path was planned")

    monkeypatch.setattr(sys.modules["swarm_gym.plan"], "plan", planned)


def outputs(*paths):
    return [word for path in paths for word in ("--output", str(path))]


def test_all_files_are_written(tmp_path, capsys):
    files = [tmp_path / name for name in ("a.csv", "a.yaml", "b.geojson", "deep/c.svg", "d.csv")]
    assert main([*COMMAND, *outputs(*files)]) == 0
    assert all(str(file) in capsys.readouterr().out for file in files[:1])
    assert sorted(path for path in tmp_path.rglob("*") if path.is_file()) == sorted(files)
    table = np.loadtxt(files[0], delimiter=",", skiprows=1)
    assert json.loads(files[2].read_text())["geometry"]["coordinates"] == table.tolist()
    assert files[0].read_bytes() == files[4].read_bytes()


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["a.csv", "a.doc"], "a.doc': the name must end with .csv, .geojson, .yaml, .svg, .png"),
        (["a.doc", "a.csv"], "a.doc': the name must end with .csv"),
        (["a.csv", "folder.csv"], "folder.csv': a folder; name a file in it"),
        (["a.csv", "a.yaml", "a.csv"], "a.csv': two outputs have this name"),
    ],
)
def test_all_names_are_checked_before_anything_is_planned(tmp_path, names, message, unplanned, capsys):
    (tmp_path / "folder.csv").mkdir()
    assert main([*COMMAND, *outputs(*(tmp_path / name for name in names))]) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1
    assert list(tmp_path.rglob("*")) == [tmp_path / "folder.csv"]


def test_a_png_needs_pillow_before_anything_is_planned(tmp_path, monkeypatch, unplanned, capsys):
    monkeypatch.setitem(sys.modules, "PIL", None)
    assert main([*COMMAND, *outputs(tmp_path / "a.csv", tmp_path / "a.png")]) == 2
    assert "a.png' needs Pillow: run `pip install 'swarm_gym[maps]'`" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_no_file_is_written_before_all_contents_are_complete(tmp_path, monkeypatch):
    def failing(_):
        raise SettingError("no picture")

    monkeypatch.setitem(writing.FORMATS, ".svg", failing)
    found = plan("case1", max_evaluations=500)
    with pytest.raises(SettingError, match="no picture"):
        writing.write_plan(found, tmp_path / "a.csv", tmp_path / "a.svg")
    assert not list(tmp_path.iterdir())


def test_a_file_that_cannot_be_written_is_named_and_the_others_are_whole(tmp_path, monkeypatch, capsys):
    def filling(path, content):
        if path.name == "b.csv":
            raise OSError(28, "No space left on device", str(path))
        return write_atomically(path, content)

    monkeypatch.setattr(writing, "write_atomically", filling)
    assert main([*COMMAND, *outputs(tmp_path / "a.csv", tmp_path / "b.csv")]) == 2
    assert "b.csv': cannot be written: No space left on device" in capsys.readouterr().err
    assert len(np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1)) > 2


def test_a_name_below_a_file_is_refused_before_anything_is_planned(tmp_path, unplanned, capsys):
    (tmp_path / "file").write_text("")
    assert main([*COMMAND, *outputs(tmp_path / "file" / "folder" / "b.csv")]) == 2
    assert f"'{tmp_path / 'file'}' is a file, no folder for it" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["small.yaml", "small.png"])
def test_neither_a_map_nor_its_picture_is_replaced(tmp_path, name, unplanned, capsys):
    pytest.importorskip("yaml", reason="needs the extra `maps`")
    (tmp_path / "small.png").write_bytes(b"a picture")
    (tmp_path / "small.yaml").write_text(
        "image: small.png\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
        "free_thresh: 0.196\n"
    )
    before = (tmp_path / name).read_bytes()
    command = ["--map", str(tmp_path / "small.yaml"), "--start", "1,1", "--goal", "2,2"]
    assert main([*command, *outputs(tmp_path / name)]) == 2
    assert "this command reads it; name another file" in capsys.readouterr().err
    assert (tmp_path / name).read_bytes() == before


SPACE = '{"type": "Polygon", "coordinates": [[[-1, -1], [11, -1], [11, 11], [-1, 11], [-1, -1]]]}'
BLOCK = '{"type": "Polygon", "coordinates": [[[4, 4], [5, 4], [5, 5], [4, 5], [4, 4]]]}'
OVER_BLOCK = ["--map", "map.geojson", "--start", "0,0", "--goal", "10,10"]


@pytest.mark.parametrize(
    ("command", "names"),
    [
        ([*OVER_BLOCK, "--workspace", "space.geojson"], ["space.geojson"]),
        ([*OVER_BLOCK, "--previous", "before.csv"], ["before.csv"]),
        ([*OVER_BLOCK, "--previous", "before-2.csv", "--alternatives", "2"], ["before.csv"]),
        ([*OVER_BLOCK, "--alternatives", "2"], ["floor.yaml"]),
        ([*OVER_BLOCK, "--alternatives", "3"], ["k.csv", "k-2.csv"]),
        (["--map", "ros:floor-2.yaml?start=1,1&goal=2,2"], ["floor-2.yaml"]),
        (
            ["--map", "terrain-file:dem.asc?start=1,1,150&goal=2,2,150&threats=space.geojson"],
            ["space.geojson"],
        ),
    ],
)
def test_neither_inputs_nor_other_outputs_are_replaced(
    tmp_path, monkeypatch, command, names, unplanned, capsys
):
    pytest.importorskip("yaml", reason="needs the extra `maps`")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "map.geojson").write_text(BLOCK)
    (tmp_path / "space.geojson").write_text(SPACE)
    (tmp_path / "floor-2.yaml").write_text(
        "image: floor.png\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
        "free_thresh: 0.196\n"
    )
    for name in ("before.csv", "before-2.csv"):
        (tmp_path / name).write_text("x,y\n0,0\n10,0\n10,10\n")
    if "floor.yaml" in names:
        command = ["--map", "floor-2.yaml", *command[2:]]
    before = {file.name: file.read_text() for file in tmp_path.iterdir()}
    assert main([*command, *outputs(*names)]) == 2
    assert re.search("this command reads it|two outputs have this name", capsys.readouterr().err)
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == before


def test_ctrl_c_before_a_path_is_there_is_one_line(monkeypatch, capsys):
    def stopped(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(sys.modules["swarm_gym.plan"], "plan", stopped)
    assert main(COMMAND) == 130
    assert capsys.readouterr().err == "interrupted before a path was found or written\n"


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (["--wishes", "distance=2,distance=3"], "distance is given twice in 'distance=2,distance=3'"),
        (["--switch-margin", "0.2"], "--switch-margin: it compares with a previous path"),
    ],
)
def test_options_without_an_effect_are_refused(option, message, unplanned, capsys):
    try:
        status = main([*COMMAND, *option])
    except SystemExit as ended:
        status = ended.code
    assert status == 2
    assert message in capsys.readouterr().err


def test_numbers_of_a_ros_path_are_numbers_and_names_of_maps_are_text(tmp_path, monkeypatch):
    yaml = pytest.importorskip("yaml", reason="needs the extra `maps`")
    monkeypatch.chdir(tmp_path)
    name = "a&b <c>.geojson"
    (tmp_path / name).write_text(BLOCK)
    command = ["--map", name, "--start", "0.00001,0", "--goal", "10,0.00002"]
    assert main([*command, *outputs("a.yaml", "a.svg")]) == 0
    poses = yaml.safe_load((tmp_path / "a.yaml").read_text())["poses"]
    numbers = [number for one in poses for part in one["pose"].values() for number in part.values()]
    assert {type(number) for number in numbers} == {float}
    assert numbers[:2] == [1e-5, 0.0]
    title = ElementTree.parse(tmp_path / "a.svg").getroot()[0].text
    assert title.endswith("on a&b <c>")


@pytest.mark.parametrize(("width", "height"), [(10, 1200), (1200, 10)])
def test_pictures_of_long_maps_have_a_largest_size(tmp_path, monkeypatch, width, height):
    image = pytest.importorskip("PIL.Image", reason="needs the extra `maps`")
    grid = GridMap("long", np.zeros((height, width), np.bool_))
    found = plan(grid, (1.0, 1.0), (width - 2.0, height - 2.0))
    drawn = image.open(io.BytesIO(drawing.as_png(found)))
    limit = round(drawing.WIDTH), round(drawing.HEIGHT)
    assert drawn.size == ((30, 3600) if height > width else (900, 8))
    assert all(size <= most for size, most in zip(drawn.size, limit, strict=True))
    assert drawn.getpixel((drawn.size[0] // 2, drawn.size[1] // 2)) != (255, 255, 255)  # the path
