"""Sources of new members: newcomers, first populations, growth and immigrants against plain Python."""

import numpy as np
import pytest

from helpers.builders import (
    advance,
    assert_same_as_oracle,
    begin,
    make_problem,
    oracle_twin,
    problem_of,
    small_grid_problem,
)
from helpers.compiled import compiled
from helpers.loops import looped
from helpers.newcomers import PATH_OPTIMIZERS, drawn, naively_drawn
from helpers.slow import slow_but
from oracles import naive
from oracles.naive_sources import Source
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.population import Swarms, num_staying
from swarm_gym.problem import AnalyticProblem
from swarm_gym.problem.geometry.bends import BENDS
from swarm_gym.scenarios import Circle, Scenario
from swarm_gym.sources import BECAME_BEST, BEST_SMOOTH, IMMIGRANTS, SOURCE_DECISIONS, kind_of_bends
from swarm_gym.sources import Source as OwnSource
from swarm_gym.ways import with_ways

all_optimizers = pytest.mark.parametrize("optimizer", PATH_OPTIMIZERS)
# One that moves member by member, one by generations, and one that draws all its members anew.
DIFFERENT = ("firefly", "multivariate", "cma-es")
# Optimizers that shrink and grow member by member.
BY_MEMBER = [name for name in PATH_OPTIMIZERS if name not in ("multivariate", "cma-es")]
PROBLEMS = {
    "waypoints": lambda: make_problem("case1", 9),
    "eight waypoints": lambda: problem_of("random", 8),
    "one waypoint": lambda: problem_of("random", 1, 5),
    "polyline": lambda: small_grid_problem("waypoints", 5, seed=5),
    "curve": lambda: small_grid_problem("bezier", 3, seed=4),
    "curve of many points": lambda: small_grid_problem("bezier", 6, seed=2),
    "guided waypoints": lambda: with_ways(make_problem("case1", 9)),
    "guided polyline": lambda: with_ways(small_grid_problem("waypoints", 5, seed=5)),
    "guided curve": lambda: with_ways(small_grid_problem("bezier", 3, seed=4)),
}
# A source of each sort, with immigrants.
SOURCES = {
    "uniform": Source(immigrants=0.3),
    "smooth": Source(1.0, 0.4, "harmonics", 0.25),
    "mixed": Source(0.4, 0.7, "stomp", 0.5),
    "all": Source(0.6, 0.2, "harmonics", 1.0),
}
WINDOW = 4  # iterations of which new members are recorded
# (size, repair degree): growing, shrinking, the same size, and two members.
PLAN = [(7, 0.0), (12, 0.5), (12, 0.0), (5, 1.0), (2, 0.0), (9, 0.0)]


# One new member.


@looped("share", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("bends", BENDS)
@pytest.mark.parametrize("problem", PROBLEMS)
def test_newcomers_and_the_random_numbers_they_take_are_the_naive_ones(problem, bends, share):
    made, source = PROBLEMS[problem](), Source(share, 0.5, bends)
    positions, smooth, words = drawn(made, source, 25, seed=3)
    expected, expected_words = naively_drawn(made, source, 25, seed=3)
    assert words == expected_words
    np.testing.assert_allclose(positions, expected, rtol=1e-9, atol=1e-9)
    assert smooth.all() == (share == 1.0)
    assert smooth.any() == (share > 0.0)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_the_share_of_smooth_members_is_the_one_asked_for(share):
    _, smooth, _ = drawn(make_problem("case1", 9), Source(share), 2000)
    assert smooth.mean() == pytest.approx(share, abs=3 * np.sqrt(share * (1 - share) / 2000))


def test_uniform_members_of_a_mixed_source_fill_the_box():
    """Draw uniform members anew, since the number that decided against a bend is known to be large."""
    problem = make_problem("case1", 9)
    positions, smooth, _ = drawn(problem, Source(0.9), 4000)
    low, high = problem.initial_bounds
    places = (positions[~smooth] - low) / (high - low)
    assert places.min() < 0.05
    np.testing.assert_allclose(places.mean(axis=0), 0.5, atol=0.06)


# First populations, growth and immigrants.


def run(optimizer, problem, source, plan=PLAN, **options):
    """Advance a swarm and its oracle along a plan; compare them and their new members after every step."""
    options = {"size": 7, "iterations": len(plan), "source": source, **options}
    swarms, tables = begin(optimizer, [problem], **options)
    swarms = swarms._replace(arrivals=np.full((1, 2, WINDOW), 7.0))
    twin = oracle_twin(optimizer, problem, **options)
    assert_same_as_oracle(swarms, twin)
    for size, repair_degree in plan:
        if swarms.evaluations[0] >= swarms.budget[0]:
            break
        parameters = {"tries": 1.0} if "tries" in get_optimizer(optimizer).parameters else {}
        values = advance(optimizer, swarms, tables, size, repair_degree, parameters)
        twin.step(size, repair_degree, values)
        assert_same_as_oracle(swarms, twin)
        recorded = swarms.arrivals[0, :, (swarms.iteration[0] - 1) % WINDOW]
        assert recorded[BECAME_BEST] == twin.became_best
        assert recorded[BEST_SMOOTH] == pytest.approx(twin.best_smooth, rel=1e-9)
    return swarms


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("optimizer", slow_but((*DIFFERENT, "fish-swarm"), PATH_OPTIMIZERS))
def test_episodes_are_the_naive_ones_whatever_the_source(optimizer, source):
    run(optimizer, make_problem("case1", 9), SOURCES[source])


@pytest.mark.parametrize(
    ("optimizer", "problem"),
    slow_but(
        [("particle-swarm", "polyline")],  # on curves, and with fireflies, plain Python takes long
        [(name, problem) for name in ("firefly", "particle-swarm") for problem in ("polyline", "curve")],
    ),
)
def test_episodes_on_grid_maps_are_the_naive_ones(optimizer, problem):
    """Compare with a seed for which no rounding decides on which side of a cell's edge a sample lies."""
    for source in SOURCES.values():
        run(optimizer, PROBLEMS[problem](), source, PLAN[:3], seed=2)


@pytest.mark.parametrize("optimizer", slow_but(DIFFERENT, PATH_OPTIMIZERS))
def test_budgets_that_end_among_immigrants_are_kept_as_naive(optimizer):
    problem, source = problem_of("random", 3), Source(0.5, 0.6, "harmonics", 0.6)
    plan = [(3, 0.0), (5, 0.5), (4, 0.0)]
    for budget in range(3, 34):
        swarms = run(optimizer, problem, source, plan, size=3, budget=budget)
        assert swarms.evaluations[0] <= budget


@looped("seed", range(3))
@pytest.mark.parametrize(("size", "share", "count"), [(9, 1 / 3, 3), (9, 1.0, 8), (2, 1.0, 1), (2, 0.5, 1)])
@pytest.mark.parametrize("optimizer", BY_MEMBER)
def test_immigrants_replace_exactly_the_worst(optimizer, size, share, count, seed):
    """The budget ends with the immigrants, so that nothing moves afterwards."""
    problem, source = make_problem("case1", 9), Source(1.0, 0.3, "harmonics", share)
    options = {"size": size, "seed": seed, "source": source}
    before, _ = begin(optimizer, [problem], **options)
    begun = int(before.evaluations[0])
    swarms, tables = begin(optimizer, [problem], budget=begun + count, **options)
    advance(optimizer, swarms, tables, size, 0.0)
    doomed = naive.deletion_order(*(field[0, :size].tolist() for field in (before.fitness, before.collision)))
    kept = [i for i in range(size) if i not in doomed[:count]]
    assert (swarms.size[0], swarms.evaluations[0]) == (size, begun + count)
    np.testing.assert_array_equal(swarms.positions[0, : len(kept)], before.positions[0, kept])
    new = swarms.positions[0, len(kept) : size]
    assert not (new[:, None] == before.positions[0, None, :size]).all(axis=2).any()


@all_optimizers
def test_without_immigrants_no_member_is_replaced(optimizer):
    """A share that rounds to no member takes no random number."""
    problem, plan = make_problem("case1", 9), [(7, 0.5), (7, 0.0)]
    swarms = [run(optimizer, problem, Source(0.5, 0.5, "stomp", share), plan) for share in (0.0, 0.05)]
    for name, one, other in zip(Swarms._fields, *swarms, strict=True):
        if name != "source":
            np.testing.assert_array_equal(one, other, err_msg=name)


@pytest.mark.parametrize(
    ("size", "new_size", "share", "staying"),
    [
        (10, 10, 0.0, 10), (10, 10, 0.04, 10), (10, 10, 0.05, 9), (10, 10, 0.3, 7), (10, 10, 1.0, 1),
        (10, 4, 0.5, 2), (10, 4, 0.0, 4), (4, 10, 0.5, 2), (4, 10, 0.0, 4), (3, 3, 0.5, 1), (5, 5, 0.5, 2),
        (2, 2, 0.24, 2), (2, 2, 0.25, 1), (2, 2, 1.0, 1), (1, 1, 0.0, 1), (1, 1, 1.0, 1), (1, 9, 1.0, 1),
        (9, 1, 0.5, 1), (200, 200, 0.999, 1), (200, 200, 0.99, 2),
    ],
)  # fmt: skip
def test_as_many_members_stay_as_counted_by_hand(size, new_size, share, staying):
    swarms = Swarms.allocate(1, 200, 2)
    swarms.size[0], swarms.source[0, IMMIGRANTS] = size, share
    assert compiled(num_staying)(swarms, 0, new_size) == staying


def test_smooth_members_outside_the_initial_bounds_have_opposites_inside_the_workspace():
    """An obstacle on the side with more room makes opposites, on the other side, the better ones."""
    area, obstacle = (0.0, 0.0, 1000.0, 1000.0), Circle(500.0, 500.0, 200.0)
    scenario = Scenario("edge", (100.0, 100.0), (900.0, 100.0), (obstacle,), area, (-90.0, 90.0))
    problem, source = AnalyticProblem(scenario, 7), Source(1.0, 1.0)
    low, high = problem.bounds
    assert (-drawn(problem, source, 30, seed=2)[0] < low).any()
    run("improved-fish-swarm", problem, source, [], size=30, seed=2)
    swarms, _ = begin("improved-fish-swarm", [problem], 30, source=source, seed=2)
    positions = swarms.positions[0, :30, :7]
    assert (low <= positions).all()
    assert (positions <= high).all()


# Records of new members.


def test_arrivals_record_the_best_smooth_member_and_how_often_a_new_member_became_the_best():
    problem, source = make_problem("case1", 9), Source(1.0, 0.4, "harmonics", 0.5)
    swarms, tables = begin("firefly", [problem], 8, source=source, budget=8 + 4, seed=1)
    swarms = swarms._replace(arrivals=np.full((1, 2, 3), 7.0))
    swarms.iteration[0] = 4  # column 1 of three
    best = float(swarms.best_fitness[0])
    advance("firefly", swarms, tables, 8, 0.0)
    fitness, improved = swarms.fitness[0, 4:8].tolist(), 0
    for value in fitness:
        improved += value < best
        best = min(best, value)
    assert swarms.arrivals[0, BEST_SMOOTH].tolist() == [7.0, min(fitness), 7.0]
    assert swarms.arrivals[0, BECAME_BEST].tolist() == [7.0, improved, 7.0]


def test_iterations_without_new_members_say_so_in_their_column():
    swarms, tables = begin("firefly", [make_problem("case1", 9)], 8)
    swarms = swarms._replace(arrivals=np.full((1, 2, 3), 7.0))
    advance("firefly", swarms, tables, 8, 0.0)
    assert swarms.arrivals[0].tolist() == [[np.inf, 7.0, 7.0], [0.0, 7.0, 7.0]]


# The description of a source.


@pytest.mark.parametrize(
    ("source", "name", "options"),
    [
        (OwnSource(), "uniform", {}),
        (OwnSource(1.0, 0.3), "smooth", {"amplitude": 0.3}),
        (OwnSource(1, 1), "smooth", {"amplitude": 1}),
        (OwnSource(0.2, 0.3), "mixed", {"smooth_share": 0.2, "amplitude": 0.3}),
    ],
)
def test_a_source_gives_the_options_that_describe_it(source, name, options):
    assert source.options() == {"source": name, **options}


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ((-0.1, 0.5), r"smooth_share must lie in \[0, 1\], got -0.1"),
        ((float("nan"), 0.5), "smooth_share.*nan"),
        (("a", 0.5), "smooth_share must be a number, got 'a'"),
        ((True, 0.5), "smooth_share must be a number, got True"),
        ((0.5, 0.0), r"amplitude must lie in \[0.01, 1\], got 0.0"),
        ((0.5, 1.1), "amplitude.*1.1"),
        ((0.5, None), "amplitude must be a number, got None"),
    ],
)
def test_a_source_that_cannot_be_is_refused(numbers, message):
    with pytest.raises(SettingError, match=message):
        OwnSource(*numbers)


def test_an_unknown_kind_of_bends_names_the_known_ones():
    with pytest.raises(UnknownNameError, match=r"bends.*sines.*harmonics, stomp"):
        kind_of_bends("sines")
    assert [kind_of_bends(name) for name in BENDS] == [0, 1]


def test_decisions_are_the_first_numbers_of_a_source():
    assert SOURCE_DECISIONS[IMMIGRANTS] == "immigrants"
