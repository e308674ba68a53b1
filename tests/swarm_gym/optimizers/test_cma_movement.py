"""The movement of CMA-ES's distribution where selection is random; test_cma_es.py has the oracle."""

import numpy as np
import pytest

from swarm_gym.compiler.jit import entry
from swarm_gym.optimizers.cma_es.learning import learn
from swarm_gym.optimizers.cma_es.rates import write_weights
from swarm_gym.optimizers.cma_es.sampling import Offspring
from swarm_gym.optimizers.cma_es.state import MOVEMENT, NO_REASON, NUM_COUNTS, REASON, layout, spread_out

# Python would need minutes for the eigenvectors in 40 dimensions.
compiled_learn = entry(getattr(learn, "py_func", learn))


@pytest.mark.parametrize(("dimension", "size", "tolerance"), [(10, 10, 0.15), (10, 40, 0.15), (40, 15, 0.05)])
def test_the_squared_length_of_the_path_is_near_one_where_selection_is_random(dimension, size, tolerance):
    width = -(-dimension // 8) * 8
    state, registers = np.zeros(layout(width).end), np.zeros(NUM_COUNTS, dtype=np.int64)
    spread_out(state, registers, width, dimension, 0.3)
    generator, root, weights, found = np.random.default_rng(5), layout(width).root, np.empty(size), []
    rates = write_weights(weights, dimension)
    for generation in range(600):
        square = state[root : root + width * width].reshape(width, width)[:dimension, :dimension]
        normals = generator.standard_normal((size, dimension))
        steps = np.zeros((size, width))
        steps[:, :dimension] = normals @ square
        offspring = Offspring(
            steps.ravel(), np.square(normals).sum(axis=1), np.zeros(size), np.ones(width), np.zeros(width + 1)
        )
        compiled_learn(state, registers, dimension, offspring, np.arange(size), weights, rates)
        if registers[REASON] != NO_REASON:  # a random walk of the covariance ends as a degenerate one
            spread_out(state, registers, width, dimension, 0.3)
        elif generation > 30:
            found.append(state[MOVEMENT])
    assert len(found) > 500
    assert np.mean(found) == pytest.approx(1.0, abs=tolerance)
