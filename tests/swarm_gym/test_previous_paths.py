"""Planning that goes on from a path which was valid before the map changed."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from helpers.plans import assert_free, obstacles_of
from helpers.slow import slow_but
from swarm_gym.errors import SettingError
from swarm_gym.plan import main
from swarm_gym.planning import plan
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import Circle, GridMap, GridScenario, make_scenario


def wall_on(scenario, path):
    """Return the scenario with a round obstacle on the middle of a path, and the obstacle's place."""
    line = shapely.LineString(path)
    at = line.interpolate(0.5, normalized=True)
    if isinstance(scenario, GridScenario):
        column, row = scenario.map.to_cells((at.x, at.y))
        rows, columns = np.indices(scenario.map.blocked.shape)
        disc = (columns - column) ** 2 + (rows - row) ** 2 <= 3.0**2
        grid = scenario.map
        changed = GridMap("changed", grid.blocked | disc, grid.resolution, grid.origin, grid.y_up)
        return replace(scenario, map=changed)
    obstacles = (*scenario.obstacles, Circle(at.x, at.y, 40.0))
    return replace(scenario, obstacles=obstacles)


@pytest.mark.parametrize("name", slow_but(["case3"], ["caves:1", "case3"]))
def test_planning_goes_on_from_the_path_before_an_obstacle_appeared(name):
    before = plan(name, seed=2, planner="swarm")
    changed = wall_on(before.map, before.path)
    again = plan(changed, seed=2, previous=before.path, planner="swarm")
    assert_free(again)
    first = again.improvements[0]
    assert first.found_by.startswith("previous path")
    assert shapely.LineString(first.path).intersection(obstacles_of(changed).buffer(-1e-5)).length == 0.0
    lengths = [shapely.LineString(improvement.path).length for improvement in again.improvements]
    assert lengths == sorted(lengths, reverse=True)
    assert again.length == pytest.approx(lengths[-1])


def test_a_previous_path_that_is_still_the_shortest_is_kept():
    exact = shortest_path(make_scenario("rooms:0"))[1]
    found = plan("rooms:0", previous=exact, planner="swarm")
    assert found.found_by == "previous path"
    assert found.gap == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("previous", "message"),
    [
        ([(0.0, 0.0)], r"at least two points.*\(1, 2\)"),
        ("path", "expected points"),
        ([(0.0, 0.0), (0.0, np.nan)], "finite"),
        ([(0.0, 0.0), (5.0, 5.0)], r"starts at .*got \(0.0, 0.0\)"),
    ],
)
def test_a_previous_path_that_does_not_fit_is_refused(previous, message):
    with pytest.raises(SettingError, match=f"previous: .*{message}"):
        plan("rooms:0", previous=previous)


def test_the_command_reads_the_previous_path_that_it_wrote(tmp_path, capsys):
    file = tmp_path / "path.csv"
    assert main(["--map", "rooms:0", "--output", str(file)]) == 0
    assert main(["--map", "rooms:0", "--previous", str(file), "--budget", "1", "--planner", "swarm"]) == 0
    assert "found by     " in capsys.readouterr().out
    for content, message in (("a,b\n", "line 1"), ("x,y\n1,2\n3\n", "line 3"), (None, "cannot be read")):
        file.unlink() if content is None else file.write_text(content)
        assert main(["--map", "rooms:0", "--previous", str(file)]) == 2
        assert message in capsys.readouterr().err
