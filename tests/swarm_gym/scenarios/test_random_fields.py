import hashlib
import itertools
import math
import pickle
from collections import Counter
from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.loops import looped
from helpers.refusals import refused
from helpers.shapes import shape
from swarm_gym.errors import ScenarioError, UnknownNameError, shown
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.problem import AnalyticProblem
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import expand_name, make_scenario, make_scenarios
from swarm_gym.scenarios.random_fields import SPLITS
from swarm_gym.settings import Settings
from swarm_gym.simulation import Simulation

FIELDS_PER_SPLIT = 30
SCATTERED = sorted(set(SPLITS) - {"narrow"})


@cache
def fields(split, number=FIELDS_PER_SPLIT):
    return make_scenarios(f"random-fields:{split}:0-{number - 1}")


def blocking(field):
    """Return the number of obstacles that the straight line crosses."""
    line = shapely.LineString([field.start, field.target])
    return sum(line.intersection(shape(obstacle)).length > 0 for obstacle in field.obstacles)


# Fields.


def test_the_splits_have_disjoint_ranges_of_seeds():
    ranges = sorted((split.first_seed, split.first_seed + split.size) for split in SPLITS.values())
    assert all(end <= begin for (_, end), (begin, _) in itertools.pairwise(ranges))


def test_no_field_is_in_two_splits():
    maps = [frozenset(field.obstacles) for split in SPLITS for field in fields(split)]
    assert len(set(maps)) == len(SPLITS) * FIELDS_PER_SPLIT


@pytest.mark.parametrize(
    ("name", "digest"),
    [
        ("random-fields:train:0", "11bcd993ea401af4"),
        ("random-fields:test:199", "8c07fa53eddd7b6c"),
        ("random-fields:narrow:7", "df088cce0d757b31"),
        ("random-fields:rotated:7", "e5c9ab6c058f0e7e"),
    ],
)
def test_a_field_is_the_same_on_every_machine_and_in_every_version(name, digest):
    field = make_scenario(name)
    content = (field.start, field.target, field.workspace, field.initial_range, field.obstacles)
    assert hashlib.sha256(repr(content).encode()).hexdigest()[:16] == digest


@pytest.mark.parametrize("split", ["train", "validation", "test"])
def test_fields_have_the_geometry_of_the_cases(split):
    case = make_scenario("case1")
    for field in fields(split):
        assert (field.start, field.target) == (case.start, case.target)
        assert (field.workspace, field.initial_range) == (case.workspace, case.initial_range)
        assert 10 <= len(field.obstacles) <= 20


def test_circles_rectangles_and_mixtures_are_about_equally_frequent():
    kinds = Counter(frozenset(map(type, field.obstacles)) for field in fields("train", 300))
    assert len(kinds) == 3
    assert min(kinds.values()) >= 70


@pytest.mark.parametrize("count", [3, pytest.param(10, marks=pytest.mark.slow)])
@pytest.mark.parametrize("split", SPLITS)
def test_every_field_is_solvable_and_its_straight_line_is_blocked(split, count):
    for field in fields(split)[:count]:
        assert shortest_path(field)[0] > field.straight_line
        assert blocking(field) >= 2


@pytest.mark.parametrize("split", SCATTERED)
def test_scattered_obstacles_lie_apart(split):
    for field in fields(split):
        for a, b in itertools.combinations(map(shape, field.obstacles), 2):
            assert a.distance(b) >= 10.0


@pytest.mark.parametrize("split", SCATTERED)
@looped("num_waypoints", [23, 31])
@looped("side", [-1, 1])
def test_a_path_of_waypoints_along_the_side_of_a_scattered_field_is_free(split, num_waypoints, side):
    for field in fields(split):
        problem = AnalyticProblem(field, num_waypoints)
        offsets = problem.bounds[0 if side < 0 else 1]
        assert problem.evaluate(offsets)[1] == 0.0


def test_between_two_walls_two_waypoints_find_room():
    for field in fields("narrow"):
        spacing = field.straight_line / 24
        walls = sorted({(o.vertices[0][0], o.vertices[2][0]) for o in field.obstacles})
        assert len(walls) >= 3
        edges = [field.start[0], *itertools.chain(*walls), field.target[0]]
        rooms = np.diff(edges)[::2]
        assert (rooms[1:-1] >= 2 * spacing).all()
        assert (rooms[[0, -1]] >= spacing).all()


def test_walls_lead_beyond_the_workspace_and_have_gaps_inside_it():
    for field in fields("narrow"):
        walls = {}
        for obstacle in field.obstacles:
            (x, bottom), _, (_, top), _ = obstacle.vertices
            walls.setdefault(x, []).append((bottom, top))
        for pieces in walls.values():
            pieces.sort()
            assert (pieces[0][0], pieces[-1][1]) == (-600, 1200)
            gaps = [(low, high) for (_, low), (high, _) in itertools.pairwise(pieces)]
            assert 1 <= len(gaps) <= 2
            assert all(30 <= high - low <= 60 and low >= 100 and high <= 560 for low, high in gaps)


def test_the_other_splits_differ_from_the_training_fields_as_they_say():
    def mean(split, value):
        return np.mean([value(field) for field in fields(split)])

    def radius(field):
        return np.mean([math.sqrt(shape(o).area / math.pi) for o in field.obstacles])

    assert mean("denser", lambda f: len(f.obstacles)) > 1.5 * mean("train", lambda f: len(f.obstacles))
    assert mean("large-obstacles", radius) > 1.7 * mean("train", radius)
    assert all(field.straight_line == 1460 for field in fields("larger"))
    assert all(field.straight_line == pytest.approx(960, abs=2) for field in fields("rotated"))
    assert len({field.start for field in fields("rotated")}) > FIELDS_PER_SPLIT / 2


# Names.


@given(split=st.sampled_from(sorted(SPLITS)), number=st.integers(0, 99_999))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_a_field_is_filed_under_its_name_and_made_anew_equally(split, number):
    name = f"random-fields:{split}:{number}"
    field = make_scenario(name)
    assert field.name == name
    assert field == make_scenario(name)
    assert make_scenarios(name) == (field,)
    assert pickle.loads(pickle.dumps(field)) == field


@given(split=st.sampled_from(sorted(SPLITS)), first=st.integers(0, 99_000), more=st.integers(0, 20))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_a_range_stands_for_its_fields_both_ends_included(split, first, more):
    names = expand_name(f"random-fields:{split}:{first}-{first + more}")
    assert names == tuple(f"random-fields:{split}:{number}" for number in range(first, first + more + 1))


def test_a_range_is_refused_where_one_scenario_is_expected():
    with pytest.raises(ScenarioError, match=r"'random-fields:train:0-511'.* one scenario.* 512"):
        make_scenario("random-fields:train:0-511")
    with pytest.raises(ScenarioError, match="one scenario"):
        make_scenario("random-fields:train:5-5")


NO_NUMBERS = ["-1", "9-3", "x", "", "1.0", "1e3", "007", "+1", " 1", "1-", "-", "1-2-3", "0-100000", "100000"]


@pytest.mark.parametrize("numbers", [*NO_NUMBERS, "9" * 5000, "٣", "1\n"])
@pytest.mark.parametrize("make", [make_scenario, make_scenarios])
def test_a_number_that_is_not_in_the_split_is_refused_with_what_was_expected(make, numbers):
    name = f"random-fields:test:{numbers}"
    refused(lambda: make(name), shown(name), "from 0 to 99999", "0-511", shown(numbers))


@given(text=st.text(max_size=12))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_any_other_name_is_refused(text):
    for name in (f"random-fields:{text}", f"random-fields{text}x", f"random-fields:test:{text}x"):
        with pytest.raises((ScenarioError, UnknownNameError)):
            make_scenarios(name)


@pytest.mark.parametrize(
    "name", ["random-fields", "random-fields:", "random-fields:test", "random-fields:a:b:c"]
)
def test_a_name_of_another_form_is_refused_with_the_form(name):
    refused(lambda: make_scenario(name), repr(name), "random-fields:<split>:<number>", "validation")


def test_an_unknown_split_or_scenario_is_refused_with_the_valid_ones():
    with pytest.raises(UnknownNameError, match=r"'foo'.*large-obstacles.*train"):
        make_scenario("random-fields:foo:1")
    with pytest.raises(UnknownNameError, match="'random'") as caught:
        make_scenario("random")
    assert {"case3", "random-fields:<split>:<number>"} <= {*caught.value.valid}


# In environments.


def test_settings_put_the_fields_of_a_range_in_its_place():
    made = Settings(("case2", "random-fields:train:3-5", "case1", "random-fields:train:4")).scenarios
    numbers = [field.name.rpartition(":")[2] for field in made]
    assert numbers == ["case2", "3", "4", "5", "case1", "4"]
    assert len(Settings("random-fields:train:0-9").scenarios) == 10


def test_episodes_draw_from_the_fields_of_a_range():
    simulation = Simulation(Firefly, Settings("random-fields:train:10-13", iterations=1), 32)
    simulation.reset(np.full(32, True), [np.random.SeedSequence(seed) for seed in range(32)])
    drawn = {simulation.problem_of(row).scenario.name for row in range(32)}
    assert drawn == set(expand_name("random-fields:train:10-13"))
