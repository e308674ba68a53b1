"""What the plain-Python oracles share whose members walk: glowworms and ants.

Random numbers are drawn in blocks of eight. Of a way from the start, `best_way` is the best so far, without
the target that it leads straight on to.
"""

import math

from oracles.naive import added
from oracles.naive_swarm import Swarm

# The share of a fitness by which another one has to be less to be better: many walks are equally long, and
# rounding must not choose among them.
MARGIN = 1e-12


class Walkers(Swarm):
    """What both share: blocks of random numbers, parameters between iterations, the best way so far."""

    best_way: list

    def block(self):
        return [lane.uniform() for lane in self.stream.lanes]

    def step(self, size, repair_degree, knobs):
        self.knobs = type(self.knobs)(*knobs)
        super().step(size, repair_degree, knobs)

    def offer(self, fitness, collision, position, way):
        """As the best so far."""
        if self.best[2] is None or fitness < self.best[0] * (1 - MARGIN):
            self.best, self.best_way = (fitness, collision, list(position)), [list(point) for point in way]

    def renew_best(self):
        """Evaluate the best way so far once more, or forget it."""
        position, self.best = self.best[2], (math.inf, math.inf, None)
        if not self.is_spent():
            self.evaluations += 1
            way = [*self.best_way, self.problem.target]
            self.best = (*self.problem.cost_of_way(way), position)


def spin(weights, share):
    """The first place where the running sum of the weights exceeds a share of it, else the last one."""
    aim, reached = share * added(weights), 0.0
    for i, weight in enumerate(weights):
        reached += weight
        if reached > aim:
            return i
    return len(weights) - 1
