"""Steady replanning: a previous path keeps its corridor unless another one is better by a margin."""

import math

import numpy as np
import pytest
import shapely

from experiments.planners.streams import drive, make_stream
from helpers.plans import assert_free, obstacles_of
from swarm_gym.errors import SettingError
from swarm_gym.plan import main
from swarm_gym.planning import plan
from swarm_gym.planning.previous import rest_of
from swarm_gym.scenarios import Circle, GridMap, GridScenario, Scenario, make_scenario

WIDTH, HEIGHT = 41, 41
START, GOAL = (2.0, 20.0), (38.0, 20.0)
LOW, HIGH = 13, 26  # rows of the two doors, of which the second is nearer to the line between the ends


def wall(*doors, size=3):
    blocked = np.zeros((HEIGHT, WIDTH), dtype=bool)
    blocked[:, 20] = True
    for row in doors:
        blocked[row - size // 2 : row + size // 2 + 1, 20] = False
    blocked[0], blocked[-1] = True, True
    blocked[20, 20] = True
    return GridScenario("wall", GridMap("wall", blocked), START, GOAL)


def is_low(path):
    return np.interp(20.0, path[:, 0], path[:, 1]) < 20.0


def length_through(row, size=3):
    """Return the length of the path that turns at the near edge of a door."""
    rise = abs(row - 20.0) - size // 2 - 0.5
    return 2.0 * math.hypot(17.5, rise) + 1.0


@pytest.mark.parametrize("radius", [0.0, 0.8])
def test_a_corridor_is_kept_while_another_one_is_little_better(radius):
    before = plan(wall(LOW), robot_radius=radius)
    assert is_low(before.path)
    changed = wall(LOW, HIGH - 2)  # the other door is nearer now
    gain = 1.0 - length_through(HIGH - 2) / length_through(LOW)
    assert 0.03 < gain < 0.05
    best = plan(changed, robot_radius=radius)
    assert not is_low(best.path)
    assert best.switched is None
    steady = plan(changed, robot_radius=radius, previous=before.path)
    assert is_low(steady.path)
    assert (steady.found_by, steady.switched) == ("previous corridor", False)
    assert steady.improvements[-1].length == steady.length
    assert_free(steady, radius)
    assert steady.gap == pytest.approx(1.0 / (1.0 - gain) - 1.0, abs=0.01)
    for margin in (0.0, 0.02):
        switched = plan(changed, robot_radius=radius, previous=before.path, switch_margin=margin)
        np.testing.assert_array_equal(switched.path, best.path)
        assert switched.switched is True


def test_the_margin_is_a_share_of_the_length_in_the_previous_corridor():
    before, changed = plan(wall(LOW)), wall(LOW, HIGH - 2)
    gain = 1.0 - length_through(HIGH - 2) / length_through(LOW)
    for margin, is_kept in ((gain * 0.99, False), (gain * 1.01, True), (1.0, True)):
        assert is_low(plan(changed, previous=before.path, switch_margin=margin).path) == is_kept


def test_a_corridor_that_is_closed_is_left():
    before = plan(wall(LOW))
    after = plan(wall(HIGH), previous=before.path)
    assert not is_low(after.path)
    assert_free(after)
    assert after.switched is not None


@pytest.mark.parametrize("radius", [0.0, 0.8])
def test_a_piece_that_is_blocked_now_is_replaced_within_the_corridor(radius):
    before = plan(wall(LOW), robot_radius=radius)
    changed = wall(LOW, HIGH - 2)
    blocked = changed.map.blocked.copy()
    middle = before.path[[0, 1]].mean(axis=0)
    column, row = np.rint(middle).astype(int)
    blocked[row - 1 : row + 1, column - 1 : column + 2] = True  # on the way to the door
    changed = GridScenario("changed", GridMap("changed", blocked), START, GOAL)
    assert shapely.LineString(before.path).distance(obstacles_of(changed)) == 0.0
    after = plan(changed, robot_radius=radius, previous=before.path, switch_margin=0.2)
    assert is_low(after.path)
    assert after.found_by == "previous corridor"
    assert_free(after, radius)


def test_a_side_of_a_circle_is_kept_where_it_trembles():
    def with_circle(y):
        return Scenario("circle", (0.0, 0.0), (20.0, 0.0), (Circle(10.0, y, 4.0),), (-5.0, -10.0, 25.0, 10.0))

    path = plan(with_circle(0.1), robot_radius=0.5).path
    assert np.interp(10.0, *path.T) < 0.0
    for y in (-0.1, 0.1, -0.2, -0.1):
        for margin, is_below in ((0.05, True), (0.0, y > 0.0)):
            found = plan(with_circle(y), robot_radius=0.5, previous=path, switch_margin=margin)
            assert (np.interp(10.0, *found.path.T) < 0.0) == is_below
            assert_free(found, 0.5)
        path = plan(with_circle(y), robot_radius=0.5, previous=path).path


def test_with_wishes_the_sums_are_compared():
    before = plan(wall(LOW), wishes={"distance": 1.0})
    changed = wall(LOW, HIGH - 2)
    kept = plan(changed, previous=before.path, wishes={"distance": 1.0}, switch_margin=0.1)
    taken = plan(changed, previous=before.path, wishes={"distance": 1.0}, switch_margin=0.0)
    assert is_low(kept.path)
    assert not is_low(taken.path)
    assert taken.costs["sum"] < kept.costs["sum"] <= taken.costs["sum"] / 0.9


def test_the_rest_of_a_path_begins_at_the_robot():
    path = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)])
    np.testing.assert_array_equal(rest_of(path, (4.0, 1.0)), [(4, 1), (4, 0), (10, 0), (10, 10)])
    np.testing.assert_array_equal(rest_of(path, (11.0, 7.0)), [(11, 7), (10, 7), (10, 10)])


def test_a_robot_in_a_stream_of_maps_drives_freely_and_flips_less_with_a_margin():
    stream = make_stream(make_scenario("rooms:2"), 2, maps=24)
    plain, steady = drive(stream, 0.0, 0.4), drive(stream, 0.05, 0.4)
    assert (plain.hits, steady.hits) == (0, 0)
    assert steady.flips < plain.flips
    assert len(steady.seconds) > 12
    assert steady.length > 0.3


def test_the_command_has_the_margin(tmp_path, capsys):
    file = tmp_path / "path.csv"
    assert main(["--map", "rooms:0", "--output", str(file)]) == 0
    assert main(["--map", "rooms:0", "--previous", str(file), "--switch-margin", "0.1"]) == 0
    assert "corridor     that of the previous path\n" in capsys.readouterr().out
    for margin in (-0.1, 1.5, math.nan):
        with pytest.raises(SettingError, match="switch_margin must lie in"):
            plan("rooms:0", switch_margin=margin)
