"""The common part of plain-Python oracles of optimizers: members, the best so far, evaluations and budget.

Oracles follow the papers and docs/readings.md; they draw random numbers in the order of the kernels. A
problem is an object with `dimension`, `unit_length` (the divisor of Euclidean lengths in ranges), bounds,
`cost` and `repaired`: `naive_grid.Problem`, or `Analytic` here.
"""

import math

from oracles import naive, naive_bbob, naive_functions, naive_grid, naive_sources, naive_walks


class Analytic:
    """The oracle of an `AnalyticProblem`."""

    def __init__(self, problem):
        self.scenario, self.length_weight, self.ways = problem.scenario, problem.length_weight, problem.ways
        self.dimension = self.num_points = problem.num_waypoints
        self.unit_length = math.sqrt(self.dimension)
        self.lower, self.upper = naive.bounds(self.scenario, self.dimension)
        self.initial_lower, self.initial_upper = (bound.tolist() for bound in problem.initial_bounds)

    @property
    def width(self):
        return max(high - low for low, high in zip(self.lower, self.upper, strict=True))

    def beside_the_line(self, offsets):
        return list(offsets)

    def cost(self, vector):
        return naive.evaluate(self.scenario, vector, self.length_weight)

    def repaired(self, vector, repair_degree):
        return naive.repaired(self.scenario, vector, repair_degree)


ORACLES = {
    "AnalyticProblem": Analytic,
    "GridProblem": naive_grid.Problem,
    "FunctionProblem": naive_functions.Problem,
    "BbobProblem": naive_bbob.Problem,
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
    """A swarm of any optimizer: members, the best so far, evaluations and their budget."""

    source = naive_sources.Source()

    def __init__(self, problem, stream, iterations, budget=10**9):
        self.problem, self.stream, self.iterations, self.budget = problem, stream, iterations, budget
        self.members = []
        self.evaluations, self.iteration = 0, 0
        self.best = (math.inf, math.inf, None)
        self.feasible = (math.inf, None)  # fitness and position of the best path without collision
        self.best_smooth, self.became_best = math.inf, 0  # among the new members of an iteration

    def is_spent(self):
        return self.evaluations >= self.budget

    def uniform(self):
        return self.stream.uniform(self.problem.dimension)

    def seen(self, position):
        """Evaluate a position that cannot become the best so far."""
        assert not self.is_spent()
        self.evaluations += 1
        return Member(position, *self.problem.cost(position))

    def member(self, position):
        """Evaluate a position, which may become the best so far."""
        member = self.seen(position)
        if member.fitness < self.best[0]:
            self.best = (member.fitness, member.collision, list(position))
        if member.collision <= naive.FEASIBLE and member.fitness < self.feasible[0]:
            self.feasible = (member.fitness, list(position))
        return member

    def clipped(self, position):
        return [
            naive.clip(*values)
            for values in zip(position, self.problem.lower, self.problem.upper, strict=True)
        ]

    def treated(self, position, repair_degree):
        return self.problem.repaired(position, repair_degree) if repair_degree > 0 else position

    def draw(self, count, lower, upper):
        """Draw up to `count` new members from the source; uniform ones lie in a box."""
        drawn = []
        while len(drawn) < count and not self.is_spent():
            new, smooth = naive_sources.newcomer(self.problem, self.source, self.stream, lower, upper)
            best = self.best[0]
            drawn.append(self.member(new))
            if smooth:
                self.best_smooth = min(self.best_smooth, drawn[-1].fitness)
            self.became_best += drawn[-1].fitness < best
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
        """Evaluate all stored positions on another problem, while the budget lasts."""
        self.problem, best = problem, self.best[2]
        self.best, self.feasible = (math.inf, math.inf, None), (math.inf, None)
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
        """Return all members in the order in which they are stored."""
        return self.members

    def step(self, size, repair_degree, parameters):
        self.best_smooth, self.became_best = math.inf, 0
        if self.source.immigrants > 0:
            staying = min(len(self.stored()), size)
            self.resize(max(staying - math.floor(self.source.immigrants * staying + 0.5), 1))
        self.resize(size)
        self.iterate(repair_degree, **parameters._asdict())
        self.iteration += 1
