"""Scenarios of flights over terrain: what is refused, by its value, and what is derived."""

import math

import numpy as np
import pytest

from helpers.loops import looped
from helpers.refusals import refused
from helpers.terrains import rolling_terrain
from swarm_gym.errors import ScenarioError
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import TerrainScenario, hill_shade

HEIGHTS = np.arange(20.0).reshape(4, 5)
PARTS = {"heights": HEIGHTS, "start": (1.0, 1.0, 150.0), "goal": (30.0, 20.0, 150.0), "cell": 10.0}


def made(**parts):
    return TerrainScenario("made", **{**PARTS, **parts})


def holes():
    heights = HEIGHTS.copy()
    heights[2, 3] = np.nan
    return heights


@looped(
    ("parts", "words"),
    [
        ({"heights": []}, ("heights", "(0,)")),
        ({"heights": [[1.0]]}, ("heights", "(1, 1)")),
        ({"heights": "high"}, ("heights", "'high'")),
        ({"heights": holes()}, ("1 of 20", "nan", "row 2, column 3")),
        ({"cell": 0.0}, ("cell", "0.0")),
        ({"cell": "wide"}, ("cell", "'wide'")),
        ({"origin": (1.0,)}, ("origin", "2 numbers")),
        ({"start": (1.0, 1.0)}, ("start", "3 numbers")),
        ({"start": (-1.0, 1.0, 150.0)}, ("start", "outside the map", "0.0 to 40.0")),
        ({"goal": (8.6, 50.1, 150.0)}, ("goal", "outside the map", "another system")),
        ({"goal": (1.0, 1.0, 160.0)}, ("different points", "(1.0, 1.0)")),
        ({"start": (1.0, 1.0, 99.0)}, ("start", "99.0 metres", "100.0 to 200.0")),
        ({"start": (1.0, 1.0, math.nan)}, ("start", "nan")),
        ({"band": (200.0, 100.0)}, ("band", "(200.0, 100.0)")),
        ({"band": (-1.0, 100.0)}, ("band", "-1.0")),
        ({"largest_turn": 0.0}, ("largest_turn", "0.0")),
        ({"largest_climb": 91.0}, ("largest_climb", "91.0")),
        ({"drone_size": -1.0}, ("drone_size", "-1.0")),
        ({"danger_distance": math.inf}, ("danger_distance", "inf")),
        ({"threats": [[1.0, 2.0, 3.0]]}, ("threats", "(1, 3)")),
        ({"threats": [[5.0, 5.0, math.inf, 0.0]]}, ("threat 0", "positive radius", "0.0")),
        ({"threats": [[5.0, 5.0, math.inf, math.nan]]}, ("threat 0", "radius", "nan")),
        ({"threats": [[5.0, 5.0, math.nan, 1.0]]}, ("threat 0", "top", "nan")),
        ({"threats": [[math.nan, 5.0, 1.0, 1.0]]}, ("threat 0", "centre")),
        ({"threats": [[3.0, 1.0, math.inf, 1.5]]}, ("start", "inside threat 0", "2.0 metres")),
        ({"threats": [[30.0, 20.0, 400.0, 1.5]]}, ("goal", "inside threat 0")),
    ],
)
def test_a_malformed_task_is_refused_by_its_value(parts, words):
    refused(lambda: made(**parts), "scenario 'made'", *words)


def test_ends_may_be_above_a_threat_and_beside_it():
    assert made(threats=[[3.0, 1.0, 100.0, 1.5], [3.6, 1.0, math.inf, 1.5]]).threats.shape == (2, 4)
    assert made(threats=[]).threats.shape == (0, 4)


def test_masked_heights_are_missing():
    heights = np.ma.masked_equal(HEIGHTS.astype(np.int16), HEIGHTS.astype(np.int16)[1, 2])
    with pytest.raises(ScenarioError, match="the first nan in row"):
        made(heights=heights)


def test_arrays_are_copies_that_cannot_be_written():
    heights = HEIGHTS.copy()
    scenario = made(heights=heights, threats=[[20.0, 5.0, 10.0, 2.0]])
    heights[0, 0] = 99.0
    assert scenario.heights[0, 0] == 0.0
    for array in (scenario.heights, scenario.threats):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1.0


def test_the_ground_is_bilinear_and_that_of_the_edge_beyond_it():
    scenario = made(origin=(100.0, 200.0), start=(101.0, 201.0, 150.0), goal=(130.0, 220.0, 150.0))
    assert scenario.workspace == (100.0, 200.0, 140.0, 230.0)
    points = [(100.0, 200.0), (110.0, 200.0), (105.0, 215.0), (140.0, 230.0), (0.0, 0.0)]
    np.testing.assert_allclose(scenario.ground(points), [0.0, 1.0, 8.0, 19.0, 0.0])
    assert scenario.straight_line == pytest.approx(math.hypot(29.0, 19.0, 13.0 - 0.6))
    assert scenario.target == (130.0, 220.0)


def test_scenarios_of_equal_content_are_equal():
    assert made() == made()
    assert hash(made()) == hash(made())
    assert made() != made(largest_turn=30.0)
    assert made() != made(heights=HEIGHTS + 1.0)
    assert made() != "made"
    assert made(threats=[[20.0, 5.0, 10.0, 2.0]]).digest != made().digest


def test_there_is_no_exact_planner():
    with pytest.raises(ScenarioError, match="no shortest path is computed"):
        shortest_path(made())


def test_slopes_that_face_the_light_are_bright():
    ramp = np.tile(np.arange(10.0), (10, 1))
    to_west, to_east = (
        hill_shade(made(heights=h, start=(1.0, 1.0, 150.0), cell=1.0, goal=(8.0, 8.0, 150.0))).mean()
        for h in (ramp, ramp[:, ::-1])
    )
    assert to_west > 0.8
    assert to_east < 0.3
    assert hill_shade(rolling_terrain(), most=10).shape == (10, 10)
