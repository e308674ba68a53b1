"""Runs of the (1 + (lambda, lambda)) genetic algorithm in the environment, as tests of OneMax need them."""

import numpy as np
from gymnasium.vector import AutoresetMode

from swarm_gym.vector_env import SwarmVectorEnv

OPTIMIZER = "one-plus-lambda-lambda"


def bit_env(num, scenario, **options):
    """Return environments, small ones, of bit strings; their actions decide all four parameters."""
    chosen = {"action": "extended", "iterations": 1500, "max_population_size": 60, **options}
    return SwarmVectorEnv(num, OPTIMIZER, scenario=scenario, autoreset_mode=AutoresetMode.DISABLED, **chosen)


def as_actions(choices):
    """Return the actions in the layout `extended` that ask for choices (mutants, children, alpha, beta)."""
    mutants, children, alpha, beta = np.transpose(choices).astype(np.float64)
    return np.stack([mutants, np.zeros(len(choices)), children, alpha, beta], axis=1)


def simulated_runtimes(num, scenario, decide, seed=0, **options):
    """Return the evaluations of runs until all bits are set; `decide` has the choice by its ones."""
    env = bit_env(num, scenario, **options)
    observations, _ = env.reset(seed=seed)
    ended = np.zeros(num, dtype=np.bool_)
    while not ended.all():
        actions = as_actions([decide(int(ones)) for ones in observations[:, 1]])
        observations, _, ended = env.step_running(actions)
    assert (env.simulation.swarms.best_fitness == 0.0).all()
    return env.simulation.swarms.evaluations.copy()


def steps_from(num, scenario, choice, seed=0, **options):
    """Return the gains and evaluations of many first iterations under the same choice."""
    env = bit_env(num, scenario, **{"iterations": 1, "max_population_size": 4, **options})
    before, _ = env.reset(seed=seed)
    after, *_ = env.step_running(as_actions([choice] * num))
    return (after - before)[:, 1].astype(int), env.simulation.swarms.evaluations - 1
