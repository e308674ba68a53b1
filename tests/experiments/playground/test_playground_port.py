"""The port of the kernels to JavaScript, in Chromium, against the kernels themselves.

Python makes the recorded runs anew for each test. Arithmetic and random numbers have the same bits. The last
bit of `exp`, of logarithms and of `tanh` may differ, for which single tests state a tolerance.
"""

import numpy as np
import pytest
from gymnasium.utils.seeding import np_random

from experiments.playground.exported import POLICY, SCHEDULE, export
from experiments.playground.playground_page import engine
from helpers.browsers import chromium
from helpers.episode_seeds import episode_seed
from helpers.slow import slow_but
from oracles.naive import Stream
from swarm_gym.compiler.random_stream import seed_stream
from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.problem.tables import evaluate_entry, repair_entry

CASES = ("case1", "case2", "case3", "random-fields:test:0")
SEEDS = (0, 1, 2**32, 2**53 - 1)
# By the last bit of `exp`, in map units; see also "Determinism" in docs/architecture.md.
TOLERANCE = 1e-9
# By the last bits of numbers of 32 bits, in a network's corrections of phi.
NETWORK_TOLERANCE = 1e-6

STREAM = """seed => {
  const stream = Stream.ofSeed(seed);
  const drawn = [0, 1, 2].map(() => {
    const numbers = new Float64Array(32);
    stream.fill(numbers);
    return [...numbers];
  });
  const words = [0, 1, 2].map((row) => [...stream.low[row]].map((low, k) => [stream.high[row][k], low]));
  return { drawn, words, counter: stream.counter };
}"""
PATHS = """([data, paths, degree]) => {
  const problem = new Problem(data);
  return paths.map((numbers) => {
    const path = Float64Array.from(numbers);
    const fitness = problem.evaluate(path), collision = problem.collision;
    problem.repair(path, degree);
    return { fitness, collision, repaired: [...path] };
  });
}"""
RUN = """([data, place, seed, decisions]) => {
  const swarm = new Swarm(new Problem(data.cases[place]), data.settings, seed);
  const controllers = [new Schedule(data.schedule), new Policy(data.policy)];
  const frame = () => ({
    course: [swarm.size, swarm.best.fitness, swarm.best.collision, swarm.evaluations],
    summary: ["populationCollision", "meanCollision", "collisionDeviation", "feasibleShare", "diversity"]
      .map((name) => swarm.now[name]),
    positions: swarm.positions.map((position) => [...position]),
    fitness: swarm.fitness.slice(),
    collision: swarm.collision.slice(),
    decided: swarm.ended ? null : controllers.map((one) => Object.values(one.decide(swarm))),
  });
  swarm.begin(decisions[0][0]);
  const frames = [frame()];
  for (const [size, degree] of decisions.slice(1)) {
    for (const _ of swarm.step(size, degree));
    frames.push(frame());
  }
  return frames;
}"""


@pytest.fixture(scope="module")
def port():
    """A page that has the port, and nothing else."""
    with chromium() as browser:
        page = browser.new_page()
        page.add_script_tag(content=engine())
        yield page


def frame_of(simulation):
    """State of the only swarm, as the script `RUN` tells it."""
    swarms, size = simulation.swarms, int(simulation.swarms.size[0])
    best = swarms.best_fitness[0], swarms.best_collision[0]
    return {
        "course": [size, *map(float, best), int(swarms.evaluations[0])],
        "summary": swarms.summary[0].tolist(),
        "positions": swarms.positions[0, :size].tolist(),
        "fitness": swarms.fitness[0, :size].tolist(),
        "collision": swarms.collision[0, :size].tolist(),
    }  # fmt: skip


def by_hand(iterations, size=24):
    """Sizes that grow and shrink, and degrees from 0 to 1, as a reader could choose them."""
    sizes = [size, *(max(2, round(size + 14 * np.sin(k))) for k in range(1, iterations + 1))]
    return list(zip(sizes, [0.0, *np.linspace(0.0, 1.0, iterations).tolist()], strict=True))


def run_by_hand(scenario, seed, options, decisions):
    env = SwarmEnv(scenario=scenario, initial_population_size=decisions[0][0], **options)
    env.reset(seed=seed)
    frames = [frame_of(env.simulation)]
    for decision in decisions[1:]:
        env.step(np.array(decision, dtype=np.float64))
        frames.append(frame_of(env.simulation))
    return frames


def run_controlled(name, scenario, seed, options):
    """Return frames and a controller's decisions: the first size, then size and phi of each iteration."""
    controller = make_controller(name)
    env = SwarmEnv(scenario=scenario, **options, **controller.env_options())
    controller.reset(1, seed)
    observation, _ = env.reset(seed=seed)
    frames, ended = [frame_of(env.simulation)], False
    while not ended:
        observation, _, ended, _, _ = env.step(controller.act(observation[None])[0])
        frames.append(frame_of(env.simulation))
    history = env.simulation.history[0, :, 1:3]
    return frames, [(int(size), degree) for size, degree in history.tolist()]


def assert_same(frames, expected):
    for k, (one, other) in enumerate(zip(frames, expected, strict=True)):
        assert {name: one[name] for name in other} == other, f"after iteration {k}"


def assert_close(frames, expected):
    for k, (one, other) in enumerate(zip(frames, expected, strict=True)):
        for name, values in other.items():
            np.testing.assert_allclose(
                one[name], values, rtol=0.0, atol=TOLERANCE, err_msg=f"{name} after iteration {k}"
            )


@pytest.mark.parametrize("seed", SEEDS)
def test_random_numbers_are_the_same_word_for_word(port, seed):
    stream = seed_stream(episode_seed(np_random(seed)[0]).spawn(2)[1])
    found = port.evaluate(STREAM, seed)
    oracle = Stream(stream)
    assert found["drawn"] == [oracle.padded_uniform(31) for _ in range(3)]
    words = [[(high << 32) | low for high, low in row] for row in found["words"]]
    assert [*words, [found["counter"]] * 8] == oracle.words()


@pytest.mark.parametrize("scenario", CASES)
@pytest.mark.parametrize("degree", slow_but([0.3], [0.3, 1.0]))
def test_cost_and_repair_of_random_paths_have_the_same_bits(port, scenario, degree):
    data = export([scenario], {})["cases"][0]
    env = SwarmEnv(scenario=scenario)
    table = env.simulation.problems[0].table
    rng = np.random.default_rng(7)
    paths = np.zeros((200, len(table.lower) + 1))
    widths = rng.uniform(0.0, 1.0, size=(200, 1)) ** 3
    paths[:, 1:] = np.clip(
        widths * rng.normal(0.0, 300.0, size=(200, len(table.lower))), table.lower, table.upper
    )
    collides = 0
    for path, found in zip(paths, port.evaluate(PATHS, [data, paths.tolist(), degree]), strict=True):
        fitness, collision = evaluate_entry(table, path)
        assert (found["fitness"], found["collision"]) == (fitness, collision)
        repaired = path.copy()
        repair_entry(table, repaired, degree)
        assert found["repaired"] == repaired.tolist()
        collides += collision > 0.0
    assert collides > 20


def test_one_move_is_that_of_the_kernel(port):
    data = export(["case1"], {})
    decisions = [(2, 0.0), (2, 0.0)]
    frames = port.evaluate(RUN, [data, 0, 3, decisions])
    expected = run_by_hand("case1", 3, {}, decisions)
    assert expected[-1]["course"][-1] == 3  # evaluations: two members and a move
    assert_close(frames, expected)


@pytest.mark.parametrize("place", range(len(CASES)), ids=CASES)
def test_a_run_by_hand_has_the_same_bits_where_nothing_decays(port, place):
    options = {"absorption": 0.0}
    data, decisions = export(CASES, options), by_hand(40)
    frames = port.evaluate(RUN, [data, place, 11, decisions])
    assert_same(frames, run_by_hand(CASES[place], 11, options, decisions))


def test_a_swarm_without_extent_grows_in_the_whole_workspace(port):
    options = {"absorption": 0.0, "noise": 0.0, "attractiveness": 1.0}
    decisions = [(2, 0.0), *[(2, 0.0)] * 3, (30, 0.2)]
    expected = run_by_hand("case1", 11, options, decisions)
    one, other = np.array(expected[-2]["positions"])[:, :-1]  # the last column is padding
    assert (one == other).any()
    assert_same(port.evaluate(RUN, [export(["case1"], options), 0, 11, decisions]), expected)


@pytest.mark.parametrize("place", slow_but([0], range(len(CASES))), ids=CASES)
def test_a_run_by_hand_is_the_same_up_to_the_last_bit_of_exp(port, place):
    decisions = by_hand(40)
    frames = port.evaluate(RUN, [export(CASES, {}), place, 11, decisions])
    assert_close(frames, run_by_hand(CASES[place], 11, {}, decisions))


OTHER_SCHEDULE = {"noise": 8.0, "iterations": 20, "num_waypoints": 20}
OTHER_POLICY = {"mean_weight": 0.5, "iterations": 30}


def on_cases(options):
    """Return places of cases and options; the usual options on one case, and others on another, are fast."""
    return slow_but([(0, {}), (1, options)], [(place, one) for place in range(3) for one in ({}, options)])


@pytest.mark.parametrize(("place", "options"), on_cases(OTHER_SCHEDULE))
def test_the_schedule_decides_as_in_python(port, place, options):
    expected, decisions = run_controlled(SCHEDULE, CASES[place], 5, options)
    frames = port.evaluate(RUN, [export(CASES[:3], options), place, 5, decisions])
    assert_close(frames, expected)
    decided = [tuple(frame["decided"][0]) for frame in frames[:-1]]
    assert decided == decisions[1:]
    assert len({size for size, _ in decided}) > 5
    assert any(degree > 0.0 for _, degree in decided)


@pytest.mark.parametrize(("place", "options"), on_cases(OTHER_POLICY))
def test_the_policy_decides_as_in_python(port, place, options):
    expected, decisions = run_controlled(POLICY, CASES[place], 5, options)
    frames = port.evaluate(RUN, [export(CASES[:3], options), place, 5, decisions])
    assert_close(frames, expected)
    for frame, (size, degree) in zip(frames, decisions[1:], strict=False):
        assert frame["decided"][1][0] == size
        assert frame["decided"][1][1] == pytest.approx(degree, abs=NETWORK_TOLERANCE)


def test_the_policy_corrects_its_open_loop_in_these_runs(port):
    # Otherwise the network could be wrong, and the runs above would be the same.
    _, decisions = run_controlled(POLICY, "case1", 5, {})
    loop = make_controller(POLICY).corrects.decisions
    sizes = np.floor(loop[:, 0] + 0.5)
    assert (np.array([size for size, _ in decisions[16:]]) != sizes[15:]).mean() > 0.5


def test_an_iteration_answers_after_each_member(port):
    data = export(["case1"], {})
    parts = """data => {
      const swarm = new Swarm(new Problem(data.cases[0]), data.settings, 0);
      swarm.begin(30);
      return [...swarm.step(50, 0.0)].length;
    }"""
    assert port.evaluate(parts, data) == 50


def test_a_policy_with_features_that_are_not_ported_is_refused(port):
    data = export(["case1"], {})
    data["policy"]["features"][3] = "phase of the moon"
    message = port.evaluate(
        "data => { try { new Policy(data.policy); } catch (e) { return e.message; } }", data
    )
    assert message == f"policy {POLICY}: features that are not ported: phase of the moon"
