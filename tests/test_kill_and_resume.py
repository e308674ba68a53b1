"""Commands that are killed and begun again until they end come out as if nothing had happened."""

import io
import json
import sqlite3
import subprocess
import sys
import time

import numpy as np
import optuna
import pytest
import torch
from event_files import shown
from trainings import STEPS, TINY

from agents.checkpoints import Checkpoints
from agents.policy_file import load_policy

if sys.platform == "win32":
    pytest.skip("there are no signals that kill", allow_module_level=True)

from kills import Command, Moment, run_killed_at, run_killed_at_random

pytestmark = pytest.mark.slow

KILLS = 20

TRAININGS = {
    "ppo": {"total_steps": 3 * STEPS},
    "evolution": {"algorithm": "evolution", "warm_start": "none", "candidates": 4, "total_steps": 3 * STEPS},
}
ROUND = {"open-loop": 4 * 4 * 100, "schedule": 4 * 100}
ROUNDS = {"open-loop": 4, "schedule": 14}  # Optuna's sampler begins after ten


def as_arguments(options):
    found = []
    for name, value in options.items():
        values = value if isinstance(value, tuple) else (value,)
        found += [f"--{name.replace('_', '-')}", *map(str, values)]
    return found


def resumed(folder):
    return ["--resume"] if (folder / "it" / "config.json").exists() else []


def training(algorithm, folder):
    options = {"preset": "three-cases-ppo", **TINY, **TRAININGS[algorithm], "runs": folder, "name": "it"}
    patches = {"agents.imitation.GRADIENT_STEPS": 20}
    return Command("agents.train", [*as_arguments(options), *resumed(folder)], patches)


def tuning(what, folder):
    options = {"episodes": 4, "scenarios": ("case3", "case1"), "max_population_size": 12, "what": what}
    options |= {
        "total_steps": ROUNDS[what] * ROUND[what],
        "runs": folder,
        "name": "it",
        "output": folder / "result.json",
    }
    if what == "open-loop":
        options |= {"candidates": 4, "initial_population_size": 6}
    patches = {"agents.tuning.run.ESTIMATE_EPISODES": 2}
    return Command("agents.tune", [*as_arguments(options), *resumed(folder)], patches)


def evaluation(folder, jobs=1):
    options = {"suite": "paper", "seeds": 3, "controllers": ("fixed:3", "spsfa-tip", "spsfa")}
    options |= {"jobs": jobs, "output": folder}
    return Command("experiments.evaluate", [*as_arguments(options), "--no-figures"], {})


def state_of(folder):
    """What the last checkpoint holds, but for names and sizes of the files of events."""
    state = Checkpoints(folder, ".pt").load(lambda content: content)
    stored = torch.load(io.BytesIO(state), weights_only=True)
    del stored["events"]
    # Memory that the strategy never wrote to, where fitness would be if it were asked whether to stop.
    stored["learner"].get("strategy", {}).pop("strategy._funhist_values", None)
    return stored


def assert_same_bits(one, other):
    assert type(one) is type(other)
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        for key in one:
            assert_same_bits(one[key], other[key])
    elif isinstance(one, list | tuple):
        assert len(one) == len(other)
        for mine, theirs in zip(one, other, strict=True):
            assert_same_bits(mine, theirs)
    elif isinstance(one, torch.Tensor | np.ndarray):
        one, other = np.asarray(one), np.asarray(other)
        assert (one.dtype, one.shape) == (other.dtype, other.shape)
        assert one.tobytes() == other.tobytes()
    else:
        assert one == other


def assert_same_training(whole, folder):
    """Policies with their manifests, checkpoint and events of two runs are equal, and no file is too many."""
    for name in ("best", "latest"):
        ours, theirs = (load_policy(place / f"{name}.safetensors") for place in (whole, folder))
        assert_same_bits(ours[0], theirs[0])
        manifests = ({**manifest, "provenance": ""} for _, manifest in (ours, theirs))  # its commit may move
        assert next(manifests) == next(manifests)
    assert_same_bits(state_of(whole), state_of(folder))
    expected = shown(whole)
    assert {len(values) for values in expected["scalars"].values()} >= {1, 3, 4}
    assert shown(folder) == expected
    assert shown(folder, purge=False) == expected  # nothing is there twice and only hidden
    names = {p.name for p in folder.iterdir() if not p.name.startswith("events")}
    assert names == {p.name for p in whole.iterdir() if not p.name.startswith("events")}


def assert_same_result(what, whole, folder):
    ours, theirs = (result(place / "result.json") for place in (whole, folder))
    assert ours == theirs == result(folder / "it" / f"{what}.json")
    ours, theirs = rounds(what, whole / "it"), rounds(what, folder / "it")
    assert len(ours) == ROUNDS[what]
    assert_same_bits(ours, theirs)


def result(path):
    """All that was found but for what it was made with, since the commit may move meanwhile."""
    content = json.loads(path.read_text())
    del content["manifest"]["provenance"]
    return content


def rounds(what, folder):
    """Every round: its points and losses."""
    if what == "open-loop":
        with np.load(io.BytesIO(Checkpoints(folder, ".npz").load(lambda c: c))) as stored:
            return list(zip(stored["points"], stored["losses"], strict=True))
    study = optuna.load_study(study_name="tune", storage=f"sqlite:///{folder / 'study.db'}")
    return [(t.params, t.value) for t in study.trials if t.state.name == "COMPLETE"]


def rows(folder):
    """All runs but for the seconds they took, and for what they were made with."""
    path = folder / "paper.sqlite"
    if not path.exists():
        return []
    with sqlite3.connect(path) as database:
        tables = {name for (name,) in database.execute("SELECT name FROM sqlite_master")}
        if "runs" not in tables:
            return []
        return database.execute(
            "SELECT controller, scenario, seed, final_fitness, final_collision, evaluations, best_path, "
            "trace, columns, way FROM runs ORDER BY controller, scenario, seed"
        ).fetchall()


@pytest.mark.parametrize("algorithm", TRAININGS)
def test_training_that_is_killed_at_random_moments(tmp_path, algorithm):
    def check(folder, *_):
        if (folder / "it" / "best.safetensors").exists():
            load_policy(folder / "it" / "best.safetensors")

    run_killed_at_random(lambda folder: training(algorithm, folder), check, tmp_path, KILLS, seed=1)
    for place in tmp_path.glob("run *[0-9]"):
        assert_same_training(tmp_path / "timed" / "it", place / "it")


TRAINING_MOMENTS = {
    "before anything is there": Moment("os.replace", 1, "before", "config.json"),
    "before the first checkpoint": Moment("os.replace", 1, "before", "checkpoint.pt"),
    "in a rollout": Moment("agents.sb3_vec_env.SB3VecEnv.step_wait", 150),
    "in an update": Moment("torch.nn.utils.clip_grad_norm_", 3),
    "after a chunk": Moment("stable_baselines3.PPO.learn", 1),
    "while a policy is written": Moment("os.replace", 1, "before", "latest.safetensors"),
    "after a best policy": Moment("os.replace", 1, "after", "best.safetensors"),
    "after the events of a checkpoint": Moment("agents.training_events.TrainingEvents.flush", 1),
    "while a checkpoint is written": Moment("os.replace", 1, "before", "checkpoint-before.pt"),
    "between its two names": Moment("os.replace", 1, "after", "checkpoint-before.pt"),
    "after a checkpoint": Moment("os.replace", 1, "after", "checkpoint.pt"),
    "at the end": Moment("agents.training_events.TrainingEvents.add_hyperparameters", 1),
}


def test_training_that_is_killed_at_certain_moments(tmp_path):
    run_killed_at(lambda: training("ppo", tmp_path / "whole"), [], tmp_path / "whole.log")
    run_killed_at(
        lambda: training("ppo", tmp_path / "killed"), [*TRAINING_MOMENTS.values()], tmp_path / "killed.log"
    )
    assert_same_training(tmp_path / "whole" / "it", tmp_path / "killed" / "it")


@pytest.mark.parametrize("what", ROUNDS)
def test_tuning_that_is_killed_at_random_moments(tmp_path, what):
    run_killed_at_random(lambda folder: tuning(what, folder), lambda *_: None, tmp_path, KILLS, seed=2)
    for place in tmp_path.glob("run *[0-9]"):
        assert_same_result(what, tmp_path / "timed", place)


TUNING_MOMENTS = {
    "open-loop": [
        Moment("os.replace", 1, "before", "config.json"),
        Moment("os.replace", 1, "before", "checkpoint.npz"),
        Moment("os.replace", 1, "before", "checkpoint-before.npz"),
        Moment("os.replace", 1, "after", "checkpoint-before.npz"),
        Moment("os.replace", 1, "after", "checkpoint.npz"),
        Moment("os.replace", 1, "after", "open-loop.json"),
    ],
    "schedule": [
        Moment("optuna.storages._rdb.models.VersionInfoModel.find", 1, "before"),
        Moment("optuna.Study.add_trial", 1),
        Moment("optuna.Study.ask", 2),
        Moment("optuna.Study.tell", 1, "before"),
        Moment("optuna.Study.tell", 2),
        Moment("os.replace", 1, "after", "schedule.json"),
    ],
}


@pytest.mark.parametrize("what", TUNING_MOMENTS)
def test_tuning_that_is_killed_at_certain_moments(tmp_path, what):
    run_killed_at(lambda: tuning(what, tmp_path / "whole"), [], tmp_path / "whole.log")
    run_killed_at(lambda: tuning(what, tmp_path / "killed"), TUNING_MOMENTS[what], tmp_path / "killed.log")
    assert_same_result(what, tmp_path / "whole", tmp_path / "killed")


def test_an_evaluation_that_is_killed_at_random_moments(tmp_path):
    def check(folder, stored, killed):
        # One more may be stored than a process that was killed has lived to count.
        assert stored <= len(rows(folder)) <= stored + killed

    run_killed_at_random(evaluation, check, tmp_path, KILLS, seed=3)
    expected = rows(tmp_path / "timed")
    assert len(expected) == 3 * 3 * 3
    for place in tmp_path.glob("run *[0-9]"):
        assert rows(place) == expected


def test_the_command_with_several_processes_that_is_killed(tmp_path):
    """An evaluation by the shell's command, whose worker processes must not matter either."""
    subprocess_of(evaluation(tmp_path / "whole", jobs=2)).wait()
    expected = rows(tmp_path / "whole")
    generator = np.random.default_rng(4)
    before, kills = 0, 0
    while len(rows(tmp_path / "killed")) < len(expected) - 4:
        running = subprocess_of(evaluation(tmp_path / "killed", jobs=2))
        while running.poll() is None and len(rows(tmp_path / "killed")) < before + 6:
            time.sleep(0.05)
        time.sleep(generator.uniform(0.0, 0.3))
        kills += running.poll() is None
        running.kill()
        running.wait()
        before = len(rows(tmp_path / "killed"))
    assert kills >= 3
    assert subprocess_of(evaluation(tmp_path / "killed", jobs=2)).wait() == 0
    assert rows(tmp_path / "killed") == expected


def subprocess_of(command):
    return subprocess.Popen(
        [sys.executable, "-m", command.module, *command.arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
