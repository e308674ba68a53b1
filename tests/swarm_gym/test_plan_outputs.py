"""Files of a plan: several at once, all checked before planning, and none of them half written."""

import json
import sys

import numpy as np
import pytest

from swarm_gym.errors import SettingError
from swarm_gym.plan import main
from swarm_gym.planning import plan, writing

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
        (["a.csv", "a.yaml", "a.csv"], "a.csv': given twice"),
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


def test_a_file_that_cannot_be_written_is_named_and_the_others_are_whole(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main([*COMMAND, *outputs(tmp_path / "a.csv", tmp_path / "file" / "b.csv")]) == 2
    assert str(tmp_path / "file") in capsys.readouterr().err
    assert len(np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1)) > 2
