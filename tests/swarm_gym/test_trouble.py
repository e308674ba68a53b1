"""Plans, exact lengths and feasibility on random trouble, held against unions of shapely and another graph.

`python -m tests.helpers.trouble --help` says how to hold more scenes, from any seed on.
"""

import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from helpers.trouble_grids import hold_grid, make_grid_scene
from helpers.trouble_paths import (
    Count,
    hold_optimised_paths,
    hold_random_paths,
    hold_slope,
    is_entering,
    lines_along_edges,
    map_scene,
)
from helpers.trouble_plans import DEEPEST, LARGEST_ERROR, hold_seed
from helpers.trouble_scenes import make_scene, shared_edges
from helpers.trouble_shapes import KINDS
from oracles.shapely_paths import shortest_length
from swarm_gym.planning import plan

DATA = Path(__file__).parents[1] / "data"
PART = 500  # scenes of a slow test; each test is a part that can be run again alone
FIRSTS = range(1000, 11_000, PART)
MOST_UNCLEAR = 0.03  # of paths, which enter by so little that they are not compared


def assert_right(outcomes):
    outcomes = list(outcomes)
    wrong = [str(one) for one in outcomes if one.faults]
    assert not wrong, f"{len(wrong)} of {len(outcomes)}:\n" + "\n".join(wrong[:20])


def assert_agree(count):
    assert not count.wrong, str(count)
    assert count.unclear <= MOST_UNCLEAR * (count.free + count.entering)
    assert min(count.free, count.entering) > 0.1 * (count.free + count.entering)


def total(counts):
    return sum(counts, Count())


@pytest.mark.parametrize(
    ("name", "start", "goal", "length"),
    [
        ("plus", (0.0, 2.0), (9.0, -3.0), 15.5474),
        ("terrace", (0.0, 0.0), (9.0, 0.0), 23.2106),
        ("utm_20", (388096.5, 3948996.25), (388116.5, 3948996.25), 21.1155),
    ],
)
def test_files_have_paths_outside_their_polygons(name, start, goal, length):
    found = plan(DATA / f"{name}.geojson", start, goal)
    assert found.length >= length - 1e-4
    assert found.length / (1.0 + found.gap) == pytest.approx(length, abs=1e-4)
    assert -1e-6 <= found.gap < 0.1
    shapes = shapely.get_parts(shapely.from_geojson((DATA / f"{name}.geojson").read_text()))
    union = shapely.union_all([shapely.transform(one, lambda points: points - start) for one in shapes])
    line = shapely.LineString(found.path - start)
    assert line.intersection(union.buffer(-1e-6, join_style="mitre")).length == 0.0


def test_exact_lengths_on_random_scenes_are_right():
    assert_right(hold_seed(seed) for seed in range(30))


def test_plans_on_random_scenes_are_right():
    assert_right(hold_seed(seed, planned=True) for seed in range(200, 203))


def test_exact_lengths_and_plans_on_random_grids_are_right():
    assert_right(hold_grid(seed) for seed in range(6))


def test_random_paths_are_feasible_exactly_if_they_do_not_enter_the_union():
    assert_agree(total(hold_random_paths(seed, 30) for seed in range(10)))


def test_paths_along_a_shared_wall_are_not_feasible():
    assert_agree(total(hold_slope(seed) for seed in range(60)))


def test_members_of_swarms_are_feasible_exactly_if_they_do_not_enter_the_union():
    assert_agree(total(hold_optimised_paths(seed) for seed in range(6)))


@pytest.mark.slow
def test_scenes_hold_every_kind_of_trouble():
    scenes = [make_scene(seed) for seed in range(300)]
    assert {scene.kind for scene in scenes} == set(KINDS)
    assert any(len(one.interiors) for scene in scenes for one in scene.polygons)
    for holds in (
        lambda scene: scene.radius > 0.0,
        lambda scene: not scene.exact,
        lambda scene: len(scene.discs) > 0,
        lambda scene: abs(scene.offset) > 1e5,
        lambda scene: scene.scale * 100 < 0.1,
        lambda scene: scene.scale * 100 > 1e6,
        lambda scene: scene.geojson is not None and scene.scenario is not None,
        lambda scene: scene.geojson is not None and scene.scenario is None,
        lambda scene: (
            scene.lattice.outline.distance(shapely.Point(scene.start.real, scene.start.imag)) == 0.0
        ),
        lambda scene: len(shared_edges(scene)) > 0,
    ):
        assert sum(map(holds, scenes)) >= 5
    grids = [make_grid_scene(seed) for seed in range(60)]
    assert any(len(grid.blocked().pinches) for grid in grids)
    assert 15 < sum(grid.radius > 0.0 for grid in grids) < 45


def test_placed_scenes_are_the_lattice_exactly():
    for seed in range(100):
        scene = make_scene(seed)
        if not scene.exact:
            continue
        placed = np.concatenate([scene.place(shapely.get_coordinates(one)) for one in scene.polygons])
        drawn = np.concatenate([shapely.get_coordinates(one) for one in scene.polygons])
        there = (scene.local(placed) @ np.array([1.0, 1j])) / scene.turn
        np.testing.assert_allclose(there, drawn @ np.array([1.0, 1j]), rtol=0, atol=1e-9)
        area = scene.lattice.area.area * scene.scale**2
        assert scene.blocked.area.area == pytest.approx(area, rel=1e-12)
        assert len(scene.blocked.edges[0]) == len(scene.lattice.edges[0])


def test_lengths_around_placed_obstacles_are_those_on_the_lattice():
    for seed in range(30):
        scene = make_scene(seed)
        ends = (scene.start.real, scene.start.imag), (scene.goal.real, scene.goal.imag)
        length = scene.scale * shortest_length(scene.grown_lattice(), *ends)
        # Rounded walls that two obstacles share in part leave gaps of a last digit, which count as closed.
        if scene.exact or scene.kind not in ("staggered", "slices"):
            placed = shortest_length(scene.blocked, *scene.local(np.array(scene.ends)))
            assert placed == pytest.approx(length, rel=1e-9), seed


def test_lines_along_edges_touch_or_enter_but_do_not_stay_away():
    entering = 0
    for seed in range(20):
        scene = map_scene(seed)
        for line in lines_along_edges(scene, np.random.default_rng(seed)):
            entering += is_entering(scene, line) is True
            distance = shapely.distance(scene.blocked.outline, shapely.LineString(scene.local(line)))
            assert distance < 1e-9 * scene.blocked.extent or len(scene.discs) or len(line) == 2
    assert entering > 20


def test_faults_are_seen():
    outcome = hold_seed(1)
    assert outcome.faults == []
    outcome.error, outcome.depth, outcome.gap = 2 * LARGEST_ERROR, 2 * DEEPEST, -2e-6
    assert [text.split(":")[0] for text in outcome.faults] == ["length", "depth", "gap"]
    outcome.error = math.inf
    assert "off by inf" in str(outcome)


@pytest.mark.slow
@pytest.mark.parametrize("first", FIRSTS)
def test_thousands_of_exact_lengths_and_plans_are_right(first):
    assert_right(hold_seed(seed, planned=seed % 10 == 0) for seed in range(first, first + PART))


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 2000, 250))
def test_lengths_and_plans_on_a_thousand_grids_are_right(first):
    assert_right(hold_grid(seed) for seed in range(first, first + 250))


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 3000, 250))
def test_a_hundred_thousand_paths_are_feasible_exactly_if_outside(first):
    assert_agree(total(hold_random_paths(seed) + hold_slope(seed) for seed in range(first, first + 250)))


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 1300, 50))
def test_ten_thousand_members_are_feasible_exactly_if_outside(first):
    assert_agree(total(hold_optimised_paths(seed) for seed in range(first, first + 50)))
