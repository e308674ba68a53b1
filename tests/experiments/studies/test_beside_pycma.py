"""CMA-ES beside pycma: both have the same budget, and the table tells gaps that differ."""

import numpy as np
import pytest

from experiments.studies.strong import beside_pycma as module
from experiments.studies.strong.beside_pycma import Both, beside_pycma, run_both
from experiments.studies.strong.grounds import Ground, bbob

EVALUATIONS = 1_000


def test_runs_of_both_are_kept_and_their_gaps_are_those_after_the_budget(tmp_path, monkeypatch):
    pytest.importorskip("cma", reason="needs pycma, of the group dev")
    monkeypatch.setattr(module, "SIDE_BY_SIDE", 2)
    ground = Ground("bbob-10", ("function:bbob-1-10-101",), EVALUATIONS)
    (both,) = run_both(ground, 10, 3, tmp_path)
    # The sphere needs about 1,500 evaluations for 1e-8: after 1,000, both are between these.
    assert ((both.ours > 1e-8) & (both.ours < 1e-1)).all()
    assert ((both.theirs > 1e-8) & (both.theirs < 1e-1)).all()
    assert both.our_speed > both.their_speed > 0.0
    monkeypatch.setattr(module, "_run", lambda *_: pytest.fail("was run again"))
    (again,) = run_both(ground, 10, 3, tmp_path)
    for stored, made in zip(again, both, strict=True):
        np.testing.assert_array_equal(stored, made)
    with pytest.raises(pytest.fail.Exception, match="run again"):
        run_both(ground, 10, 2, tmp_path)


def test_the_table_counts_functions_whose_gaps_differ():
    def both(ours, theirs):
        spread = np.logspace(0.0, 0.1, 8)
        return Both(ours * spread, theirs * spread, np.array([60.0]), np.array([3.0]))

    found = [both(1.0, 1.0) for _ in bbob(10).scenarios]
    found[4], found[5] = both(1e-4, 1e-2), both(1e-3, 1e-1)  # the two instances of the third function
    found[6] = found[7] = both(1e-12, 1e-9)  # gaps below 1e-8 are equal
    table = beside_pycma(found, 10, EVALUATIONS)
    assert len(table.rows) == 25
    first, third, fourth, last = (table.rows[k] for k in (0, 2, 3, 24))
    assert first[4].numbers["value"] == pytest.approx(1.0)
    assert third[3].numbers["value"] == pytest.approx(-2.0)
    assert third[4].numbers["value"] < 0.001
    assert fourth[3].numbers["value"] == pytest.approx(0.0)
    assert str(last[4]) == "1 below 0.05"
    assert last[3].numbers["value"] == pytest.approx(-2.0 / 24)
    assert last[5].numbers["value"] == pytest.approx(20.0)
