"""A library of random steps, in plain NumPy: what the tests of adapters need of one."""

from typing import Annotated, NamedTuple

import numpy as np

from swarm_gym.adapters.library import LibraryOptimizer
from swarm_gym.optimizers.parameter import Parameter


class RandomStepParameters(NamedTuple):
    step: Annotated[
        float, Parameter(0.05, 0.0, 1.0, "s", "largest step as a share of the range", (0.01, 0.5))
    ]


class RandomSteps(LibraryOptimizer):
    """Each member tries a step; it remembers how many steps it has tried, and the swarm how many in all."""

    name = "helpers.libraries:RandomSteps"
    parameter_class = RandomStepParameters

    @staticmethod
    def memory_columns(dimension):
        return 1

    @staticmethod
    def field_size(tables):
        return 1

    @classmethod
    def iterate(cls, swarm, parameters):
        swarm.memory[swarm.num_known :] = 0.0
        if swarm.num_known == 0:
            swarm.notes[:] = 0.0
        width = parameters.step * (swarm.upper - swarm.lower)
        tried = swarm.positions + width * swarm.random.uniform(-1.0, 1.0, swarm.positions.shape)
        tried = swarm.repaired(tried)
        fitness, collision = swarm.evaluate(tried)
        better = fitness < swarm.fitness
        swarm.memory[:] += 1.0
        swarm.notes[:] += len(tried)
        swarm.replace(
            np.where(better[:, None], tried, swarm.positions),
            np.where(better, fitness, swarm.fitness),
            np.where(better, collision, swarm.collision),
        )
