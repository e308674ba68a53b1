"""Names of maps for the planner: which file or scenario each means, and one line for what is neither."""

import os
from pathlib import Path

import numpy as np
import pytest

from swarm_gym.errors import ScenarioError
from swarm_gym.plan import main
from swarm_gym.planning import plan
from swarm_gym.planning.map_names import is_map_file
from swarm_gym.planning.maps import GEOJSON, READERS
from swarm_gym.planning.tasks import read_task

ENDINGS = (*READERS, *GEOJSON)
MAP = "type octile\nheight 3\nwidth 5\nmap\n.....\n..@..\n..@..\n"
FIELD = '{"type": "Polygon", "coordinates": [[[2, 0], [3, 0], [3, 2], [2, 2], [2, 0]]]}'
YAML = "image: {}\nresolution: 1\norigin: [{}]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
WALL = np.array([[254, 254, 254, 254, 254], [254, 254, 0, 254, 254], [254, 254, 0, 254, 254]], np.uint8)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return the current folder, which is empty, and beside the data folder."""
    (tmp_path / "here").mkdir()
    (tmp_path / "data").mkdir()
    monkeypatch.setenv("SWARM_GYM_DATA", str(tmp_path / "data"))
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


def ros_map(path, origin="0, 0, 0"):
    image = pytest.importorskip("PIL.Image", reason="needs the extra `maps`")
    pytest.importorskip("yaml", reason="needs the extra `maps`")
    image.fromarray(WALL).save(path.with_name("wall.png"))
    path.write_text(YAML.format("wall.png", origin))


def message_of(name):
    with pytest.raises(ScenarioError) as caught:
        plan(name, (0.0, 2.0), (4.0, 2.0))
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 300
    assert message.startswith(f"map {name!r}: ")
    return message


@pytest.mark.parametrize(
    "name", ["a.map", "a.MAP", "a.Map", "a#1.map", "what?.map", "a#1?start=0,0&goal=1,1.map", "case1.map"]
)
def test_a_file_of_moving_ai_is_read_whatever_its_name(folder, name):
    (folder / name).write_text(MAP)
    for given in (name, Path(name), folder / name):
        task = read_task(given, (0.0, 2.0), (4.0, 2.0), 0.0)
        assert task.given.map.blocked.tolist() == [[False] * 5, *[[False, False, True, False, False]] * 2]


@pytest.mark.parametrize("name", ["a.yaml", "a.yml", "a.YAML", "a.YmL", "a#1.yaml", "a?b#.yml"])
def test_a_description_of_ros_is_read_whatever_its_name(folder, name):
    ros_map(folder / name)
    task = read_task(name, (0.5, 0.5), (4.5, 0.5), 0.0)
    np.testing.assert_array_equal(task.given.map.blocked, WALL == 0)


@pytest.mark.parametrize("name", ["a.geojson", "a.JSON", "a#1.GeoJSON"])
def test_geojson_is_read_whatever_its_name(folder, name):
    (folder / name).write_text(FIELD)
    assert len(read_task(name, (0.0, 1.0), (5.0, 1.0), 0.0).given.obstacles) == 1


def test_a_file_that_exists_wins_over_a_scenario(folder):
    name = "moving-ai:small#0.map"
    assert not is_map_file(name, ENDINGS)
    (folder / name).write_text(MAP)
    assert is_map_file(name, ENDINGS)
    assert read_task(name, (0.0, 2.0), (4.0, 2.0), 0.0).given.map.blocked.sum() == 2


@pytest.mark.parametrize("name", ["case1", "rooms:0", "random-fields:test:5", "some_module:attribute"])
def test_a_scenario_wins_over_a_folder_and_a_file_that_is_no_map(folder, name):
    (folder / name).mkdir()
    assert not is_map_file(name, ENDINGS)
    (folder / name).rmdir()
    (folder / name).write_text("notes")
    assert not is_map_file(name, ENDINGS)


def test_a_file_of_the_data_folder_is_found_with_any_ending(folder):
    data = folder.parent / "data"
    ros_map(data / "floor.yml")
    (data / "arena.MAP").write_text(MAP)
    (data / "no#1.map").write_text(MAP)
    assert read_task("floor.yml", (0.5, 0.5), (4.5, 0.5), 0.0).given.map.blocked.sum() == 2
    for name in ("arena.MAP", "no#1.map"):
        assert read_task(name, (0.0, 2.0), (4.0, 2.0), 0.0).given.map.blocked.sum() == 2


@pytest.mark.parametrize("name", ["floor.pgm", "floor.PNG", "floor.jpeg"])
def test_a_picture_is_refused_and_its_description_named(folder, name):
    message = message_of(name)
    assert "no such file, and by its ending a picture; name the YAML file" in message
    (folder / name).write_bytes(b"P5\n")
    assert "a picture; name the YAML file that describes it, with image, resolution" in message_of(name)
    (folder / "floor.yml").write_text("")
    assert message_of(name).endswith("name the YAML file that describes it: 'floor.yml'")


def test_a_folder_is_refused_and_its_maps_named(folder):
    (folder / "maps").mkdir()
    assert "a folder; it has no map; expected a map: .yaml or .yml" in message_of("maps")
    for name in ("b.yaml", "a.MAP", "notes.txt"):
        (folder / "maps" / name).write_text("")
    first, second = (os.path.join("maps", name) for name in ("a.MAP", "b.yaml"))
    assert message_of("maps").endswith(f"a folder; name a map in it: {first!r}, {second!r}")
    for k in range(40):
        (folder / "maps" / f"c{k:02}.yaml").write_text("")
    assert message_of("maps").endswith(" and 39 more")
    (folder / "folder.yaml").mkdir()
    assert "a folder; it has no map" in message_of("folder.yaml")


def test_a_file_of_problems_is_refused_and_its_map_named(folder):
    assert message_of("a.map.scen").endswith("a file of problems; name their map, a .map file")
    (folder / "a.map").write_text(MAP)
    assert message_of("a.map.scen").endswith("name their map, a .map file, such as 'a.map'")


@pytest.mark.parametrize("name", ["notes.txt", "notes", "deep/notes.txt", "floor.tiff", "no#1.txt"])
def test_another_file_is_refused_with_what_is_read(folder, name):
    (folder / "deep").mkdir()
    (folder / name).write_text("notes")
    expected = (
        "the file is not a map: .yaml or .yml of ROS's map_server, .map of Moving AI, .geojson or .json"
    )
    assert expected in message_of(name)
    (folder / name).unlink()
    if "." in name:
        assert "no file or scenario of this name; expected a map: .yaml" in message_of(name)


def test_what_is_missing_is_said_on_the_command_line(folder, capsys):
    assert main(["--map", "floor.yml", "--start", "0,0", "--goal", "1,1"]) == 2
    assert "no file floor.yml; searched" in capsys.readouterr().err
    assert main(["--map", "floor.pgm"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


# Coordinates of UTM, and the largest that a map may have.
@pytest.mark.parametrize("corner", [(388096.5, 5948996.25), (-999_999_000.0, 999_999_000.0)])
def test_a_plan_far_from_the_origin_is_the_plan_moved(folder, corner):
    ros_map(folder / "near.yaml")
    ros_map(folder / "far.yaml", f"{corner[0]}, {corner[1]}, 0")
    start, goal = np.array([0.25, 0.5]), np.array([4.75, 0.5])
    near = plan("near.yaml", tuple(start), tuple(goal), robot_radius=0.1, max_evaluations=300)
    far = plan("far.yaml", tuple(start + corner), tuple(goal + corner), robot_radius=0.1, max_evaluations=300)
    assert far.path[0].tolist() == (start + corner).tolist()
    assert far.path[-1].tolist() == (goal + corner).tolist()
    assert far.length == pytest.approx(near.length, abs=1e-3)
    assert far.clearance == pytest.approx(near.clearance, abs=1e-3)
    assert far.gap == pytest.approx(near.gap, abs=1e-3)
    assert far.gap > -1e-6
