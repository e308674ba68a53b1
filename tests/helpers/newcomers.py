"""New members as the compiled kernels draw them, one after the other."""

import numpy as np

from helpers.builders import workspace
from helpers.compiled import compiled
from oracles import naive, naive_sources, naive_swarm
from swarm_gym.compiler.random_stream import seed_stream
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.problem.geometry.bends import BENDS
from swarm_gym.problem.tables import select, stack
from swarm_gym.sources import draw_newcomer

# Optimizers whose members are whole paths.
PATH_OPTIMIZERS = [name for name in OPTIMIZERS if "walk" not in get_optimizer(name).encodings]


def drawn(problem, source, count, seed=0):
    """Return new members, (count, dimension), which of them are smooth, and the words of the stream then.

    Uniform members lie in the initial bounds.
    """
    table = compiled(select)(stack([problem.table]), 0)
    numbers = np.array([source.smooth_share, source.amplitude, source.immigrants, BENDS[source.bends]])
    stream, work = seed_stream(np.random.SeedSequence(seed)), workspace(problem.dimension)
    box = table.initial_lower, table.initial_upper
    positions, smooth = np.empty((count, problem.dimension)), np.zeros(count, dtype=np.bool_)
    for i in range(count):
        smooth[i] = compiled(draw_newcomer)(numbers, stream, table, work.noise, work.path, *box)
        positions[i] = work.path[1 : problem.dimension + 1]
        assert (work.path[problem.dimension + 1 :] == 0).all()
    return positions, smooth, stream.tolist()


def naively_drawn(problem, source, count, seed=0):
    """Return new members and the words of the stream as the oracle has them."""
    stream, oracle = naive.Stream(seed_stream(np.random.SeedSequence(seed))), naive_swarm.oracle_of(problem)
    box = oracle.initial_lower, oracle.initial_upper
    positions = [naive_sources.newcomer(oracle, source, stream, *box)[0] for _ in range(count)]
    return np.array(positions), stream.words()


def action_of(optimizer, size, repair_degree, *sources):
    """Return an action in natural units that keeps the optimizer's parameters."""
    parameters = get_optimizer(optimizer).decided_parameters().values()
    return np.array([size, repair_degree, *(parameter.default for parameter in parameters), *sources])
