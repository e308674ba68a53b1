"""What plain-Python oracles of optimizers share: members, the best so far, evaluations and their budget.

Straight from the papers and docs/readings.md; random numbers are drawn in the order of the kernels. A problem
is an object with `dimension`, `unit_length` (what a Euclidean length in ranges is divided by), bounds, `cost`
and `repaired`: `naive_grid.Problem`, or `Analytic` here.
"""

import math

from oracles import naive, naive_functions, naive_grid, naive_walks


class Analytic:
    """The oracle of an `AnalyticProblem`."""

    def __init__(self, problem):
        self.scenario, self.length_weight = problem.scenario, problem.length_weight
        self.dimension = problem.num_waypoints
        self.unit_length = math.sqrt(self.dimension)
        self.lower, self.upper = naive.bounds(self.scenario, self.dimension)
        self.initial_lower, self.initial_upper = (bound.tolist() for bound in problem.initial_bounds)

    def cost(self, vector):
        return naive.evaluate(self.scenario, vector, self.length_weight)

    def repaired(self, vector, repair_degree):
        return naive.repaired(self.scenario, vector, repair_degree)


ORACLES = {
    "AnalyticProblem": Analytic,
    "GridProblem": naive_grid.Problem,
    "FunctionProblem": naive_functions.Problem,
    "WalkProblem": naive_walks.Problem,
}


def oracle_of(problem):
    return ORACLES[type(problem).__name__](problem)


class Member:
    """A position with its fitness and collision."""

    def __init__(self, position, fitness, collision):
        self.position, self.fitness, self.collision = list(position), fitness, collision


def scaled(lower, upper, uniforms):
    return [a + (b - a) * u for a, b, u in zip(lower, upper, uniforms, strict=True)]


class Swarm:
    """What is the same for all: members, the best so far, evaluations and their budget."""

    def __init__(self, problem, stream, iterations, budget=10**9):
        self.problem, self.stream, self.iterations, self.budget = problem, stream, iterations, budget
        self.members = []
        self.evaluations, self.iteration = 0, 0
        self.best = (math.inf, math.inf, None)

    def is_spent(self):
        return self.evaluations >= self.budget

    def uniform(self):
        return self.stream.uniform(self.problem.dimension)

    def seen(self, position):
        """Evaluate a position that no member is at."""
        assert not self.is_spent()
        self.evaluations += 1
        return Member(position, *self.problem.cost(position))

    def member(self, position):
        """Evaluate a position, which may be the best so far."""
        member = self.seen(position)
        if member.fitness < self.best[0]:
            self.best = (member.fitness, member.collision, list(position))
        return member

    def clipped(self, position):
        return [
            naive.clip(*values)
            for values in zip(position, self.problem.lower, self.problem.upper, strict=True)
        ]

    def treated(self, position, repair_degree):
        return self.problem.repaired(position, repair_degree) if repair_degree > 0 else position

    def draw(self, count, lower, upper):
        """Up to that many new members, uniform in a box."""
        drawn = []
        while len(drawn) < count and not self.is_spent():
            drawn.append(self.member(scaled(lower, upper, self.uniform())))
        return drawn

    def begin(self, size):
        self.members = self.draw(size, self.problem.initial_lower, self.problem.initial_upper)

    def adopt(self, positions):
        self.members = [self.member([float(value) for value in position]) for position in positions]

    def resize(self, size):
        if size > len(self.members):
            positions = [member.position for member in self.members]
            box = naive.growth_box(positions, self.problem.lower, self.problem.upper)
            self.members += self.draw(size - len(self.members), *box)
        doomed = self.deletion_order(self.members)[: max(len(self.members) - size, 0)]
        self.members = [member for i, member in enumerate(self.members) if i not in doomed]

    @staticmethod
    def deletion_order(members):
        return naive.deletion_order([m.fitness for m in members], [m.collision for m in members])

    def re_evaluate(self, problem):
        """The problem is another one: all that is remembered is evaluated as long as the budget lasts."""
        self.problem, best = problem, self.best[2]
        self.best = (math.inf, math.inf, None)
        self.re_evaluate_members()
        if not self.is_spent():
            self.member(best)

    def re_evaluate_members(self):
        for i, member in enumerate(self.members):
            if self.is_spent():
                del self.members[i:]
                return
            member.fitness, member.collision = self.costs_now(member.position)

    def costs_now(self, position):
        member = self.member(position)
        return member.fitness, member.collision

    def stored(self):
        """All members in the order in which they are stored."""
        return self.members

    def step(self, size, repair_degree, knobs):
        self.resize(size)
        self.iterate(repair_degree, *knobs)
        self.iteration += 1
