"""A million steps with any actions: no NaN, no wrong counter, nothing outside a space, constant memory."""

import gc
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from agents import make_controller
from helpers.builders import is_walker
from swarm_gym.observation import ITERATION
from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.vector_env import SwarmVectorEnv

# Differential evolution needs four members.
NUM_SWARMS, ITERATIONS, SIZES = 100, 25, (4, 12)
STEPS = 1_000_000
# Memory that may be added after a tenth of the steps.
WARM, MOST_GROWTH = 0.1, 5 * 2**20
# Kinds of maps, each for the same number of steps, and whether an evaluation budget ends episodes, too.
MAPS = (
    ({"scenario": ["random-fields:train:0-31"]}, None),
    ({"scenario": ["rooms:0-7", "caves:0-3"]}, 150),
    ({"scenario": ["dynamic:case1-gate@9", "dynamic:case2-block@5"]}, None),
    ({"scenario": ["function:rastrigin-10", "function:booth-10"]}, 150),
)


class Schedule:
    """A schedule as an actor, which sees the observations of the SPSFA paper."""

    def __init__(self):
        self._controller = make_controller("spsfa-tip")
        self._controller.reset(NUM_SWARMS, 0)

    def __call__(self, observation):
        decided = self._controller.act(observation)
        return np.clip(decided, [SIZES[0], 0.0], [SIZES[1], 1.0])


def actors(rng):
    """Return functions from observations (B, 4) to actions (B, 2), by name."""
    low, high = np.array([SIZES[0], 0.0]), np.array([SIZES[1], 1.0])
    turn = iter(range(10**9))

    def tiled(action):
        return np.tile(action, (NUM_SWARMS, 1))

    return {
        "random": lambda _: rng.uniform(low, high, (NUM_SWARMS, 2)),
        "smallest": lambda _: tiled(low),
        "largest": lambda _: tiled(high),
        "alternating": lambda _: tiled(high if next(turn) % 2 else low),
        "corners": lambda _: np.where(rng.random((NUM_SWARMS, 2)) < 0.5, low, high),
        "schedule": Schedule(),
    }


def resident():
    """Return the bytes of memory that this process holds."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


def soak(optimizer, options, budget, steps, rng):
    """Advance an environment and check every step; yield now and then."""
    env = SwarmVectorEnv(
        NUM_SWARMS,
        optimizer,
        autoreset_mode=AutoresetMode.SAME_STEP,
        iterations=ITERATIONS,
        initial_population_size=6,
        min_population_size=SIZES[0],
        max_population_size=SIZES[1],
        max_evaluations=budget,
        **options,
    )
    space = env.single_observation_space
    static = "dynamic" not in options["scenario"][0]
    keeps_all = optimizer != "multivariate"  # a point that no list has a place for is dropped
    observation, info = env.reset(seed=int(rng.integers(2**31)))
    done, before = np.zeros(NUM_SWARMS, dtype=int), info
    beginning = info["evaluations"][0]  # evaluations of the first population
    rounds = steps // NUM_SWARMS
    schedule = actors(rng)
    turns = np.array_split(np.arange(rounds), 2 * len(schedule))
    for name, turn in zip([*schedule, *schedule], turns, strict=True):
        for _ in turn:
            action = schedule[name](observation)
            observation, reward, ended, truncated, info = env.step(action)
            done += 1
            here = f"{optimizer} on {options}, {name}"
            assert ((observation >= space.low) & (observation <= space.high)).all(), here
            assert np.isfinite(reward).all(), here
            assert not truncated.any(), here
            last = {key: info[key].copy() for key in ("evaluations", "population_size", "best_fitness")}
            if ended.any():
                final = info["final_info"]
                for key, values in last.items():
                    values[ended] = final[key][ended]
            wanted = np.rint(action[:, 0])
            assert (last["evaluations"] >= before["evaluations"]).all(), here
            assert np.isfinite(last["best_fitness"]).all(), here
            if static:
                assert (last["best_fitness"] <= before["best_fitness"]).all(), here
            assert (last["population_size"] <= np.maximum(wanted, before["population_size"])).all(), here
            if budget is None:
                if keeps_all:
                    assert (last["population_size"] == wanted).all(), here
                assert (ended == (done == ITERATIONS)).all(), here
            else:
                assert (last["evaluations"] <= budget).all(), here
                assert (ended == ((done == ITERATIONS) | (last["evaluations"] == budget))).all(), here
            done[ended] = 0
            assert (observation[:, ITERATION] == done).all(), here
            # In the same step the next episode has begun, with a population that was evaluated.
            assert (info["evaluations"][ended] == beginning).all(), here
            before = info
        yield


def maps_for(optimizer):
    if not is_walker(optimizer):
        return MAPS
    # Walks have no path over a function, and take a hundred times as long over cells of the usual size.
    coarse = {"cell_size": 20.0}
    return [
        (options if budget else options | coarse, budget)
        for options, budget in MAPS
        if "function" not in options["scenario"][0]
    ]


def run(optimizer, steps):
    rng, maps = np.random.default_rng(5), maps_for(optimizer)
    for options, budget in maps:
        yield from soak(optimizer, options, budget, steps // len(maps), rng)


@pytest.mark.slow
@pytest.mark.parametrize("optimizer", OPTIMIZERS)
def test_a_million_steps_need_no_more_memory(optimizer):
    sizes = []
    for _ in run(optimizer, int(WARM * STEPS)):  # also makes all maps, which are kept
        pass
    if Path("/proc/self/statm").exists():
        sizes.append(resident())
    for _ in run(optimizer, STEPS):
        pass
    if sizes:
        sizes.append(resident())
    for before, after in pairwise(sizes):
        assert after - before < MOST_GROWTH, f"grew by {(after - before) / 2**20:.1f} MiB"
