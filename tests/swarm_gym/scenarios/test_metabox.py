"""The BBOB functions of MetaBox: their values against MetaBox and the oracle, their names, their draws."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.builders import as_path, function_problem
from helpers.compiled import compiled
from helpers.refusals import refused
from oracles.naive_swarm import oracle_of
from swarm_gym.env import SwarmEnv
from swarm_gym.problem.tables import evaluate_entry, select, stack
from swarm_gym.reference import known_optimum
from swarm_gym.scenarios import MetaBoxScenario, expand_name, make_scenario
from swarm_gym.scenarios.bbob.metabox_instance import SEED, MetaBoxInstance, RandomNumbers
from swarm_gym.scenarios.bbob.scenario import FUNCTIONS

functions = pytest.mark.parametrize("function", FUNCTIONS)

# Values that MetaBox itself computes. With the seed 3849 in ten dimensions, without f_opt: at ten numbers
# from -4 to 4, evenly spaced, and at 1.5, -2.5, 1.5, ... Then with the seed 7 in thirty dimensions, biased,
# f_opt included, at 1.5, -2.5, 1.5, ...
LINE, ZIGZAG = np.linspace(-4.0, 4.0, 10), np.tile([1.5, -2.5], 15)
VALUES = {
    1: (92.43210000617779, 136.7097900117347, 1291.5863760074096),
    2: (17185164.95445001, 50794397.69477698, 48385636.26032731),
    3: (667.2012655909382, 688.4460143332859, 3136.6188956231695),
    4: (9956.654599021746, 1259.0981819538902, 20556.529233785448),
    5: (209.4399314361121, 206.0009015087008, 2777.382267181236),
    6: (321784.0460290478, 135973.8618398397, 1098061.0892282156),
    7: (2513.5307864144306, 623.813022912362, 4243.545762157399),
    8: (139643.9544225394, 104194.2542560276, 428757.1872757264),
    9: (58573.20771277736, 28181.398741286466, 293243.22883395635),
    10: (3828701.6832639677, 2092487.9279514765, 6451089.09227719),
    11: (4341.1070676904465, 1004705.3331409593, 10776655.592734242),
    12: (801336406.2697096, 657273412.1523788, 703209570.3348279),
    13: (2201.5955367894644, 1992.3870171322314, 4682.5741902957325),
    14: (90.87868563773392, 169.8211382502538, 1504.9988216535892),
    15: (1670.7318307702756, 439.6954771577807, 4141.63576636577),
    16: (101.35633314166945, 140.5395479411657, 578.1753868772626),
    17: (18.694280478884856, 30.965021370283303, 2056.054341711049),
    18: (275.05351581880734, 383.1355233783981, 2521.653081850804),
    19: (41.22088828388268, 24.39812999474645, 2426.9933134040143),
    20: (49176.73744615357, 66116.12550100841, 192765.65527484484),
    21: (68.51878521164278, 79.70436131841646, 2285.3370869860246),
    22: (85.57926633288824, 79.34794047131156, 985.8684997569236),
    23: (18.781478612291036, 9.543095139251138, 707.886661181406),
    24: (240.97423076984774, 257.0807870500621, 1532.7156226538398),
}
# First component of x_opt in that first case, to all digits, and first entry of R for some functions.
OPTIMA = {1: -3.6200037268236773, 2: 1.2194800972633404, 4: 0.6032620562568625, 23: -3.692787533894414}
ROTATIONS = {1: -0.1193935701502723, 2: 0.0922275039047512, 18: -0.42373588279965335, 22: -0.4292963461905642}


def problem_of(function, more="-10"):
    return function_problem(f"metabox-bbob:{function}{more}")


# Values.


@functions
def test_values_are_those_of_metabox(function):
    line, zigzag, other = VALUES[function]
    problem = problem_of(function)
    np.testing.assert_allclose(problem.values([LINE, ZIGZAG[:10]]), [line, zigzag], rtol=1e-9)
    problem = problem_of(function, "-30-biased-seed:7")
    found = problem.evaluate(ZIGZAG)[0] + problem.scenario.least_value
    assert found == pytest.approx(other, rel=1e-9)


@functions
@settings(max_examples=7, deadline=None)
@given(st.data())
def test_values_are_those_of_the_definition(function, data):
    """Compare with the oracle, outside of the domain too."""
    more = data.draw(st.sampled_from(["-10", "-30", "-10-biased", "-10-seed:1", "-30-biased-seed:2"]))
    problem = problem_of(function, more)
    rng = np.random.default_rng(data.draw(st.integers(0, 10**6)))
    vector = rng.uniform(-6.0, 6.0, problem.dimension)
    expected, _ = oracle_of(problem).cost(vector.tolist())
    found, collision = problem.evaluate(vector)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert collision == 0.0


@functions
def test_the_value_at_the_optimum_is_0_and_larger_beside_it(function):
    problem = problem_of(function)
    optimum = np.array(problem.scenario.optimum)
    assert (np.abs(optimum) <= 5.0).all()
    assert 0.0 <= problem.evaluate(optimum)[0] <= 1e-13
    inwards = np.where(optimum > 0.0, -0.1, 0.1)
    for component in (0, 9):
        beside = optimum.copy()
        beside[component] += inwards[component]
        assert problem.evaluate(beside)[0] > 1e-7
    assert (known_optimum(problem), problem.lower_bound) == (0.0, 0.0)


def test_out_of_a_stack_every_problem_keeps_its_values_also_beside_those_of_bbob():
    problems = [problem_of(function) for function in FUNCTIONS]
    problems += [function_problem(f"function:bbob-{function}-10-1") for function in FUNCTIONS]
    tables = stack([problem.table for problem in problems])
    for number, problem in enumerate(problems):
        assert evaluate_entry(compiled(select)(tables, number), as_path(LINE)) == problem.evaluate(LINE)


def test_problems_are_told_apart_also_from_those_of_bbob():
    names = ("4-10", "5-10", "4-30", "4-10-biased", "4-10-seed:7")
    identities = {function_problem(f"metabox-bbob:{name}").identity for name in names}
    assert len(identities) == 5
    assert function_problem("function:bbob-4-10-7").identity not in identities


# What instances draw.


def test_optima_and_rotations_are_those_of_metabox():
    for function, first in OPTIMA.items():
        assert MetaBoxInstance(function, 10).optimum[0] == first
    for function, entry in ROTATIONS.items():
        assert MetaBoxInstance(function, 10).first_rotation[0, 0] == pytest.approx(entry, abs=1e-14)


def test_normal_numbers_are_those_of_numpy_to_the_last_place():
    """In an odd count, the second number of the last pair waits for the next draw."""
    expected, found = np.random.RandomState(5), RandomNumbers(5)
    for count in (10, 9, 1, 2, 7, 0, 3):
        np.testing.assert_allclose(found.normal(count), expected.normal(size=count), rtol=1e-15)
        np.testing.assert_array_equal(found.uniform(2, 3), expected.random_sample((2, 3)))
        assert found.whole(1, 26) == expected.randint(1, 26)
        np.testing.assert_array_equal(found.signs(4), expected.choice([-1.0, 1.0], size=4))


@pytest.mark.parametrize("dimension", [10, 11])
def test_rotations_are_orthogonal_and_keep_orientation(dimension):
    matrix = RandomNumbers(3).rotation(dimension)
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(dimension), atol=1e-12)
    assert np.linalg.det(matrix) == pytest.approx(1.0)


def test_the_least_value_is_a_whole_hundred_of_biased_functions_and_0_of_others():
    biased = [make_scenario(name).least_value for name in expand_name("metabox-bbob:test-10-biased")]
    assert set(biased) <= set(range(100, 2600, 100))
    assert len(set(biased)) > 5
    assert {make_scenario(name).least_value for name in expand_name("metabox-bbob:test")} == {0.0}


# Names.


def test_a_name_says_function_dimension_and_seed():
    made = make_scenario("metabox-bbob:15-30-biased-seed:12")
    assert (made.number, made.dimension, made.instance, made.biased) == (15, 30, 12, True)
    assert made.domain == (-5.0, 5.0)
    assert pickle.loads(pickle.dumps(made)) == made == make_scenario("metabox-bbob:15-30-biased-seed:12")
    assert made != make_scenario("metabox-bbob:15-30-seed:12")


def test_the_seed_of_metabox_has_no_name_of_its_own():
    assert make_scenario(f"metabox-bbob:4-10-seed:{SEED}").name == "metabox-bbob:4-10"
    assert expand_name("metabox-bbob:4-10-seed:3848-3850") == (
        "metabox-bbob:4-10-seed:3848", "metabox-bbob:4-10", "metabox-bbob:4-10-seed:3850",
    )  # fmt: skip


def test_sets_are_the_functions_for_training_and_for_tests():
    train, test = expand_name("metabox-bbob:train"), expand_name("metabox-bbob:test")
    assert [make_scenario(name).number for name in train] == [1, 2, 3, 5, 15, 16, 17, 21]
    assert sorted(make_scenario(name).number for name in train + test) == list(FUNCTIONS)
    assert expand_name("metabox-bbob:test-10") == test
    expected = [f"metabox-bbob:{part}-30-biased-seed:{seed}" for part in (1, 2) for seed in (5, 6)]
    assert list(expand_name("metabox-bbob:train-30-biased-seed:5-6")[:4]) == expected


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("metabox-bbob:25-10", ["functions 1 to 24", "function 25"]),
        ("metabox-bbob:0-10", ["functions 1 to 24", "function 0"]),
        ("metabox-bbob:4-5", ["dimensions 10 and 30", "dimension 5"]),
        ("metabox-bbob:test-20", ["dimensions 10 and 30", "dimension 20"]),
        ("metabox-bbob:4-10-seed:0", ["seeds 1 to 999999999", "seed 0"]),
        ("metabox-bbob:4-10-seed:3-1", ["<seed>", "metabox-bbob:4-10-seed:1-50"]),
        ("metabox-bbob:4-10-seed:", ["<seed>"]),
        ("metabox-bbob:4-10-seed:7-biased", ["<seed>"]),
        ("metabox-bbob:4", ["metabox-bbob:<function>-<dimension>"]),
        ("metabox-bbob:04-10", ["<dimension>"]),
        ("metabox-bbob:4-10\n", ["<dimension>"]),
        ("metabox-bbob:Sphere-10", ["<dimension>"]),
        ("metabox-bbob:validation", ["metabox-bbob:train"]),
    ],
)
def test_a_malformed_name_is_refused_with_what_was_expected(name, words):
    refused(lambda: make_scenario(name), repr(name), *words)


def test_scenarios_of_ones_own_are_checked():
    made = MetaBoxScenario("mine", "metabox-bbob-8", np.int64(30), instance=5)
    assert (made.number, made.dimension, made.instance) == (8, 30, 5)
    for function in ("metabox-bbob-25", "bbob-8", 8, None):
        refused(
            lambda f=function: MetaBoxScenario("mine", f, 10), "'mine'", repr(function), "metabox-bbob-24"
        )
    for dimension in (2, 10.0, True):
        refused(lambda d=dimension: MetaBoxScenario("mine", "metabox-bbob-8", d), "'mine'", repr(dimension))


# Environments.


def test_an_environment_draws_from_a_set_and_reports_the_gap():
    env = SwarmEnv("particle-swarm", scenario="metabox-bbob:test", iterations=5, max_population_size=40,
                   initial_population_size=30)  # fmt: skip
    scenarios = set()
    for seed in range(8):
        _, info = env.reset(seed=seed)
        scenarios.add(info["scenario"])
        ended = False
        while not ended:
            _, _, ended, _, info = env.step(np.array([30.0, 0.0]))
        assert info["optimality_gap"] == info["best_fitness"] >= 0.0
    assert len(scenarios) > 1
