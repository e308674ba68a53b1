"""The best schedule of lambda over iterations, which sees nothing of the string."""

from typing import Any

import numpy as np
from cmaes import CMA
from numpy.typing import NDArray
from tqdm import trange

from experiments.studies.onemax.runtimes import Floats
from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.controllers.onemax_rules import OPTIMIZER
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.seeds import TRAINING_START

KNOTS = 10
LARGEST = 64
CANDIDATES, GENERATIONS, EPISODES = 14, 40, 100


class Schedule(Controller):
    """A size that depends on the iteration alone, linear in its logarithm between knots.

    Args:
        size: n; the last knot is at 4 n iterations, and the size stays from there on.
        logarithms: (KNOTS,) logarithms of lambda at the knots, which are evenly spaced.
    """

    made_for = OPTIMIZER
    initial_population_size = 1
    needed_limits = SizeLimits(1, LARGEST)

    def __init__(self, size: int, logarithms: Floats):
        self._logarithms = np.clip(logarithms, 0.0, np.log(LARGEST))
        knots = np.linspace(0.0, 4.0 * size, KNOTS)
        between = np.interp(np.arange(4 * size + 1), knots, self._logarithms)
        self._sizes = np.floor(np.exp(between) + 0.5)

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Do nothing; there is no state."""

    def act(self, observations: NDArray[Any]) -> Floats:
        """Return (B, 2) sizes, and no repair."""
        iteration = np.minimum(observations[:, 3].astype(int), len(self._sizes) - 1)
        return np.stack([self._sizes[iteration], np.zeros(len(iteration))], axis=1)

    def identity(self) -> object:
        """Return the logarithms at the knots."""
        return "onemax schedule", self._logarithms.tolist()


def tune(size: int) -> Schedule:
    """Return the schedule with the fewest evaluations that CMA-ES finds; a generation shares its seeds."""
    strategy = CMA(mean=np.full(KNOTS, 1.5), sigma=0.7, seed=0, population_size=CANDIDATES)
    for generation in trange(GENERATIONS, desc=f"schedule at n = {size}", leave=False):
        seeds = range(TRAINING_START + generation * EPISODES, TRAINING_START + (generation + 1) * EPISODES)
        candidates = [strategy.ask() for _ in range(CANDIDATES)]
        strategy.tell([(one, _evaluations(Schedule(size, one), size, seeds)) for one in candidates])
    return Schedule(size, strategy.mean)


def _evaluations(schedule: Schedule, size: int, seeds: range) -> float:
    runs = run_episodes(schedule, f"onemax:{size}", seeds, OPTIMIZER, iterations=12 * size)
    return float(runs.evaluations.mean())
