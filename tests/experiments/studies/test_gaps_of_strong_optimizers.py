"""Rows of the study of strong optimizers: their runs are kept, and their tables count them right."""

import json

import numpy as np
import pytest

from experiments.studies.strong import measured_gaps
from experiments.studies.strong.entrants import LAST_SIZE, Entrant, entrants, entrants_on_bbob
from experiments.studies.strong.grounds import METABOX, REPEATED, bbob
from experiments.studies.strong.measured_gaps import Measured, measure
from experiments.studies.strong.on_bbob import CONSTANT, SCHEDULE, on_bbob
from experiments.studies.strong.published import EVALUATIONS, FUNCTIONS, best_of
from experiments.studies.strong.published import RUNS as PUBLISHED_RUNS
from experiments.studies.strong.tables_of_gaps import REPEATED_ROWS, gaps_of, repeated, tables
from swarm_gym.rollout import Episodes

RUNS = 3


def row(gap, seeds=1):
    """Return a row with these gaps, (functions,) or one for all."""
    final = np.broadcast_to(np.reshape(gap, (1, -1, 1)), (seeds, len(FUNCTIONS), RUNS)).astype(float)
    return Measured(final, np.log10(np.maximum(final, 1e-8)) + 1.0)


def test_rows_are_constants_rules_and_policies_of_both_optimizers():
    names = [entrant.name for entrant in entrants()]
    assert len(set(names)) == len(names)
    assert names[:11] == [
        *(f"CMA-ES, lambda {size}" for size in (10, 20, 40, 80, 160)), "CMA-ES, IPOP", "CMA-ES, BIPOP",
        "CMA-ES, PSA", "CMA-ES, constant tuned", "CMA-ES, schedule tuned", "CMA-ES, early restarts",
    ]  # fmt: skip
    assert names[-9:] == [
        "L-SHADE, linear", "L-SHADE, nlpsr", "L-SHADE, N = 100", "L-SHADE, constant tuned",
        "L-SHADE, schedule tuned", "L-SHADE, learned, evolution", "L-SHADE, learned, evolution, together",
        "L-SHADE, learned on both optimizers", "L-SHADE, learned on both optimizers, together",
    ]  # fmt: skip
    assert "CMA-ES, learned, PPO, together" not in names  # two training seeds


def test_reductions_end_with_the_budget():
    linear, other = (one for one in entrants() if f"smallest={LAST_SIZE}" in one.controllers[0])
    mean = 0.5 * (180 + LAST_SIZE)
    assert linear.iterations == pytest.approx((EVALUATIONS - 180) / mean, rel=0.02)
    assert other.iterations > linear.iterations


def test_runs_are_kept_until_something_else_is_asked_for(tmp_path, monkeypatch):
    asked = []

    def run(controller, scenario, seeds, optimizer, **options):
        asked.append((scenario, optimizer, options["iterations"], options["max_evaluations"]))
        gap = np.full(len(seeds), float(len(asked)))
        return Episodes(gap, gap, -np.log10(gap), gap[:, None], gap[:, None])

    monkeypatch.setattr(measured_gaps, "run_episodes", run)
    entrant = Entrant("a row", "cma-es", ("fixed:10", "fixed:20"))
    first = measure(entrant, RUNS, tmp_path)
    assert first.final.shape == (2, len(FUNCTIONS), RUNS)
    assert first.final[1, 0, 0] == len(FUNCTIONS) + 1.0
    assert first.anytime == pytest.approx(np.log10(first.final))
    assert len(asked) == 2 * len(FUNCTIONS)
    assert asked[0] == (f"metabox-bbob:{FUNCTIONS[0]}-10-biased", "cma-es", 5000, EVALUATIONS)
    again = measure(entrant, RUNS, tmp_path)
    assert len(asked) == 2 * len(FUNCTIONS)
    np.testing.assert_array_equal(again.final, first.final)
    measure(entrant._replace(iterations=100), RUNS, tmp_path)
    measure(entrant, RUNS + 1, tmp_path)
    assert len(asked) == 6 * len(FUNCTIONS)
    assert {json.loads(file.read_text())["asked"]["runs"] for file in tmp_path.iterdir()} == {3, 4}


def test_rows_are_repeated_with_other_seeds(tmp_path, monkeypatch):
    asked = []

    def run(controller, scenario, seeds, optimizer, **options):
        asked.append((scenario, seeds))
        gap = np.ones(len(seeds))
        return Episodes(gap, gap, gap, gap[:, None], gap[:, None])

    monkeypatch.setattr(measured_gaps, "run_episodes", run)
    entrant = Entrant("a row", "cma-es", ("fixed:10",))
    for ground in (METABOX, REPEATED):
        measure(entrant, RUNS, tmp_path, ground)
    (first, *others), (again, *_) = asked[: len(FUNCTIONS)], asked[len(FUNCTIONS) :]
    assert first == (f"metabox-bbob:{FUNCTIONS[0]}-10-biased", range(RUNS))
    assert again == (first[0], range(REPEATED.first_seed, REPEATED.first_seed + RUNS))
    assert {seeds for _, seeds in others} == {range(RUNS)}
    assert REPEATED.first_seed >= PUBLISHED_RUNS
    assert len(list(tmp_path.iterdir())) == 2
    names = [one.name for one in entrants()]
    assert set(REPEATED_ROWS) <= set(names)


def test_the_table_of_other_seeds_names_them_and_has_the_same_counts():
    rows = {"CMA-ES, constant tuned": row(1e-3), "CMA-ES, early restarts": row(1e-9)}
    table, (whole, _) = repeated(rows, 151), tables(rows)
    assert "from test seed 151 on" in table.caption
    assert table.name == "repeated"
    assert "average rank" in whole.caption
    assert "average rank" not in table.caption
    assert [str(line[1]) for line in table.rows] == [
        str(line[whole.columns.index("functions level or ahead")]) for line in whole.rows
    ]
    assert "-5.00" in str(table.rows[1][table.columns.index("minus the tuned constant")])


def test_policies_on_bbob_have_rows_of_their_own_blinded_and_a_budget_by_dimension(tmp_path, monkeypatch):
    rows = {one.name: one.controllers for one in entrants_on_bbob(20)}
    blinded = {name for name in rows if "blinded" in name}
    assert "CMA-ES, learned, evolution, longer, blinded" in blinded
    assert blinded <= {f"{name}, blinded" for name in rows if "learned" in name}
    assert "CMA-ES, early restarts" in rows
    assert not any("L-SHADE" in name for name in rows)
    others = {one.name for one in entrants_on_bbob(40)}
    assert {"CMA-ES, default lambda", CONSTANT, SCHEDULE, "CMA-ES, learned, PPO"} <= others
    assert not any("blinded" in name or "BIPOP" in name for name in others)
    # The default size is 4 + 3 log(dimension), rounded down, and restarts begin with it.
    assert rows["CMA-ES, default lambda"] == ("fixed:12",)
    assert rows["CMA-ES, BIPOP"] == ("bipop:start=12",)
    asked = []

    def run(controller, scenario, seeds, optimizer, **options):
        asked.append((scenario, options["iterations"], options["max_evaluations"]))
        gap = np.ones(len(seeds))
        return Episodes(gap, gap, gap, gap[:, None], gap[:, None])

    monkeypatch.setattr(measured_gaps, "run_episodes", run)
    entrant = Entrant("a row", "cma-es", ("fixed:10",), iterations=1000)
    assert measure(entrant, 3, tmp_path, bbob(5)).final.shape == (1, 48, 3)
    assert asked[:3] == [(f"function:bbob-{name}", 500, 10_000) for name in ("1-5-101", "1-5-102", "2-5-101")]
    measure(entrant, 3, tmp_path, bbob(20))
    measure(entrant, 3, tmp_path, bbob(5))
    assert len(asked) == 2 * 48  # the last ones were kept


def test_policies_have_the_budget_of_the_dimension_and_not_of_their_training(tmp_path, monkeypatch):
    budgets = set()

    def run(controller, scenario, seeds, optimizer, **options):
        budgets.add((controller.env_options()["max_evaluations"], options["max_evaluations"]))
        gap = np.ones(len(seeds))
        return Episodes(gap, gap, gap, gap[:, None], gap[:, None])

    monkeypatch.setattr(measured_gaps, "run_episodes", run)
    policies, together, blinded, blinded_together = (
        one._replace(controllers=one.controllers[:1])
        for one in entrants_on_bbob(20)
        if one.name.startswith("CMA-ES, learned, evolution, longer")
    )
    assert together.controllers == ("together:cma-search-longer",)
    assert blinded_together.name.endswith(", together, blinded")
    for one in (policies, together, blinded, blinded_together):
        measure(one, 3, tmp_path, bbob(20))
    assert budgets == {(40_000, 40_000)}
    measure(policies, 3, tmp_path)
    assert budgets == {(40_000, 40_000), (EVALUATIONS, EVALUATIONS)}


def test_differences_on_bbob_are_to_blind_rivals_over_three_dimensions():
    def rows(dimension):
        gaps = np.full((1, 48, 4), 10.0**-dimension)
        constant = Measured(10.0 * gaps, np.log10(gaps) + 2.0)
        learned = Measured(np.tile(gaps, (2, 1, 1)), np.tile(np.log10(gaps), (2, 1, 1)))
        rows = {CONSTANT: constant, SCHEDULE: constant, "CMA-ES, learned, PPO": learned}
        blinded = Measured(100.0 * learned.final, learned.anytime + 3.0)
        return rows | ({"CMA-ES, learned, PPO, blinded": blinded} if dimension in (5, 10, 20) else {})

    table = on_bbob({dimension: rows(dimension) for dimension in (3, 5, 10, 20, 40)})
    constant, _, learned, blinded = (dict(zip(table.columns, row, strict=True)) for row in table.rows)
    assert str(constant["minus the tuned constant"]) == "–"
    assert str(constant["minus itself blinded"]) == "–"

    # Gaps below 1e-8 count as equal: of 1e-10 and 1e-9, and of 1e-20 and 1e-19.
    assert learned["at the end"].numbers["value"] == pytest.approx(-(5 + 8 + 8) / 3)
    minus = learned["minus the tuned constant"].numbers
    assert minus == pytest.approx({"value": -1 / 3, "low": -1 / 3, "high": -1 / 3})
    assert learned["minus the tuned schedule"].numbers["value"] == pytest.approx(-1 / 3)
    assert learned["minus itself blinded"].numbers["value"] == pytest.approx(-2 / 3)
    for rival, difference in (("the tuned constant", -2), ("the tuned schedule", -2), ("itself blinded", -3)):
        assert learned[f"anytime, minus {rival}"].numbers["value"] == pytest.approx(difference)
    others = [f"at the end, {dimension} dimensions" for dimension in (3, 40)]
    assert [learned[name].numbers["value"] for name in others] == [-3.0, -8.0]
    assert [str(blinded[name]) for name in others] == ["–", "–"]  # it has no runs there


def test_the_short_table_counts_functions_and_means():
    best = np.array([best_of(number)[1].mean for number in FUNCTIONS])
    # Powers of two, whose means are exact.
    ahead = np.where(best > 0.0, 0.5 ** np.ceil(1.0 - np.log2(np.maximum(best, 1e-9))), 0.0)
    behind = np.where(np.arange(len(FUNCTIONS)) < 4, ahead, 2.0 * best + 1.0)
    short, by_function = tables(
        {
            "CMA-ES, lambda 10": row(ahead),
            "CMA-ES, IPOP": row(behind),
            "L-SHADE, learned, evolution": row(ahead, 2),
            "L-SHADE, learned, evolution, together": row(ahead),
            "L-SHADE, constant tuned": row(behind),
        }
    )
    counts = [float(line[2].numbers["value"]) for line in short.rows]
    assert counts == [16.0, 4.0, 16.0, 16.0, 4.0]
    assert [str(line[1]) for line in short.rows] == ["–", "–", "2", "2", "–"]  # training seeds
    assert short.rows[0][3].numbers["value"] == pytest.approx(1.0)
    expected = np.log10(np.maximum(behind, 1e-8)).mean()
    assert short.rows[1][4].numbers["value"] == pytest.approx(expected)
    assert short.rows[1][8].numbers["value"] == pytest.approx(expected + 1.0)
    assert [str(short.rows[k][5]) for k in (0, 1, 4)] == ["–"] * 3  # there is no such rival of CMA-ES
    minus = np.log10(np.maximum(ahead, 1e-8)).mean() - expected
    assert [short.rows[k][5].numbers["value"] for k in (2, 3)] == pytest.approx([minus, minus])
    assert {str(line[column]) for line in short.rows for column in (6, 7)} == {"–"}
    # All runs of a function are equal, and functions are given: the interval has no width.
    assert short.rows[1][4].numbers["low"] == pytest.approx(expected)
    shown = ("CMA-ES, lambda 10", "L-SHADE, constant tuned", "L-SHADE, learned, evolution")
    assert by_function.columns[2:] == shown


def test_the_gap_of_a_function_is_over_all_runs_and_training_seeds():
    measured = row(np.arange(1.0, 17.0), seeds=2)
    measured.final[1, 3] += 2.0
    assert gaps_of(measured)[FUNCTIONS[3]] == (5.0, 1.0)
