"""Planning with wishes on maps of cells: cost of ground and distance from obstacles besides the length."""

import math

import numpy as np
import pytest
import shapely
from scipy import ndimage, optimize

from helpers.plans import assert_free, obstacles_of
from swarm_gym.errors import ScenarioError, SettingError, UnknownNameError
from swarm_gym.plan import main
from swarm_gym.planning import plan, wishes
from swarm_gym.planning.tasks import read_task
from swarm_gym.planning.wishes import WishedTask
from swarm_gym.scenarios import GridMap, make_scenario
from swarm_gym.scenarios.graded_map import GradedMap

EMPTY = GridMap("meadow", np.zeros((40, 60), dtype=bool), 0.5, (0.25, 19.75), y_up=True)


def meadow(swamp, cost):
    costs = np.zeros(EMPTY.blocked.shape)
    costs[swamp] = cost
    return GradedMap(EMPTY, costs)


def test_a_path_is_refracted_where_the_ground_changes():
    # Snell's law: the left half costs 1 and the right half 3 per metre, from (5, 4) to (25, 16).
    ground = meadow(np.s_[:, 30:], 2.0)
    start, goal = (5.0, 4.0), (25.0, 16.0)

    def sum_through(y):
        return math.dist(start, (15.0, y)) + 3.0 * math.dist((15.0, y), goal)

    best = optimize.minimize_scalar(sum_through, bounds=(4.0, 16.0), method="bounded").fun
    assert best < 0.97 * sum_through(10.0)  # the straight line is worse
    found = plan(ground, start, goal)
    assert found.found_by == "wishes"
    assert found.costs["sum"] == pytest.approx(found.length + found.costs["ground"])
    assert best - 1e-9 <= found.costs["sum"] <= 1.002 * best


def test_a_path_goes_around_a_swamp_only_if_that_is_worth_it():
    swamp = np.s_[10:30, 25:35]  # 5 metres wide, 10 high, in the middle
    for cost, is_around in ((0.1, False), (9.0, True)):
        found = plan(meadow(swamp, cost), (2.0, 10.0), (28.0, 10.0))
        assert (found.length > 26.01) == is_around
        assert (found.costs["ground"] < 1e-6) == is_around
    free = plan(meadow(swamp, 9.0), (2.0, 10.0), (28.0, 10.0), wishes={"ground": 0.0})
    assert free.length == pytest.approx(26.0)
    assert set(free.costs) == {"length"}


@pytest.mark.parametrize("radius", [0.0, 0.8])
def test_a_path_that_wishes_for_distance_is_free_and_farther_from_obstacles(radius):
    near = plan("rooms:1", robot_radius=radius)
    far = plan("rooms:1", robot_radius=radius, wishes={"distance": 3.0})
    assert_free(near, radius)
    assert_free(far, radius)
    assert far.costs["distance"] < 0.7 * nearness(near, radius)
    assert far.gap > 0.0
    assert far.costs["sum"] == pytest.approx(far.length + 3.0 * far.costs["distance"])
    assert far.costs["distance"] == pytest.approx(nearness(far, radius), rel=0.02)


def nearness(found, radius):
    """Integrate the cost of nearness along a path by samples, with distances of cells from shapely."""
    line, blocked, grid = shapely.LineString(found.path), obstacles_of(found.map), found.map.map
    places = np.linspace(0.0, line.length, 2001)[1:-1]
    xy = shapely.get_coordinates(line.interpolate(places))
    middles = grid.to_map(np.rint(grid.to_cells(xy)))
    apart = shapely.distance(shapely.points(middles), blocked)
    decay = max(radius, 3.0 * grid.resolution)
    return float(np.exp(-np.maximum(apart - radius, 0.0) / decay).mean() * line.length)


def test_the_field_of_wishes_is_one_on_empty_plain_ground():
    task = read_task(meadow(np.s_[:, :], 0.5), (2.0, 10.0), (28.0, 10.0), 0.0)
    wished = WishedTask(task, {"ground": 2.0, "distance": 5.0})
    np.testing.assert_array_equal(wished.field, 2.0)
    costs = wished.costs_of(np.array([(2.0, 10.0), (28.0, 10.0)]))
    assert costs == pytest.approx({"length": 26.0, "ground": 13.0, "distance": 0.0, "sum": 52.0})


def test_along_a_border_between_cells_the_dearer_ground_counts():
    wished = WishedTask(
        read_task(meadow(np.s_[:20], 1.0), (2.0, 10.0), (28.0, 10.0), 0.0), {"ground": 1.0, "distance": 0.0}
    )
    for y, cost in ((9.999, 0.0), (10.0, 26.0), (10.001, 26.0)):
        path = np.array([(2.0, y), (28.0, y)])
        assert wished.costs_of(path)["ground"] == pytest.approx(cost), y


def test_the_sum_never_exceeds_that_of_the_shortest_path():
    for name in ("caves:3", "rooms:4"):
        scenario = make_scenario(name)
        rng = np.random.default_rng(3)
        costs = ndimage.gaussian_filter(rng.uniform(0.0, 30.0, scenario.map.blocked.shape), 2.0)
        task = read_task(GradedMap(scenario.map, costs), scenario.start, scenario.target, 0.0)
        shortest = WishedTask(task, {"ground": 1.0, "distance": 1.0}).costs_of(task.shortest[1])
        found = plan(
            GradedMap(scenario.map, costs),
            scenario.start,
            scenario.target,
            wishes={"ground": 1.0, "distance": 1.0},
        )
        assert_free(found)
        assert found.costs["sum"] < 0.999 * shortest["sum"]
        assert [one.found_by for one in found.improvements] == ["exact planner", "wishes"]


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        (
            {"wishes": {"distance": -1.0}},
            SettingError,
            r"weight of distance must lie in \[0, 1e\+06\], got -1",
        ),
        ({"wishes": {"comfort": 1.0}}, UnknownNameError, "unknown wish 'comfort'"),
        ({"wishes": 2.0}, SettingError, "wishes must be weights by name"),
        ({"wishes": {"ground": 1.0}}, SettingError, "has no costs of ground"),
        ({"wishes": {"distance": 1.0}, "planner": "swarm"}, SettingError, "a swarm weighs the length alone"),
        ({"unknown": "free"}, SettingError, "map 'rooms:0' has no grades"),
        ({"lethal": 3}, SettingError, "no grades"),
        ({"terrain": {"S": 1.0}}, SettingError, "no grades"),
    ],
)
def test_wishes_that_cannot_be_are_refused(options, error, words):
    with pytest.raises(error, match=words):
        plan("rooms:0", **options)


def test_wishes_need_a_map_of_cells_and_maps_of_cells_need_ends(monkeypatch):
    with pytest.raises(SettingError, match="map 'case1' has circles and polygons"):
        plan("case1", wishes={"distance": 1.0})
    monkeypatch.setattr(wishes, "MOST_CELLS", 100)
    with pytest.raises(SettingError, match="at most 100 cells, map 'rooms:0' has"):
        plan("rooms:0", wishes={"distance": 1.0})
    with pytest.raises(ScenarioError, match="expected a start and a goal"):
        plan(EMPTY)
    assert plan(EMPTY, (1.0, 1.0), (20.0, 1.0)).length == pytest.approx(19.0)


def test_the_command_takes_grades_and_wishes(tmp_path, capsys):
    (tmp_path / "pond.map").write_text(
        "type octile\nheight 9\nwidth 21\nmap\n"
        + ("." * 8 + "WWWWW" + "." * 8 + "\n") * 6
        + ("." * 21 + "\n") * 3
    )
    ends = ["--map", str(tmp_path / "pond.map"), "--start", "1,1", "--goal", "19,1"]
    assert main(ends) == 0
    assert "length       20.8" in capsys.readouterr().out  # around the water
    assert main([*ends, "--terrain", "W=0.01"]) == 0
    output = capsys.readouterr().out
    assert "length       18\n" in output
    assert "ground       0.05\n" in output
    assert "sum          18.05\n" in output
    assert main([*ends, "--terrain", "W=-1"]) == 2
    assert "cost of 'W' must be a number from 0 on" in capsys.readouterr().err
    assert main([*ends, "--unknown", "dear"]) == 2
    assert "letters" in capsys.readouterr().err
    with pytest.raises(SystemExit, match="2"):
        main([*ends, "--wishes", "distance"])
    assert "expected name=number" in capsys.readouterr().err
