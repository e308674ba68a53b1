"""Grid maps on which waypoints cannot reach the target are warned about."""

import warnings

import gymnasium
import numpy as np
import pytest

from swarm_gym.problem.grid.problem import has_forward_path
from swarm_gym.scenarios import GridMap, GridScenario

# The way from S leads to the left, and around the wall.
TURN = """
.......
.#####.
.#S....
.######
......T
"""
# A way up, over a hook and down.
OVER = """
.....
.###.
S..#T
.#.#.
.####
"""
# A wall with a door in the middle.
DOOR = """
..#..
..#..
S...T
..#..
..#..
"""


def scenario_of(drawing, turns=0, start="S", target="T"):
    cells = np.rot90(np.array([list(row) for row in drawing.split()]), turns)
    ends = [tuple(np.argwhere(cells == end)[0][::-1].astype(float).tolist()) for end in (start, target)]
    return GridScenario("drawn", GridMap("drawn", cells == "#"), *ends)


@pytest.mark.parametrize("turns", range(4))
@pytest.mark.parametrize(("start", "target"), [("S", "T"), ("T", "S")])
def test_a_way_back_is_seen_from_all_sides(turns, start, target):
    assert has_forward_path(scenario_of(DOOR, turns, start, target))
    assert has_forward_path(scenario_of(OVER, turns, start, target))
    assert not has_forward_path(scenario_of(TURN, turns, start, target))


def test_waypoints_are_warned_about_where_all_paths_turn_back():
    scenario = scenario_of(TURN)
    with pytest.warns(UserWarning, match="turns back"):
        gymnasium.make("swarm_gym/Firefly-v0", scenario=scenario)
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        gymnasium.make("swarm_gym/Firefly-v0", scenario=scenario, encoding="bezier")
        gymnasium.make("swarm_gym/Firefly-v0", scenario=scenario_of(DOOR))
