"""Functions that `ioh` keeps, under adapted optimizers: values, counts, contracts and messages."""

import copy
import pickle
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from helpers.adapted import adapted, episode_of
from helpers.libraries import RandomSteps
from helpers.loops import looped
from helpers.slow import slow_but
from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import MissingExtraError, ScenarioError, SettingError, UnknownNameError
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.registration import environment_id
from swarm_gym.rendering.function_view import RESOLUTION
from swarm_gym.scenarios import IohScenario, expand_name, make_scenario
from swarm_gym.scenarios.ioh_scenario import called
from swarm_gym.settings import Settings
from swarm_gym.simulation import Decisions, Simulation
from swarm_gym.testing import check_optimizer, check_scenario
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.worlds import make_problem

ioh = pytest.importorskip("ioh", reason="needs the extra `benchmarks`")

NAME, COMPILED = "ioh:bbob-15-5-2", "function:bbob-15-5-2"
OPTIONS = {"iterations": 6, "initial_population_size": 9}
SIZES = [9, 14, 5, 2, 8, 8]
FUNCTIONS = pytest.mark.parametrize("function", range(1, 25))


def counted(name=NAME):
    """Return ioh's object of a function, with its count at 0."""
    problem = make_scenario(name).ioh_problem
    problem.reset()
    return problem


def advance(env, sizes=SIZES):
    return [env.step(np.array([size, 0.4]))[-1]["best_fitness"] for size in sizes]


# Values.


@FUNCTIONS
@looped("dimension", [2, 5])
def test_values_are_those_of_the_compiled_function(function, dimension):
    theirs = make_problem(f"ioh:bbob-{function}-{dimension}-3")
    ours = make_problem(f"function:bbob-{function}-{dimension}-3")
    np.testing.assert_allclose(theirs.scenario.optimum, ours.scenario.optimum, rtol=1e-12, atol=1e-14)
    vectors = np.random.default_rng(function).uniform(-5.0, 5.0, (100, dimension))
    found = [theirs.evaluate(vector)[0] for vector in vectors]
    np.testing.assert_allclose(found, ours.values(vectors), rtol=1e-9, atol=1e-9)
    assert theirs.bounds[0].tolist() == ours.bounds[0].tolist() == [-5.0] * dimension


@pytest.mark.parametrize("name", ["ioh:sbox-8-5-1", "ioh:cec2022-1001-10-1", "ioh:cec2022-1012-2-1"])
def test_the_least_value_of_every_suite_is_0_at_the_optimum_inside_the_domain(name):
    problem = make_problem(name)
    optimum, (low, high) = np.array(problem.scenario.optimum), problem.scenario.domain
    assert ((optimum >= low) & (optimum <= high)).all()
    assert problem.evaluate(optimum) == (pytest.approx(0.0, abs=1e-9), 0.0)
    assert problem.evaluate(np.full(len(optimum), 0.9 * high))[0] > 1.0
    assert problem.repaired(optimum, 1.0).tolist() == optimum.tolist()


# Episodes.


# The compiled function needs kernels that no other test compiles.
@pytest.mark.slow
@pytest.mark.parametrize("budget", [None, 40])
def test_an_episode_is_that_on_the_compiled_function(budget):
    found = []
    for scenario in (NAME, COMPILED):
        env = SwarmEnv("helpers.libraries:RandomSteps", scenario=scenario, max_evaluations=budget, **OPTIONS)
        course = [env.reset(seed=3)[1]]
        for size in SIZES:
            course.append(env.step(np.array([size, 0.4]))[-1])
            if env.simulation.swarms.evaluations[0] == budget:
                break
        entries = ("best_fitness", "feasible_fitness", "evaluations", "population_size")
        found.append([[info[entry] for entry in entries] for info in course])
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9, atol=1e-9)


@pytest.mark.slow
def test_newcomers_are_recorded_as_on_the_compiled_function():
    found = []
    for scenario in (NAME, COMPILED):
        simulation = Simulation(RandomSteps, Settings(scenario=scenario, **OPTIONS), 1, arrival_window=4)
        simulation.reset(np.array([True]), [np.random.SeedSequence(1)])
        for size in (3, 40, 3, 80):
            decisions = Decisions(np.array([size]), np.zeros(1), simulation.parameters, simulation.sources)
            simulation.step(np.array([True]), decisions)
        found.append(simulation.swarms.arrivals.tolist())
    assert found[0] == found[1]
    assert np.sum(found[0][0][1]) > 0.0


@pytest.mark.parametrize("name", adapted())
@pytest.mark.parametrize("scenario", slow_but([NAME], [NAME, "ioh:cec2022-1001-2-1"]))
def test_adapted_optimizers_keep_their_contract_on_it(name, scenario):
    check_optimizer(name, scenario)


@pytest.mark.parametrize("name", adapted())
def test_gymnasium_accepts_it(name):
    options = {"observation": "scaled", "action": "normalised", **OPTIONS}
    check_env(
        gymnasium.make(environment_id(name), scenario=NAME, **options).unwrapped, skip_render_check=True
    )


@pytest.mark.parametrize("name", adapted())
def test_evaluations_are_those_that_ioh_counts(name):
    problem = counted()
    env = SwarmEnv(name, scenario=NAME, **OPTIONS)
    assert env.reset(seed=0)[1]["evaluations"] == problem.state.evaluations == 9
    for size in SIZES:
        info = env.step(np.array([size, 0.4]))[-1]
        assert info["evaluations"] == problem.state.evaluations
    assert info["best_fitness"] == pytest.approx(problem.state.current_best.y - problem.optimum.y, rel=1e-9)


def test_a_vector_of_swarms_shares_the_count_and_its_bits_do_not_depend_on_it():
    problem = counted()
    envs = SwarmVectorEnv(3, "helpers.libraries:RandomSteps", scenario=NAME, **OPTIONS)
    envs.reset(seed=5)
    together = [envs.step(np.tile([size, 0.4], (3, 1)))[-1]["best_fitness"].tolist() for size in SIZES]
    assert envs.simulation.swarms.evaluations.sum() == problem.state.evaluations
    env = SwarmEnv("helpers.libraries:RandomSteps", scenario=NAME, **OPTIONS)
    for row in range(3):
        env.reset(seed=5 + row)
        assert advance(env) == [fitness[row] for fitness in together]


def test_a_copied_or_pickled_environment_goes_on_with_the_same_bits():
    env = SwarmEnv("helpers.libraries:RandomSteps", scenario=NAME, **OPTIONS)
    env.reset(seed=5)
    advance(env, SIZES[:3])
    copies = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    expected = advance(env, SIZES[3:])
    assert [advance(one, SIZES[3:]) for one in copies] == [expected, expected]


@pytest.mark.parametrize("controller", ["fixed:20", "linear-reduction", "spsfa"])
def test_controllers_of_the_project_decide_on_it(controller):
    made = make_controller(controller)
    options = {"scenario": "ioh:bbob-1-5-2", "iterations": 20, "max_evaluations": 600, **made.env_options()}
    env = SwarmEnv("helpers.libraries:RandomSteps", **options)
    first, info = episode_of(env, made)
    assert info["best_fitness"] < first
    assert 20 < info["evaluations"] <= 600


def test_loggers_of_ioh_record_a_run(tmp_path):
    problem = counted("ioh:bbob-1-2-1")
    # ioh does not keep the logger alive: without the name here, the process would crash.
    logger = ioh.logger.Analyzer(root=str(tmp_path), folder_name="run", algorithm_name="mine")
    problem.attach_logger(logger)
    try:
        env = SwarmEnv("helpers.libraries:RandomSteps", scenario="ioh:bbob-1-2-1", **OPTIONS)
        env.reset(seed=0)
        advance(env)
        problem.reset()
    finally:
        problem.detach_logger()
        logger.close()
    (data,) = tmp_path.rglob("*.dat")
    evaluations, values = np.loadtxt(data, skiprows=1).T
    assert values.min() == pytest.approx(env.simulation.swarms.best_fitness[0], rel=1e-6)
    assert evaluations[-1] == env.simulation.swarms.evaluations[0]


def test_pictures_and_checks_do_not_count():
    pytest.importorskip("pygame", reason="needs the extra `render`")
    problem = counted("ioh:bbob-1-2-1")
    env = SwarmEnv(
        "helpers.libraries:RandomSteps", scenario="ioh:bbob-1-2-1", render_mode="rgb_array", **OPTIONS
    )
    env.reset(seed=0)
    assert env.render().ndim == 3
    values = make_problem("ioh:bbob-1-2-1").values_in_plane(np.zeros(RESOLUTION), np.zeros(2))
    assert values.shape == (2, RESOLUTION)
    assert problem.state.evaluations == 9


def test_a_plane_has_the_optimum_in_the_other_components():
    problem = make_problem(NAME)
    values = problem.values_in_plane(np.array([-1.0, 0.5]), np.array([3.0]))
    rest = problem.scenario.optimum[2:]
    assert values.tolist() == [[problem.evaluate([x, 3.0, *rest])[0] for x in (-1.0, 0.5)]]


# Names and messages.


def test_a_name_makes_its_scenario_and_a_range_several():
    check_scenario(NAME, "helpers.libraries:RandomSteps")
    scenario = make_scenario(NAME)
    assert (scenario.suite, scenario.number, scenario.dimension, scenario.instance) == ("bbob", 15, 5, 2)
    assert scenario == IohScenario(NAME, "bbob-15", 5, 2)
    assert expand_name("ioh:bbob-15-5-2-4") == tuple(f"ioh:bbob-15-5-{number}" for number in (2, 3, 4))


def test_ioh_has_every_function_and_dimension_that_a_name_can_have():
    for number in range(1001, 1013):
        for dimension in (2, 10, 20):
            if dimension > 2 or number not in (1006, 1007, 1008):
                problem = called("cec2022", number, dimension, 1)
                assert problem(problem.optimum.x) == pytest.approx(problem.optimum.y)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("ioh:bbob-25-5-1", "bbob has the functions 1 to 24, got function 25"),
        ("ioh:bbob-8-1-1", "bbob has the dimensions 2 to 100, got dimension 1"),
        ("ioh:bbob-8-5-0", "bbob has the instances 1 to 1000, got instance 0"),
        ("ioh:bbob-8-5-9-1001", "bbob has the instances 1 to 1000, got instance 1001"),
        ("ioh:bbob-8-5-4-3", "the range of instances 4-3 is empty"),
        ("ioh:cec2022-1-10-1", "cec2022 has the functions 1001 to 1012, got function 1"),
        ("ioh:cec2022-1001-5-1", "cec2022 has the dimensions 2, 10, 20, got dimension 5"),
        ("ioh:cec2022-1007-2-1", "function 1007 of cec2022 has the dimensions 10, 20, got dimension 2"),
        ("ioh:bbob-8-5", "expected ioh:<suite>-<function>-<dimension>-<instance>.* such as ioh:bbob-8-5-1"),
        ("ioh:", "expected ioh:<suite>"),
    ],
)
def test_a_name_without_a_function_is_refused(name, message):
    with pytest.raises(ScenarioError, match=message):
        expand_name(name)


def test_a_wrong_suite_or_object_is_refused():
    with pytest.raises(UnknownNameError, match="suite of ioh 'pbo'; valid: bbob, cec2022, sbox"):
        expand_name("ioh:pbo-1-5-1")
    with pytest.raises(ScenarioError, match="suite and number of a function, such as bbob-8, got 'sphere'"):
        IohScenario("mine", "sphere", 2)
    with pytest.raises(ScenarioError, match=r"bbob has the dimensions 2 to 100, got dimension 2\.5"):
        IohScenario("mine", "bbob-1", 2.5)


@pytest.mark.parametrize("optimizer", [o for o in OPTIMIZERS if "waypoints" in get_optimizer(o).encodings])
def test_compiled_optimizers_say_who_can_call_it(optimizer):
    with pytest.raises(SettingError, match=rf"{NAME}.*{optimizer}.* is compiled.*swarm_gym\.adapters\.pymoo"):
        SwarmEnv(optimizer, scenario=NAME)


def test_where_ioh_is_missing_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "ioh", None)
    with pytest.raises(MissingExtraError, match=r"needs ioh.*swarm_gym\[benchmarks\]"):
        make_scenario("ioh:bbob-15-7-123")
    assert expand_name("ioh:bbob-15-7-123") == ("ioh:bbob-15-7-123",)
