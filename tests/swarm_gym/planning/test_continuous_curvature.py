"""Curves of continuous curvature: limits by other code, clothoids by Fresnel's integrals, refusals."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import fresnel

from helpers.grids import grid
from oracles.driven_curves import assert_drivable
from swarm_gym.errors import NoPathError, SettingError
from swarm_gym.plan import main
from swarm_gym.planning import Planner, plan
from swarm_gym.planning.curve import Curve
from swarm_gym.planning.drive_costs import USUAL
from swarm_gym.planning.drive_map import DriveMap
from swarm_gym.planning.smoothing import is_free, smoothed
from swarm_gym.planning.tasks import read_task
from swarm_gym.scenarios import Circle, GridMap, Scenario

SHORT = 1e-4  # chords that are left out: their directions are little known


def assert_continuous(curve, rate, step):
    """Assert that the curvature changes no faster than a rate, by points alone and in what is claimed."""
    poses = curve.sampled(step)
    assert np.abs(poses[:, 3]).max() <= (1.0 + 1e-8) / curve.turning_radius
    points = poses[:, :2]
    chords = np.diff(points, axis=0)
    lengths = np.hypot(*chords.T)
    changes = np.abs(np.diff(poses[:, 3]))
    assert (changes <= rate * lengths * (1.0 + 1e-3) + 1e-9).all()
    kept = lengths > SHORT
    angles = np.arctan2(chords[:, 1], chords[:, 0])[kept] + np.where(poses[:-1, 4][kept] < 0.0, np.pi, 0.0)
    lengths, signs = lengths[kept], poses[:-1, 4][kept]
    between = 0.5 * (lengths[1:] + lengths[:-1])
    turns = (np.diff(angles) + np.pi) % (2.0 * np.pi) - np.pi
    same = signs[1:] == signs[:-1]
    curvatures = (signs[1:] * turns / between)[same]
    apart = (0.5 * (between[1:] + between[:-1]))[same[1:] & same[:-1]]
    measured = np.abs(np.diff(signs[1:] * turns / between))[same[1:] & same[:-1]]
    assert np.abs(curvatures).max() <= (1.0 + 1e-3) / curve.turning_radius
    assert (measured <= rate * (apart + 2.0 * SHORT) * 1.01 + 1e-6).all()


def circles():
    return Scenario(
        "two", (0.0, 0.0), (40.0, 3.0), (Circle(12.0, 1.0, 4.0), Circle(27.0, -1.0, 4.0)),
        (-10.0, -20.0, 50.0, 20.0),
    )  # fmt: skip


def rooms():
    blocked = np.zeros((24, 40), dtype=bool)
    blocked[:16, 13] = blocked[8:, 26] = True
    return GridMap("rooms", blocked)


@pytest.mark.parametrize("rate", [0.3, 0.03])
@pytest.mark.parametrize("ends", [{}, {"start_heading": 60.0, "goal_heading": -45.0}])
def test_curves_obey_the_rate_and_all_other_limits(rate, ends):
    found = plan(
        circles(), robot_radius=1.0, turning_radius=3.0, curvature_rate=rate, max_evaluations=1000, **ends
    )
    assert_drivable(found, 1.0, step=0.01, **ends)
    assert_continuous(found.curve, rate, 0.01)
    assert found.curve.least_radius >= 3.0 * (1.0 - 1e-9)
    jumping = plan(circles(), robot_radius=1.0, turning_radius=3.0, max_evaluations=1000, **ends)
    assert jumping.curve.rates is None
    with pytest.raises(AssertionError):
        assert_continuous(jumping.curve, rate, 0.01)
    squares = (found.curve.sampled(0.01)[:-1, 3] * 3.0) ** 2
    steps = np.hypot(*np.diff(found.curve.sampled(0.01)[:, :2], axis=0).T)
    assert found.costs["curvature"] == pytest.approx(float((squares * steps).sum()), rel=1e-2)


def test_curves_on_cells_and_their_alternatives_obey_the_rate():
    found = plan(
        rooms(), (3.0, 4.0), (36.0, 20.0), robot_radius=0.4, turning_radius=2.0, curvature_rate=0.2,
        max_evaluations=1000,
    )  # fmt: skip
    assert_drivable(found, 0.4, step=0.01)
    assert_continuous(found.curve, 0.2, 0.01)
    two = plan(
        circles(), robot_radius=1.0, turning_radius=3.0, curvature_rate=0.1, alternatives=2,
        max_evaluations=500,
    )  # fmt: skip
    assert len(two.alternatives) == 2
    for one in two.alternatives:
        assert_continuous(one.curve, 0.1, 0.02)


def test_curvature_is_continuous_where_the_robot_turns_back():
    blocked = np.ones((11, 30), dtype=bool)
    blocked[1:-1, 1:-1] = False
    found = plan(
        GridMap("corridor", blocked), (12.0, 5.0), (20.0, 5.0), robot_radius=0.5, turning_radius=3.0,
        start_heading=180.0, goal_heading=0.0, reverse=True, curvature_rate=0.5, max_evaluations=1000,
    )  # fmt: skip
    assert found.curve.changes >= 1
    assert_drivable(found, 0.5, 180.0, 0.0, reverses=True, step=0.01)
    assert_continuous(found.curve, 0.5, 0.01)


def test_curves_are_free_where_dense_points_keep_the_margin():
    """Lines that pass below two circles, closer and closer."""
    drive_map = DriveMap(read_task(circles(), None, None, 1.0), 3.0, dict.fromkeys(USUAL, 0.0))
    line = Curve(np.array([0.0, 0.0, 0.0]), np.array([[0.0, 40.0]]), 3.0, np.zeros(1))
    seen = []
    for y in (-12.0, -6.01, -6.002, -5.998, -5.99, -4.0, 0.0, 12.0):
        moved = replace(line, start=np.array([-8.0, y, 0.0]))
        places = moved.at(np.linspace(0.0, 40.0, 40_001))[:, :2]
        apart = min(np.hypot(*(places - one).T).min() - 4.0 for one in ((12.0, 1.0), (27.0, -1.0)))
        if abs(apart - 1.0) > drive_map.slack:
            assert is_free(drive_map, moved) == (apart > 1.0)
            seen.append(apart > 1.0)
        assert apart > 1.0 or not is_free(drive_map, moved)
    assert True in seen
    assert False in seen


def test_points_on_a_clothoid_are_integrals_of_fresnel():
    rate, length = 0.35, 2.6
    curve = Curve(np.array([2.0, 1.0, 0.0]), np.array([[0.0, length]]), 0.5, np.array([rate]))
    poses = curve.sampled(0.1)
    unit = math.sqrt(math.pi / rate)
    along = np.linspace(0.0, length, len(poses))
    sines, cosines = fresnel(along / unit)
    np.testing.assert_allclose(poses[:, :2], np.stack([2.0 + unit * cosines, 1.0 + unit * sines], axis=-1))
    np.testing.assert_allclose(np.radians(poses[:, 2]), 0.5 * rate * along**2, atol=1e-12)
    np.testing.assert_allclose(poses[:, 3], rate * along, atol=1e-12)
    assert curve.least_radius == pytest.approx(1.0 / (rate * length))
    assert curve.bending() == pytest.approx(0.25 * rate**2 * length**3 / 3.0)


def test_a_straight_line_stays_as_it_is():
    line = Curve(np.array([0.0, 0.0, 90.0]), np.array([[0.0, 5.0]]), 1.0)
    found = smoothed(line, np.array([0.0, 5.0, math.pi / 2.0]), 1.0, 0.1, False, False)
    np.testing.assert_allclose(found.sampled(0.5)[:, 3], 0.0, atol=1e-9)
    assert smoothed(line, np.array([4.0, 0.0, math.pi / 2.0]), 1.0, 0.1, False, False) is None


def test_a_rate_that_no_curve_obeys_is_the_reason(capsys, tmp_path):
    bend = grid(*["#" * 14, *["#..." + "#" * 10] * 6, *["#" + "." * 12 + "#"] * 3, "#" * 14])
    file = tmp_path / "bend.map"
    rows = ["".join("@" if cell else "." for cell in row) for row in bend]
    file.write_text("\n".join(["type octile", "height 11", "width 14", "map", *rows, ""]))
    limits = ["--start", "2,1.5", "--goal", "11.5,8", "--turning-radius", "2", "--robot-radius", "0.4"]
    arguments = ["--map", str(file), *limits, "--budget", "500", "--curvature-rate"]
    assert main([*arguments, "2", "--output", str(tmp_path / "path.csv")]) == 0
    lines = (tmp_path / "path.csv").read_text().splitlines()[1:]
    curvatures = np.array([float(line.split(",")[3]) for line in lines])
    assert np.abs(np.diff(curvatures)).max() <= 2.0 * 0.05 * 2.0 * (1.0 + 1e-6)
    assert main([*arguments, "0.001"]) == 3
    said = capsys.readouterr().err
    assert "that obeys the curvature rate 0.001; without it there is a curve of length" in said


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"turning_radius": 1.0, "curvature_rate": 0.0}, "curvature_rate must lie in .*got 0.0"),
        ({"turning_radius": 1.0, "curvature_rate": "slow"}, "curvature_rate must be a number, got 'slow'"),
        ({"curvature_rate": 1.0}, "curvature_rate 1.0: expected a turning_radius, too"),
    ],
)
def test_bad_rates_are_named(options, message):
    with pytest.raises(SettingError, match=message):
        plan(circles(), **options)


def test_a_planner_keeps_the_rate_and_the_corridor():
    planner = Planner(circles(), robot_radius=1.0, turning_radius=3.0, curvature_rate=0.1)
    found = planner.with_map(circles()).plan(max_evaluations=500)
    assert_continuous(found.curve, 0.1, 0.02)
    again = planner.plan(previous=found.path, max_evaluations=500)
    assert again.switched is False
    assert_continuous(again.curve, 0.1, 0.02)
    with pytest.raises(NoPathError, match="curvature rate 1e-08"):
        plan(circles(), turning_radius=3.0, curvature_rate=1e-8, start_heading=90.0)
