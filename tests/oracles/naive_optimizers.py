"""Plain-Python oracles for the optimizers with one evaluation per member and iteration.

At the end, those of all optimizers by name.
"""

import math
from importlib import import_module
from pathlib import Path

from oracles import naive
from oracles.naive_swarm import Swarm, scaled
from swarm_gym.optimizers import OPTIMIZERS


class Firefly(Swarm):
    def iterate(self, repair_degree, noise, attractiveness, absorption):
        bounds = self.problem.lower, self.problem.upper
        pull = attractiveness, absorption
        for i in range(len(self.members)):
            for j in range(len(self.members)):
                here, other = self.members[i], self.members[j]
                if other.fitness < here.fitness and not self.is_spent():
                    ends = here.position, other.position
                    moved = naive.firefly_move(*ends, self.uniform(), *bounds, noise, *pull)
                    self.members[i] = self.member(self.treated(moved, repair_degree))


class GenerationalFirefly(Swarm):
    def iterate(self, repair_degree, noise, attractiveness, absorption, least_attractiveness):
        before = list(self.members)
        extents = [b - a for a, b in zip(self.problem.lower, self.problem.upper, strict=True)]
        for i, member in enumerate(before):
            brighter = [other for other in before if other.fitness < member.fitness]
            if self.is_spent():
                return
            x = list(member.position)
            for other in brighter:
                ways = [b - a for a, b in zip(x, other.position, strict=True)]
                squared = math.fsum(way**2 for way in ways)
                span = attractiveness - least_attractiveness
                pull = least_attractiveness + span * math.exp(-absorption * squared)
                shifts = [
                    noise * extent * (u - 0.5) for extent, u in zip(extents, self.uniform(), strict=True)
                ]
                x = [a + pull * way + by for a, way, by in zip(x, ways, shifts, strict=True)]
            x = self.clipped(x)
            self.members[i] = self.member(self.treated(x, repair_degree) if brighter else x)


class ParticleSwarm(Swarm):
    def settle(self, members):
        for member in members:
            member.velocity = [0.0] * self.problem.dimension
            member.own_best, member.own_fitness = list(member.position), member.fitness

    def begin(self, size):
        super().begin(size)
        self.settle(self.members)
        for member in self.members:
            extents = [b - a for a, b in zip(self.problem.lower, self.problem.upper, strict=True)]
            fastest = [0.2 * extent for extent in extents]
            member.velocity = scaled([-v for v in fastest], fastest, self.uniform())

    def adopt(self, positions):
        super().adopt(positions)
        self.settle(self.members)

    def resize(self, size):
        old = list(self.members)
        super().resize(size)
        self.settle([member for member in self.members if member not in old])

    def re_evaluate_members(self):
        super().re_evaluate_members()
        for member in self.members:
            if self.is_spent():
                own_fitness = math.inf
            else:
                own_fitness, _ = self.costs_now(member.own_best)
            member.own_fitness = min(own_fitness, member.fitness)
            if member.fitness < own_fitness:
                member.own_best = list(member.position)

    def iterate(
        self, repair_degree, first_inertia, last_inertia, inertia_factor, cognitive, social, velocity_limit
    ):
        progress = self.iteration / max(self.iterations - 1, 1)
        inertia = (first_inertia * (1 - progress) + last_inertia * progress) * inertia_factor
        swarm_best = self.best[2]
        for i, old in enumerate(self.members):
            if self.is_spent():
                return
            r1, r2 = self.uniform(), self.uniform()
            velocity, position = [], []
            for k, x in enumerate(old.position):
                low, high = self.problem.lower[k], self.problem.upper[k]
                v = inertia * old.velocity[k]
                v += cognitive * r1[k] * (old.own_best[k] - x) + social * r2[k] * (swarm_best[k] - x)
                fastest = velocity_limit * (high - low)
                v = naive.clip(v, -fastest, fastest)
                velocity.append(v if low <= x + v <= high else 0.0)
                position.append(naive.clip(x + v, low, high))
            new = self.member(self.treated(position, repair_degree))
            new.velocity, new.own_best, new.own_fitness = velocity, old.own_best, old.own_fitness
            if new.fitness < old.own_fitness:
                new.own_best, new.own_fitness = list(new.position), new.fitness
            self.members[i] = new


class EliteGenetic(Swarm):
    def iterate(self, repair_degree, crossover, mutation):
        old, size, n = list(self.members), len(self.members), self.problem.dimension
        fitness = [member.fitness for member in old]
        worst, spread = max(fitness), max(fitness) - min(fitness)
        weights = [worst - value + 1e-12 + 0.01 * spread for value in fitness]
        if self.is_spent():
            return
        self.members[0] = self.member(old[fitness.index(min(fitness))].position)
        num_copies = size - 1 - math.floor(crossover * (size - 1) + 0.5)
        for i in range(1, size):
            if self.is_spent():
                return
            # The first three numbers choose the parents and where their genes meet.
            chosen = self.stream.uniform(max(n, 3))
            genes = list(old[self.spin(weights, chosen[0])].position)
            if i > num_copies:
                second = old[self.spin(weights, chosen[1])]
                cut = 1 + math.floor(chosen[2] * (n - 1))
                genes[cut:] = second.position[cut:]
            mutated = [u < mutation for u in self.uniform()]
            if any(mutated):
                new = scaled(self.problem.lower, self.problem.upper, self.uniform())
                genes = [b if flag else a for a, b, flag in zip(genes, new, mutated, strict=True)]
            self.members[i] = self.member(self.treated(genes, repair_degree))

    @staticmethod
    def spin(weights, share):
        total, reached = math.fsum(weights), 0.0
        for i, weight in enumerate(weights):
            reached += weight
            if share < reached / total:
                return i
        return len(weights) - 1


class Column:
    """A region: its head, and a list of members around it."""

    def __init__(self, head):
        self.head, self.list = head, []


def by_fitness(member):
    return member.fitness


def regions_of(size):
    """Return the most regions whose heads and lists of n, n - 1, ..., 1 members are at most this size."""
    n = 1
    while (n + 1) * (n + 4) // 2 <= size:
        n += 1
    return n


class Multivariate(Swarm):
    columns: list

    def rank(self):
        """Order the columns and cut their lists."""
        self.columns.sort(key=lambda column: column.head.fitness)
        for i, column in enumerate(self.columns):
            del column.list[len(self.columns) - i :]

    def enter(self, heads, limit):
        self.columns += [Column(head) for head in heads]
        self.columns.sort(key=lambda column: column.head.fitness)
        del self.columns[limit:]

    def begin(self, size):
        n = regions_of(size)
        self.columns = []
        count = size - n * (n + 1) // 2
        self.enter(self.draw(count, self.problem.initial_lower, self.problem.initial_upper), n)
        self.search_around(0.0, 20.0)

    def adopt(self, positions):
        found = sorted((self.member([float(v) for v in position]) for position in positions), key=by_fitness)
        n = regions_of(len(found))
        self.columns = [Column(member) for member in found[:n]]
        for member in found[n:]:
            with_room = [c for i, c in enumerate(self.columns) if len(c.list) < n - i]
            if with_room:
                nearest = min(with_room, key=lambda c: math.dist(c.head.position, member.position))
                nearest.list.append(member)

    def resize(self, size):
        n = regions_of(size)
        self.besides = size - n * (n + 3) // 2
        if n > len(self.columns):
            positions = [column.head.position for column in self.columns]
            box = naive.growth_box(positions, self.problem.lower, self.problem.upper)
            self.enter(self.draw(n - len(self.columns), *box), n)
        while n < len(self.columns):
            del self.columns[self.deletion_order([column.head for column in self.columns])[0]]
        self.rank()

    def iterate(self, repair_degree, radius):
        n = len(self.columns)
        self.enter(self.draw(n + self.besides, self.problem.lower, self.problem.upper), n)
        self.search_around(repair_degree, radius)

    def search_around(self, repair_degree, radius):
        n = len(self.columns)
        for i, column in enumerate(self.columns):
            centre = column.head
            del column.list[n - i :]
            for _ in range(n - i):
                if self.is_spent():
                    break
                near = [
                    x + radius * (2 * u - 1) for x, u in zip(centre.position, self.uniform(), strict=True)
                ]
                column.list.append(self.member(self.treated(self.clipped(near), repair_degree)))
                column.list.sort(key=by_fitness)
                del column.list[n - i :]
            if column.list and column.list[0].fitness < centre.fitness:
                column.head = column.list.pop(0)
                column.list.append(centre)
                column.list.sort(key=by_fitness)
        self.rank()

    def re_evaluate_members(self):
        self.members = self.stored()
        super().re_evaluate_members()
        alive = self.members
        self.columns = [column for column in self.columns if column.head in alive]
        for column in self.columns:
            column.list = sorted((member for member in column.list if member in alive), key=by_fitness)
            if column.list and column.list[0].fitness < column.head.fitness:
                column.list.append(column.head)
                column.head = column.list.pop(0)
                column.list.sort(key=by_fitness)
        self.rank()

    def stored(self):
        heads = [column.head for column in self.columns]
        return heads + [member for column in self.columns for member in column.list]


def oracles_by_name():
    """Return the oracle of each optimizer, without those that have none.

    It is the subclass of `Swarm` in a file `naive_*.py` that has the name of the optimizer's class.
    """
    modules = [import_module(f"oracles.{path.stem}") for path in Path(__file__).parent.glob("naive_*.py")]
    found = {
        name: value
        for module in modules
        for name, value in vars(module).items()
        if isinstance(value, type) and issubclass(value, Swarm) and value.__module__ == module.__name__
    }
    return {name: found[cls] for name, (_, cls) in OPTIMIZERS.items() if cls in found}


NAIVE = oracles_by_name()
