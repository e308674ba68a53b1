"""The options of each algorithm: on command lines, in presets and in stored configurations."""

import dataclasses
import json
import subprocess
import sys

import pytest

from agents.train import main, read_command_line
from helpers.slow import slow_but
from helpers.trainings import EVOLUTION, STEPS, train
from swarm_gym.runs.folder import RunFolderError, as_json
from swarm_gym.training.algorithms import (
    ALGORITHMS,
    DQN,
    EVERY_OPTION,
    PPO,
    DevicePPO,
    Evolution,
    foreign_options,
    option_names,
)
from swarm_gym.training.config import SHARED, TrainConfig, stored_config
from swarm_gym.training.learners import LEARNERS
from swarm_gym.training.presets import load_preset

# Presets as earlier versions had them, without a table.
EARLIER = {
    "three-cases": """
        scenarios = ["case1", "case2", "case3"]
        validation_seeds = 128
        base = "open-loop:three-cases"
        corrected_from = 15
        warm_start = "none"
        initial_population_size = 60
        observation = "priced"
        reward = "optimality"
        price = [0.3, 5.0]
        num_swarms = 256
        group_size = 8
        critic = false
        gae_lambda = 1.0
        noise_steps = 0
        log_std = -3.5
        averaging = 0.8
        learning_rate = 5e-4
        decay_steps = 1_000_000
        batch_size = 5_440
        rollouts_per_chunk = 9
        total_steps = 1_000_000
    """,
    "three-cases-evolution": """
        like = "three-cases"
        algorithm = "evolution"
        critic = true
        group_size = 1
        noise_steps = 1
        averaging = 0.0
        decay_steps = 0
        candidates = 16
        num_swarms = 384
        sigma = 0.02
        rollouts_per_chunk = 6
    """,
    "ablation-dqn": """
        like = "ablation-all"
        algorithm = "dqn"
        critic = true
        group_size = 1
        noise_steps = 1
        averaging = 0.0
        num_swarms = 64
        batch_size = 256
        return_steps = 20
        exploration_steps = 150_000
        rollouts_per_chunk = 16
        total_steps = 307_200
        decay_steps = 307_200
    """,
    "three-cases-sourced-ppo": """
        like = "three-cases-sourced"
        algorithm = "ppo"
    """,
}


@pytest.fixture
def preset(tmp_path):
    def write(content, name="mine"):
        path = tmp_path / f"{name}.toml"
        path.write_text(content)
        return str(path)

    return write


def test_every_algorithm_has_options_of_its_own_name_and_a_learner():
    assert ALGORITHMS.keys() == LEARNERS.keys()
    for name, algorithm in ALGORITHMS.items():
        assert algorithm().name == name
        assert not {*option_names(algorithm)} & {*SHARED}


@pytest.mark.parametrize("name", ["three-cases", "three-cases-evolution", "ablation-dqn"])
def test_a_preset_of_an_earlier_version_is_read_as_before(preset, name):
    assert load_preset(preset(EARLIER[name], name)) == load_preset(name)


def test_presets_of_earlier_versions_may_be_like_each_other(preset):
    base = preset(EARLIER["three-cases"], "three-cases")
    flat = EARLIER["three-cases-evolution"].replace('"three-cases"', f"'{base}'")
    assert load_preset(preset(flat, "three-cases-evolution")) == load_preset("three-cases-evolution")


def test_an_earlier_preset_that_trains_otherwise_than_the_one_it_is_like_still_imitates_nothing(preset):
    config = load_preset(preset(EARLIER["three-cases-sourced-ppo"]))
    assert (config.algorithm, config.base) == (PPO(warm_start="none"), "open-loop:three-cases-sourced/0@1")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            'algorithm = "dqn"\ngroup_size = 8',
            "group_size 8 is for algorithm 'ppo' or 'device-ppo' only",
        ),
        ('algorithm = "evolution"\nwarm_start = "spsfa-tip"', "evolution imitates no controller"),
        ('algorithm = "sac"', "algorithm 'sac'.*recurrent-ppo"),
        ("algorithm = 3", "algorithm must be of type string, got 3"),
        ('[algorithm]\nname = "sac"', "algorithm 'sac'.*recurrent-ppo"),
        ("[algorithm]\nname = 3", "algorithm: name must be of type string, got 3"),
        (
            '[algorithm]\nname = "dqn"\nclip_range = 0.1',
            "algorithm: unknown key 'clip_range', expected",
        ),
        ("[algorithm]\nepochs = 1.5", "algorithm: epochs must be of type integer, got 1.5"),
        ("[algorithm]\nseed = 1", "algorithm: unknown key 'seed'"),
        ('[algorithm]\nwarm_start = "mine:Rule"', "names own code|mine:Rule"),
    ],
)
def test_options_that_an_algorithm_lacks_are_refused_in_presets(preset, content, message):
    with pytest.raises(ValueError, match=message):
        load_preset(preset(content))


def test_a_table_changes_the_options_of_the_algorithm_that_it_is_like(preset):
    base = preset('seed = 4\n[algorithm]\nname = "dqn"\nlearning_rate = 1e-3\nreplay_size = 9', "base")
    same = load_preset(preset(f"like = '{base}'\n[algorithm]\nreplay_size = 8"))
    assert (same.seed, same.algorithm) == (4, DQN(learning_rate=1e-3, replay_size=8))
    other = load_preset(preset(f"like = '{base}'\n[algorithm]\nname = 'device-ppo'\ngroup_size = 2"))
    assert (other.seed, other.algorithm) == (4, DevicePPO(learning_rate=1e-3, group_size=2))


def test_an_option_that_does_not_exist_is_refused_by_name():
    with pytest.raises(ValueError, match=r"unknown options \['sed'\]"):
        TrainConfig().changed(sed=3)


@pytest.mark.parametrize("name", ALGORITHMS)
def test_options_are_read_back_from_what_is_stored(name):
    config = TrainConfig(algorithm=ALGORITHMS[name]())
    stored = as_json(config.options())
    assert stored["algorithm"] == name
    del stored["runs"]  # a path, which no manifest has
    assert stored_config({"config": stored}) == config


def test_a_stored_configuration_of_an_earlier_version_has_the_options_of_all_algorithms():
    others = {option: default for option, (_, default) in EVERY_OPTION.items()}
    stored = {
        **others,
        "algorithm": "evolution",
        "candidates": 8,
        "warm_start": "none",
        "epochs": 3,
    }
    assert stored_config({"config": stored}) == TrainConfig(algorithm=Evolution(candidates=8))


def test_a_run_of_an_earlier_version_is_resumed_with_the_same_options_only(tmp_path):
    train(tmp_path, **EVOLUTION, total_steps=4).run()
    path = tmp_path / "ppo" / "config.json"
    stored = json.loads(path.read_text())
    assert not {*stored} & foreign_options("evolution")
    others = {option: EVERY_OPTION[option][1] for option in foreign_options("evolution")}
    path.write_text(json.dumps({**stored, **others, "warm_start": "none"}))
    run = train(tmp_path, **EVOLUTION, total_steps=2 * STEPS, resume=True)
    run.run()
    assert run.learner.num_steps >= 2 * STEPS
    with pytest.raises(RunFolderError, match=r"sigma was 0\.1, is 0\.2"):
        train(tmp_path, **EVOLUTION, sigma=0.2, resume=True)


def test_a_command_line_gives_options_of_the_algorithm_that_it_names():
    given = read_command_line(
        ["--algorithm", "dqn", "--size-choices", "-0.5", "0.5", "--seeds", "1", "2", "--learning-rate=1e-3"]
    )
    kept = load_preset(TrainConfig.preset).algorithm
    assert given.config.algorithm == DQN(
        size_choices=(-0.5, 0.5), learning_rate=1e-3, batch_size=kept.batch_size, decay_steps=kept.decay_steps
    )
    assert given.seeds == (1, 2)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--group-size", "1", "--no-branch-at-events", "--critic", "--candidates", "8"],
        ["--candidates=8", "--warm-start", "none", "--branches", "--seeds", "3"],
        ["--clip-range", "0.3", "--candidates", "8", "--size_choices", "-0.3", "-0.15", "0", "0.15", "0.3"],
    ],
)
def test_options_of_other_algorithms_that_have_no_effect_are_accepted(arguments, capsys):
    given = read_command_line(["--preset", "three-cases", "--algorithm", "evolution", *arguments])
    expected = dataclasses.replace(load_preset("three-cases"), algorithm=Evolution(candidates=8))
    assert given.config == expected
    note = "note: --clip-range 0.3 changes nothing with evolution\n" if "--clip-range" in arguments else ""
    assert capsys.readouterr().err == note


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--algorithm", "sac"], "error: unknown algorithm 'sac'"),
        (["--algorithm", "dqn", "--group-size", "4"], "error: group_size 4 is for algorithm 'ppo' or"),
        (["--algorithm", "evolution", "--no-critic"], "error: critic False is for algorithm"),
        (["--algorithm", "evolution", "--warm-start", "spsfa"], "warm_start must be 'none', got 'spsfa'"),
        (["--replay-size", "5"], "error: replay_size 5 is for algorithm 'dqn' only, got 'ppo'"),
    ],
)
def test_options_of_other_algorithms_that_would_have_an_effect_are_refused(tmp_path, arguments, message):
    with pytest.raises(SystemExit, match=message):
        main([*arguments, "--runs", str(tmp_path)])
    assert list(tmp_path.iterdir()) == []


def test_an_option_of_another_algorithm_needs_a_value_of_its_type(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--algorithm", "dqn", "--group-size", "many"])
    assert ended.value.code == 2
    assert "many" in capsys.readouterr().err


@pytest.mark.parametrize("name", ALGORITHMS)
def test_the_help_has_the_options_of_one_algorithm(name, capsys):
    with pytest.raises(SystemExit):
        main(["--algorithm", name, "--help"])
    words = {word.split("=")[0].strip(",") for word in capsys.readouterr().out.split()}
    shown = {option for option in EVERY_OPTION if f"--{option.replace('_', '-')}" in words}
    assert shown == {*option_names(ALGORITHMS[name])}


@pytest.mark.parametrize(
    "command",
    slow_but(["agents.train"], ["swarm_gym.training.command_line", "agents.train"]),
)
def test_a_command_imports_neither_torch_nor_the_simulation_before_it_trains(command):
    code = f"import sys, {command}; print(*sys.modules)"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    modules = found.stdout.split()
    ours = [name for name in modules if name.partition(".")[0] in ("swarm_gym", "agents", "experiments")]
    assert len(ours) <= 120
    assert command in ours
    assert not {"torch", "stable_baselines3", "swarm_gym.simulation"} & {*modules}
