"""Presets and the command line of training."""

import dataclasses
from pathlib import Path

import pytest

from agents import make_controller
from agents.train import main, read_command_line, read_configs
from helpers.loops import looped
from swarm_gym.training.algorithms import PPO
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.learners import LEARNERS
from swarm_gym.training.learners.checks import require_options
from swarm_gym.training.presets import PresetError, load_preset, preset_names


@looped("name", preset_names())
def test_every_packaged_preset_loads(name):
    config = load_preset(name)
    assert config.preset == name
    assert config.algorithm.name in LEARNERS
    require_options(config)
    if config.base != "none":  # as many members as the controller that it corrects
        base = make_controller(config.base, config.limits)
        assert config.initial_population_size == base.initial_population_size


def test_the_default_preset_is_packaged():
    assert TrainConfig.preset in preset_names()


@pytest.fixture
def preset(tmp_path):
    path = tmp_path / "mine.toml"

    def write(content):
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return str(path)

    return write


def test_a_preset_changes_what_it_names(preset):
    config = load_preset(
        preset('price = [1, 2.5]\nscenarios = ["case1"]\nseed = 4\nlog_std = -2\nruns = "x"')
    )
    assert config == TrainConfig(
        "mine", runs=Path("x"), price=(1.0, 2.5), scenarios=("case1",), seed=4, algorithm=PPO(log_std=-2.0)
    )
    assert isinstance(config.price[0], float)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("sed = 3", "unknown key 'sed'.*seed"),
        ('preset = "other"', "unknown key 'preset'"),
        ("seed = 1.5", "seed must be of type integer, got 1.5"),
        ("seed = true", "seed must be of type integer, got True"),
        ('seed = "3"', "seed must be of type integer"),
        ("resume = 1", "resume must be of type boolean"),
        ("price = 0.5", "price must be a list, got 0.5"),
        ('price = ["a"]', "price must be of type float"),
        ('scenarios = "case1"', "scenarios must be a list"),
        ("scenarios = [1]", "scenarios must be of type string, got 1"),
        ("hidden_layers = [8.0]", "hidden_layers must be of type integer"),
        ("runs = 3", "runs must be of type string"),
        ("[seed]\nvalue = 3", "seed must be of type integer"),
        ("like = 3", "like must be of type string, got 3"),
        ('like = "nowhere"', "like 'nowhere': preset 'nowhere': neither a packaged one .*three-cases"),
        (b"\xff\xfe", r"mine\.toml"),
        ("seed = ", "not a readable preset"),
        ("seed = 1\nseed = 2", "not a readable preset"),
    ],
)
def test_a_wrong_preset_is_refused_by_file_and_entry(preset, content, message):
    path = preset(content)
    with pytest.raises(PresetError, match=message) as error:
        load_preset(path)
    assert path in str(error.value)


def test_a_preset_like_another_one_changes_what_it_names(preset, tmp_path):
    (tmp_path / "other.toml").write_text("seed = 4\ntotal_steps = 7")
    config = load_preset(preset(f"like = '{tmp_path / 'other.toml'}'\ntotal_steps = 8"))
    assert config == TrainConfig(preset="mine", seed=4, total_steps=8)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        ("sed = 4", r"mine\.toml: like .*other\.toml: unknown key 'sed'"),
        ("like = '{mine}'", "it is like itself"),
    ],
)
def test_an_error_of_a_preset_that_another_one_is_like_names_both(preset, tmp_path, other, message):
    (tmp_path / "other.toml").write_text(other.format(mine=tmp_path / "mine.toml"))
    with pytest.raises(PresetError, match=message):
        load_preset(preset(f"like = '{tmp_path / 'other.toml'}'"))


@pytest.mark.parametrize("name", ["nowhere", "", ".", "agents"])
def test_a_missing_preset_names_the_packaged_ones(name):
    with pytest.raises(PresetError, match=r"neither a packaged one \(.*, see .*presets\)\) nor a file"):
        load_preset(name)


def test_options_change_the_preset(preset):
    path = preset("seed = 4\ntotal_steps = 7")
    for arguments in (["--preset", path, "--seed", "3"], ["--seed", "3", f"--preset={path}"]):
        given = read_command_line(arguments)
        assert given.config == TrainConfig(preset="mine", seed=3, total_steps=7)
        assert given.config.folder == Path("runs/mine/3")
        assert given.seeds == ()


def test_several_seeds_are_read():
    given = read_command_line(
        ["--preset", "three-cases", "--seeds", "0", "1", "--jobs", "2", "--price", "1", "2"]
    )
    assert (given.seeds, given.where.jobs, given.config.price) == ((0, 1), 2, (1.0, 2.0))


def test_several_presets_each_keep_their_own_options_with_all_seeds():
    arguments = ["--presets", "case1", "three-cases-linear", "--seeds", "3", "4", "--price", "1"]
    configs = read_configs(read_command_line(arguments), arguments)
    assert [str(config.folder) for config in configs] == [
        "runs/case1/3", "runs/case1/4", "runs/three-cases-linear/3", "runs/three-cases-linear/4"
    ]  # fmt: skip
    for config in configs:
        assert config == dataclasses.replace(load_preset(config.preset), seed=config.seed, price=(1.0,))
    arguments += ["--name", "mine"]
    configs = read_configs(read_command_line(arguments), arguments)
    assert [config.name for config in configs] == [
        "mine/case1/3", "mine/case1/4", "mine/three-cases-linear/3", "mine/three-cases-linear/4"
    ]  # fmt: skip


@pytest.mark.parametrize("option", ["--sed=3", "--seed=x", "--resum"])
def test_an_option_that_is_none_is_refused(option, capsys):
    with pytest.raises(SystemExit):
        read_command_line([option])
    assert option.split("=", maxsplit=1)[0] in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--preset", "nowhere"], "error: preset 'nowhere'"),
        (["--scenarios", "case9"], "error: .*case9"),
        (["--seeds", "1", "1"], "error: --seeds: each one once"),
        (["--presets", "case1", "case1"], "error: --presets: each one once, got case1 case1"),
        (["--presets", "case1", "nowhere"], "error: preset 'nowhere'"),
        (["--seeds", "1", "--jobs", "-1"], "error: --jobs must be positive"),
        (["--seeds", "1", "--address", "10.0.0.1:6379"], "error: --address 10.0.0.1:6379: --backend local"),
        (["--address", "auto"], "error: --address auto: --backend local has no address"),
        (["--backend", "slurm", "--address", "local"], "error: --backend slurm: give the number of jobs"),
    ],
)
def test_the_program_ends_with_one_line(tmp_path, arguments, message):
    with pytest.raises(SystemExit, match=message):
        main([*arguments, "--runs", str(tmp_path)])
    assert list(tmp_path.iterdir()) == []
