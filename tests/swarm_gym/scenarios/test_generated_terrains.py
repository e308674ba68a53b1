"""Generated terrains: equal to the published generator, their names and splits, the cache of height maps."""

import hashlib
from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from oracles.naive_terrain import naive_terrain
from swarm_gym.errors import ScenarioError, UnknownNameError
from swarm_gym.scenarios import expand_name
from swarm_gym.scenarios.terrain import generated, generator, heights_cache
from swarm_gym.scenarios.terrain.generator import SIDE, draw, make_terrain

CELLS = ((0, 0), (449, 449), (123, 777), (899, 899))
# What MetaBox's own `createmodel` made, by seed and number of threats: a digest of the heights, rounded to
# metres; the heights of CELLS and their mean; start, goal, first and last threat.
PUBLISHED = {
    (3849, 15): (
        "9dcfd0f3d6fd9520",
        (-18.076450101955913, 98.19620890487307, 196.68119842358033, 126.2310458938091, 103.43492674419731),
        (39, 112, 855, 812),
        (603, 197, 83, 86), (362, 822, 121, 80),
    ),
    (2_000_003, 15): (
        "ae7f48f3e4429406",
        (464.82485326988535, 1081.3345320161652, 2007.923031977139, 440.7954076064928, 617.6532511713853),
        (53, 137, 795, 731),
        (277, 360, 538, 67), (322, 867, 79, 67),
    ),
    (3_000_005, 30): (
        "78eb6c488c30cf7a",
        (-279.32557249304597, -338.9425478191322, -366.03949732336264, -123.57588576397384,
        -281.63266600330707), (101, 54, 802, 774),
        (170, 883, -182, 81), (368, 179, -192, 67),
    ),
}  # fmt: skip
SLOW = pytest.mark.slow
SMALL = 3_000_005  # a seed whose terrain begins with one point, and takes a second


@lru_cache(maxsize=1)
def made(seed, threats):
    """Return the terrain of a seed."""
    return make_terrain(draw(np.random.RandomState(seed), threats))


def digest(heights):
    return hashlib.sha256(np.rint(heights).astype("<i4").tobytes()).hexdigest()[:16]


@pytest.mark.parametrize(
    ("seed", "threats"), [(SMALL, 30), *(pytest.param(*key, marks=SLOW) for key in list(PUBLISHED)[:2])]
)
def test_terrains_are_those_of_the_published_generator(seed, threats):
    terrain = made(seed, threats)
    expected, heights, ends, first, last = PUBLISHED[seed, threats]
    found = [*(terrain.heights[cell] for cell in CELLS), terrain.heights.mean()]
    assert found == pytest.approx(heights, rel=1e-9)
    assert digest(terrain.heights) == expected
    assert (*terrain.start[:2], *terrain.goal[:2]) == ends
    assert (tuple(terrain.threats[0]), tuple(terrain.threats[-1])) == (first, last)
    assert len(terrain.threats) == threats


@pytest.mark.parametrize("seed", [SMALL, *(pytest.param(seed, marks=SLOW) for seed in range(20))])
def test_every_bit_is_that_of_one_step_at_a_time(seed):
    streams = [np.random.RandomState(seed) for _ in range(2)]
    terrain = made(seed, 30)
    draw(streams[0], 30)
    with threadpool_limits(1, user_api="blas"):  # else its threads wait for each other, for minutes
        heights, threats, start, goal = naive_terrain(streams[1], 30)
    assert np.array_equal(terrain.heights, heights)
    assert np.array_equal(terrain.threats, threats)
    assert (terrain.start, terrain.goal) == (start, goal)
    assert streams[0].rand() == streams[1].rand()


def test_test_terrains_are_those_of_one_stream_without_two_goals_in_threats():
    stream = np.random.RandomState(3849)
    all_draws = [draw(stream, 15 if k < 28 else 30) for k in range(58)]
    impossible = [k for k, draws in enumerate(all_draws) if not draws.is_possible]
    assert impossible == [33, 36]
    possible = [draws for draws in all_draws if draws.is_possible]
    for number in (0, 27, 28, 33, 55):
        found = generated.draws_of(f"terrain:test:{number}")
        assert (found.roughness, found.start) == (possible[number].roughness, possible[number].start)
        assert len(found.threats) == (15 if number < 28 else 30)


def test_splits_are_disjoint():
    ranges = sorted((split.first_seed, split.first_seed + split.size) for split in generated.SPLITS.values())
    assert all(end <= first for (_, end), (first, _) in pairwise(ranges))


@pytest.mark.parametrize(
    ("name", "threats"), [("train-few:3", 15), ("train-many:3", 30), ("train:4", 15), ("train:5", 30)]
)
def test_a_name_says_how_many_threats(name, threats):
    draws = generated.draws_of(f"terrain:{name}")
    assert len(draws.threats) == threats
    assert draws.is_possible


def test_a_terrain_is_a_scenario_and_is_read_from_the_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_CACHE", str(tmp_path))
    monkeypatch.setattr(generated, "terrain_of", generated.terrain_of.__wrapped__)
    flat = np.full((SIDE, SIDE), 7.0)
    monkeypatch.setattr(heights_cache, "heights_of", lambda draws: flat.copy())
    scenario = generated.make("terrain:train-many:0")
    assert scenario.origin == (1.0, 1.0)
    assert scenario.workspace == (1.0, 1.0, 900.0, 900.0)
    assert len(scenario.threats) == 30
    assert np.isinf(scenario.threats[:, 2]).all()
    assert scenario.start[2] == scenario.goal[2] == 150.0
    monkeypatch.setattr(heights_cache, "heights_of", None)
    assert generated.make("terrain:train-many:0") == scenario
    (file,) = tmp_path.rglob("*.npy")
    file.write_bytes(file.read_bytes()[:1000])
    monkeypatch.setattr(heights_cache, "heights_of", lambda draws: flat + 1.0)
    assert generated.make("terrain:train-many:0").heights[0, 0] == 8.0


def test_the_cache_keeps_the_newest_files(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_CACHE", str(tmp_path))
    monkeypatch.setattr(heights_cache, "MOST", 2)
    monkeypatch.setattr(heights_cache, "heights_of", lambda draws: np.zeros((SIDE, SIDE)))
    draws = generated.draws_of("terrain:train-few:0")
    for key in "abc":
        heights_cache.terrain_of(key, draws)
    assert len(list(tmp_path.rglob("*.npy"))) == 2


def test_ends_are_refused_where_threats_leave_no_room():
    with pytest.raises(ScenarioError, match="leave no room for a start"):
        draw(np.random.RandomState(1), 5_000)


def test_a_threat_on_the_last_row_is_refused_as_the_published_program_fails():
    draws = generated.draws_of("terrain:train-few:0")
    threats = draws.threats.copy()
    threats[2, 1] = 900.0
    with pytest.raises(ScenarioError, match="threat 2 lies at y = 900, expected below 900"):
        generator.terrain_with(draws._replace(threats=threats), np.zeros((SIDE, SIDE)))
    assert not draws._replace(threats=threats).is_possible


@pytest.mark.parametrize("name", ["terrain:test:56", "terrain:test", "terrain:test:-1", "terrain:test:0:1"])
def test_names_of_another_form_are_refused(name):
    with pytest.raises(ScenarioError):
        expand_name(name)


def test_an_unknown_split_is_refused():
    with pytest.raises(UnknownNameError, match="split of terrain"):
        expand_name("terrain:hard:0")


def test_a_range_stands_for_many():
    assert expand_name("terrain:test:0-55")[-1] == "terrain:test:55"
