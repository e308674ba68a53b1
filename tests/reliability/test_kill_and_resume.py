"""Commands that are killed and resumed until they end have the same results as without kills."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

from swarm_gym.controllers.learned.policy_file import load_policy

if os.name != "posix":
    pytest.skip("needs POSIX: it kills by signals", allow_module_level=True)

from helpers.kills import Moment, run_killed_at, run_killed_at_random
from helpers.small_commands import (
    ROUNDS,
    TRAININGS,
    assert_same_result,
    assert_same_training,
    evaluation,
    rows,
    training,
    tuning,
)

pytestmark = pytest.mark.slow

KILLS = 20


@pytest.mark.parametrize("algorithm", TRAININGS)
def test_training_that_is_killed_at_random_moments_goes_on_alike(tmp_path, algorithm):
    def check(folder, *_):
        if (folder / "it" / "best.safetensors").exists():
            load_policy(folder / "it" / "best.safetensors")

    run_killed_at_random(lambda folder: training(algorithm, folder), check, tmp_path, KILLS, seed=1)
    for place in tmp_path.glob("run *[0-9]"):
        assert_same_training(tmp_path / "timed" / "it", place / "it")


TRAINING_MOMENTS = {
    "before anything is there": Moment("os.replace", 1, "before", "config.json"),
    "before the first checkpoint": Moment("os.replace", 1, "before", "checkpoint.pt"),
    "in a rollout": Moment("swarm_gym.training.sb3_vec_env.SB3VecEnv.step_wait", 150),
    "in an update": Moment("torch.nn.utils.clip_grad_norm_", 3),
    "after a chunk": Moment("stable_baselines3.PPO.learn", 1),
    "while a policy is written": Moment("os.replace", 1, "before", "latest.safetensors"),
    "after a best policy": Moment("os.replace", 1, "after", "best.safetensors"),
    "after the events of a checkpoint": Moment("swarm_gym.training.events.TrainingEvents.flush", 1),
    "while a checkpoint is written": Moment("os.replace", 1, "before", "checkpoint-before.pt"),
    "between its two names": Moment("os.replace", 1, "after", "checkpoint-before.pt"),
    "after a checkpoint": Moment("os.replace", 1, "after", "checkpoint.pt"),
    "at the end": Moment("swarm_gym.training.events.TrainingEvents.add_hyperparameters", 1),
}


def test_training_that_is_killed_at_certain_moments_goes_on_alike(tmp_path):
    run_killed_at(lambda: training("ppo", tmp_path / "whole"), [], tmp_path / "whole.log")
    run_killed_at(
        lambda: training("ppo", tmp_path / "killed"), [*TRAINING_MOMENTS.values()], tmp_path / "killed.log"
    )
    assert_same_training(tmp_path / "whole" / "it", tmp_path / "killed" / "it")


@pytest.mark.parametrize("what", ROUNDS)
def test_tuning_that_is_killed_at_random_moments_goes_on_alike(tmp_path, what):
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
def test_tuning_that_is_killed_at_certain_moments_goes_on_alike(tmp_path, what):
    run_killed_at(lambda: tuning(what, tmp_path / "whole"), [], tmp_path / "whole.log")
    run_killed_at(lambda: tuning(what, tmp_path / "killed"), TUNING_MOMENTS[what], tmp_path / "killed.log")
    assert_same_result(what, tmp_path / "whole", tmp_path / "killed")


def test_an_evaluation_that_is_killed_at_random_moments_goes_on_alike(tmp_path):
    def check(folder, stored, killed):
        # A killed process may have stored a unit of three runs that it did not count any more.
        assert stored <= len(rows(folder)) <= stored + 3 * killed

    run_killed_at_random(evaluation, check, tmp_path, KILLS, seed=3)
    expected = rows(tmp_path / "timed")
    assert len(expected) == 3 * 3 * 3  # controllers, scenarios and seeds
    for place in tmp_path.glob("run *[0-9]"):
        assert rows(place) == expected


def test_a_command_with_several_processes_that_is_killed_goes_on_alike(tmp_path):
    """Check an evaluation by its shell command, with worker processes."""
    subprocess_of(evaluation(tmp_path / "whole", jobs=2)).wait()
    expected = rows(tmp_path / "whole")
    generator = np.random.default_rng(4)
    before, kills = 0, 0
    while len(rows(tmp_path / "killed")) < len(expected) - 4:
        running = subprocess_of(evaluation(tmp_path / "killed", jobs=2))
        while running.poll() is None and len(rows(tmp_path / "killed")) < before + 1:
            time.sleep(0.05)
        time.sleep(generator.uniform(0.0, 0.1))
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
