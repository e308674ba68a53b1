"""The benchmark measures what it says: same problem, same moves; and its page shows what was measured."""

import multiprocessing
import re
from collections import Counter
from functools import cache, partial

import numba
import numpy as np
import pytest
from scipy.stats import ks_2samp

from experiments import benchmark_gpu
from experiments.benchmark import GROUPS, measure_groups
from experiments.speed import environments, gpu, growth, moves, start, threads, training
from experiments.speed.benchmark_page import write_page
from experiments.speed.measurement import (
    ALL_THREADS,
    CASES,
    IN_NUMPY,
    NUMPY_COST,
    Measurement,
    Quantity,
    measure,
    measured_before,
    medians,
    read_measurements,
    write_measurements,
)
from experiments.speed.numpy_firefly import NumpyFirefly
from experiments.speed.peers import comparisons
from experiments.speed.peers.cost import compiled_cost, numpy_cost
from experiments.speed.peers.runs import Peer, ours_per_evaluation, ratios
from helpers.slow import slow_but
from oracles import naive_grid
from swarm_gym.errors import UnknownNameError
from swarm_gym.problem import AnalyticProblem, GridProblem
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario
from swarm_gym.vector_env import SwarmVectorEnv


@pytest.mark.parametrize("case", CASES)
def test_the_numpy_version_has_the_same_cost(case):
    problem = AnalyticProblem(make_scenario(case))
    swarm = NumpyFirefly(problem, 2, seed=0)
    rng = np.random.default_rng(1)
    for spread in (5.0, 60.0, 250.0):
        for _ in range(100):
            position = rng.uniform(-spread, spread, 31)
            assert swarm.evaluate(position) == pytest.approx(problem.evaluate(position)[0], rel=1e-12)


def test_the_numpy_version_converges_like_the_kernels():
    problem, size, iterations = AnalyticProblem(make_scenario("case3")), 12, 5
    theirs, seeds = [], 40
    for seed in range(seeds):
        swarm = NumpyFirefly(problem, size, seed)
        for _ in range(iterations):
            swarm.iterate()
        theirs.append(swarm.fitness.mean())
    env = SwarmVectorEnv(seeds, scenario="case3", initial_population_size=size)
    env.reset(seed=0)
    for _ in range(iterations):
        env.step(np.tile([size, 0.0], (seeds, 1)))
    ours = env.simulation.swarms.fitness[:, :size].mean(axis=1)
    assert ks_2samp(ours, theirs).pvalue > 0.01


def assert_is_fitness(cost, fitness, vectors):
    """Assert that a cost function gives that fitness, one after the other and all at once."""
    assert cost.of_many(vectors) == pytest.approx(fitness, rel=1e-12)
    assert [cost.of_one(vector) for vector in vectors] == pytest.approx(fitness, rel=1e-12)


def numbered(quantities):
    """Return a measurement for each quantity, no two alike."""
    return [Measurement(q.name, q.unit, n + 1.0, n + 0.5, n + 2.0) for n, q in enumerate(quantities)]


@pytest.fixture(scope="module")
def curves():
    return comparisons.grid_problem()


def test_other_libraries_get_the_fitness_of_the_kernel_or_that_of_samples(curves):
    rng = np.random.default_rng(1)
    anywhere = rng.uniform(*curves.bounds, (60, curves.dimension))
    # Control points on the straight line and a little beside it, so that few samples are infeasible.
    line = np.linspace(curves.scenario.start, curves.scenario.target, comparisons.NUM_CONTROL_POINTS + 2)[
        1:-1
    ]
    near = line.T.ravel() + rng.normal(0.0, 10.0, (60, curves.dimension))
    corners = np.stack(curves.bounds)
    vectors = np.concatenate([anywhere, np.clip(near, *curves.bounds), corners])
    assert_is_fitness(compiled_cost(curves), [curves.evaluate(vector)[0] for vector in vectors], vectors)
    oracle = naive_grid.Problem(curves)
    fitness = [oracle.sampled_fitness(vector) for vector in vectors]
    assert_is_fitness(numpy_cost(curves), fitness, vectors)
    assert min(fitness) < 50 * curves.penalty < max(fitness)


def test_the_numpy_fitness_knows_the_size_of_cells_and_where_they_lie():
    blocked = np.random.default_rng(0).random((12, 20)) < 0.3
    blocked[[2, 8], [1, 17]] = False
    blocked[:, 1] = blocked[8] = False
    grid = GridMap("small", blocked, resolution=0.5, origin=(-3.0, 7.0), y_up=True)
    start, target = grid.to_map([(1, 2), (17, 8)])
    problem = GridProblem(GridScenario("small", grid, tuple(start), tuple(target)), num_points=3, penalty=2.5)
    vectors = np.random.default_rng(1).uniform(*problem.bounds, (50, problem.dimension))
    oracle = naive_grid.Problem(problem)
    assert_is_fitness(numpy_cost(problem), [oracle.sampled_fitness(vector) for vector in vectors], vectors)


def test_a_peer_is_measured_with_every_cost_and_compared_with_ours():
    runs = []

    def run(problem, cost, size, iterations):
        runs.append((cost.name, size, iterations))
        cost.of_many(np.zeros((size, problem.dimension)))
        return size * (iterations + 1)

    peers = (Peer("A", "particle-swarm", run), Peer("B", "elite-genetic", run))
    quantities = list(comparisons.curve_quantities(peers))
    for quantity in quantities:
        if ": A," in quantity.name:
            assert quantity.once() > 0
    assert runs == [(name, 65, 100) for name in COSTS]
    assert_ratios(numbered(quantities), {"particle-swarm": "A", "elite-genetic": "B"})


COSTS = ("cost in NumPy", "our compiled cost")


def assert_ratios(measured, peers):
    """Assert that times of peers, whose names are given by problem, are divided by ours for either cost."""
    found = medians(measured)
    assert medians(ratios(measured)) == {
        f"{problem}: {peer}, {cost} / swarm_gym": found[f"{problem}: {peer}, {cost}"]
        / found[f"{problem}: swarm_gym"]
        for problem, peer in peers.items()
        for cost in COSTS
    }


def test_the_rastrigin_function_of_fish_swarms_is_the_known_one():
    assert comparisons.rastrigin(np.zeros(10)) == 0.0
    assert comparisons.rastrigin(np.ones(10)) == pytest.approx(10.0)
    assert comparisons.rastrigin(np.array([0.5, 2.0])) == pytest.approx(20.25 + 4.0)


@pytest.mark.parametrize(
    "scenario", [pytest.param(comparisons.FUNCTION, marks=pytest.mark.slow), comparisons.CASE]
)
def test_other_fish_swarms_get_the_fitness_of_the_kernel(scenario):
    problem = comparisons.fish_environment(scenario).simulation.problems[0]
    vectors = np.random.default_rng(1).uniform(*problem.bounds, (50, problem.dimension))
    for cost in (comparisons.path_cost(scenario), compiled_cost(problem)):
        assert_is_fitness(cost, [problem.evaluate(vector)[0] for vector in vectors], vectors)


@pytest.mark.slow  # kernels are compiled for it
def test_a_fish_swarm_is_measured_on_both_problems_and_compared_with_ours():
    runs = []

    def run(problem, cost, size, iterations):
        runs.append((problem.dimension, cost.name, size, iterations))
        return size * (iterations + 1)

    quantities = list(comparisons.fish_quantities((Peer("A", comparisons.FISH, run),)))
    for quantity in quantities:
        assert quantity.once() > 0
    assert runs == [(dimension, cost, 100, 10) for dimension in (10, 31) for cost in COSTS]
    assert_ratios(numbered(quantities), {comparisons.FUNCTION: "A", comparisons.CASE: "A"})


def test_a_figure_is_the_median_after_a_run_that_is_thrown_away_and_what_takes_long_is_measured_once():
    values = iter([100.0, 3.0, 1.0, 2.0, 5.0])
    figure = measure(Quantity("x", "s", lambda: next(values)), 3)
    assert figure == Measurement("x", "s", 2.0, 1.0, 3.0)
    assert measure(Quantity("x", "s", lambda: next(values), repeats=1), 3).median == 5.0


PARTS = [partial(moves.part_nanoseconds, "case1", part) for part in moves.PARTS.values()]


@pytest.mark.parametrize(
    "make",
    [
        pytest.param(lambda: environments.single(4), id="single"),
        pytest.param(lambda: environments.vector(3, 4, 1), id="vector"),
        pytest.param(lambda: moves.per_move("case2", 0.2, 3), id="move"),
        pytest.param(lambda: moves.run_milliseconds("case2"), id="run"),
        pytest.param(
            lambda: start.first_step(start.FIRST_STEP, cold=False), id="first step", marks=pytest.mark.slow
        ),
        # Each is compiled for this alone.
        *slow_but(
            [PARTS[-1]],
            [
                *PARTS,
                *(partial(moves.new_member_nanoseconds, "case1", one) for one in moves.NEW_MEMBERS.values()),
            ],
        ),
        *(
            lambda name=name: ours_per_evaluation(comparisons.curve_environment(name))
            for name in comparisons.WITH_CURVES
        ),
    ],
)
def test_what_is_measured_runs_again_and_again(make):
    once = make()
    for _ in range(4):  # past the end of an episode
        assert once() > 0


@pytest.mark.slow
def test_processes_run_side_by_side_and_end():
    before = set(multiprocessing.active_children())  # those of other tests
    with threads.processes(2, 2, 4, 100) as together:
        assert together() > 0
        assert together() > 0
        assert len(set(multiprocessing.active_children()) - before) == 2
    assert set(multiprocessing.active_children()) <= before


# Tables of pairs of many waypoints and obstacles take half a minute to make.
@pytest.mark.parametrize(
    "axis",
    [pytest.param(axis, marks=pytest.mark.slow if axis.name == "waypoints" else ()) for axis in growth.AXES],
    ids=lambda axis: axis.name,
)
def test_every_value_of_an_axis_is_an_environment(axis):
    for value in axis.values:
        SwarmVectorEnv(**axis.options(value))
    assert growth.megabytes(axis, axis.values[0])() > 0.01
    assert growth.microseconds(axis, axis.values[0])() > 0


@pytest.mark.parametrize("number", [4, 32])
def test_every_bar_is_near_every_segment(number):
    problem = AnalyticProblem(growth.bars(number))
    assert np.bincount([pair.segment for pair in problem.pairs]).tolist() == [number] * 32


def test_the_exponent_is_that_of_the_power():
    values = (10, 20, 40)
    results = [3.0 * value**1.7 for value in values]
    assert growth.exponent(values, results) == pytest.approx(1.7)
    assert growth.fitted_line(values, results) == pytest.approx(results)


def test_the_stopwatch_of_training_adds_up_what_a_method_takes():
    watch = training.Stopwatch(lambda a, b: a + b)
    assert watch(1, b=2) == 3
    first = watch.seconds
    watch(1, 2)
    assert watch.seconds > first > 0


def test_a_group_that_is_not_there_is_refused_before_anything_is_measured():
    with pytest.raises(UnknownNameError, match="nonsense"):
        measure_groups(("moves", "nonsense"), repeats=5)


def test_new_members_are_compared_with_uniform_ones():
    quantities = numbered(moves.quantities())
    found = {m.name: m.median for m in quantities}
    ratios = {m.name: m.median for m in moves.summary(quantities)}
    uniform = found["case2: new member, uniform"]
    assert ratios["case2: new member, smooth / uniform"] == found["case2: new member, smooth"] / uniform


# The page.


@cache
def counted(group):
    """Measurements of a group, with its summary."""
    made = numbered(GROUPS[group].quantities())
    return made + GROUPS[group].summary(made)


@pytest.mark.parametrize("with_peers", slow_but([True], [False, True]))
def test_the_page_shows_every_quantity_and_the_headline_its_numbers(tmp_path, with_peers):
    groups = {name: counted(name) for name in GROUPS}
    write_measurements(tmp_path / "benchmark.json", groups)
    if with_peers:
        cases = [
            Measurement(f"{case}: {peer} / swarm_gym", "times", 7.0, 7.0, 7.0)
            for case in CASES
            for peer in ("NumPy", NUMPY_COST)
        ]
        curves = [
            Measurement(f"particle-swarm: A, {cost} / swarm_gym", "times", 9.0, 9.0, 9.0)
            for cost in (IN_NUMPY, "our compiled cost")
        ]
        schools = [Measurement(f"case1: B, {IN_NUMPY} / swarm_gym", "times", 8.0, 8.0, 8.0)]
        measured = {"peers": cases, "bezier-peers": curves, "fish-peers": schools}
        write_measurements(tmp_path / "peers.json", measured)
    page = write_page(tmp_path).read_text()
    for measurements in groups.values():
        for m in measurements:
            assert f"| {m.name} |" in page
    head = page.split("**")[2]  # below the caption of the first table
    assert (f"| case2: {NUMPY_COST} / swarm_gym | 7 |" in head) == with_peers
    assert ("| particle-swarm: A, cost in NumPy / swarm_gym | 9 |" in head) == with_peers
    assert ("| case1: B, cost in NumPy / swarm_gym | 8 |" in head) == with_peers
    assert "our compiled cost" not in head
    found = {m.name: m.median for m in groups["environments"] + groups["moves"]}
    for name in (environments.name(64, 60, ALL_THREADS), "case2: NumPy / swarm_gym"):
        assert f"| {name} | {found[name]:.3g} |" in head
    assert (tmp_path / "growth.svg").read_bytes().startswith(b"<?xml")


def test_peers_of_another_machine_or_version_are_refused(tmp_path):
    for name in ("benchmark.json", "peers.json"):
        write_measurements(tmp_path / name, {"start": counted("start")})
    stored = (tmp_path / "peers.json").read_text()
    (tmp_path / "peers.json").write_text(stored.replace('"commit": "', '"commit": "0'))
    with pytest.raises(ValueError, match=r"peers\.json is of another machine or version"):
        write_page(tmp_path)


def test_groups_of_the_same_version_are_kept_and_of_another_are_not(tmp_path):
    file = tmp_path / "benchmark.json"
    assert measured_before(file) == {}
    write_measurements(file, {"start": counted("start")})
    assert measured_before(file) == {"start": counted("start")} == read_measurements(file)[1]
    assert read_measurements(file)[0]["threads"] == ALL_THREADS
    file.write_text(file.read_text().replace('"commit": "', '"commit": "0'))
    assert measured_before(file) == {}


def test_two_quantities_of_one_name_are_refused():
    with pytest.raises(ValueError, match="'x' was measured twice"):
        medians([Measurement("x", "s", 1.0, 1.0, 1.0)] * 2)


def test_a_page_of_some_groups_has_no_headline(tmp_path):
    write_measurements(tmp_path / "benchmark.json", {"start": counted("start")})
    page = write_page(tmp_path).read_text()
    assert "Import, first step, memory" in page
    assert "Speed on" not in page
    assert not (tmp_path / "growth.svg").exists()


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"machine": {}, "groups": {"moves": [{"name": 1}]}}'])
def test_a_file_of_something_else_is_refused_by_name(tmp_path, content):
    file = tmp_path / "x.json"
    file.write_text(content)
    with pytest.raises(ValueError, match=re.escape(str(file))):
        read_measurements(file)


def test_the_bound_of_a_gpu_counts_the_obstacles_over_the_fullest_block():
    problem = AnalyticProblem(make_scenario("case1"))
    assert {pair.circle is None for pair in problem.pairs} == {False}
    # A tile has one obstacle for each of the eight segments of a block: as many tiles as the fullest segment.
    most = Counter(pair.segment for pair in problem.pairs)
    fullest = max(most.values())
    fixed = gpu.MOVE_OPERATIONS + gpu.SEGMENT_OPERATIONS
    assert gpu.operations_of_a_move("case1") == 32 * (fixed + fullest * gpu.CIRCLE_OPERATIONS)


def test_registers_are_those_of_the_kernel_in_float64_though_one_in_float32_is_compiled():
    def arguments(number):
        return tuple(numba.typeof(np.zeros((1, 1), number)) for _ in range(gpu.PARAMETERS + 1))

    variants = {arguments(np.float32): 120, arguments(np.float64): 96}
    assert gpu.registers_of(variants, np.float64) == 96
    assert gpu.registers_of(variants, np.float32) == 120


def test_the_benchmark_of_a_gpu_refuses_where_there_is_none(monkeypatch):
    torch = pytest.importorskip("torch")
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    monkeypatch.setattr("sys.argv", ["benchmark_gpu"])
    with pytest.raises(SystemExit, match="device 'cuda': torch finds no GPU here"):
        benchmark_gpu.main()


def test_a_summary_of_a_gpu_sets_its_rates_beside_the_cpu_and_the_bound():
    names = [quantity.name for quantity in gpu.quantities()]
    assert len(set(names)) == len(names)
    made = [Measurement(name, "", 2.0, 2.0, 2.0) for name in names]
    assert [found.median for found in gpu.summary(made)] == [1.0, 100.0]
