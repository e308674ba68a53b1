"""Random fields that change: events, their times, and what is left after them."""

import hashlib
import itertools
from collections import Counter
from functools import cache

import numpy as np
import pytest
import shapely

from helpers.refusals import refused
from helpers.shapes import shape
from helpers.slow import slow_but
from swarm_gym.errors import ScenarioError, UnknownNameError
from swarm_gym.problem import AnalyticProblem
from swarm_gym.scenarios import Circle, expand_name, make_scenario, make_scenarios
from swarm_gym.scenarios.dynamic.corridor import MARGIN, covered, shortest_way
from swarm_gym.scenarios.dynamic.events import Appear, Disappear, Move
from swarm_gym.scenarios.dynamic.fields import FIRST, LAST, SPLITS
from swarm_gym.scenarios.random_fields import SPLITS as FIXED_SPLITS

NUMBER = 40


# Fields of the splits differ in their seeds alone, but for those whose obstacles move.
every_kind = pytest.mark.parametrize("split", slow_but(["train", "moving"], SPLITS))


@cache
def fields(split, number=NUMBER):
    return make_scenarios(f"dynamic-fields:{split}:0-{number - 1}")


def changes(field):
    """Yield the world before each event and the event; several may not follow the same iteration."""
    yield from zip((world.scenario for world in field.worlds), field.events, strict=False)


def test_the_splits_have_disjoint_ranges_of_seeds():
    splits = [*SPLITS.values(), *FIXED_SPLITS.values()]
    ranges = sorted((split.first_seed, split.first_seed + split.size) for split in splits)
    assert all(end <= begin for (_, end), (begin, _) in itertools.pairwise(ranges))


@pytest.mark.parametrize(
    ("name", "digest"),
    [
        ("dynamic-fields:train:0", "bbe21843fab118dd"),
        ("dynamic-fields:test:199", "1fd4ebceb9412bdb"),
        ("dynamic-fields:moving:7", "c5f0084853b9638f"),
    ],
)
def test_a_field_is_the_same_on_every_machine_and_in_every_version(name, digest):
    field = make_scenario(name)
    content = repr((field.base.obstacles, field.events))
    assert hashlib.sha256(content.encode()).hexdigest()[:16] == digest


@every_kind
def test_kinds_of_events_belong_to_splits(split):
    kinds = Counter(type(event) for field in fields(split) for event in field.events)
    assert set(kinds) == ({Move} if split == "moving" else {Appear, Disappear})
    assert min(kinds.values()) >= 15


@pytest.mark.parametrize("number", [NUMBER, pytest.param(200, marks=pytest.mark.slow)])
def test_one_to_three_events_follow_iterations_from_the_whole_episode(number):
    many = fields("train", number)
    assert set(Counter(len(field.events) for field in many)) == {1, 2, 3}
    times = np.array([event.iteration for field in many for event in field.events])
    assert times.min() < 10
    assert times.max() > 80
    assert ((times >= FIRST) & (times <= LAST)).all()
    assert abs(times.mean() - (FIRST + LAST) / 2) < 5
    assert all(len({e.iteration for e in field.events}) == len(field.events) for field in many)


@every_kind
def test_after_every_event_a_path_of_waypoints_is_free(split):
    for field in fields(split):
        for world in field.worlds:
            problem = AnalyticProblem(world.scenario)
            assert [problem.evaluate(offsets)[1] for offsets in problem.bounds] == [0.0, 0.0]


@every_kind
def test_the_shortest_way_is_free_in_every_world(split):
    for field in fields(split)[:15]:
        for world in field.worlds:
            way = shortest_way(field.base, list(world.scenario.obstacles))
            assert (way[0] == field.base.start).all()
            assert (way[-1] == field.base.target).all()
            line = shapely.LineString(way)
            assert not any(line.intersects(shape(obstacle)) for obstacle in world.scenario.obstacles)


def test_events_touch_the_shortest_way_in_about_half_of_the_cases():
    """Obstacles that appear close the way, or are away from it; so are those that move."""
    for split, kind in (("train", Appear), ("moving", Move)):
        touching = []
        for field in fields(split):
            for world, event in changes(field):
                if not isinstance(event, kind):
                    continue
                way = shortest_way(field.base, list(world.obstacles))
                there = event.obstacle if kind is Appear else world.obstacles[event.number].moved(event.by)
                touching.append(covered(way, there, MARGIN).any())
        assert len(touching) > 25
        assert 0.3 < np.mean(touching) < 0.7


def test_a_way_is_the_shortest_of_all_on_its_lattice():
    """Against a search over all ways, on a small map with one obstacle."""
    start, target = (0.0, 50.0), (20.0, 50.0)
    small = make_scenario("case1").__class__(
        "small", start, target, (Circle(10, 50, 3),), (0.0, 0.0, 20.0, 100.0), (-50.0, 50.0)
    )
    points = [[(5.0 * column, 10.0 * row) for row in range(11)] for column in range(5)]
    lengths = []
    for rows in itertools.product(range(11), repeat=3):
        way = [5, *rows, 5]
        steps = np.abs(np.diff(way))
        path = [points[column][row] for column, row in enumerate(way)]
        if steps.max() <= 1 and all(np.hypot(x - 10, y - 50) > 3 + MARGIN for x, y in path):
            lengths.append(shapely.LineString(path).length)
    found = shortest_way(small, list(small.obstacles))
    assert shapely.LineString(found).length == pytest.approx(min(lengths))
    closed = [Circle(10, 10.0 * row, 4) for row in range(11)]
    assert shortest_way(small, closed) is None


@pytest.mark.parametrize(
    ("name", "error", "mention"),
    [
        ("dynamic-fields:tests:1", UnknownNameError, "moving, test, train, validation"),
        ("dynamic-fields:test", ScenarioError, "dynamic-fields:<split>:<number>"),
        ("dynamic-fields:test:100000", ScenarioError, "from 0 to 99999"),
        ("dynamic-fields:test:7-3", ScenarioError, "0-255"),
        ("dynamic-fields:test:03", ScenarioError, "0-255"),
    ],
)
def test_other_names_are_refused(name, error, mention):
    refused(lambda: expand_name(name), mention, error=error)
