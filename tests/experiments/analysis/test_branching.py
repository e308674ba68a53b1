"""Runs that branch off: alike up to a window, and what is said of where they end."""

import numpy as np
import pytest
from scipy import stats

from agents import make_controller
from experiments.analysis.branching import (
    CHANGES,
    WINDOWS,
    Change,
    Changed,
    analyse,
    branching_tables,
    write_report,
)
from experiments.runs.database import ResultsError
from helpers.stored_runs import printed_rows
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.seeds import ANALYSIS

NAME = "open-loop:three-cases-extended"
SEEDS = ANALYSIS[:3]


@pytest.fixture(scope="module")
def found():
    return analyse(NAME, make_controller(NAME), ("case1", "case3"), SEEDS)


def test_a_change_holds_in_its_window_within_the_ranges():
    plain = run_episodes(make_controller(NAME), "case3", SEEDS)
    changed = run_episodes(Changed(make_controller(NAME), Change("", 0, 3.0), (2, 5)), "case3", SEEDS)
    np.testing.assert_array_equal(changed.sizes[:, :2], plain.sizes[:, :2])
    np.testing.assert_array_equal(changed.sizes[:, 5:], plain.sizes[:, 5:])
    np.testing.assert_allclose(changed.sizes[:, 2:5], 3.0 * plain.sizes[:, 2:5], atol=2.0)
    largest = run_episodes(Changed(make_controller(NAME), Change("", 0, 1e6), (2, 5)), "case3", SEEDS)
    assert (largest.sizes[:, 2:5] == 200).all()
    repaired = run_episodes(Changed(make_controller(NAME), Change("", 1, 0.0, 1.0), (2, 5)), "case3", SEEDS)
    assert (repaired.repair_degrees[:, 2:5] == 1.0).all()


def test_branches_are_alike_up_to_their_window(found):
    assert set(found.branches) == {(window, change.name) for window in WINDOWS for change in CHANGES}
    for ((first, end), _), runs in found.branches.items():
        for straight, branch in zip(found.straight, runs, strict=True):
            np.testing.assert_array_equal(branch.seen[: first + 1], straight.seen[: first + 1])
            if end < 100:
                assert (branch.seen[end + 1] != straight.seen[end + 1]).any()


def test_the_table_says_what_the_changes_did(found):
    branching, foresight = branching_tables(found)
    assert len(branching.rows) == len(WINDOWS) * len(CHANGES)
    before = np.array([w.gap for w in found.straight])
    after = np.array([w.gap for w in found.branches[(30, 60), "size x 2"]])
    (row,) = [r for r in printed_rows(branching) if r[:2] == ("30 to 59", "size x 2")]
    assert row[2].startswith(f"{100 * (after - before).mean():+.2f} % [")
    assert row[3] == f"{100 * (abs(after - before) > 0.01).mean():.0f} %"
    assert float(row[4]) > 1.2
    (best,) = [r for r in printed_rows(foresight) if r[0].startswith("log(best fitness")]
    column = foresight.columns.index("iteration 60, case3")
    seen = found.straight[1].seen[60, :, 6]
    assert best[column] == f"{stats.spearmanr(seen, before[1]).statistic:+.2f}"


def test_what_does_not_decide_in_natural_units_is_refused():
    name = "learned:random-fields-extended/0"
    with pytest.raises(ResultsError, match=f"{name}.*'extended-normalised'.*natural"):
        analyse(name, make_controller(name), ("case1",), SEEDS)


def test_a_controller_of_size_and_phi_has_changes_of_these(tmp_path):
    found = analyse("fixed:8", make_controller("fixed:8"), ("case3",), SEEDS)
    assert {name for _, name in found.branches} == {"size x 2", "size / 2", "φ = 0", "φ = 1"}
    page = write_report(found, tmp_path)
    assert "FA-8 with one decision changed" in page.read_text()
    assert {path.name for path in tmp_path.iterdir()} >= {"branching.md", "foresight.csv", "README.md"}
