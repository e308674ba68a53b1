"""Dynamic scenarios: their worlds, the errors they raise, and their names."""

import math
import pickle

import numpy as np
import pytest
import shapely

from helpers.refusals import refused
from swarm_gym.errors import ScenarioError, SettingError, UnknownNameError
from swarm_gym.problem import AnalyticProblem
from swarm_gym.reference import optimum, shortest_path
from swarm_gym.scenarios import (
    Appear,
    Circle,
    Disappear,
    DynamicScenario,
    FunctionScenario,
    GridMap,
    GridScenario,
    Move,
    Polygon,
    Scenario,
    make_scenario,
    make_scenarios,
    world_at,
    worlds_of,
)
from swarm_gym.scenarios.dynamic.family import EVENTS

FIRST, SECOND, NEW = Circle(30, 0, 10), Polygon.rectangle(50, -5, 60, 5), Circle(80, 0, 5)
BASE = Scenario("base", (0, 0), (100, 0), (FIRST, SECOND), (-10, -50, 110, 50))
FORM = "<base>[-<event>@<iteration>[-<last>]]"
FREE = GridScenario("free", GridMap("free", np.zeros((9, 14), dtype=np.bool_)), (0, 4), (13, 4))


def dynamic(*events, base=BASE):
    return DynamicScenario("made", base, events)


def test_the_map_is_what_the_events_so_far_made_of_it():
    events = [Appear(3, NEW), Move(5, 0, (0, 4)), Disappear(5, 1), Move(9, 2, (-1, 1)), Disappear(12, 0)]
    found = [(world.iteration, world.scenario.obstacles) for world in dynamic(*events).worlds]
    moved = Circle(30, 4, 10)
    assert found == [
        (0, (FIRST, SECOND)),
        (3, (FIRST, SECOND, NEW)),
        (5, (moved, NEW)),
        (9, (moved, Circle(79, 1, 5))),
        (12, (Circle(79, 1, 5),)),
    ]


def test_worlds_are_the_base_under_the_name_of_the_scenario_but_for_their_obstacles():
    for world in dynamic(Appear(3, NEW)).worlds:
        scenario = world.scenario
        assert scenario.name == "made"
        assert (scenario.start, scenario.target) == (BASE.start, BASE.target)
        assert (scenario.workspace, scenario.initial_range) == (BASE.workspace, BASE.initial_range)
    assert [(world.iteration, world.scenario.obstacles) for world in dynamic().worlds] == [
        (0, BASE.obstacles)
    ]
    assert worlds_of(BASE) == ((0, BASE),)


def test_what_happens_after_an_iteration_is_there_when_it_is_done():
    made = dynamic(Appear(3, NEW), Disappear(5, 2))
    numbers = [len(world_at(made, iteration).obstacles) for iteration in range(7)]
    assert numbers == [2, 2, 2, 3, 3, 2, 2]
    assert world_at(BASE, 7) is BASE


def test_a_polygon_moves_as_a_whole():
    (_, world) = dynamic(Move(1, 1, (2.5, -1))).worlds
    assert world.scenario.obstacles == (FIRST, Polygon.rectangle(52.5, -6, 62.5, 4))


def test_on_grids_what_came_blocks_cells_and_leaves_those_of_the_map_when_it_goes():
    blocked = np.zeros((9, 14), dtype=np.bool_)
    blocked[2, 5:8] = True
    base = GridScenario("walls", GridMap("walls", blocked), (0, 4), (13, 4))
    block = Polygon.rectangle(4.5, 0.5, 6.5, 2.5)
    worlds = dynamic(Appear(2, block), Move(4, 0, (1, 1)), Disappear(6, 0), base=base).worlds
    there, moved = blocked.copy(), blocked.copy()
    there[1:3, 5:7] = True
    moved[2:4, 6:8] = True
    for world, expected in zip(worlds, (blocked, there, moved, blocked), strict=True):
        np.testing.assert_array_equal(world.scenario.map.blocked, expected)
    assert worlds[0].scenario.map == base.map == worlds[3].scenario.map


def test_scenarios_are_equal_where_their_bases_and_events_are_and_survive_pickling():
    one, other = dynamic(Appear(3, NEW)), dynamic(Appear(3, NEW))
    assert one == other == pickle.loads(pickle.dumps(one))
    assert hash(one) == hash(other)
    assert one != dynamic(Appear(4, NEW))


# Errors.


@pytest.mark.parametrize(
    ("events", "mentions"),
    [
        ([Appear(5, NEW), Appear(4, NEW)], ["order", "iteration=5", "iteration=4"]),
        ([Appear(0, NEW)], ["iteration=0", "from 1 on"]),
        ([Move(5, 2, (1, 1))], ["after iteration 5", "number=2", "[0, 1]"]),
        ([Disappear(5, 0), Move(6, 0, (1, 1))], ["after iteration 6", "number=0", "[1]"]),
        ([Disappear(5, 7)], ["number=7", "[0, 1]"]),
        ([Appear(5, Circle(3, 0, 4))], ["after iteration 5", "start", "obstacle 2"]),
        ([Appear(5, NEW), Move(8, 2, (18, 0))], ["after iteration 8", "target"]),
        (["block"], ["Appear", "'block'"]),
        (7, ["Appear", "7"]),
    ],
)
def test_events_that_cannot_be_are_refused(events, mentions):
    refused(lambda: DynamicScenario("made", BASE, events), "'made'", *mentions)


def test_on_grids_obstacles_of_the_map_have_no_number_and_the_map_must_not_fall_apart():
    with pytest.raises(ScenarioError, match=r"number=0.*\[\]"):
        dynamic(Disappear(5, 0), base=make_scenario("rooms:0"))
    with pytest.raises(ScenarioError, match=r"after iteration 4.*no path"):
        dynamic(Appear(4, Polygon.rectangle(6, -1, 7, 9)), base=FREE)


@pytest.mark.parametrize("base", [FunctionScenario("f", "easom", 2), "case1", None])
def test_only_maps_can_change(base):
    with pytest.raises(ScenarioError, match="base must be"):
        DynamicScenario("made", base, ())


@pytest.mark.parametrize(
    ("event", "numbers"),
    [
        *((Appear, numbers) for numbers in ((-1, NEW), (1.5, NEW), (1, (1, 2, 3)))),
        *((Move, numbers) for numbers in ((1, -1, (0, 0)), (1, 0, (math.nan, 0)), (1, 0, (1, 2, 3)))),
        *((Disappear, numbers) for numbers in ((True, 0), (1, "first"))),
    ],
)
def test_an_event_of_other_than_valid_numbers_is_refused(event, numbers):
    with pytest.raises((ScenarioError, SettingError), match=r"Appear|Move|Disappear"):
        event(*numbers)


def test_what_needs_one_map_refuses_several():
    made = make_scenario("dynamic:case1-block@70")
    for call in (shortest_path, AnalyticProblem):
        with pytest.raises(ScenarioError, match=r"dynamic:case1-block@70.*worlds"):
            call(made)


# Names.


@pytest.mark.parametrize("base", EVENTS)
def test_events_by_name_happen_from_their_iteration_on(base):
    for event, happening in EVENTS[base].items():
        made = make_scenario(f"dynamic:{base}-{event}@12")
        assert made.base == make_scenario(base)
        assert [e.iteration for e in made.events] == [12 + e.iteration for e in happening]
        assert make_scenarios(made.name) == (made,)


@pytest.mark.slow
@pytest.mark.parametrize("base", EVENTS)
def test_a_block_lies_on_the_shortest_path_and_makes_it_longer(base):
    before, after = (world.scenario for world in make_scenario(f"dynamic:{base}-block@5").worlds)
    length, path = shortest_path(before)
    (block,) = (event.obstacle for event in EVENTS[base]["block"])
    assert shapely.LineString(path).intersection(shapely.Polygon(block.vertices)).length > 1.0
    detour = shortest_path(after)[0]
    assert detour > 1.01 * length
    if isinstance(before, Scenario):
        assert optimum(AnalyticProblem(after))[0] > 1.01 * optimum(AnalyticProblem(before))[0]


@pytest.mark.parametrize(
    ("name", "error", "mention"),
    [
        *(
            (f"dynamic:case1{end}", ScenarioError, FORM)
            for end in ("", "-block", "-block@070", "-block@7-09")
        ),
        ("dynamic:case1-block@9-7", ScenarioError, "such as 20-80, got '9-7'"),
        ("dynamic:case1-block@0-7", ScenarioError, "from 1 on"),
        ("dynamic:case1-block@1-999999", ScenarioError, "at most 200000 numbers"),
        ("dynamic:case1-block@0", ScenarioError, "from 1 on"),
        ("dynamic:case9-block@70", UnknownNameError, "case1, case2, case3"),
        ("dynamic:case1-flood@70", UnknownNameError, "block, gate, passer"),
    ],
)
def test_other_names_are_refused(name, error, mention):
    refused(lambda: make_scenario(name), mention, "case", error=error)
