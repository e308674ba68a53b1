"""Test functions: their values, their names, and their problems."""

import hashlib
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.builders import as_path, function_problem
from helpers.compiled import compiled
from helpers.refusals import refused
from oracles.naive_functions import FUNCTIONS as NAIVE
from oracles.naive_swarm import oracle_of
from swarm_gym.compiler.jit import entry
from swarm_gym.compiler.simd import load, store
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.problem import AnalyticProblem, FunctionProblem
from swarm_gym.problem.function.table import NUMBERS, squared_sine, values_in_plane
from swarm_gym.problem.tables import evaluate_entry, select, stack
from swarm_gym.reference import ensure_optima, gap_to_optimum, known_optimum, shortest_path
from swarm_gym.scenarios import FunctionScenario, expand_name, make_scenario, make_scenarios
from swarm_gym.scenarios.function_scenario import FUNCTIONS
from swarm_gym.settings import Settings
from swarm_gym.worlds import make_problem, problems_for

NAMES = [f"function:{function}-2" for function in FUNCTIONS]

functions = pytest.mark.parametrize("function", FUNCTIONS)


def dimensions(function, below=30):
    return st.sampled_from([d for d in FUNCTIONS[function].dimensions if d < below])


def value(name, *vector):
    return function_problem(name).evaluate(vector)[0]


# Values.


def test_there_are_kernels_and_textbook_formulas_of_every_function():
    assert FUNCTIONS.keys() == NUMBERS.keys() == NAIVE.keys()


@functions
@settings(max_examples=60, deadline=None)
@given(st.data())
def test_values_are_those_of_the_textbook(function, data):
    """Compare random vectors of any dimension, with the optimum at its place or at another one."""
    dimension = data.draw(dimensions(function))
    number = data.draw(st.none() | st.integers(0, 999))
    shifted = "" if number is None else f"-shifted:{number}"
    problem = function_problem(f"function:{function}-{dimension}{shifted}")
    vector = np.random.default_rng(data.draw(st.integers(0, 10**6))).uniform(*problem.bounds)
    expected, _ = oracle_of(problem).cost(vector.tolist())
    found, collision = problem.evaluate(vector)
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-11)
    assert collision == 0.0


@functions
@pytest.mark.parametrize("shifted", ["", "-shifted:0", "-shifted:17"])
def test_the_value_at_the_optimum_is_exactly_0_and_larger_all_around(function, shifted):
    for dimension in (FUNCTIONS[function].dimensions[0], 8, 1000):
        problem = function_problem(f"function:{function}-{dimension}{shifted}")
        optimum = np.array(problem.scenario.optimum)
        assert problem.evaluate(optimum) == (0.0, 0.0)
        for component in {0, dimension // 2, dimension - 1}:
            for step in (-1e-3, 1e-3):
                beside = optimum.copy()
                beside[component] += step
                assert problem.evaluate(beside)[0] > 1e-7


@functions
@settings(max_examples=30, deadline=None)
@given(st.data())
def test_no_value_is_below_0(function, data):
    problem = function_problem(f"function:{function}-{data.draw(dimensions(function))}-shifted:1")
    rng = np.random.default_rng(data.draw(st.integers(0, 10**6)))
    scale = 10.0 ** data.draw(st.integers(-12, 0))
    optimum = np.array(problem.scenario.optimum)
    assert problem.evaluate(optimum + scale * rng.uniform(-1.0, 1.0, len(optimum)))[0] >= 0.0


@entry
def squared_sines(angles):
    """Return the results for several lanes at once, and for one number after the other."""
    out = np.empty((2, len(angles)))
    for k in range(0, len(angles), 8):
        store(out[0], k, squared_sine(load(angles, k)))
        for lane in range(k, k + 8):
            out[1, lane] = squared_sine(angles[lane])
    return out


def test_the_squared_sine_is_exact_to_a_few_last_bits_near_its_zeros_too():
    """Compare with a computation of more bits, at multiples of a half turn and near them."""
    rng = np.random.default_rng(0)
    parts = np.concatenate(
        [rng.uniform(-0.5, 0.5, 397), [0.25, 0.5, -0.5], 10.0 ** rng.uniform(-12, -1, 400)]
    )
    angles = rng.integers(-20, 21, len(parts)) + parts
    remainders = (angles - np.round(angles)).astype(np.longdouble)
    more_of_pi = np.longdouble(math.pi) + np.longdouble(1.2246467991473532e-16)
    of_lanes, of_numbers = squared_sines(angles)
    np.testing.assert_allclose(of_lanes, np.sin(more_of_pi * remainders) ** 2, rtol=2e-15)
    np.testing.assert_array_equal(of_lanes, of_numbers)
    known = squared_sines(np.array([0.0, 1.0, -7.0, 0.5, 2.5, -1.5, 4.0, 1e15]))
    assert known[0].tolist() == [0, 0, 0, 1, 1, 1, 0, 0]


def test_values_are_those_known_from_the_literature():
    assert value("function:rastrigin-2", 1.0, 1.0) == pytest.approx(2.0)
    # Its largest value in the domain, in two dimensions.
    assert value("function:rastrigin-2", 4.52299366, 4.52299366) == pytest.approx(80.70658039, abs=1e-7)
    assert value("function:sum-squares-10", *[1.0] * 10) == 55.0
    assert value("function:booth-2", 0.0, 0.0) == 74.0
    assert value("function:booth-2", -10.0, -10.0) == 2594.0
    assert value("function:booth-4", 0.0, 0.0, 1.0, 3.0) == 74.0
    assert value("function:bohachevsky-2", 1.0, 1.0) == pytest.approx(3.6)
    # -1 at (pi, pi), and 0 on the lines where a cosine is 0; 1 is added.
    assert value("function:easom-2", math.pi, math.pi) == 0.0
    assert value("function:easom-2", math.pi / 2, math.pi) == pytest.approx(1.0)
    assert value("function:easom-2", 3.0, 3.5) == pytest.approx(
        1 - math.cos(3.0) * math.cos(3.5) * math.exp(-((3.0 - math.pi) ** 2) - (3.5 - math.pi) ** 2)
    )


def test_the_domains_are_those_that_are_customary():
    for function, (_, _, extent) in NAIVE.items():
        lower, upper = function_problem(f"function:{function}-4-shifted:2").bounds
        assert set(lower) == {-extent}
        assert set(upper) == {extent}


@functions
def test_a_shifted_function_is_the_same_moved_with_the_domain_left_in_place(function):
    plain, moved = (function_problem(f"function:{function}-4{end}") for end in ("", "-shifted:5"))
    by = np.subtract(moved.scenario.optimum, plain.scenario.optimum)
    for vector in np.random.default_rng(0).uniform(-4.0, 4.0, (20, 4)):
        assert moved.evaluate(vector + by)[0] == pytest.approx(plain.evaluate(vector)[0], abs=1e-10)
    np.testing.assert_array_equal(plain.bounds, moved.bounds)
    np.testing.assert_array_equal(moved.bounds, moved.initial_bounds)


def test_out_of_a_stack_every_problem_keeps_its_values():
    problems = [function_problem(f"function:{function}-4-shifted:3") for function in FUNCTIONS]
    tables, vector = stack([problem.table for problem in problems]), [-3.0, -1.5, 0.25, 2.0]
    for number, problem in enumerate(problems):
        assert evaluate_entry(compiled(select)(tables, number), as_path(vector)) == problem.evaluate(vector)


def test_repair_changes_nothing():
    vector = np.array([1.0, -2.0, 3.0])
    assert (function_problem("function:rastrigin-3").repaired(vector, 1.0) == vector).all()


def test_values_in_the_plane_have_the_optimum_in_the_other_components():
    problem = function_problem("function:rastrigin-5-shifted:1")
    x, y = np.array([-1.0, 0.5, 2.0]), np.array([3.0, -4.0])
    values = values_in_plane(problem.table, x, y)
    for row, second in enumerate(y):
        for column, first in enumerate(x):
            vector = [first, second, *problem.scenario.optimum[2:]]
            assert values[row, column] == problem.evaluate(vector)[0]
    one = function_problem("function:sum-squares-1")
    np.testing.assert_array_equal(values_in_plane(one.table, x, y[:1]), [x**2])


def test_points_are_parallel_coordinates():
    problem = function_problem("function:booth-4")
    vectors = np.arange(12.0).reshape(3, 4)
    points = problem.points(vectors)
    assert points.shape == (3, 4, 2)
    np.testing.assert_array_equal(points[..., 1], vectors)
    np.testing.assert_array_equal(points[1, :, 0], [1, 2, 3, 4])
    for shape in ((), (3,), (4, 1)):
        with pytest.raises(ValueError, match="broadcast"):
            problem.points(np.zeros(shape))


# Names.


def test_a_name_says_function_dimension_and_where_the_optimum_is():
    made = make_scenario("function:sum-squares-12")
    assert (made.function, made.dimension, made.optimum) == ("sum-squares", 12, (0.0,) * 12)
    assert make_scenario("function:booth-4").optimum == (1.0, 3.0, 1.0, 3.0)
    assert make_scenario("function:easom-3").optimum == (math.pi,) * 3
    assert len(set(make_scenario("function:easom-3-shifted:0").optimum)) == 3


def test_a_range_stands_for_all_its_numbers():
    names = expand_name("function:sum-squares-10-shifted:8-11")
    assert names == tuple(f"function:sum-squares-10-shifted:{number}" for number in (8, 9, 10, 11))
    assert [made.name for made in make_scenarios("function:rastrigin-2-shifted:0-1")] == [
        "function:rastrigin-2-shifted:0",
        "function:rastrigin-2-shifted:1",
    ]


def test_shifted_optima_spread_over_the_middle_of_the_domain():
    optima = np.array([made.optimum for made in make_scenarios("function:rastrigin-2-shifted:0-499")])
    assert np.abs(optima).max() <= 0.8 * 5.12
    np.testing.assert_allclose(
        np.quantile(optima, [0.25, 0.5, 0.75], axis=0).T / 5.12, [[-0.4, 0, 0.4]] * 2, atol=0.1
    )
    assert len(np.unique(optima)) == 1000


def test_shifted_optima_do_not_change():
    """Check that optima stay where they are, since published results refer to them."""
    names = [f"function:{function}-10-shifted:0-9" for function in FUNCTIONS]
    optima = [made.optimum for name in names for made in make_scenarios(name)]
    assert hashlib.sha256(np.array(optima, dtype="<f8").tobytes()).hexdigest()[:16] == "eea981d5b134bec7"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("function:", ["function:<function>-<dimension>", "rastrigin"]),
        ("function:rastrigin", ["<dimension>"]),
        ("function:rastrigin-02", ["<dimension>"]),
        ("function:rastrigin-2:7", ["<dimension>"]),
        ("function:rastrigin-2\n", ["<dimension>"]),
        ("function:rastrigin-0", ["<dimension>"]),
        ("function:rastrigin-1001", ["1, 2, ..., 1000", "1001"]),
        ("function:bohachevsky-1", ["2, 3, ..., 1000", "1"]),
        ("function:booth-3", ["2, 4, ..., 1000", "3"]),
        ("function:booth-3-shifted:1", ["2, 4, ..., 1000", "3"]),
        ("function:easom-2-shifted:", ["0-49", "''"]),
        ("function:easom-2-shifted:07", ["0-49", "'07'"]),
        ("function:easom-2-shifted:9-3", ["0-49", "'9-3'"]),
        ("function:easom-2-shifted:1000000", ["999999", "'1000000'"]),
    ],
)
def test_a_malformed_name_is_refused_with_what_was_expected(name, words):
    refused(lambda: make_scenario(name), repr(name), *words)


def test_an_unknown_function_is_refused_with_the_known_ones():
    refused(lambda: make_scenario("function:ackley-2"), "'ackley'", *FUNCTIONS, error=UnknownNameError)


def test_scenarios_of_ones_own_are_checked():
    made = FunctionScenario("mine", "booth", np.int64(2), (1, 2.5))
    assert (made.dimension, made.optimum) == (2, (1.0, 2.5))
    assert FunctionProblem(made).evaluate([1.0, 2.5]) == (0.0, 0.0)
    for dimension in (3, 2.0, True, "2"):
        refused(lambda d=dimension: FunctionScenario("mine", "booth", d), "'mine'", repr(dimension))
    for optimum in ((1.0,), (1.0, math.nan), (1.0, "x"), 3.0, [], None):
        refused(lambda o=optimum: FunctionScenario("mine", "booth", 2, o), "'mine'", "optimum")
    refused(lambda: FunctionScenario("mine", "booth", 2, (0.0, 10.5)), "component 2", "[-10.0, 10.0]", "10.5")


# Known optima, and options that test functions do not have.


def test_the_optimum_is_known_to_be_0_without_a_file(tmp_path, monkeypatch):
    monkeypatch.setenv("SWARM_GYM_CACHE", str(tmp_path))
    problem = function_problem("function:rastrigin-7-shifted:3")
    assert known_optimum(problem) == 0.0
    assert ensure_optima([problem]) == [0.0]
    assert not any(tmp_path.iterdir())


def test_a_function_has_no_path():
    refused(lambda: shortest_path(make_scenario("function:booth-2")), "'function:booth-2'", "no path")
    refused(lambda: AnalyticProblem(make_scenario("function:booth-2")), "'function:booth-2'", "test function")


def test_gaps_are_relative_to_the_optimum_but_absolute_where_that_is_0():
    found = gap_to_optimum([3.0, 0.25, 5.0], [2.0, 0.0, math.nan])
    np.testing.assert_array_equal(found, [0.5, 0.25, math.nan])


def test_problems_with_the_same_values_are_the_same_whatever_their_names():
    problem = function_problem("function:booth-2")
    twin = FunctionProblem(FunctionScenario("other", "booth", 2, (1, 3)))
    assert twin.identity == problem.identity
    for name in ("function:bohachevsky-2", "function:booth-4", "function:booth-2-shifted:0"):
        assert function_problem(name).identity != problem.identity


# Settings.


def problems_of(**options):
    return problems_for(Settings.from_options(Firefly, options))


def test_settings_make_the_problems_of_functions():
    problems = problems_of(scenario=["function:booth-2", "function:rastrigin-2-shifted:0-1"])
    assert [problem.scenario.function for problem in problems] == ["booth", "rastrigin", "rastrigin"]
    assert make_problem("function:booth-2") == problems[0]


@pytest.mark.parametrize(
    "option", ["encoding", "num_waypoints", "num_control_points", "length_weight", "penalty"]
)
def test_options_without_effect_on_functions_are_refused(option):
    value = getattr(Settings, option)
    words = repr(option), "test functions", "has no effect"
    refused(lambda: problems_of(scenario=NAMES, **{option: value}), *words, error=SettingError)
    refused(lambda: make_problem(NAMES[0], **{option: value}), *words, error=SettingError)


@pytest.mark.parametrize("other", ["case1", "rooms:0", "function:booth-4"])
def test_scenarios_of_another_kind_or_dimension_are_refused_by_name(other):
    for names in (["function:booth-2", other], [other, "function:booth-2"]):
        refused(lambda n=names: problems_of(scenario=n), *map(repr, names), error=SettingError)


def test_scenarios_are_made_once(monkeypatch):
    made = []
    monkeypatch.setattr(
        "swarm_gym.settings.make_scenarios", lambda name: made.append(name) or make_scenarios(name)
    )
    problems_of(scenario=["case1", "case2"], num_waypoints=9)
    assert made == ["case1", "case2"]
