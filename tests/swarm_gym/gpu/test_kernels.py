"""Kernels for GPUs move, repair, evaluate, draw and count as those of the CPU do."""

import numba
import numpy as np
import pytest
from scipy.stats import ks_2samp

from helpers.devices import Pair
from swarm_gym.arrays import as_numpy
from swarm_gym.compiler.random_stream import fill_uniform, seed_stream
from swarm_gym.problem.geometry.bends import STOMP
from swarm_gym.problem.tables import stack
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.worlds import make_problem

CASES = ("case1", "case2", "case3")
FUNCTIONS = ("rastrigin-10", "sum-squares-10", "easom-2", "booth-2", "bohachevsky-2")


@pytest.mark.parametrize("rounds", [1, 2, 4])
def test_a_warp_draws_the_numbers_of_the_cpu(rounds):
    from swarm_gym.gpu.random_stream import draw, load_stream, store_stream
    from swarm_gym.gpu.state import as_kernels_see, torch_device
    from swarm_gym.gpu.warps import entry, lane_number, launch, swarm_number, wait

    torch = pytest.importorskip("torch")

    @entry
    def draw_twice(streams, numbers):
        b, lane = swarm_number(), lane_number()
        stream = load_stream(streams, b, lane)
        numbers[b, 0, lane], stream = draw(stream, lane, rounds)
        numbers[b, 1, lane], stream = draw(stream, lane, rounds)
        wait()  # four lanes have loaded the same stream
        store_stream(streams, b, lane, stream)

    streams = np.stack([seed_stream(np.random.SeedSequence(seed)) for seed in range(3)])
    words = torch.as_tensor(streams.view(np.int64).copy(), device=torch_device())
    numbers = torch.zeros((3, 2, 32), dtype=torch.float64, device=torch_device())
    launch(draw_twice, 3, as_kernels_see(words).view(np.uint64), as_kernels_see(numbers))
    for b in range(3):
        expected = np.empty((2, 8 * rounds))
        for row in expected:
            fill_uniform(streams[b], row)
        np.testing.assert_array_equal(numbers[b, :, : 8 * rounds].cpu(), expected)
        assert not numbers[b, :, 8 * rounds :].any()
        np.testing.assert_array_equal(words[b].cpu().numpy().view(np.uint64), streams[b])


@pytest.mark.parametrize("phi", [0.0, 0.7])
@pytest.mark.parametrize("case", CASES)
def test_one_move_is_that_of_the_cpu(case, phi):
    pair = Pair(scenario=case, initial_population_size=2)
    pair.reset(seed=3)
    pair.assert_alike()
    pair.step(2, phi)
    assert pair.cpu.swarms.evaluations[0] == 3  # one of two fireflies has moved
    pair.assert_alike()


@pytest.mark.parametrize("case", CASES)
def test_the_first_iterations_of_each_case_are_those_of_the_cpu(case):
    pair = Pair(scenario=case)
    pair.reset(seed=1)
    for size, phi in ((4, 0.0), (6, 0.4), (3, 1.0), (3, 0.0), (4, 0.2)):
        pair.step(size, phi)
        pair.assert_alike()


@pytest.mark.parametrize("phi", [0.0, 0.7])
@pytest.mark.parametrize("case", CASES)
def test_in_float32_a_move_is_that_of_the_cpu_but_for_rounding(case, phi):
    pair = Pair(scenario=case, initial_population_size=2, precision="float32")
    pair.reset(seed=3)
    pair.step(2, phi)
    ours, theirs = pair.cpu.swarms, pair.gpu.swarms
    assert theirs.evaluations.tolist() == ours.evaluations.tolist() == [3]
    assert {str(theirs.fitness.dtype), str(theirs.positions.dtype)} == {"torch.float32"}
    np.testing.assert_allclose(theirs.fitness[0, :2].cpu(), ours.fitness[0, :2], rtol=3e-6)
    np.testing.assert_allclose(theirs.positions[0, :2].cpu(), ours.positions[0, :2], rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("optimizer", ["firefly", "particle-swarm"])
def test_in_float32_a_test_function_is_that_of_the_cpu_but_for_rounding(optimizer):
    pair = Pair(optimizer, scenario="function:rastrigin-10", precision="float32")
    pair.reset(seed=2)
    for size in (5, 3):
        pair.step(size)
    ours, theirs = pair.cpu.swarms, pair.gpu.swarms
    assert theirs.evaluations.tolist() == ours.evaluations.tolist()
    np.testing.assert_allclose(theirs.fitness[0, :3].cpu(), ours.fitness[0, :3], rtol=1e-3)


@pytest.mark.parametrize("source", [{"source": "mixed", "smooth_share": 0.5}, {"source": "guided"}])
@pytest.mark.parametrize("bends", ["harmonics", "stomp"])
def test_new_members_of_all_sources_are_those_of_the_cpu(bends, source):
    options = {"bends": bends, **source}
    pair = Pair("particle-swarm", scenario="case2", window=5, **options)
    pair.reset(seed=2)
    pair.assert_alike()
    for size, decided in ((8, (1.0, 0.3, 0.0)), (6, (0.4, 0.8, 0.5)), (7, (0.0, 0.1, 1.0))):
        pair.step(size, 0.3, decided)
        pair.assert_alike()


def test_in_float32_a_bend_is_finite_where_random_numbers_round_to_one():
    from swarm_gym.gpu.state import as_kernels_see, tables_with_lanes, torch_device
    from swarm_gym.gpu.warps import entry, lane_number, launch
    from swarm_gym.gpu.waypoints import draw_bend

    torch = pytest.importorskip("torch")
    amplitude, nearly_one = np.float32(0.5), 1.0 - 2.0**-53

    @entry
    def bend(tables, noise, places):
        lane = lane_number()
        places[lane] = draw_bend(tables, 0, lane, amplitude, STOMP, noise[lane], 1.0)

    tables = tables_with_lanes(stack([make_problem("case1").table]), np.float32)
    placed = type(tables)._make(torch.as_tensor(array, device=torch_device()) for array in tables)
    noise = torch.full((32,), nearly_one, dtype=torch.float64, device=torch_device()).float()
    places = torch.zeros_like(noise)
    launch(bend, 1, *map(as_kernels_see, (placed, noise, places)))
    assert noise[0] == 1.0
    assert torch.isfinite(places).all()
    assert places.any()


@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize("optimizer", ["firefly", "particle-swarm"])
def test_test_functions_are_those_of_the_cpu(optimizer, function):
    pair = Pair(optimizer, scenario=f"function:{function}")
    pair.reset(seed=4)
    for size in (5, 8, 2):
        pair.step(size)
        pair.assert_alike()


def test_few_waypoints_leave_lanes_idle():
    pair = Pair(scenario="case1", num_waypoints=5)
    pair.reset()
    for size in (5, 3):
        pair.step(size, 0.5)
        pair.assert_alike()


def test_a_budget_is_never_exceeded():
    pair = Pair(scenario="function:rastrigin-10", max_evaluations=20, num_swarms=2)
    pair.reset()
    while pair.cpu.running.any():
        pair.step(6)
        pair.assert_alike()
    assert pair.gpu.swarms.evaluations.tolist() == [20, 20]
    assert not pair.gpu.running.any()


def test_a_given_population_begins_the_episode():
    pair = Pair("particle-swarm", scenario="case3")
    given = np.linspace(-40.0, 60.0, 3 * 31).reshape(3, 31)
    pair.reset(initial_population=given)
    pair.assert_alike()
    pair.step(3)
    pair.assert_alike()


@pytest.mark.parametrize("optimizer", ["firefly", "particle-swarm"])
def test_after_an_event_the_memory_is_evaluated_anew(optimizer):
    pair = Pair(optimizer, scenario="dynamic:case1-gate@2", iterations=4)
    pair.reset()
    worlds = set()
    for _ in range(3):
        pair.step(3)
        pair.assert_alike()
        worlds.update(pair.gpu.swarms.problem.tolist())
    assert worlds == {0, 1}


def test_swarms_do_not_depend_on_their_number():
    together, alone = (
        Pair(scenario="function:rastrigin-10", num_swarms=3),
        Pair(scenario="function:rastrigin-10"),
    )
    together.reset()
    alone.reset()
    for size in (6, 4):
        together.step(size)
        alone.step(size)
    for name in ("fitness", "positions", "stream", "best_position"):
        first, only = getattr(together.gpu.swarms, name)[0], getattr(alone.gpu.swarms, name)[0]
        np.testing.assert_array_equal(first.cpu(), only.cpu())


@pytest.mark.skipif(
    bool(numba.config.ENABLE_CUDASIM),
    reason="NUMBA_ENABLE_CUDASIM=1 turns on the simulator, in which whole episodes take hours",
)
@pytest.mark.parametrize("case", CASES)
def test_final_fitness_has_the_distribution_of_the_cpu(case):
    options = {"scenario": case, "iterations": 30, "initial_population_size": 30, "max_population_size": 60}
    found = []
    for device, seed in (("cpu", 0), ("cuda", 1_000)):  # other seeds, so that the samples are independent
        env = SwarmVectorEnv(512, device=device, autoreset_mode="Disabled", **options)
        env.reset(seed=seed)
        for _ in range(options["iterations"]):
            env.step(np.tile([30.0, 0.1], (512, 1)))
        found.append(as_numpy(env.simulation.swarms.best_fitness))
    assert ks_2samp(*found).pvalue > 0.001
