"""Runs of pyswarms: its particle swarm with one global best position."""

import contextlib
import tempfile

import numpy as np

from experiments.speed.peers.cost import Cost
from swarm_gym.problem import Problem

# pyswarms has no defaults; these are c1, c2 and the last inertia weight of PSO-w in the MOA paper.
PARAMETERS = {"c1": 1.49445, "c2": 1.49445, "w": 0.5}


def particle_swarm(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the particle swarm with these parameters; return the number of evaluations."""
    # pyswarms opens a log file in the working directory when it is imported and when a swarm is made.
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        from pyswarms.single import GlobalBestPSO

        np.random.seed(0)  # noqa: NPY002 (pyswarms draws from NumPy's global generator)
        swarm = GlobalBestPSO(size, problem.dimension, PARAMETERS, bounds=problem.bounds)
        # The first population counts as an iteration.
        swarm.optimize(cost.of_many, iterations + 1, verbose=False)
    return size * len(swarm.cost_history)
