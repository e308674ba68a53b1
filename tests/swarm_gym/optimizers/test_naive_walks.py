"""The plain-Python glowworms and ants themselves: sight against shapely, small maps by hand."""

import itertools
import math

import numpy as np
import pytest
import shapely

from helpers.builders import METRES, random_grid_scenario
from helpers.grids import area_of, drawn_problem
from helpers.slow import slow_but
from oracles import naive, naive_swarm
from oracles.naive_ants import AntColony
from oracles.naive_glowworm import Glowworm, relayed
from oracles.naive_walkers import spin
from oracles.naive_walks import length_of
from swarm_gym.compiler.random_stream import seed_stream
from swarm_gym.problem import WalkProblem
from swarm_gym.reference import shortest_grid_path
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario


def twin_of(kind, problem, seed=0, budget=10**9, **parameters):
    stream = naive.Stream(seed_stream(np.random.SeedSequence(seed)))
    twin = kind(naive_swarm.oracle_of(problem), stream, 1000, budget)
    twin.parameters = twin.parameters._replace(**parameters)
    return twin


def advance(twin, steps, size):
    for _ in range(steps):
        if not twin.is_spent():
            twin.step(size, 0.0, twin.parameters)


# What is seen.


def scattered_problem(rng, **geometry):
    """Return a map of single blocked cells, some of which touch at corners."""
    blocked = rng.random((8, 11)) < 0.25
    blocked[0, :2] = False
    grid = GridMap("scattered", blocked, **geometry)
    return WalkProblem(GridScenario("scattered", grid, *map(tuple, grid.to_map([(0, 0), (1, 0)]).tolist())))


def ends_of_segments(rng, grid, count):
    """Return segments between corners, centres and middles of edges, and between any points, in cells."""
    most = np.array([grid.width, grid.height]) - 0.5
    halves = rng.integers(-1, 2 * most + 1, (count, 2, 2)) / 2
    return [*halves, *rng.uniform(-0.5, most, (count, 2, 2))]


@pytest.mark.parametrize("geometry", [{}, METRES])
@pytest.mark.parametrize("seed", slow_but([0], range(3)))
def test_a_point_sees_another_where_shapely_covers_the_way_and_no_gap_is_on_it(seed, geometry):
    rng = np.random.default_rng(seed)
    problem = naive_swarm.oracle_of(scattered_problem(rng, **geometry))
    grid = problem.map
    free = area_of(~grid.blocked)
    gaps = []
    for r, c in itertools.product(range(grid.height - 1), range(grid.width - 1)):
        if grid.blocked[r : r + 2, c : c + 2].tolist() in ([[0, 1], [1, 0]], [[1, 0], [0, 1]]):
            gaps.append((c + 0.5, r + 0.5))
    seen = closed = 0
    for here, there in ends_of_segments(rng, grid, 150):
        line = shapely.LineString([here, there]) if (here != there).any() else shapely.Point(here)
        passed = [gap for gap in gaps if line.distance(shapely.Point(gap)) < 1e-12]
        is_open = all((gap == here).all() or (gap == there).all() for gap in map(np.array, passed))
        is_seen = problem.sees(*grid.to_map([here, there]).tolist())
        assert is_seen == (free.buffer(1e-12, join_style="mitre").covers(line) and is_open)
        blocked = line.difference(free.buffer(1e-12, join_style="mitre")).length
        assert problem.blocked_length(here, there) == pytest.approx(blocked, abs=1e-6)
        seen += is_seen
        closed += not is_open
    assert 20 < seen < 280
    assert closed > 0


@pytest.mark.parametrize("geometry", [{}, METRES])
def test_fitness_and_collision_are_those_of_the_kernel(geometry):
    problem = WalkProblem(random_grid_scenario(2, **geometry))
    oracle, rng = naive_swarm.oracle_of(problem), np.random.default_rng(0)
    for here, _ in ends_of_segments(rng, problem.scenario.map, 100):
        point = problem.scenario.map.to_map(here)
        assert oracle.cost(point.tolist()) == pytest.approx(problem.evaluate(point), rel=1e-12, abs=1e-9)


WALL = (
    ".....",
    ".....",
    "####.",
    ".....",
    ".....",
)


def test_the_cost_of_a_way_is_its_length_and_a_penalty_for_what_is_blocked_of_all_of_it():
    problem = naive_swarm.oracle_of(drawn_problem(*WALL, start=(0, 0), target=(0, 4), **METRES))
    a, b, c = (problem.centre_of(cell) for cell in ((0, 1), (0, 3), (4, 3)))
    assert problem.cost_of_path([a, b, c]) == pytest.approx((6 * 0.05 + 500, 0.05))
    assert problem.freed(problem.centre_of((1, 2.2))) in (
        problem.centre_of((1, 1)),
        problem.centre_of((1, 3)),
    )
    assert problem.freed(a) == a


# Glowworms.


def placed(problem, *cells, **parameters):
    """Return glowworms with all but the robot in these places."""
    twin = twin_of(Glowworm, problem, **parameters)
    twin.adopt([problem.scenario.start, *problem.scenario.map.to_map(cells)])
    return twin


def test_light_is_relayed_around_an_obstacle():
    problem = drawn_problem(*WALL, start=(0, 0), target=(0, 4))
    twin = placed(problem, (4, 1), (4, 4), (1, 1))
    advance(twin, 1, 4)
    far = 4 + math.hypot(4, 3)  # along the wall's open end, down and left
    costs = [math.hypot(4, 1) + 3 + 4, 3 + 4, 4, 3 + 3 + 4]
    assert far > costs[1]
    shares = [(member.luciferin - 0.6 * 5) / 0.6 for member in twin.members]
    assert shares == pytest.approx([1 / (1 + cost) for cost in costs])


@pytest.mark.parametrize(
    ("glow", "shares"),
    [(1, [0, 0, 1 / 5]), (2, [1 - math.hypot(*way) / math.hypot(5, 5) for way in ((0, 4), (4, 3), (4, 0))])],
)
def test_members_shine_by_sight_and_by_distance_as_computed_by_hand(glow, shares):
    twin = placed(drawn_problem(*WALL, start=(0, 0), target=(0, 4)), (4, 1), (4, 4), glow=glow)
    advance(twin, 1, 3)
    assert [(member.luciferin - 0.6 * 5) / 0.6 for member in twin.members] == pytest.approx(shares)


def test_glowworms_move_to_the_brightest_that_they_see_by_where_all_were():
    problem = drawn_problem(*WALL, start=(0, 0), target=(0, 4))
    twin = placed(problem, (4, 1), (4, 4), step=0.1)
    advance(twin, 1, 3)
    eta, way = 0.5, math.hypot(4, 1)
    robot, second, third = (member.position for member in twin.members)
    assert robot == pytest.approx([eta * 4 / way, eta * 1 / way])
    assert second == pytest.approx([4, 1.5])
    # All outshine the target at first: the third one sees none that is brighter, and goes anywhere.
    assert math.dist(third, (4, 4)) == pytest.approx(eta)
    assert twin.evaluations == 6
    assert twin.best == (pytest.approx(math.hypot(4, 0) + 500), pytest.approx(1.0), [0.0, 0.0])


def test_near_the_brightest_one_they_step_onto_it_and_then_stay():
    problem = drawn_problem("......", start=(0, 0), target=(5, 0))
    twin = placed(problem, (1, 0), (1.2, 0), step=0.05, gain=0.0, decay=0.0)
    twin.members[1].luciferin, twin.members[2].luciferin = 6.0, 7.0
    twin.parameters = twin.parameters._replace(decision_range=0.1)  # the target is out of reach
    advance(twin, 1, 3)
    assert twin.members[1].position == pytest.approx([1.2, 0])
    spent, draws = twin.evaluations, twin.stream.words()
    here = list(twin.members[1].position)
    twin.members[2].position = list(here)
    assert twin.next_place(1, [member.position for member in twin.members], [5, 6, 7], [True] * 4) == here
    assert (twin.evaluations, twin.stream.words()) == (spent, draws)


@pytest.mark.parametrize(
    "parameters",
    [
        {},
        {"glow": 1},
        {"selection": 1, "levels": 1, "decision_range": 0.3},
        {"dimming": 1},
        {"range_rule": 1},
    ],
)
def test_the_robot_arrives_behind_the_block_on_a_free_way(parameters):
    problem = WalkProblem(make_scenario("block:50"))
    twin = twin_of(Glowworm, problem, seed=1, step=0.03, **parameters)
    twin.begin(10)
    advance(twin, 150, 10)
    way = [*twin.best_walk, twin.problem.target]
    assert twin.budget == twin.evaluations
    assert twin.members[0].position == twin.trajectory[-1] == twin.problem.target
    assert twin.best[:2] == (pytest.approx(length_of(way)), 0.0)
    assert 43.1 < twin.best[0] < 80.0
    assert all(twin.problem.sees(*ends) for ends in itertools.pairwise(way))


def test_no_wall_is_stepped_through_to_arrive():
    problem = drawn_problem(*WALL, start=(0, 1), target=(0, 3))
    twin = placed(problem, (1, 1), step=0.5)
    advance(twin, 1, 2)
    assert math.dist(twin.members[0].position, (0, 3)) <= 2.5
    assert not twin.is_spent()


def test_on_another_map_all_but_the_robot_are_placed_anew():
    twin = placed(drawn_problem("....", "....", start=(0, 0), target=(3, 0)), (1, 0), (2, 1), step=0.125)
    advance(twin, 2, 3)
    spent, last = twin.evaluations, list(twin.trajectory[-1])
    here = twin.problem.cell_of(last)
    rows = [list("...."), list("....")]
    rows[here[1]][here[0]] = "#"
    start, target = (0, 1 - here[1]), (3, 0)
    twin.re_evaluate(naive_swarm.oracle_of(drawn_problem(*map("".join, rows), start=start, target=target)))
    assert twin.evaluations == spent + 4
    assert twin.problem.is_free(*twin.problem.cell_of(twin.members[0].position))
    assert twin.trajectory[-2:] == [last, twin.members[0].position]
    assert [member.luciferin for member in twin.members] == [5.0] * 3
    assert twin.best[:2] == pytest.approx(twin.problem.cost_of_path([*twin.best_walk, twin.problem.target]))


# Ants.


def test_spinning_chooses_the_first_whose_running_sum_exceeds_the_share():
    weights = [0.5, 0.0, 1.5]
    assert [spin(weights, share) for share in (0.0, 0.2, 0.25, 0.9, 1.0)] == [0, 0, 2, 2, 2]


def test_costs_are_relayed_along_the_shortest_chain():
    here = [(0, 0), (3, 0), (3, 4), (9, 9)]
    sight = [
        [False, True, False, False],
        [True, False, True, False],
        [False, True, False, False],
        [False] * 4,
    ]
    assert relayed([math.inf, 20.0, 1.0, math.inf], here, sight) == [8.0, 5.0, 1.0, math.inf]


@pytest.mark.parametrize("geometry", [{}, METRES])
def test_ants_find_the_octile_optimum_of_a_small_map(geometry):
    rows = (".......", "..##...", "..##...", ".......")
    problem = drawn_problem(*rows, start=(0, 1), target=(6, 2), **geometry)
    twin = twin_of(AntColony, problem)
    twin.begin(20)
    advance(twin, 15, 20)
    grid = problem.scenario.map
    optimum = shortest_grid_path(grid.blocked, (0, 1), (6, 2)).length * grid.resolution
    assert twin.best[:2] == (pytest.approx(optimum), 0.0)


def test_an_ant_in_a_dead_end_steps_back_and_its_walk_has_no_loops():
    rows = ("......", ".####.", "....#.", ".####.", "......")
    problem = drawn_problem(*rows, start=(0, 2), target=(5, 2))
    twin = twin_of(AntColony, problem, sight_weight=4.0)
    twin.begin(5)
    for ant in twin.members:
        assert ant.arrived
        assert len(set(ant.cells)) == len(ant.cells) == 10
        assert (1, 2) not in ant.cells
        assert ant.length == ant.fitness == pytest.approx(9.0)


def test_where_a_walk_comes_back_beside_itself_the_loop_is_cut_out():
    problem = drawn_problem("....", "....", ".#..", start=(0, 0), target=(3, 2))
    twin = twin_of(AntColony, problem)
    # (0, 2) is beside (1, 1), but behind a corner of the blocked cell.
    way = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (2, 1), (1, 1), (0, 1), (0, 2)]
    assert twin.without_loops(way) == [(0, 0), (0, 1), (0, 2)]
    assert twin.without_loops(way[::-1]) == [(0, 2), (0, 1), (0, 0)]
    assert twin.without_loops(way[2:]) == [(2, 0), (1, 1), (0, 1), (0, 2)]
    assert twin.without_loops(way[:1]) == way[:1]


def test_an_ant_whose_steps_are_used_up_goes_straight_on_from_where_it_is():
    """The winding corridor is longer than an ant walks."""
    walls = ("#" * 19 + ".", "." + "#" * 19)
    rows = [row for k in range(9) for row in ("." * 20, walls[k % 2])] + ["." * 20]
    twin = twin_of(AntColony, drawn_problem(*rows, start=(0, 0), target=(19, 18)), evaporation=0.5)
    twin.begin(2)
    for ant in twin.members:
        assert not ant.arrived
        assert len(ant.cells) == 1 + 4 * (20 + 19)
        assert ant.length == len(ant.cells) - 1
        rest = twin.problem.cost(ant.points[-1])
        assert rest[1] > 0
        assert (ant.fitness, ant.collision) == (ant.length + rest[0], rest[1])
    assert twin.best_walk == twin.members[0].points
    assert {trail for row in twin.trails for cell in row for trail in cell} == {0.5}


def test_trails_evaporate_and_ants_that_arrived_lay_theirs_and_the_best_once_more():
    problem = drawn_problem("....", start=(0.25, 0), target=(2.75, 0))
    twin = twin_of(AntColony, problem, evaporation=0.5, deposit=1.0, elite_weight=3.0)
    twin.begin(2)
    laid = twin.trails[0]
    assert twin.best[0] == 2.5
    assert [cell[0] for cell in laid] == [0.5 + 2 + 3] * 3 + [0.5]
    assert [cell[4] for cell in laid] == [0.5] * 4
    advance(twin, 3, 2)
    assert [cell[0] for cell in laid] == [((5.5 / 2 + 5) / 2 + 5) / 2 + 5] * 3 + [0.0625]


def test_on_another_map_ants_walk_anew_and_lay_no_trails():
    twin = twin_of(AntColony, drawn_problem("....", "....", "....", start=(0, 1), target=(3, 1)))
    twin.begin(6)
    advance(twin, 5, 6)
    trails = [[list(cell) for cell in row] for row in twin.trails]
    assert twin.best[:2] == (3.0, 0.0)
    other = naive_swarm.oracle_of(drawn_problem("....", "..#.", "....", start=(0, 1), target=(3, 1)))
    twin.re_evaluate(other)
    assert twin.trails == trails
    assert twin.evaluations == 7 * 6 - 6 + 7
    way = [*twin.best_walk, other.target]
    assert twin.best[:2] == pytest.approx(other.cost_of_path(way))
    assert twin.best[0] == pytest.approx(min(ant.fitness for ant in twin.members))
