"""BBOB functions: their values against the oracle and against `ioh`, their names, and their problems."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.builders import as_path, function_problem
from helpers.compiled import compiled
from helpers.loops import looped
from helpers.refusals import refused
from helpers.slow import slow_but
from oracles.naive_swarm import oracle_of
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.problem import BbobProblem, FunctionProblem
from swarm_gym.problem.tables import evaluate_entry, select, stack
from swarm_gym.reference import known_optimum, shortest_path
from swarm_gym.scenarios import BbobScenario, expand_name, make_scenario, make_scenarios
from swarm_gym.scenarios.bbob.instance import FUNCTION_NAMES
from swarm_gym.scenarios.bbob.random_numbers import rotation, uniform_numbers
from swarm_gym.scenarios.bbob.scenario import FUNCTIONS
from swarm_gym.settings import Settings
from swarm_gym.worlds import problems_for

functions = pytest.mark.parametrize("function", FUNCTIONS)
# Other tests compare the values of all functions, with those of ioh and of the program of the authors.
some_functions = pytest.mark.parametrize("function", slow_but([*FUNCTIONS][::3], FUNCTIONS))

# Values of `coco-experiment` 2.8.2, f_opt included, at (4.5, -3.5, 0.75), three dimensions, instance 4.
AT = (4.5, -3.5, 0.75)
VALUES = {
    1: -83.21427312,
    2: 363484.0677543146,
    3: 59.65708003154718,
    4: 241.97006911502635,
    5: 998.4134164902525,
    6: 95390.18669884997,
    7: 453.84825411063224,
    8: 127396.28390643417,
    9: 23515.818078444172,
    10: 17470251.849319767,
    11: 6396269.739775053,
    12: 4273634320.850506,
    13: 2157.1169709974515,
    14: 60.854906563883716,
    15: 581.7486553965008,
    16: -438.6054554597426,
    17: 64.90537738498188,
    18: 322.65179728313154,
    19: -13.478090716705445,
    20: 5867.567468257648,
    21: 30.966949043052118,
    22: 377.57853099086685,
    23: -204.78077531795404,
    24: 299.48048917887905,
}


def problem_of(function, dimension, instance=1):
    return function_problem(f"function:bbob-{function}-{dimension}-{instance}")


# Values.


@functions
def test_values_are_those_of_the_program_of_the_authors(function):
    problem = problem_of(function, 3, 4)
    found = problem.evaluate(AT)[0] + problem.scenario.least_value
    assert found == pytest.approx(VALUES[function], rel=1e-9, abs=1e-9)


@functions
@looped("dimension", [2, 5, 10])
@looped("instance", [1, 2, 7, 50])
def test_values_are_those_of_ioh(function, dimension, instance):
    """Compare a thousand random points, and the optimum; values without f_opt, up to rounding."""
    ioh = pytest.importorskip("ioh", reason="needs the extra `benchmarks`")
    theirs = ioh.get_problem(function, instance, dimension, ioh.ProblemClass.BBOB)
    problem = problem_of(function, dimension, instance)
    assert problem.scenario.least_value == theirs.optimum.y
    np.testing.assert_allclose(problem.scenario.optimum, theirs.optimum.x, rtol=1e-12, atol=1e-14)
    vectors = np.random.default_rng(function).uniform(-5.0, 5.0, (1000, dimension))
    expected = np.array([theirs(vector) for vector in vectors]) - problem.scenario.least_value
    np.testing.assert_allclose(problem.values(vectors), expected, rtol=1e-9, atol=1e-9)


@some_functions
@settings(max_examples=8, deadline=None)
@given(st.data())
def test_values_are_those_of_the_definition(function, data):
    """Compare with the oracle, outside of the domain too."""
    problem = problem_of(function, data.draw(st.integers(2, 24)), data.draw(st.integers(1, 1000)))
    rng = np.random.default_rng(data.draw(st.integers(0, 10**6)))
    vector = rng.uniform(-6.0, 6.0, problem.dimension)
    expected, _ = oracle_of(problem).cost(vector.tolist())
    found, collision = problem.evaluate(vector)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert collision == 0.0


@some_functions
@looped("dimension", [2, 40])
def test_the_value_at_the_optimum_is_0_and_larger_beside_it(function, dimension):
    problem = problem_of(function, dimension, 3)
    optimum = np.array(problem.scenario.optimum)
    assert (np.abs(optimum) <= 5.0).all()
    assert 0.0 <= problem.evaluate(optimum)[0] <= 1e-14 * dimension
    inwards = np.where(optimum > 0.0, -0.1, 0.1)
    for component in (0, dimension - 1):
        beside = optimum.copy()
        beside[component] += inwards[component]
        assert problem.evaluate(beside)[0] > 1e-7


@functions
def test_no_value_is_below_0(function):
    problem = problem_of(function, 4, 2)
    steps = np.random.default_rng(function).uniform(-1.0, 1.0, (300, 4))
    scales = 10.0 ** np.random.default_rng(0).uniform(-12.0, 0.0, (300, 1))
    assert (problem.values(np.array(problem.scenario.optimum) + scales * steps) >= 0.0).all()


def test_out_of_a_stack_every_problem_keeps_its_values():
    problems = [problem_of(function, 4, instance) for function in FUNCTIONS for instance in (1, 2)]
    tables, vector = stack([problem.table for problem in problems]), [-3.0, -1.5, 0.25, 2.0]
    for number, problem in enumerate(problems):
        assert evaluate_entry(compiled(select)(tables, number), as_path(vector)) == problem.evaluate(vector)


def test_values_in_the_plane_have_the_optimum_in_the_other_components():
    problem = problem_of(15, 5)
    x, y = np.array([-1.0, 0.5, 2.0]), np.array([3.0, -4.0])
    values = problem.values_in_plane(x, y)
    for row, second in enumerate(y):
        for column, first in enumerate(x):
            vector = [first, second, *problem.scenario.optimum[2:]]
            assert values[row, column] == problem.evaluate(vector)[0]


# What instances draw.


def test_rotations_are_orthogonal():
    for dimension in (2, 7, 40):
        matrix = rotation(dimension, 10_001)
        np.testing.assert_allclose(matrix @ matrix.T, np.eye(dimension), atol=1e-12)


def test_uniform_numbers_spread_over_the_interval_and_begin_alike_for_any_count():
    drawn = uniform_numbers(20_000, 3)
    assert ((drawn > 0.0) & (drawn < 1.0)).all()
    np.testing.assert_allclose(np.quantile(drawn, [0.1, 0.5, 0.9]), [0.1, 0.5, 0.9], atol=0.02)
    np.testing.assert_array_equal(uniform_numbers(9, 3), drawn[:9])
    np.testing.assert_array_equal(uniform_numbers(9, -3), drawn[:9])


def test_instances_differ_in_optimum_and_least_value():
    made = make_scenarios("function:bbob-15-10-1-200")
    assert len({scenario.optimum for scenario in made}) == 200
    assert len({scenario.least_value for scenario in made}) > 150
    assert all(abs(scenario.least_value) <= 1000.0 for scenario in made)


# Names.


def test_a_name_says_function_dimension_and_instance():
    made = make_scenario("function:bbob-15-10-3")
    assert (made.number, made.dimension, made.instance) == (15, 10, 3)
    assert made.domain == (-5.0, 5.0)
    assert pickle.loads(pickle.dumps(made)) == made == make_scenario("function:bbob-15-10-3")


def test_a_range_stands_for_all_its_instances():
    assert expand_name("function:bbob-7-2-9-11") == tuple(f"function:bbob-7-2-{k}" for k in (9, 10, 11))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("function:bbob-25-2-1", ["functions 1 to 24", "function 25"]),
        ("function:bbob-0-2-1", ["functions 1 to 24", "function 0"]),
        ("function:bbob-1-1-1", ["dimensions 2 to 100", "dimension 1"]),
        ("function:bbob-1-101-1", ["dimensions 2 to 100", "dimension 101"]),
        ("function:bbob-1-2-0", ["instances 1 to 1000", "instance 0"]),
        ("function:bbob-1-2-1001", ["instances 1 to 1000", "instance 1001"]),
        ("function:bbob-1-2-1-1001", ["instances 1 to 1000", "instance 1001"]),
        ("function:bbob-1-2-3-1", ["3-1", "empty"]),
        ("function:bbob-1-2", ["function:bbob-<function>-<dimension>-<instance>", "function:bbob-15-10-3"]),
        ("function:bbob-01-2-1", ["<instance>"]),
        ("function:bbob-1-2-1\n", ["<instance>"]),
        ("function:bbob-1-2-shifted:3", ["<instance>"]),
        ("function:bbob-sphere-2-1", ["<instance>"]),
    ],
)
def test_a_malformed_name_is_refused_with_what_was_expected(name, words):
    refused(lambda: make_scenario(name), repr(name), *words)


def test_scenarios_of_ones_own_are_checked():
    made = BbobScenario("mine", "bbob-8", np.int64(3), instance=5)
    assert BbobProblem(made).identity == problem_of(8, 3, 5).identity
    for function in ("bbob-25", "bbob-08", "rastrigin", 8, None):
        refused(lambda f=function: BbobScenario("mine", f, 3), "'mine'", repr(function), "bbob-24")
    for dimension in (1, 2.0, True, "2"):
        refused(lambda d=dimension: BbobScenario("mine", "bbob-8", d), "'mine'", repr(dimension))
    for instance in (0, 1.0, False):
        refused(lambda i=instance: BbobScenario("mine", "bbob-8", 2, i), "'mine'", repr(instance))


# Problems and environments.


def test_the_optimum_is_known_to_be_0():
    problem = problem_of(20, 6)
    assert isinstance(problem, FunctionProblem)
    assert (known_optimum(problem), problem.lower_bound) == (0.0, 0.0)
    refused(lambda: shortest_path(problem.scenario), "no path")


def test_problems_are_told_apart_by_function_dimension_and_instance():
    identities = {problem_of(*parts).identity for parts in ((3, 2, 1), (4, 2, 1), (3, 4, 1), (3, 2, 2))}
    assert len(identities) == 4


def test_other_test_functions_are_refused_beside_them_by_name():
    names = ["function:bbob-3-2-1", "function:rastrigin-2"]
    for given_names in (names, names[::-1]):
        options = {"scenario": given_names}
        refused(
            lambda o=options: problems_for(Settings.from_options(Firefly, o)),
            *map(repr, names),
            error=SettingError,
        )


def test_an_environment_reports_the_precision_as_gap():
    env = SwarmEnv("particle-swarm", scenario="function:bbob-1-3-1-4", iterations=30, max_population_size=40,
                   initial_population_size=30)  # fmt: skip
    scenarios = set()
    for seed in range(8):
        _, info = env.reset(seed=seed)
        scenarios.add(info["scenario"])
        first, ended = info["best_fitness"], False
        while not ended:
            _, _, ended, _, info = env.step(np.array([30.0, 0.0]))
        assert info["optimality_gap"] == info["best_fitness"] < 0.01 * first
        problem = env.simulation.problem_of(0)
        assert problem.evaluate(info["best_path"][:, 1])[0] == info["best_fitness"]
    assert len(scenarios) > 1


def test_every_function_has_a_name():
    assert len(FUNCTION_NAMES) == len(set(FUNCTION_NAMES)) == 24
