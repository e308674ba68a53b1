"""The layout `search`: what it says of CMA-ES and of differential evolution, and what leaves it as it is."""

import numpy as np
import pytest

from swarm_gym.errors import SettingError
from swarm_gym.history import COLUMN
from swarm_gym.observation import make_observation
from swarm_gym.optimizers.cma_es import state as cma
from swarm_gym.search_features import GENERATIONS, LONGEST_WAIT, SEARCH
from swarm_gym.vector_env import SwarmVectorEnv

NAMES = [feature.name for feature in SEARCH]
BUDGET = 4000
OF_CMA = [0, 1, 2, 4, 6]  # numbers that only CMA-ES has
OF_EVOLUTION = [11, 12, 13]
# Differential evolution is compiled for maps already, and CMA-ES for functions by other tests.
SCENARIOS = {"cma-es": "metabox-bbob:15-10", "differential-evolution": "case1"}


def swarms_of(optimizer, scenario=None, num_swarms=3, **options):
    scenario = scenario or SCENARIOS[optimizer]
    return SwarmVectorEnv(
        num_swarms, optimizer, scenario=scenario, observation="search", iterations=300,
        max_evaluations=BUDGET, initial_population_size=10, **options,
    )  # fmt: skip


def after(swarms, iterations, size=10):
    """Return the last observations, and those of all iterations, (iterations + 1, B, k)."""
    seen = [swarms.reset(seed=5)[0]]
    actions = np.tile([float(size), 0.0], (swarms.num_envs, 1))
    for _ in range(iterations):
        seen.append(swarms.step(actions)[0])
    assert all(swarms.observation_space.contains(one) for one in seen)
    return seen[-1], np.array(seen)


def test_the_numbers_of_cma_es_are_those_of_its_state():
    swarms = swarms_of("cma-es")
    nothing = make_observation("search").observe(swarms.unwrapped.simulation)
    assert np.isfinite(nothing).all()
    _, seen = after(swarms, 40)
    assert (seen[0, :, [0, 1, 2, 6, 7]] == 0.0).all()
    simulation = swarms.unwrapped.simulation
    field = simulation.swarms.field
    assert seen[-1, :, 0] == pytest.approx(np.log10(field[:, cma.STEP_SIZE] / 0.3) / 6.0, rel=1e-5)
    assert seen[-1, :, 2] == pytest.approx(np.log10(field[:, cma.CONDITION]) / 7.0, rel=1e-5)
    assert seen[-1, :, 4] == pytest.approx(field[:, cma.PATH_LENGTH], rel=1e-5)
    # The trend is the change of the step size, but for its largest change and restarts.
    restarted = (np.diff(seen[:, :, 0], axis=0) > 0.1).any(axis=0)
    assert not restarted.all()
    steps = seen[:, ~restarted, 0] * 6.0 * np.log(10.0)
    assert seen[1:, ~restarted, 1] == pytest.approx(np.diff(steps, axis=0), abs=2e-5)
    assert (seen[:, :, OF_EVOLUTION] == 0.0).all()


def test_shares_are_those_of_the_last_generations():
    swarms, medians = swarms_of("cma-es"), []
    swarms.reset(seed=5)
    field = swarms.unwrapped.simulation.swarms.field
    for _ in range(25):
        seen, *_ = swarms.step(np.tile([10.0, 0.0], (3, 1)))
        medians.append(field[:, cma.GENERATION_MEDIAN].copy())
    assert (swarms.unwrapped.simulation.swarms.registers[:, cma.RESTARTS] == 0).all()
    last = np.array(medians)[-GENERATIONS - 1 :]
    worse = (np.diff(last, axis=0) > 0.0).mean(axis=0)
    assert seen[:, 6] == pytest.approx(worse, abs=1e-6)
    assert worse.max() > 0.0
    gain, spread = last[0] - last[-1], last[-1] - field[:, cma.GENERATION_BEST]
    assert seen[:, 7] == pytest.approx(gain / spread / (1.0 + np.abs(gain / spread)), rel=1e-5)
    best = swarms.unwrapped.simulation.history[:, 25 - GENERATIONS : 26, COLUMN.best_fitness]
    improved = np.diff(best, axis=1) < 0.0
    assert seen[:, 5] == pytest.approx(improved.mean(axis=1), abs=1e-6)
    assert improved.any()
    since = [np.argmax(row[::-1]) if row.any() else None for row in improved]
    for waited, expected in zip(seen[:, 8], since, strict=True):
        if expected is not None:
            assert waited == pytest.approx(np.log1p(expected) / np.log1p(LONGEST_WAIT), rel=1e-5)


def test_the_numbers_of_differential_evolution_are_those_of_its_memory():
    swarms = swarms_of("differential-evolution")
    last, seen = after(swarms, 20)
    assert seen[0, :, OF_EVOLUTION[0]] == pytest.approx(0.5)
    assert (seen[:, :, OF_CMA] == 0.0).all()
    assert last[:, OF_EVOLUTION] == pytest.approx(swarms.unwrapped.simulation.swarms.field[:, :3], rel=1e-5)
    assert (last[:, OF_EVOLUTION[2]] > 0.0).all()
    assert len(set(last[:, OF_EVOLUTION[1]].tolist())) == 3
    # Selection is greedy, so the best never gets worse: gains are not negative.
    assert (seen[:, :, 7] >= 0.0).all()
    assert (seen[:, :, 7] > 0.0).any()
    assert last[:, 9] == pytest.approx(swarms.unwrapped.simulation.swarms.evaluations / BUDGET, rel=1e-6)


@pytest.mark.parametrize("optimizer", SCENARIOS)
def test_shift_and_scale_of_the_fitness_and_of_the_box_change_nothing(optimizer):
    swarms = swarms_of(optimizer)
    after(swarms, 30)
    simulation = swarms.unwrapped.simulation
    before = make_observation("search").observe(simulation)
    state = simulation.swarms
    fitness = [state.fitness, state.best_fitness, simulation.history[:, :, COLUMN.best_fitness]]
    if optimizer == "cma-es":
        at = cma.layout(state.positions.shape[2])
        fitness += [state.field[:, cma.GENERATION_BEST : cma.GENERATION_MEDIAN + 1]]
        fitness += [state.field[:, at.bests : at.end]]
        state.field[:, at.mean : at.step_path] *= 32.0
    for values in fitness:
        values[...] = 1024.0 * values + 128.0
    state.positions[...] *= 32.0
    state.best_position[...] *= 32.0
    found = make_observation("search").observe(simulation)
    np.testing.assert_allclose(found, before, rtol=1e-5)
    assert (np.abs(before[:, [5, 7, 8]]).max(axis=0) > 0.0).all()


def test_episodes_on_a_shifted_optimum_look_alike_in_distribution():
    # Functions of BBOB add f_opt, which MetaBox draws: the layout must not tell one from the other.
    plain, biased = (
        after(swarms_of("cma-es", f"metabox-bbob:1-10{end}", 8), 30)[1] for end in ("", "-biased")
    )
    for feature in range(len(SEARCH)):
        assert plain[-1, :, feature].mean() == pytest.approx(biased[-1, :, feature].mean(), abs=0.25), feature


def test_long_waits_are_seen_as_the_longest():
    swarms = swarms_of("cma-es")
    after(swarms, 100, size=6)
    simulation = swarms.unwrapped.simulation
    simulation.history[:, :101, COLUMN.best_fitness] = 7.0
    assert make_observation("search").observe(simulation)[:, 8] == pytest.approx(1.0)


def test_optimizers_without_such_a_state_are_refused_by_name():
    with pytest.raises(SettingError, match=r"'search'.*cma-es.*'firefly' has neither"):
        SwarmVectorEnv(2, "firefly", scenario="case1", observation="search")
    joined = SwarmVectorEnv(2, "cma-es", scenario="case1", observation="search+restarts")
    assert joined.single_observation_space.shape == (len(SEARCH) + 5,)


def test_names_tell_the_numbers_apart():
    assert len(set(NAMES)) == len(NAMES)
    assert NAMES[3] == "share of the iterations done"
