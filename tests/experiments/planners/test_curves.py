"""The study of drivable curves: a check that names broken limits, and tables of records known by hand."""

import math

import numpy as np
import pytest

from experiments.planners.curves import CurvesConfig, DriveRecord, curve_tables, curves
from experiments.planners.drive_check import STEP, check
from experiments.planners.drive_tasks import ON_CELLS, DriveTask, draw_drive_tasks
from helpers.ompl import require_ompl
from helpers.stored_runs import cells_of
from swarm_gym.planning import Curve
from swarm_gym.scenarios import GridMap, GridScenario


def task(pieces, turning_radius=2.0, radius=0.5, blocked=(5, 1)):
    """Return the task of a curve of pieces from (2, 4), and the poses along the curve."""
    cells = np.zeros((20, 30), dtype=bool)
    cells[blocked[1], blocked[0]] = True
    curve = Curve(np.array([2.0, 4.0, 0.0]), np.array(pieces), 2.0)
    poses = curve.sampled(STEP)[:, :3]
    x, y, heading = poses[-1].tolist()
    poses[:, 2] = np.radians(poses[:, 2])
    scenario = GridScenario("one", GridMap("one", cells), (2.0, 4.0), (x, y))
    return DriveTask("one", 0, scenario, (0.0, heading), radius, turning_radius, 1.0), poses


BEND = [(0.0, 6.0), (0.5, 2.0), (-0.25, 3.0)]


def test_the_check_accepts_a_curve_at_its_limits():
    made, poses = task(BEND)
    verdict = check(made, poses)
    assert verdict.broken == ""
    assert verdict.length == pytest.approx(11.0, rel=1e-6)
    assert verdict.clearance == pytest.approx(2.5, abs=1e-6)
    exactly, same = task(BEND, radius=2.5)
    assert check(exactly, same).broken == ""


def test_the_check_names_the_limit_that_is_broken():
    assert check(*task(BEND, turning_radius=2.1)).broken == "curvature"
    assert check(*task(BEND, radius=2.51)).broken == "distance"
    assert check(*task(BEND, blocked=(6, 4))).broken == "distance"
    made, poses = task(BEND)
    assert check(made, poses[:-10]).broken == "ends"
    assert check(made, poses[::3]).broken == "ends"  # longer steps than a millimetre
    turned = DriveTask("one", 0, made.scenario, (10.0, made.headings[1]), 0.5, 2.0, 1.0)
    assert check(turned, poses).broken == "ends"
    assert check(*task([(0.0, 3.0), (0.0, -1.0), (0.5, 2.0)])).broken == "curvature"  # it reverses


@pytest.mark.parametrize("count", [1, pytest.param(3, marks=pytest.mark.slow)])
def test_drawn_tasks_have_room_at_their_ends(count):
    for one in draw_drive_tasks("generated rooms", count, 0):
        assert (one.radius, one.turning_radius) == ON_CELLS
        assert one.shortest > math.dist(one.scenario.start, one.scenario.target) * (1.0 - 1e-9)
        for end, heading, sign in zip(
            (one.scenario.start, one.scenario.target), one.headings, (1.0, -1.0), strict=True
        ):
            ahead = np.array(end) + sign * np.array(
                [math.cos(math.radians(heading)), math.sin(math.radians(heading))]
            )
            assert one.scenario.map.is_free(one.scenario.map.cell_of(tuple(ahead.tolist())))


def test_tables_count_curves_that_obey_all_limits():
    def record(task, planner, broken="", first=0.1, length=1.1, total=1.5):
        return DriveRecord("maze", task, planner, broken, first, length, total, 2.0)

    ours, rival = "curve search", "OMPL RRT*, sum of wishes"
    records = [
        *(record(k, ours, total=1.2, first=0.1 * k) for k in range(3)),
        record(3, ours, "none found"),
        *(record(k, rival) for k in range(2)),
        record(2, rival, "curvature"),
        record(3, rival, "none found"),
        record(3, "longer", "none found"),
    ]
    tables = curve_tables(records, 1.0)
    first, second = cells_of(tables, "curves")
    assert (first["planner"], first["tasks"], first["obeys all"], first["breaks one"]) == (
        ours,
        "3",
        "100.0 %",
        "0",
    )
    assert (first["sum"], first["first, s"]) == ("1.200", "0.100")
    assert (second["obeys all"], second["breaks one"], second["sum"]) == ("66.7 %", "1", "1.500")
    (difference,) = cells_of(tables, "curves-differences")
    assert difference["tasks"] == "2"
    assert difference["difference"].startswith("-30.0 %")
    records[-1] = record(3, "longer")  # so it can be solved
    assert cells_of(curve_tables(records, 1.0), "curves")[0]["obeys all"] == "75.0 %"


@pytest.mark.slow
def test_the_study_runs_and_goes_on(tmp_path, capsys):
    require_ompl()
    config = CurvesConfig(tmp_path, ("generated rooms", "caves"), 1, 0.3)
    files = curves(config)
    assert "obeys all" in files[0].read_text()
    kept = (tmp_path / "curves.jsonl").read_text()
    assert curves(config) == files
    assert (tmp_path / "curves.jsonl").read_text() == kept
    assert len(kept.splitlines()) == 2 * 5
