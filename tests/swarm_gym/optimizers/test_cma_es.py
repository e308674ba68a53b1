"""CMA-ES; what holds for every optimizer is in test_optimizers.py."""

import gymnasium
import numpy as np
import pytest
from test_optimizers import PLAN, problems, run

from helpers.builders import advance, begin, function_problem, make_problem, oracle_twin
from helpers.loops import looped
from oracles import naive_cma
from oracles.naive_sources import Source
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.optimizers.cma_es.rates import write_weights
from swarm_gym.optimizers.cma_es.sampling import ranked, ranked_with_penalty
from swarm_gym.optimizers.cma_es.stalling import judge
from swarm_gym.optimizers.cma_es.state import (
    CONDITION,
    GENERATION,
    LONGEST_HISTORY,
    MOVEMENT,
    NO_REASON,
    NUM_COUNTS,
    PATH_LENGTH,
    REASON,
    RESTARTS,
    SINCE_BEST,
    STALLED,
    STEP_SIZE,
    layout,
    spread_out,
)

NAME = "cma-es"
NEVER = {"restarts": "degenerate"}


def state_of(swarms, n, b=0):
    """Return mean, paths and covariance of a swarm."""
    width, field = swarms.positions.shape[2], swarms.field[b]
    at = layout(width)
    paths = [field[first : first + n] for first in (at.mean, at.step_path, at.covariance_path)]
    square = field[at.covariance : at.covariance + width * width].reshape(width, width)
    return (*paths, square[:n, :n])


def assert_same_state(swarms, twin):
    mean, step_path, covariance_path, covariance = state_of(swarms, twin.problem.dimension)
    np.testing.assert_allclose(mean, twin.mean, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(step_path, twin.step_path, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(covariance_path, twin.covariance_path, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(covariance, twin.covariance, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(swarms.field[0, STEP_SIZE], twin.sigma, rtol=1e-9)
    assert swarms.registers[0, RESTARTS] == twin.restarts
    np.testing.assert_allclose(swarms.field[0, MOVEMENT], np.sum(twin.movement**2), rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("kind", ["analytic", "one waypoint"])
def test_the_distribution_is_the_naive_one_after_every_generation(kind):
    problem, source = problems(NAME)[kind], Source(immigrants=0.3)
    swarms, tables = begin(NAME, [problem], 7, source=source)
    twin = oracle_twin(NAME, problem, 7, source=source)
    assert_same_state(swarms, twin)
    for size, repair_degree in PLAN:
        values = advance(NAME, swarms, tables, size, repair_degree)
        twin.step(size, repair_degree, values)
        assert_same_state(swarms, twin)


@looped(
    "parameters",
    [
        {"step_factor": 0.5},
        {"step_factor": 2.0, "restarts": "degenerate"},
        {"restart": 1.0},
        {"restart": 0.5, "first_step": 0.05, "step_factor": 1.5},
        {"restart": 0.49},
    ],
)
def test_episodes_with_other_parameters_are_the_naive_ones(parameters):
    """A step that is twice as long at every generation soon leads out of the bounds everywhere."""
    swarms, twin = run(NAME, make_problem("case1", 9), PLAN[:6], parameters, size=7)
    assert_same_state(swarms, twin)
    assert twin.restarts == (6 if parameters.get("restart", 0.0) >= 0.5 else 0)


@looped(("dimension", "size"), [(n, size) for n in (1, 2, 10, 40) for size in (1, 2, 3, 4, 7, 10, 80)])
def test_weights_and_rates_are_those_of_the_tutorial(dimension, size):
    weights = np.empty(size)
    rates, expected = write_weights(weights, dimension), naive_cma.Settings(dimension, size)
    np.testing.assert_allclose(weights, expected.weights, rtol=1e-12)
    assert weights[: rates.parents].sum() == pytest.approx(1.0)
    assert (weights[rates.parents :] <= 0.0).all()
    found = rates.effective, rates.step_rate, rates.damping, rates.path_rate, rates.rank_one, rates.rank_mu
    np.testing.assert_allclose(
        found, [getattr(expected, name) for name in ("mueff", "cs", "ds", "cc", "c1", "cmu")], rtol=1e-12
    )
    assert (rates.parents, rates.expected_length) == (expected.mu, pytest.approx(expected.chi))
    assert rates.weight_sum == pytest.approx(weights.sum(), abs=1e-12)


def test_a_generation_is_ranked_by_fitness_and_by_distance_to_the_bounds():
    fitness = np.array([4.0, 1.0, 3.0, 2.0])
    order = ranked(fitness)
    assert order.tolist() == [1, 3, 2, 0]
    assert ranked_with_penalty(fitness, order, np.zeros(4)).tolist() == order.tolist()
    # The quartiles are 2 and 4: member 1 counts as 1 + 2 * 2 * 0.6 = 3.4.
    assert ranked_with_penalty(fitness, order, np.array([0.0, 0.6, 0.0, 0.0])).tolist() == [3, 2, 1, 0]
    assert ranked(np.array([1.0, 0.0, 1.0, 0.0])).tolist() == [1, 3, 0, 2]


def test_a_new_size_draws_and_evaluates_nothing_before_its_generation():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=6)
    for size in (20, 5, 20, 2):
        before = int(swarms.evaluations[0])
        advance(NAME, swarms, tables, size, 0.0)
        assert swarms.evaluations[0] - before == size == swarms.size[0]


def test_given_members_make_their_weighted_better_half_the_mean():
    problem = make_problem("case1", 9)
    population = np.random.default_rng(3).uniform(*problem.initial_bounds, (4, 9))
    swarms, _ = begin(NAME, [problem], size=4, populations=[population])
    first, second = population[np.argsort([problem.evaluate(one)[0] for one in population])[:2]]
    raw = np.log(2.5) - np.log([1.0, 2.0])
    expected = (raw[0] * first + raw[1] * second) / raw.sum()
    np.testing.assert_allclose(state_of(swarms, 9)[0], expected, rtol=1e-12)
    vectors = get_optimizer(NAME).decision_vectors(swarms, 0, 9)
    np.testing.assert_array_equal(vectors[-1], state_of(swarms, 9)[0][None])
    vectors[-1][:] = 0.0  # views, so that a robot that drives can move what they hold
    assert (state_of(swarms, 9)[0] == 0.0).all()


def test_a_restart_that_is_asked_for_begins_with_a_mean_from_the_source():
    problem = make_problem("case1", 9)
    swarms, tables = begin(NAME, [problem], size=8)
    for _ in range(5):
        advance(NAME, swarms, tables, 8, 0.0)
    best, spent = float(swarms.best_fitness[0]), int(swarms.evaluations[0])
    tiny = {"restart": 1.0, "first_step": 1e-6}
    advance(NAME, swarms, tables, 8, 0.0, tiny)
    assert (swarms.registers[0, RESTARTS], swarms.registers[0, GENERATION]) == (1, 1)
    assert swarms.evaluations[0] == spent + 8
    assert swarms.best_fitness[0] <= best
    low, high = problem.initial_bounds
    assert (low <= swarms.positions[0, :8, :9]).all()
    assert (swarms.positions[0, :8, :9] <= high).all()
    assert np.ptp(swarms.positions[0, :8, :9], axis=0).max() < 1e-4 * (high - low).max()


def broken(singular):
    """Return swarms whose covariance is about to become degenerate, and their tables."""
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=8)
    advance(NAME, swarms, tables, 8, 0.0)
    singular(swarms, state_of(swarms, 9)[3])
    return swarms, tables


def _flatten(_, covariance):
    covariance[0, 0] = 1e-30


def _turn_negative(_, covariance):
    covariance[3, 3] = -5.0


def _spoil(_, covariance):
    covariance[2, 1] = covariance[1, 2] = np.nan


def _explode(swarms, _):
    swarms.field[0, STEP_SIZE] = 1e30


def _vanish(swarms, _):
    swarms.field[0, STEP_SIZE] = 1e-300


def _stretch(_, covariance):
    covariance[4, 4] = 1e20


@pytest.mark.parametrize("restarts", ["stalled", "degenerate"])
@looped("singular", [_flatten, _turn_negative, _spoil, _explode, _vanish, _stretch])
def test_a_degenerate_distribution_begins_anew_and_nothing_is_nan(restarts, singular):
    swarms, tables = broken(singular)
    for _ in range(12):  # a covariance may need some generations to tell
        advance(NAME, swarms, tables, 8, 0.0, {"restarts": restarts})
        assert np.isfinite(swarms.positions).all()
        assert np.isfinite(swarms.fitness[0, :8]).all()
    assert swarms.registers[0, RESTARTS] >= 1
    assert np.isfinite(swarms.field).all()


def test_a_sound_distribution_does_not_begin_anew():
    swarms, tables = broken(lambda *_: None)
    for _ in range(12):
        advance(NAME, swarms, tables, 8, 0.0)
    assert swarms.registers[0, RESTARTS] == 0


def test_a_swarm_that_stalls_begins_anew_only_where_restarts_say_so():
    """With a step so small that it changes no mean, the swarm has stalled after one generation."""
    for parameters, restarts in (({}, 1), (NEVER, 0)):
        swarms, tables = begin(NAME, [make_problem("case1", 9)], size=10)
        swarms.field[0, STEP_SIZE] = 1e-30
        advance(NAME, swarms, tables, 10, 0.0, parameters)
        assert swarms.registers[0, RESTARTS] == 0
        advance(NAME, swarms, tables, 10, 0.0, parameters)
        assert swarms.registers[0, RESTARTS] == restarts


def judged(best, median, dimension=4, size=10, equal=False):
    """Return the reason after generations of these fitness values, with a distribution that stays round."""
    state, registers = np.zeros(layout(8).end), np.zeros(NUM_COUNTS, dtype=np.int64)
    spread_out(state, registers, 8, dimension, 0.3)
    ranges, order = np.ones(8), np.arange(size)
    for low, middle in zip(best, median, strict=True):
        fitness = np.full(size, low) if equal else np.linspace(low, 2.0 * middle - low, size)
        judge(state, registers, dimension, ranges, fitness, order, 0.3)
        registers[GENERATION] += 1
        if registers[REASON] == STALLED:
            break
    return int(registers[REASON]), int(registers[GENERATION])


def test_a_swarm_has_stalled_when_its_best_fitness_is_the_same_for_a_window():
    """The window has 10 + 30 n / lambda = 22 generations."""
    assert judged(np.full(60, 5.0), np.linspace(9.0, 8.0, 60)) == (STALLED, 22)
    assert judged(5.0 + np.arange(60) % 2, np.linspace(9.0, 8.0, 60)) == (NO_REASON, 60)
    # It may differ by rounding, where that of all members of a generation does.
    nearly = 5.0 + 1e-14 * np.arange(60)
    assert judged(nearly, nearly, equal=True) == (STALLED, 22)
    assert judged(nearly, nearly + 1.0) == (NO_REASON, 60)


def test_a_swarm_has_stalled_when_neither_best_nor_median_gets_better():
    """Medians of the first and the last 30 % of 132 generations are compared at every twentieth one."""
    noise = np.random.default_rng(0).uniform(0.0, 1.0, (2, 300))
    reason, generation = judged(5.0 + noise[0], 9.0 + noise[1])
    assert (reason, generation % 20) == (STALLED, 1)
    assert 132 <= generation < 300
    better = np.linspace(2.0, 0.0, 300)
    assert judged(5.0 + noise[0], 9.0 + noise[1] + better) == (NO_REASON, 300)
    assert judged(5.0 + noise[0] + better, 9.0 + noise[1] + better) == (NO_REASON, 300)


def test_numbers_for_observations_follow_the_swarm():
    swarms, tables = begin(NAME, [make_problem("case1", 9)], size=10)
    assert swarms.field[0, [STEP_SIZE, CONDITION, PATH_LENGTH]].tolist() == [0.3, 1.0, 0.0]
    since = 0
    for _ in range(10):
        best = swarms.best_fitness[0]
        advance(NAME, swarms, tables, 10, 0.0)
        since = 0 if swarms.best_fitness[0] < best else since + 1
        assert swarms.registers[0, SINCE_BEST] == since
        _, step_path, _, covariance = state_of(swarms, 9)
        assert swarms.field[0, CONDITION] == pytest.approx(np.linalg.cond(covariance), rel=1e-9)
        expected = np.linalg.norm(step_path) / naive_cma.Settings(9, 10).chi
        assert swarms.field[0, PATH_LENGTH] == pytest.approx(expected)


def test_a_history_of_any_length_stays_in_its_place():
    """Let more generations pass than the rings of best and median fitness have places."""
    swarms, tables = begin(NAME, [make_problem("case1", 1)], size=2, iterations=400)
    for _ in range(LONGEST_HISTORY + 5):
        advance(NAME, swarms, tables, 2, 0.0, {"step_factor": 1.05})
    at = layout(swarms.positions.shape[2])
    assert swarms.field.shape[1] == at.end
    assert np.isfinite(swarms.field).all()


def test_info_counts_restarts():
    options = {"scenario": "case1", "num_waypoints": 9, "iterations": 4, "initial_population_size": 6}
    env = gymnasium.make("swarm_gym/CmaEs-v0", action="extended", **options)
    _, info = env.reset(seed=3)
    assert info["restarts"] == 0
    for asked, counted in ((0.01, 0), (1.0, 1), (0.01, 1), (0.7, 2)):
        *_, info = env.step(np.array([6.0, 0.0, 1.0, asked]))
        assert info["restarts"] == counted
    assert env.reset(seed=4)[1]["restarts"] == 0
    assert "restarts" not in gymnasium.make("swarm_gym/Firefly-v0", **options).reset(seed=3)[1]


def test_what_the_method_cannot_have_is_refused_by_name():
    make = lambda **options: gymnasium.make("swarm_gym/CmaEs-v0", **options)  # noqa: E731
    make(min_population_size=2)
    with pytest.raises(SettingError, match=r"min_population_size.*2.*got 1"):
        make(min_population_size=1)
    make(scenario="rooms:0", encoding="bezier")
    with pytest.raises(
        UnknownNameError, match=r"encoding of cma-es.*walk.*bezier, shifted, spherical, waypoints"
    ):
        make(scenario="rooms:0", encoding="walk")
    make(restarts="degenerate")
    with pytest.raises(UnknownNameError, match=r"restarts.*often.*degenerate, stalled"):
        make(restarts="often")
    with pytest.raises(UnknownNameError, match=r"unknown option .restarts."):
        gymnasium.make("swarm_gym/Firefly-v0", restarts="stalled")
    with pytest.raises(SettingError, match="onemax:100"):
        make(scenario="onemax:100")


def test_an_optimum_in_a_corner_of_the_bounds_is_reached():
    """Members outside are moved to the bounds: the linear slope of BBOB is solved exactly."""
    swarms, tables = begin(NAME, [function_problem("function:bbob-5-10-1")] * 4, size=10)
    for _ in range(600):
        advance(NAME, swarms, tables, 10, 0.0)
    assert (swarms.best_fitness < 1e-8).all()
    assert (np.abs(swarms.positions) <= 5.0).all()
