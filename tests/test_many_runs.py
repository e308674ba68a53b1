"""Several training seeds by one command: they equal single runs, and one that fails fails alone."""

import dataclasses
from pathlib import Path

import pytest
from trainings import STEPS, tiny_config

from agents.policy_file import load_policy
from agents.training_run import TrainingRun
from agents.training_seeds import Outcome, configs_of_seeds, describe, train_seeds

SHORT = {"warm_start": "none", "total_steps": STEPS}


@pytest.mark.slow
def test_seeds_equal_single_runs_fail_alone_and_resume(tmp_path):
    config = tiny_config(tmp_path, **SHORT, name="many")
    configs = configs_of_seeds(config, [0, 1, 2])
    TrainingRun(configs[1])  # begun already, so that it is refused without --resume
    outcomes = {outcome.folder.name: outcome for outcome in train_seeds(configs, jobs=2)}
    assert {name: outcome.best is None for name, outcome in outcomes.items()} == {
        "0": False,
        "1": True,
        "2": False,
    }
    assert "--resume" in outcomes["1"].error
    again = configs_of_seeds(dataclasses.replace(config, resume=True), [0, 1, 3])
    outcomes = {outcome.folder.name: outcome for outcome in train_seeds(again, jobs=2)}
    assert all(
        outcome.best == tmp_path / "many" / name / "best.safetensors" for name, outcome in outcomes.items()
    )
    single = TrainingRun(tiny_config(tmp_path, **SHORT, seed=3, name="single"))
    ours, theirs = load_policy(single.run())[0], load_policy(outcomes["3"].best)[0]
    assert all((ours[key] == theirs[key]).all() for key in ours)
    assert outcomes["3"].best_return == single.best_return


def test_every_seed_has_a_folder(tmp_path):
    configs = configs_of_seeds(tiny_config(tmp_path, name=""), [4, 5])
    assert [c.folder for c in configs] == [tmp_path / "three-cases" / "4", tmp_path / "three-cases" / "5"]
    configs = configs_of_seeds(tiny_config(tmp_path, name="mine"), [4])
    assert [(c.folder, c.seed) for c in configs] == [(tmp_path / "mine" / "4", 4)]


@pytest.mark.parametrize(("seeds", "jobs", "message"), [([1, 1], 1, "each one once"), ([1], 0, "--jobs")])
def test_impossible_requests_are_refused(tmp_path, seeds, jobs, message):
    with pytest.raises(ValueError, match=message):
        list(train_seeds(configs_of_seeds(tiny_config(tmp_path), seeds), jobs))


def test_an_outcome_is_one_line():
    done = Outcome(Path("runs/a/0"), Path("runs/a/0/best.safetensors"), -0.5, "")
    assert describe(done) == "runs/a/0: done, best validation return -0.5000, runs/a/0/best.safetensors"
    assert describe(Outcome(Path("runs/a/1"), None, 0.0, "no")) == "runs/a/1: failed: no"
