"""The study of length and nearness: its table counts runs right, and its policies fit its suite."""

import json

import numpy as np
import pytest

from experiments.documents.suite_page import make_tables
from experiments.studies.driving.suites import BASE, CONSTANT, DRIVING, OPTIONS, POLICIES, SCHEDULE
from experiments.studies.driving.tables import PLANNED, planned_costs
from helpers.stored_runs import cells_of, part_of, stored_run
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.open_loop import OPEN_LOOPS
from swarm_gym.training.config import stored_config
from swarm_gym.training.presets import load_preset

MAPS = ("rooms:2000", "caves:2001")
SPENT = {"evaluations": np.array([0.0, 5000.0])}


def add(database, controller, factors, free=True):
    """Store a run on each map, with a straight path, whose fitness is so many times the planner's sum."""
    for name, factor in zip(MAPS, factors, strict=True):
        length, total = planned_costs(name, 2.0)
        path = np.array([[0.0, 0.0], [1.5 * length, 0.0]])
        values = {"final_fitness": factor * total, "best_path": path, "final_collision": 0.0 if free else 1.0}
        database.add(stored_run((controller, name, 0), SPENT, **values))


@pytest.fixture
def rows(database):
    add(database, "fixed:100", (2.0, 2.0))
    add(database, "fixed:20", (4.0, 1.0))
    add(database, "fixed:60", (8.0, 8.0), free=False)
    suite = part_of(DRIVING, ("fixed:100", "fixed:20", "fixed:60"), MAPS, 1, baseline="fixed:100")
    return {row["controller"]: row for row in cells_of(make_tables(suite, database), "driving")}


def test_the_table_counts_free_paths_above_those_of_the_planner(rows):
    planned = {name: planned_costs(name, 2.0) for name in MAPS}
    mean_sum = np.mean([total for _, total in planned.values()])
    mean_length = np.mean([length for length, _ in planned.values()])
    constant = rows["FA-100"]
    assert constant["free"] == "100.0 %"
    assert (constant["length"], constant["sum"]) == ("50.0", "100.0")
    nearness = 2.0 * mean_sum - 1.5 * mean_length
    assert constant["nearness"] == f"{100.0 * (nearness / (mean_sum - mean_length) - 1.0):.1f}"
    assert constant["objective"].startswith(f"{100.0 * np.log(2.0):.1f} [")
    assert constant["minus the rival"] == "–"
    # Twice as much on one map and half as much on the other are level in the mean logarithm.
    assert rows["FA-20"]["minus the rival"].startswith("+0.0 [")
    assert rows["FA-60"]["minus the rival"].startswith(f"+{100.0 * np.log(4.0):.1f} [")


def test_paths_that_are_not_free_have_no_length(rows):
    assert rows["FA-60"]["free"] == "0.0 %"
    assert [rows["FA-60"][part] for part in ("length", "nearness", "sum")] == ["–"] * 3
    assert rows["FA-60"]["objective"].startswith(f"{100.0 * np.log(8.0):.1f} [")


def test_the_planner_has_a_row_at_zero(rows):
    assert set(rows[PLANNED].values()) == {PLANNED, "–", "100.0 %", "0.0"}


def test_policies_were_trained_as_the_suite_runs_on_other_maps():
    preset = load_preset("driving")
    assert preset.base == BASE
    trained, validated = set(preset.scenarios), set(preset.validation_scenarios)
    assert len(trained) == 48
    assert len(trained | validated | set(DRIVING.scenarios)) == 48 + len(validated) + len(DRIVING.scenarios)
    for name in POLICIES:
        config = stored_config(make_controller(name).manifest)
        assert {option: config.env_options()[option] for option in OPTIONS} == OPTIONS
        assert (set(config.scenarios), set(config.validation_scenarios)) == (trained, validated)
    for name in (CONSTANT, SCHEDULE):
        file = OPEN_LOOPS.find(name.removeprefix("open-loop:"))
        config = json.loads(file.read_text())["manifest"]["config"]
        assert {option: config[option] for option in OPTIONS} == OPTIONS
        assert set(config["scenarios"]) == trained


def test_policies_are_compared_with_themselves_blinded(database):
    for seed, factor in enumerate((2.0, 4.0)):
        add(database, f"learned:a/{seed}", (factor, factor))
        add(database, f"blinded:a/{seed}", (2.0 * factor, 2.0 * factor))
    names = [f"{family}:a/{seed}" for family in ("learned", "blinded") for seed in range(2)]
    suite = part_of(DRIVING, names, MAPS, 1, baseline="blinded:a/*")
    found = {row["controller"]: row for row in cells_of(make_tables(suite, database), "driving")}
    halved = f"{-100.0 * np.log(2.0):+.1f}"
    # The training seeds of both are the same policies, so that their luck widens no interval.
    assert found["learned a"]["minus itself blinded"] == f"{halved} [{halved}, {halved}]"
    assert found["learned a"]["minus the rival"].startswith(f"{halved} [")
    assert found["learned a"]["minus the rival"] != found["learned a"]["minus itself blinded"]
    assert found["blinded a"]["minus itself blinded"] == "–"
