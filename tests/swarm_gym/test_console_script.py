"""The console script runs the commands of the package."""

import sys
import tomllib
from pathlib import Path

import pytest

from swarm_gym.__main__ import COMMANDS, main
from swarm_gym.controllers import packaged


@pytest.fixture(autouse=True)
def _arguments_return(monkeypatch):
    monkeypatch.setattr(sys, "argv", list(sys.argv))


def test_without_a_command_it_lists_all(capsys):
    main([])
    printed = capsys.readouterr().out
    assert all(name in printed for name in COMMANDS)


@pytest.mark.parametrize("name", COMMANDS)
def test_each_command_has_a_help(name, capsys):
    with pytest.raises(SystemExit) as ended:
        main([name, "--help"])
    assert ended.value.code == 0
    assert "usage: " in capsys.readouterr().out


def test_arguments_reach_the_command(tmp_path, capsys):
    path = tmp_path / "path.csv"
    with pytest.raises(SystemExit) as ended:
        main(["plan", "--map", "case2", "--budget", "300", "--output", str(path)])
    assert ended.value.code == 0
    assert path.exists()


def test_an_unknown_command_is_refused_with_the_valid_ones(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["fly"])
    assert ended.value.code == 2
    assert "unknown command 'fly'; valid: plan, train, tune" in capsys.readouterr().err


def test_a_command_of_the_laboratory_says_that_it_needs_a_checkout(tmp_path, monkeypatch):
    monkeypatch.setattr(packaged, "LABORATORY", tmp_path)
    with pytest.raises(SystemExit, match=r"swarm-gym verify belongs to the laboratory.*a checkout"):
        main(["verify", "--help"])


@pytest.mark.parametrize("name", ["train", "tune"])
def test_a_command_without_its_extra_says_how_to_install_it(name, monkeypatch):
    monkeypatch.delitem(sys.modules, COMMANDS[name].module, raising=False)
    monkeypatch.setitem(sys.modules, "tyro", None)
    with pytest.raises(
        SystemExit, match=rf"swarm-gym {name} needs tyro: run `pip install 'swarm_gym\[train\]'`"
    ):
        main([name, "--help"])


def test_a_command_finds_own_code_in_the_folder_where_it_is_called(tmp_path, monkeypatch):
    (tmp_path / "code_of_mine.py").write_text("def main():\n    return 7\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place not in ("", str(tmp_path))])
    monkeypatch.setitem(COMMANDS, "plan", COMMANDS["plan"]._replace(module="code_of_mine"))
    with pytest.raises(SystemExit) as ended:
        main(["plan"])
    assert ended.value.code == 7


def test_a_command_that_is_interrupted_while_it_is_imported_ends_with_130(monkeypatch, capsys):
    def interrupted(_):
        raise KeyboardInterrupt

    monkeypatch.setattr("swarm_gym.__main__.import_module", interrupted)
    with pytest.raises(SystemExit) as ended:
        main(["plan"])
    assert ended.value.code == 130
    assert capsys.readouterr().err == "interrupted before it began\n"


def test_the_package_declares_the_script():
    content = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    assert content["project"]["scripts"] == {"swarm-gym": "swarm_gym.__main__:main"}
