"""Outputs of commands: names are checked before any work, and no input is replaced."""

import os
import subprocess
import sys

import pytest

from agents import distil, export_onnx, import_sb3
from agents.distil import DistilConfig
from agents.import_sb3 import ImportOptions
from experiments.report.__main__ import ReportConfig, write_report
from swarm_gym.command import PIPE_CLOSED
from swarm_gym.comparing import command_line as comparing
from swarm_gym.errors import SettingError
from swarm_gym.outputs import files_named, require_outputs
from swarm_gym.scenarios.terrain import convert_uav56
from swarm_gym.tuning import run as tuning_run
from swarm_gym.tuning.config import TuneConfig


def test_files_are_found_in_names_of_controllers_and_scenarios(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a.safetensors", "b.yaml", "c+d.json", "e.geojson"):
        (tmp_path / name).write_text("")
    names = [
        f"firefly+learned:{tmp_path}/a.safetensors@0.3",
        "ros:b.yaml?start=0,0&goal=1,1",
        "tuned:c+d.json",
        "terrain-file:none.tif?threats=e.geojson&start=0,0",
    ]
    assert [[file.name for file in files_named(name)] for name in names] == [
        ["a.safetensors"], ["b.yaml"], ["c+d.json"], ["e.geojson"]
    ]  # fmt: skip
    assert files_named("fixed:60", "case1", None, "x" * 5000, "a\0b") == []


def test_outputs_that_cannot_be_or_are_read_are_refused(tmp_path):
    read = tmp_path / "read.csv"
    read.write_text("")
    (tmp_path / "link.csv").symlink_to(read)
    (tmp_path / "folder").mkdir()
    require_outputs([tmp_path / "new" / "a.csv", tmp_path / "b"], [read, "fixed:60", None])
    for names, message in (
        (["read.csv"], "this command reads it"),
        (["link.csv"], "this command reads it"),
        (["folder/../read.csv"], "this command reads it"),
        (["folder"], "a folder; name a file in it"),
        (["read.csv/a.csv"], "is a file, no folder for it"),
        (["a.csv", "folder/../a.csv"], "two outputs have this name"),
    ):
        with pytest.raises(SettingError, match=message):
            require_outputs([tmp_path / name for name in names], [read])
    with pytest.raises(SettingError, match=r"a\.txt': the name must end with \.csv, \.png"):
        require_outputs([tmp_path / "a.txt"], formats={".csv": None, ".png": None})


def test_a_folder_that_cannot_be_written_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr("swarm_gym.outputs.os.access", lambda place, _: place != tmp_path)
    with pytest.raises(SettingError, match=rf"a\.csv': the folder '.*{tmp_path.name}' cannot be written"):
        require_outputs([tmp_path / "deep" / "a.csv"])


def test_commands_of_policies_and_results_refuse_to_replace_what_they_read(tmp_path, monkeypatch):
    monkeypatch.setattr(distil, "make_controller", None)  # no work is begun
    monkeypatch.setattr(export_onnx, "load_policy", None)
    monkeypatch.setattr(comparing, "compare", None)
    file = tmp_path / "kept.safetensors"
    file.write_text("kept")
    commands = (
        lambda: distil.run_distillation(DistilConfig(f"learned:{file}@1", file)),
        lambda: export_onnx.main([str(file), str(file)]),
        lambda: import_sb3.import_sb3(ImportOptions(file, file)),
        lambda: comparing.main([f"firefly+learned:{file}@1", "fixed:20", "--output", str(file)]),
        lambda: convert_uav56.main([str(file), "--output", str(file)]),
        lambda: write_report(ReportConfig(file, output=file)),
    )
    for run in commands:
        with pytest.raises((SettingError, SystemExit), match="this command reads it; name another file"):
            run()
    assert file.read_text() == "kept"


def test_outputs_below_a_file_are_refused_before_any_work(tmp_path, monkeypatch):
    monkeypatch.setattr(comparing, "compare", None)
    monkeypatch.setattr(distil, "make_controller", None)
    monkeypatch.setattr(tuning_run, "prepare_folder", None)
    (tmp_path / "file").write_text("")
    below = tmp_path / "file" / "a.csv"
    config = TuneConfig(what="open-loop", output=below, total_steps=10**6, runs=tmp_path / "runs")
    for run in (
        lambda: comparing.main(["fixed:20", "--output", str(below)]),
        lambda: distil.run_distillation(DistilConfig("learned:three-cases/0@1", below)),
        lambda: tuning_run.TuningRun(config),
    ):
        with pytest.raises((SettingError, SystemExit), match="is a file, no folder for it"):
            run()


@pytest.mark.skipif(os.name == "nt", reason="Windows has no pipe that a reader closes so")
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_results_are_written_though_nobody_reads_what_is_printed(tmp_path, unbuffered):
    path = tmp_path / "path.csv"
    for command in (
        ["plan", "--map", "case2", "--budget", "300", "--output", str(path)],
        ["--help"],
        ["plan", "--help"],
    ):
        with subprocess.Popen(
            [sys.executable, "-m", "swarm_gym", *command],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
        ) as process:
            process.stdout.close()
            said = process.stderr.read().decode()
        # argparse passes over the error of an output without buffer.
        assert process.returncode in ((PIPE_CLOSED, 0) if command[1:] == ["--help"] else (PIPE_CLOSED,)), said
        assert "Broken pipe" not in said
        assert "Traceback" not in said
    assert path.exists()
