"""Comparison on bit strings, where runs are measured by their evaluations until the optimum."""

import csv

import numpy as np
import pytest

from helpers.bits import OPTIMIZER
from swarm_gym.comparing import compare
from swarm_gym.comparing.command_line import main
from swarm_gym.comparing.compared_runs import least_evaluations_of
from swarm_gym.controllers import make_controller
from swarm_gym.errors import ScenarioError
from swarm_gym.reference.onemax.optima import packaged
from swarm_gym.rollout import run_episodes
from swarm_gym.worlds import make_problem

RULES = ["theory", "one-fifth"]


@pytest.fixture(scope="module")
def runs():
    return compare(RULES, ["onemax:50", "onemax:100"], range(4), OPTIMIZER)


def cells_of(line):
    return [cell.strip() for cell in line.split("  ") if cell.strip()]


def test_the_runs_are_the_episodes_of_the_controllers(runs):
    episodes = run_episodes(make_controller("one-fifth"), "onemax:100", range(4), OPTIMIZER)
    np.testing.assert_array_equal(runs.evaluations[1, 1], episodes.evaluations)
    assert runs.solved.all()


def test_the_gap_is_that_of_the_evaluations_to_the_optimal_expectation(runs):
    least = np.array([packaged(size, "onemax").evaluations for size in (50, 100)])
    np.testing.assert_array_equal(runs.least_evaluations, least)
    np.testing.assert_allclose(runs.gap, runs.evaluations / least[:, None] - 1.0, rtol=1e-12)
    with pytest.raises(ScenarioError, match="optimum"):
        runs.objective()


def test_the_table_has_evaluations_and_how_far_they_are_above_the_optimum(runs):
    header, first, second = str(runs).splitlines()
    assert cells_of(header) == [
        "controller", "evaluations", "minus theory", "above the optimum", "solved", "onemax:50", "onemax:100",
    ]  # fmt: skip
    assert cells_of(first)[1].startswith(f"{runs.evaluations[0].mean():,.1f} [")
    assert f"{100.0 * runs.gap[1].mean():+.2f} [" in second
    assert f"{(runs.evaluations[1] - runs.evaluations[0]).mean():+,.1f} [" in second
    assert cells_of(second)[-3:] == [
        "100 %", *(f"{runs.evaluations[1, place].mean():,.1f}" for place in (0, 1))
    ]  # fmt: skip


def test_runs_that_were_stopped_are_infinitely_far_and_are_said_to_be_unsolved():
    stopped = compare(["theory"], ["onemax:50"], range(3), OPTIMIZER, iterations=5)
    assert np.isinf(stopped.gap).all()
    assert cells_of(str(stopped).splitlines()[1])[-2:] == ["unknown", "0 %"]


def test_lengths_whose_optimum_does_not_ship_have_no_gap():
    found = compare(RULES, ["onemax:20"], range(2), OPTIMIZER)
    assert np.isnan(found.gap).all()
    assert "unknown" in str(found).splitlines()[2]


def test_the_way_to_count_decides_which_optimum_it_is():
    assert least_evaluations_of(["onemax:50"], {"counting": "all"}) == [
        packaged(50, "onemax", "all").evaluations
    ]
    assert least_evaluations_of(["case1", "onemax:50"], {}) is None
    assert np.isnan(least_evaluations_of(["onemax:50-start:30"], {})).all()


def test_a_problem_of_bits_needs_no_encoding():
    assert make_problem("onemax:50") == make_problem("onemax:50", encoding="ones")
    assert make_problem("case1") == make_problem("case1", encoding="waypoints")


def test_the_command_compares_on_bits_and_names_may_begin_with_the_optimizer(tmp_path, capsys):
    path, name = tmp_path / "runs.csv", f"{OPTIMIZER}+theory"
    main([name, "--scenarios", "onemax:50", "--seeds", "2", "--output", str(path)])
    assert "above the optimum" in capsys.readouterr().out
    rows = list(csv.DictReader(path.read_text().splitlines()))
    found = compare(["theory"], ["onemax:50"], range(2), OPTIMIZER)
    assert [float(row["gap"]) for row in rows] == found.gap.ravel().tolist()
