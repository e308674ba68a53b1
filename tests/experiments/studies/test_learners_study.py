"""The study of plain learners: trainings that repeat, are stored once, and fill a table and curves."""

import json
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra `study`")

from experiments.documents.records import records_in
from experiments.learners import LearnersConfig, run
from experiments.studies.learners import recipes, trainings
from experiments.studies.learners import tables_of_learners as tables
from experiments.studies.learners.recipes import ALGORITHMS, RECIPES, Recipe
from swarm_gym.comparing import compare
from swarm_gym.errors import UnknownNameError

STEPS = 40
SMALL = {"iterations": 5, "initial_population_size": 6, "max_population_size": 12}
PPO = Recipe("PPO", {"n_steps": 5, "batch_size": 20, "gamma": 1.0}, SMALL)


@pytest.fixture
def short(monkeypatch):
    """Trainings of seconds, on two seeds."""
    monkeypatch.setattr(trainings, "TEST_SEEDS", range(60_000, 60_002))
    monkeypatch.setattr(tables, "TEST_SEEDS", range(60_000, 60_002))
    monkeypatch.setattr(trainings, "VALIDATION_SEEDS", range(120_000, 120_002))
    monkeypatch.setattr(trainings, "NUM_SWARMS", 4)
    monkeypatch.setattr(
        tables, "RIVALS", {**tables.RIVALS, "this project's PPO, three-cases@1": ("fixed:9",)}
    )
    monkeypatch.setitem(RECIPES, "ppo", PPO)


def trained(folder, name="ppo", seed=0):
    return json.loads(trainings.train(name, seed, STEPS, folder, lambda _: None).read_text(encoding="utf-8"))


def test_a_training_repeats_and_is_stored_once(short, tmp_path):
    first, again = trained(tmp_path / "a"), trained(tmp_path / "b")
    assert first["outcome"] == again["outcome"]
    assert first["course"] == again["course"]
    assert list(map(int, first["course"])) == [4, STEPS]
    assert trained(tmp_path / "a", seed=1)["outcome"] != first["outcome"]
    file = trainings.training_file(tmp_path / "a", "ppo", STEPS, 0)
    file.write_text(json.dumps({**first, "seed": 7}), encoding="utf-8")
    assert trained(tmp_path / "a")["seed"] == 7


def test_a_stored_training_is_tested_again_when_the_test_seeds_change(short, monkeypatch, tmp_path):
    first = trained(tmp_path / "a")
    monkeypatch.setattr(trainings, "TEST_SEEDS", range(60_100, 60_103))
    again, whole = trained(tmp_path / "a"), trained(tmp_path / "b")
    assert again["course"] == first["course"]
    assert again["outcome"] == whole["outcome"] != first["outcome"]


def test_episodes_are_those_that_compare_makes(short):
    """A learner that always puts out zero is 0.3 of the largest size and phi = 1/16."""

    class Zero:
        def predict(self, observations, state=None, episode_start=None, deterministic=False):
            assert deterministic
            return np.zeros((len(observations), 2), dtype=np.float32), state

    recipe = Recipe("PPO", env={"initial_population_size": 60})
    outcome = trainings.run(recipe, Zero(), range(60_000, 60_002))
    rule = "linear-reduction:start=60,smallest=60,repair_degree=0.0625"
    runs = compare([rule], ["case1", "case2", "case3"], range(60_000, 60_002))
    np.testing.assert_array_equal(outcome.gaps, runs.gap[0])
    np.testing.assert_array_equal(outcome.evaluations, runs.evaluations[0])
    assert outcome.objective == pytest.approx(runs.objective().mean(), rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_every_algorithm_trains_in_the_environment(short, monkeypatch, tmp_path, algorithm):
    options = {"n_steps": 5, "batch_size": 20} if "PPO" in algorithm else {"learning_starts": 8}
    env = {**SMALL, **({"choices": (3, 2)} if algorithm == "DQN" else {})}
    monkeypatch.setitem(RECIPES, "one", Recipe(algorithm, options, env, scales_rewards=True))
    assert np.isfinite(trained(tmp_path, "one")["outcome"]["gaps"]).all()


def test_the_command_writes_tables_and_curves(short, monkeypatch, tmp_path):
    monkeypatch.setitem(RECIPES, "ppo-residual-rules", replace(PPO, env={**PPO.env, "base": "spsfa-tip"}))
    run(LearnersConfig(("ppo-residual-rules",), (0,), STEPS, tmp_path))
    files = run(LearnersConfig(("ppo",), (0, 1), STEPS, tmp_path))
    assert all(file.exists() for file in files)
    table = next(file for file in files if file.stem == f"reached-{STEPS}").read_text(encoding="utf-8")
    rows = {line.split(" | ")[0].removeprefix("| "): line for line in table.splitlines() if "|" in line}
    assert {"PPO (`ppo`)", "SPSFA-TIP", "FA-60", "open loop three-cases"} <= set(rows)
    assert "| 2 |" in rows["PPO (`ppo`)"]  # two training seeds
    assert rows["PPO (`ppo`)"].endswith("| – |")  # corrects nothing
    of_paper, _, of_base = rows["PPO (`ppo-residual-rules`)"].split(" | ")[-3:]
    assert of_base == f"{of_paper} |"
    (record,) = records_in(tmp_path)
    assert record.commits
    assert "SPSFA-TIP" in record.digests
    with pytest.raises(UnknownNameError, match="unknown recipe 'pppo'"):
        run(LearnersConfig(("pppo",), (0,), STEPS, tmp_path))


def test_recipes_have_the_algorithms_of_the_libraries():
    assert {recipe.algorithm for recipe in RECIPES.values()} == set(ALGORITHMS) == set(recipes.ALGORITHMS)
