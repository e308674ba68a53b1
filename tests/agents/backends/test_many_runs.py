"""Many runs by one command: they equal single runs, and one that fails fails alone."""

import dataclasses
import threading
from pathlib import Path

import pytest
from filelock import FileLock

from agents.backends import many_runs
from agents.backends.local import LocalBackend
from agents.backends.many_runs import Finished, RunOutcome, carry_out, configs_of_seeds, train, tune
from helpers.trainings import STEPS, assert_same_weights, tiny_config
from swarm_gym.runs.folder import prepare_folder
from swarm_gym.training.run import TrainingRun
from swarm_gym.tuning.config import TuneConfig

SHORT = {"warm_start": "none", "total_steps": STEPS}


@pytest.mark.slow
def test_seeds_equal_single_runs_fail_alone_and_resume(tmp_path):
    config = tiny_config(tmp_path, **SHORT, name="many")
    configs = configs_of_seeds(config, [0, 1, 2])
    TrainingRun(configs[1])  # begun already, so that it is refused without --resume
    outcomes = {outcome.folder.name: outcome for outcome in carry_out(train, configs, LocalBackend(2))}
    failed = {name: outcome.finished is None for name, outcome in outcomes.items()}
    assert failed == {"0": False, "1": True, "2": False}
    assert "--resume" in outcomes["1"].error
    again = configs_of_seeds(dataclasses.replace(config, resume=True), [0, 1, 3])
    outcomes = {outcome.folder.name: outcome for outcome in carry_out(train, again, LocalBackend(2))}
    assert {name: outcome.finished.result for name, outcome in outcomes.items()} == {
        name: tmp_path / "many" / name / "best.safetensors" for name in ("0", "1", "3")
    }
    single = TrainingRun(tiny_config(tmp_path, **SHORT, seed=3, name="single"))
    assert_same_weights(single.run(), outcomes["3"].finished.result)
    assert outcomes["3"].finished.summary == single.verdict


@pytest.mark.slow
def test_an_error_ends_its_own_run(tmp_path):
    config = TuneConfig(runs=tmp_path, name="many", episodes=3, total_steps=10_000, candidates=4)
    configs = [
        dataclasses.replace(one, scenarios=("case9",)) if one.seed == 1 else one
        for one in configs_of_seeds(config, [0, 1])
    ]
    found = {outcome.folder.name: outcome for outcome in carry_out(tune, configs, LocalBackend(1))}
    assert found["0"].finished == Finished(tmp_path / "many" / "0" / "open-loop.json", "9600 steps")
    assert found["1"].finished is None
    assert "case9" in found["1"].error


@pytest.mark.parametrize("released", [True, False])
def test_a_lock_that_a_lost_machine_may_have_left_is_waited_for(tmp_path, monkeypatch, released):
    monkeypatch.setattr(many_runs, "LOCK_TIMEOUT", 1.5)
    backend = LocalBackend(1)
    backend.on_this_machine = False
    config = tiny_config(tmp_path, **SHORT, name="one", resume=True)
    config.folder.mkdir(parents=True)

    def work(config):
        return Finished(prepare_folder(config.folder, config.options(), config.resume, ()).lock_file, "")

    lock = FileLock(config.folder / "lock", thread_local=False)
    lock.acquire()
    if released:
        threading.Timer(0.5, lock.release).start()
    (outcome,) = carry_out(work, [config], backend)
    assert (outcome.finished is not None) == released
    assert released or outcome.error == f"RunTakenError: {config.folder}: another process works on this run"
    lock.release()


def test_every_seed_has_a_folder_and_is_there_once(tmp_path):
    configs = configs_of_seeds(tiny_config(tmp_path, name=""), [4, 5])
    assert [c.folder for c in configs] == [tmp_path / "three-cases" / "4", tmp_path / "three-cases" / "5"]
    configs = configs_of_seeds(tiny_config(tmp_path, name="mine"), [4])
    assert [(c.folder, c.seed) for c in configs] == [(tmp_path / "mine" / "4", 4)]
    with pytest.raises(ValueError, match="each one once"):
        configs_of_seeds(tiny_config(tmp_path), [1, 1])


def test_an_outcome_is_one_line():
    done = RunOutcome(Path("runs/a/0"), Finished(Path("runs/a/0/best.safetensors"), "well"))
    assert str(done) == "runs/a/0: done, well, runs/a/0/best.safetensors"
    assert str(RunOutcome(Path("runs/a/1"), None, "no")) == "runs/a/1: failed: no"
