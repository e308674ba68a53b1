"""The common part of the plain-Python oracles whose members walk: glowworms and ants.

Random numbers are drawn in blocks of eight. `best_walk` is the best walk from the start so far, without the
target, to which the path goes straight on.
"""

import math

from oracles.naive import added
from oracles.naive_swarm import Swarm

# The share of a fitness by which another one has to be less to be better: many walks are equally long, and
# rounding must not choose among them.
MARGIN = 1e-12


class Walkers(Swarm):
    """Members that walk: blocks of random numbers, stored parameters, the best walk so far."""

    best_walk: list

    def block(self):
        return [lane.uniform() for lane in self.stream.lanes]

    def step(self, size, repair_degree, parameters):
        self.parameters = type(self.parameters)(**parameters._asdict())
        super().step(size, repair_degree, parameters)

    def offer(self, fitness, collision, position, way):
        """Make a walk the best so far, if it is better."""
        if self.best[2] is None or fitness < self.best[0] * (1 - MARGIN):
            self.best, self.best_walk = (fitness, collision, list(position)), [list(point) for point in way]

    def renew_best(self):
        """Evaluate the best walk so far once more, or forget it if the budget is spent."""
        position, self.best = self.best[2], (math.inf, math.inf, None)
        if not self.is_spent():
            self.evaluations += 1
            way = [*self.best_walk, self.problem.target]
            self.best = (*self.problem.cost_of_path(way), position)


def spin(weights, share):
    """Return the first place at which the running sum of the weights exceeds a share of it, else the last."""
    aim, reached = share * added(weights), 0.0
    for i, weight in enumerate(weights):
        reached += weight
        if reached > aim:
            return i
    return len(weights) - 1
