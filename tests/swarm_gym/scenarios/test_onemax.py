"""Scenarios of bit strings: names, ranges, refusals; and their problems."""

import copy
import pickle

import numpy as np
import pytest

from helpers.builders import as_path
from helpers.compiled import compiled
from helpers.refusals import refused
from swarm_gym.errors import SettingError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.problem import AnalyticProblem, FunctionProblem, OneMaxProblem, problem_of_function
from swarm_gym.problem.tables import evaluate_entry, select, stack
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import OneMaxScenario, expand_name, make_scenario, make_scenarios
from swarm_gym.settings import Settings
from swarm_gym.worlds import make_problem, problems_for

# Names.


def test_a_name_says_the_length_and_half_of_the_bits_are_set():
    made = make_scenario("onemax:101")
    assert isinstance(made, OneMaxScenario)
    assert (made.name, made.size, made.start, made.dimension) == ("onemax:101", 101, 50, 1)
    assert (made.optimum, made.domain) == ((101.0,), (0.0, 101.0))
    assert [make_scenario(f"onemax:{size}").size for size in (10, 100_000)] == [10, 100_000]


@pytest.mark.parametrize("start", [0, 7, 50, 100])
def test_a_name_may_say_the_ones_at_the_beginning(start):
    made = make_scenario(f"onemax:100-start:{start}")
    assert (made.size, made.start) == (100, start)


def test_a_range_stands_for_all_its_lengths():
    assert expand_name("onemax:100-103") == ("onemax:100", "onemax:101", "onemax:102", "onemax:103")
    assert expand_name("onemax:20-21-start:9") == ("onemax:20-start:9", "onemax:21-start:9")
    assert [made.start for made in make_scenarios("onemax:10-12")] == [5, 5, 6]
    assert len(expand_name("onemax:100-500")) == 401


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("onemax:", ["onemax:<n>[-start:<ones>]", "10 to 100000"]),
        ("onemax:x", ["onemax:<n>"]),
        ("onemax:010", ["onemax:<n>"]),
        ("onemax:100\n", ["onemax:<n>"]),
        ("onemax:100-start:", ["onemax:<n>"]),
        ("onemax:100-start:-1", ["onemax:<n>"]),
        ("onemax:100-start:5-start:6", ["onemax:<n>"]),
        ("onemax:9", ["length n", "10 to 100000", "got 9"]),
        ("onemax:100001", ["length n", "10 to 100000", "got 100001"]),
        ("onemax:8-12", ["length n", "got 8"]),
        ("onemax:100-start:101", ["ones at the start", "0 to 100", "got 101"]),
        ("onemax:20-30-start:25", ["ones at the start", "0 to 20", "got 25"]),
    ],
)
def test_a_malformed_name_is_refused_with_what_was_expected(name, words):
    refused(lambda: expand_name(name), repr(name)[:8], *words)


def test_a_range_that_falls_is_refused():
    refused(lambda: expand_name("onemax:30-20"), "30-20")


def test_scenarios_of_ones_own_are_checked():
    assert OneMaxScenario("mine", size=np.int64(30), start=np.int64(4)).start == 4
    assert OneMaxScenario("mine").size == 100
    for size in (9, 100_001, 20.0, True, "20", None):
        refused(lambda s=size: OneMaxScenario("mine", size=s), "'mine'", "length", repr(size))
    for start in (-2, 31, 3.5, False, "3"):
        refused(lambda s=start: OneMaxScenario("mine", size=30, start=s), "'mine'", "start", repr(start))


def test_copies_are_equal_and_other_strings_are_not():
    made = make_scenario("onemax:30-start:3")
    for twin in (pickle.loads(pickle.dumps(made)), copy.deepcopy(made), make_scenario("onemax:30-start:3")):
        assert twin == made
        assert hash(twin) == hash(made)
        assert twin.start == 3
    assert len({made, make_scenario("onemax:30"), make_scenario("onemax:31-start:3")}) == 3


# Problems.


def problem(name="onemax:40"):
    return problem_of_function(make_scenario(name))


def test_fitness_is_the_number_of_zeros_and_nothing_collides():
    made = problem()
    assert isinstance(made, OneMaxProblem)
    assert [made.evaluate([ones]) for ones in (0.0, 17.0, 40.0)] == [(40.0, 0.0), (23.0, 0.0), (0.0, 0.0)]
    assert made.dimension == 1
    assert [bound.tolist() for bound in made.bounds] == [[0.0], [40.0]]
    assert made.repaired(np.array([3.0]), 1.0).tolist() == [3.0]


def test_an_episode_ends_at_the_optimum_which_evaluations_measure():
    assert (problem().target, problem().counts_evaluations, problem().least_fitness) == (0.0, True, None)
    others = FunctionProblem(make_scenario("function:booth-2")), make_problem("case1")
    for other in others:
        assert (other.target, other.counts_evaluations) == (-np.inf, False)


def test_out_of_a_stack_every_problem_keeps_its_values():
    problems = [problem(name) for name in ("onemax:10", "onemax:40", "onemax:99-start:3")]
    tables = stack([one.table for one in problems])
    for number, one in enumerate(problems):
        table = compiled(select)(tables, number)
        assert evaluate_entry(table, as_path([7.0])) == one.evaluate([7.0]) == (one.scenario.size - 7.0, 0.0)
        assert table.start == one.scenario.start


def test_problems_are_alike_by_length_and_start_whatever_their_names():
    mine = problem_of_function(OneMaxScenario("mine", size=40, start=20))
    assert mine.identity == problem().identity
    assert len({problem(name).identity for name in ("onemax:40", "onemax:41", "onemax:40-start:3")}) == 3


def test_values_in_the_plane_do_not_depend_on_the_second_number():
    values = problem().values_in_plane(np.array([0.0, 10.0]), np.array([1.0, 2.0, 3.0]))
    assert values.tolist() == [[40.0, 30.0]] * 3


def test_a_bit_string_has_no_path():
    refused(lambda: shortest_path(make_scenario("onemax:10")), "'onemax:10'", "no path")
    refused(lambda: AnalyticProblem(make_scenario("onemax:10")), "'onemax:10'", "bit string")


# Settings.


@pytest.mark.parametrize("option", ["num_waypoints", "num_control_points", "length_weight", "penalty"])
def test_options_without_effect_on_bit_strings_are_refused(option):
    value = getattr(Settings, option)
    refused(
        lambda: make_problem("onemax:40", **{option: value}), repr(option), "bit strings", error=SettingError
    )


@pytest.mark.parametrize("other", ["case1", "rooms:0", "function:rastrigin-1"])
def test_scenarios_of_another_kind_are_refused_beside_bit_strings(other):
    optimizer = get_optimizer("one-plus-lambda-lambda")
    for names in (["onemax:40", other], [other, "onemax:40"]):
        refused(
            lambda n=names: problems_for(Settings.from_options(optimizer, {"scenario": n})),
            repr(other),
            error=SettingError,
        )


def test_strings_of_several_lengths_go_together():
    optimizer = get_optimizer("one-plus-lambda-lambda")
    made = problems_for(Settings.from_options(optimizer, {"scenario": ["onemax:10", "onemax:20-21"]}))
    assert [one.scenario.size for one in made] == [10, 20, 21]
