"""The multivariate optimization algorithm; what holds for every optimizer is in test_optimizers.py."""

import itertools

import gymnasium
import numpy as np
import pytest
from test_optimizers import PLAN, problems, run
from test_re_evaluation import change
from test_re_evaluation import problems as alternating

from helpers.builders import advance, begin, make_problem
from swarm_gym.errors import SettingError
from swarm_gym.optimizers.multivariate.regions import num_regions
from swarm_gym.problem.tables import stack

NAME = "multivariate"


def table_of(swarms):
    """Return the fitness of the heads, and of the list below each."""
    n = int(swarms.registers[0, 0])
    lengths = swarms.registers[0, 1 : n + 1].tolist()
    ends = np.cumsum([n, *lengths])
    fitness = swarms.fitness[0]
    assert ends[-1] == swarms.size[0]
    return fitness[:n], [fitness[a:b] for a, b in itertools.pairwise(ends)]


def assert_sorted(swarms, regions):
    """Check that heads are sorted, none is worse than its list, and lists are sorted and not too long."""
    heads, lists = table_of(swarms)
    assert len(heads) == regions
    assert (np.diff(heads) >= 0).all()
    for i, (head, values) in enumerate(zip(heads, lists, strict=True)):
        assert len(values) <= regions - i
        assert (np.diff(values, prepend=head) >= 0).all()


@pytest.mark.parametrize(
    ("size", "regions"), [(2, 1), (4, 1), (5, 2), (8, 2), (9, 3), (64, 9), (65, 10), (76, 10), (77, 11)]
)
def test_sizes_are_numbers_of_regions(size, regions):
    assert num_regions(size) == regions
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size, capacity=80)
    for _ in range(2):
        assert swarms.registers[0, 0] == regions
        assert len(table_of(swarms)[0]) == regions
        assert swarms.size[0] <= size
        advance(NAME, swarms, tables, size, 0.0)


def test_sixty_five_members_are_ten_regions_whose_lists_are_filled_in_time():
    """A region that rose in rank has a shorter list than its rank allows, until the next iteration."""
    swarms, tables = begin(NAME, [make_problem("case1", 9)], 65, capacity=80)
    assert swarms.registers[0, 0] == 10
    assert swarms.size[0] <= swarms.evaluations[0] == 65
    # Where nothing is better than a head, regions keep their ranks.
    for _ in range(40):
        advance(NAME, swarms, tables, 65, 0.0)
    assert swarms.registers[0, 0] == 10


@pytest.mark.parametrize("kind", ["analytic", "curve"])
def test_regions_and_lists_are_sorted_and_no_longer_than_their_place_allows(kind):
    swarms, tables = begin(NAME, [problems(NAME)[kind]], 20)
    for size, repair_degree in [*PLAN, (32, 0.0), (32, 1.0), (27, 0.0), (4, 0.0), (30, 0.3)]:
        advance(NAME, swarms, tables, size, repair_degree)
        n = num_regions(size)
        assert_sorted(swarms, n)
        assert swarms.size[0] <= n * (n + 3) // 2 <= size
        assert swarms.best_fitness[0] <= swarms.fitness[0, 0]


@pytest.mark.parametrize("size", [2, 3, 5, 8, 20, 30])
def test_an_iteration_costs_as_many_evaluations_as_members_were_asked_for(size):
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size)
    assert swarms.evaluations[0] == size
    for count in range(2, 5):
        advance(NAME, swarms, tables, size, 0.0)
        assert swarms.evaluations[0] == count * size


def test_regions_stay_sorted_when_the_map_changes():
    both = alternating(NAME, "analytic")
    swarms, _ = begin(NAME, both[:1], 20)
    tables = stack([problem.table for problem in both])
    for step in range(1, 9):
        advance(NAME, swarms, tables, 20, 0.0)
        change(NAME, swarms, tables, step % 2)
        assert_sorted(swarms, 5)


def test_new_regions_are_drawn_between_the_heads():
    problem = make_problem("case1", 9)
    swarms, tables = begin(NAME, [problem], 20)
    heads = swarms.positions[0, :5, :9].copy()
    before = swarms.evaluations[0]
    advance(NAME, swarms, tables, 27, 0.0)
    assert swarms.registers[0, 0] == 6
    assert swarms.evaluations[0] == before + 1 + 27
    assert np.ptp(heads, axis=0).min() > 0


def test_the_best_head_survives_and_stays_best():
    swarms, tables = begin(NAME, [problems(NAME)["curve"]], 20)
    for _ in range(8):
        advance(NAME, swarms, tables, 20, 0.0)
        assert swarms.fitness[0, 0] == swarms.best_fitness[0]


@pytest.mark.parametrize("radius", [0.0, 0.5, 500.0])
def test_episodes_with_another_radius_are_the_naive_ones(radius):
    run(NAME, problems(NAME)["curve"], PLAN[:4], {"radius": radius}, size=9)


def test_lists_lie_in_the_cube_around_where_a_head_was():
    """With radius 0 every point of a list is its head, and costs as much."""
    swarms, tables = begin(NAME, [make_problem("case1", 9)], 20)
    advance(NAME, swarms, tables, 20, 0.0, {"radius": 0.0})
    n, lengths = swarms.registers[0, 0], swarms.registers[0, 1:6]
    assert n == 5
    assert lengths.tolist() == [5, 4, 3, 2, 1]


def test_one_member_is_too_few():
    with pytest.raises(SettingError, match="min_population_size"):
        gymnasium.make("swarm_gym/Multivariate-v0", min_population_size=1)


def test_the_first_lists_are_drawn_at_the_radius_that_was_chosen():
    env = gymnasium.make(
        "swarm_gym/Multivariate-v0", scenario="case1", num_waypoints=5, initial_population_size=20, radius=0.5
    )
    env.reset(seed=0)
    positions = env.unwrapped.simulation.positions(0)
    heads, others = positions[:5], positions[5:]
    nearest = np.abs(others[:, None] - heads).max(axis=-1).min(axis=-1)
    assert len(others) > 5
    assert (nearest <= 2 * 0.5).all()  # a head may have changed places with one of its list
