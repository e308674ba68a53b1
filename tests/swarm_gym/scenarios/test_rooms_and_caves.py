import hashlib
import itertools
from functools import cache

import numpy as np
import pytest
import shapely

from helpers.grids import area_of
from helpers.refusals import refused
from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios import GridScenario, expand_name, make_scenario, make_scenarios
from swarm_gym.scenarios.rooms_and_caves import NUM_SEEDS

MADE = ("rooms", "caves")
MAPS_PER_FAMILY = 40


@cache
def maps(family, number=MAPS_PER_FAMILY):
    return make_scenarios(f"{family}:0-{number - 1}")


@pytest.mark.parametrize(
    ("name", "digest"),
    [
        ("rooms:0", "a449ce172a44d144"),
        ("rooms:123456", "07506aff5eff01fc"),
        ("caves:0", "457b7672e188e973"),
        ("caves:123456", "67b7ab7304ca07d1"),
    ],
)
def test_a_made_map_is_the_same_on_every_machine_and_in_every_version(name, digest):
    made = make_scenario(name)
    content = repr((made.start, made.target)).encode() + made.map.blocked.tobytes()
    assert hashlib.sha256(content).hexdigest()[:16] == digest


@pytest.mark.parametrize("family", MADE)
def test_no_two_maps_of_a_family_are_the_same(family):
    assert len({made.map for made in maps(family)}) == MAPS_PER_FAMILY


@pytest.mark.parametrize("family", MADE)
def test_made_maps_have_one_size_and_one_component(family):
    for made in maps(family):
        assert isinstance(made, GridScenario)
        assert made.name == made.map.name
        assert (made.map.width, made.map.height) == (128, 96)
        assert made.map.components.max() == 1
        assert 0.1 < made.map.blocked.mean() < 0.8


@pytest.mark.parametrize("family", MADE)
def test_start_and_target_are_far_apart_and_the_straight_line_is_blocked(family):
    for made in maps(family, 10):
        assert made.target[0] - made.start[0] >= 80
        line = shapely.LineString([made.start, made.target])
        assert line.intersection(area_of(made.map.blocked)).length > 0


@pytest.mark.parametrize("family", MADE)
def test_there_is_room_around_start_and_target(family):
    for made in maps(family):
        for x, y in (made.start, made.target):
            around = itertools.product(range(int(x) - 2, int(x) + 3), range(int(y) - 2, int(y) + 3))
            assert all(made.map.is_free(cell) for cell in around)


def test_a_robot_of_five_cells_gets_through_the_doors_of_rooms():
    for made in maps("rooms"):
        grid = made.map.inflated(2.0)
        GridScenario("wide", grid, made.start, made.target)


def test_passages_of_caves_are_three_cells_wide():
    for made in maps("caves", 10):
        free = ~made.map.blocked
        blocks = np.lib.stride_tricks.sliding_window_view(free, (3, 3)).all(axis=(2, 3))
        covered = np.zeros_like(free)
        for row, column in np.argwhere(blocks).tolist():
            covered[row : row + 3, column : column + 3] = True
        assert (covered == free).all()


@pytest.mark.parametrize("family", MADE)
def test_starts_vary_between_maps(family):
    starts = {made.start for made in maps(family)}
    assert len(starts) > MAPS_PER_FAMILY / 2
    assert max(y for _, y in starts) - min(y for _, y in starts) > 40


@pytest.mark.parametrize("family", MADE)
def test_a_range_stands_for_all_its_maps(family):
    assert expand_name(f"{family}:8-11") == tuple(f"{family}:{seed}" for seed in range(8, 12))
    assert make_scenarios(f"{family}:1-2")[1] == make_scenario(f"{family}:2")
    with pytest.raises(ScenarioError, match="got a range of 4"):
        make_scenario(f"{family}:8-11")


@pytest.mark.parametrize("family", MADE)
@pytest.mark.parametrize("seed", ["", "-1", "01", "1.0", "2-1", "0-", "x", f"{NUM_SEEDS}", "0:1"])
def test_a_name_of_another_form_is_refused(family, seed):
    for name in (family if not seed else f"{family}:{seed}", f"{family}:{seed}"):
        refused(lambda name=name: expand_name(name), repr(name), f"{family}:<seed>")
