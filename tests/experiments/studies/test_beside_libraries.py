"""CMA-ES and L-SHADE beside other libraries: all have the same budget, and runs are kept."""

import numpy as np
import pytest

from experiments.studies import libraries
from experiments.studies.strong import beside_libraries as module
from experiments.studies.strong.beside_libraries import OURS, PEERS, Timed, beside_libraries, run_all
from experiments.studies.strong.grounds import Ground, bbob

EVALUATIONS = 1_000


@pytest.mark.slow
def test_runs_of_all_rows_are_kept_and_have_the_same_budget(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "SIDE_BY_SIDE", 2)
    ground = Ground("bbob-10", ("function:bbob-1-10-101",), EVALUATIONS)
    found = run_all(ground, 2, tmp_path)
    assert list(found) == [*OURS, *libraries.installed(PEERS)]
    for timed in found.values():
        assert timed.final.shape == (1, 2)
        assert ((timed.final > 1e-8) & (timed.final < 100.0)).all()  # the sphere needs more evaluations
        assert (timed.speed > 0.0).all()
    monkeypatch.setattr(module, "_run", lambda *_: pytest.fail("was run again"))
    for name, timed in run_all(ground, 2, tmp_path).items():
        np.testing.assert_array_equal(timed.final, found[name].final)


def test_the_table_counts_functions_on_which_a_row_is_first():
    shape = (len(bbob(10).scenarios), 4)
    found = {
        "CMA-ES, BIPOP": Timed(np.full(shape, 1e-3), np.full(shape[0], 4e5)),
        "pymoo DE": Timed(np.full(shape, 1e-2), np.full(shape[0], 2e4)),
    }
    found["pymoo DE"].final[:6] = 1e-5  # the first three functions, of two instances each
    found["CMA-ES, BIPOP"].final[6:8] = 1e-12  # below the least gap that counts, as the other one
    found["pymoo DE"].final[6:8] = 1e-9
    ours, theirs = beside_libraries(found, EVALUATIONS).rows
    assert [str(cells[2]) for cells in (ours, theirs)] == ["21", "4"]
    assert theirs[0] == "pymoo DE, library"
    assert theirs[1].numbers["value"] == pytest.approx((20 * -2.0 + 3 * -5.0 - 8.0) / 24)
    assert str(ours[3]) == "400,000"
