"""Kept runs of libraries over terrain: each library has them, and they can be made again."""

import dataclasses

import numpy as np
import pytest

from experiments.studies.libraries import run_peer
from experiments.studies.terrain.library_runs import FILE, all_kept_runs, kept_runs
from experiments.studies.terrain.rows import Setting
from swarm_gym.runs.seeds import TEST
from swarm_gym.scenarios import make_scenario
from swarm_gym.worlds import make_problem

RUNS = 31
ROWS = (
    "cmaes CMA-ES, spherical",
    "mealpy L-SHADE, waypoints",
    "niapy L-SHADE, waypoints",
    "pymoo DE, waypoints",
)
TERRAINS = [f"terrain:test:{k}" for k in range(56)]


def test_each_library_has_as_many_runs_over_every_terrain():
    found = all_kept_runs()
    assert {one.row for one in found} == set(ROWS)
    expected = {Setting(row, "metabox", 20_000, terrain) for row in ROWS for terrain in TERRAINS}
    assert {one for one in found if one.evaluations == 20_000} == expected
    for one in expected:
        costs = found[one].costs
        assert len(costs) == RUNS
        assert len(set(costs)) > 1
        assert np.isfinite(costs).all()
        assert len(found[one].commit) == 40
    assert FILE.stat().st_size < 500_000


@pytest.mark.slow
@pytest.mark.parametrize("terrain", [TERRAINS[0], TERRAINS[-1]])
@pytest.mark.parametrize("row", ROWS)
def test_a_kept_run_is_made_again(row, terrain):
    peer, encoding = row.split(", ")
    problem = make_problem(make_scenario(terrain), encoding=encoding, cost="metabox")
    kept = kept_runs(Setting(row, "metabox", 20_000, terrain), problem)
    assert kept is not None
    # Runs of cmaes and niapy depend on NumPy's code for the processor; those of the others do not.
    if peer.startswith(("pymoo", "mealpy")):
        found = run_peer(peer, problem, 20_000, TEST[RUNS - 1]).best
        assert found == pytest.approx(kept.costs[RUNS - 1], rel=1e-9)


@pytest.mark.parametrize(("change", "is_known"), [(1e-12, True), (1e-3, False)])
def test_last_digits_of_heights_do_not_matter(change, is_known):
    setting = Setting("pymoo DE, waypoints", "metabox", 20_000, "terrain:test:3")
    scenario = make_scenario(setting.terrain)
    moved = dataclasses.replace(scenario, heights=scenario.heights * (1.0 + change))
    found = kept_runs(setting, make_problem(moved, encoding="waypoints", cost="metabox"))
    assert (found is not None) == is_known
