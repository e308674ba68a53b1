"""Plain-Python oracle of differential evolution, L-SHADE; docs/readings-optimizers.md has its readings.

A generation first makes and evaluates all trials, then selects, archives and remembers.
"""

import math

from oracles.naive_swarm import Swarm


def rounded(value):
    return math.floor(value + 0.5)


def without(numbers, *left_out):
    return [number for number in numbers if number not in left_out]


def pick(choices, share):
    return choices[math.floor(share * len(choices))]


def lehmer(weights, values):
    top = math.fsum(w * value**2 for w, value in zip(weights, values, strict=True))
    return top / math.fsum(w * value for w, value in zip(weights, values, strict=True))


class DifferentialEvolution(Swarm):
    """Members, an archive of positions, and a memory of pairs (F, CR); a terminal CR is None."""

    LONGEST = 100

    def forget(self):
        self.archive, self.entry, self.filled = [], 0, 0.0
        self.factors, self.rates = [0.5] * self.LONGEST, [0.5] * self.LONGEST

    def begin(self, size):
        super().begin(size)
        self.forget()

    def adopt(self, positions):
        super().adopt(positions)
        self.forget()

    def numbers(self):
        return self.stream.padded_uniform(self.problem.dimension)

    def iterate(self, repair_degree, best_share, memory_length, archive_rate):
        size, length = len(self.members), rounded(memory_length)
        limit = rounded(archive_rate * size)
        while len(self.archive) > limit:
            place = math.floor(self.numbers()[0] * len(self.archive))
            self.archive[place] = self.archive[-1]
            self.archive.pop()
        by_fitness = sorted(self.members, key=lambda member: member.fitness)
        best = by_fitness[: max(rounded(best_share * size), 2)]
        trials = []
        for i in range(size):
            if self.is_spent():
                break
            x, factor, rate = self.trial(i, best, length)
            trials.append((self.member(self.treated(x, repair_degree)), factor, rate))
        won = []
        for i, (new, factor, rate) in enumerate(trials):
            old = self.members[i]
            if new.fitness < old.fitness:
                won.append((old.fitness - new.fitness, factor, rate))
                self.put_away(old.position, limit)
            if new.fitness <= old.fitness:
                self.members[i] = new
        if won:
            self.remember(won, length)
        self.length, self.filled = length, len(self.archive) / limit if limit else 0.0

    def trial(self, i, best, length):
        numbers, n = self.numbers(), self.problem.dimension
        entry = pick(range(length), numbers[0])
        rate = 0.0
        if self.rates[entry] is not None:
            normal = math.sqrt(-2 * math.log(1 - numbers[1])) * math.cos(2 * math.pi * numbers[2])
            rate = min(max(self.rates[entry] + 0.1 * normal, 0.0), 1.0)
        factor = self.factors[entry] + 0.1 * self.cauchy(numbers[3])
        towards = pick(best, numbers[4]).position
        positions = [member.position for member in self.members]
        everyone = positions + self.archive
        plus = minus = positions[i]
        if len(positions) > 1 and len(everyone) > 2:
            first = pick(without(range(len(positions)), i), numbers[5])
            second = pick(without(range(len(everyone)), i, first), numbers[6])
            plus, minus = positions[first], everyone[second]
        certain = pick(range(n), numbers[7])
        while factor <= 0:
            factor = self.factors[entry] + 0.1 * self.cauchy(self.numbers()[0])
        factor = min(factor, 1.0)
        mutant = [
            x + factor * (t - x) + factor * (p - m)
            for x, t, p, m in zip(positions[i], towards, plus, minus, strict=True)
        ]
        shares = self.numbers()
        crossed = [
            self.inside(k, mutant[k], x) if shares[k] < rate or k == certain else x
            for k, x in enumerate(positions[i])
        ]
        return crossed, factor, rate

    @staticmethod
    def cauchy(share):
        return math.tan(math.pi * (0.5 - share))

    def inside(self, k, wanted, member):
        low, high = self.problem.lower[k], self.problem.upper[k]
        if wanted < low:
            return (low + member) / 2
        return (high + member) / 2 if wanted > high else wanted

    def put_away(self, position, limit):
        if len(self.archive) < limit:
            self.archive.append(list(position))
        elif limit > 0:
            self.archive[math.floor(self.numbers()[0] * limit)] = list(position)

    def remember(self, won, length):
        gains, factors, rates = zip(*won, strict=True)
        weights = [gain / math.fsum(gains) for gain in gains]
        entry = self.entry % length
        self.factors[entry] = lehmer(weights, factors)
        if max(rates) == 0:
            self.rates[entry] = None
        if self.rates[entry] is not None:
            self.rates[entry] = lehmer(weights, rates)
        self.entry = (entry + 1) % length
