"""Plain-Python oracle of CMA-ES, after the tutorial (arXiv:1604.00772v2), with NumPy's eigenvalues.

Its distribution has a mean in map units, and steps in ranges of the initial bounds.
"""

import math
from statistics import NormalDist

import numpy as np

from oracles import naive, naive_sources
from oracles.naive_swarm import Swarm

LEAST_SHARE = 2.0**-54
BETA = 0.4  # of PSA-CMA-ES


def weights_of(size):
    """Return weights before they are scaled, best member first, and the number of parents."""
    if size == 1:
        return np.ones(1), 1
    return math.log((size + 1) / 2) - np.log(np.arange(1, size + 1)), size // 2


class Settings:
    """Weights and learning rates by table 1 of the tutorial."""

    def __init__(self, n, size):
        raw, self.mu = weights_of(size)
        good, bad = raw[: self.mu], raw[self.mu :]
        self.mueff = good.sum() ** 2 / (good**2).sum()
        self.cs = (self.mueff + 2) / (n + self.mueff + 5)
        self.ds = 1 + 2 * max(0, math.sqrt((self.mueff - 1) / (n + 1)) - 1) + self.cs
        self.cc = (4 + self.mueff / n) / (n + 4 + 2 * self.mueff / n)
        self.c1 = 2 / ((n + 1.3) ** 2 + self.mueff)
        offset = 1 / 4 + self.mueff + 1 / self.mueff - 2
        self.cmu = min(1 - self.c1, 2 * offset / ((n + 2) ** 2 + self.mueff))
        self.weights = raw / good.sum()
        if (bad < 0).any():
            mueff_bad = bad.sum() ** 2 / (bad**2).sum()
            share = min(
                1 + self.c1 / self.cmu,
                1 + 2 * mueff_bad / (self.mueff + 2),
                (1 - self.c1 - self.cmu) / (n * self.cmu),
            )
            self.weights[self.mu :] = share * bad / abs(bad.sum())
        self.chi = math.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n**2))

    def expected_movement(self, n, gamma_s, gamma_c):
        """Return the mean squared length of a random step, by the formula of PSA-CMA-ES."""
        up, down = self.weights[: self.mu], self.weights[self.mu :]
        noise = gamma_s * (n - self.chi**2) / self.chi**2 * (self.cs / self.ds) ** 2
        path = self.cc * (2 - self.cc) * self.mueff
        spread = (
            self.cmu**2 * (n**2 + n) * (up**2).sum()
            + self.cmu**2 * (n**2 - n) * (down**2).sum()  # not in the paper, which has no negative weights
            + self.c1 * self.cmu * (n**2 + n) * path * (up**3).sum()
            + self.c1**2 * (gamma_c**2 * n**2 + (1 - 2 * gamma_c + 2 * gamma_c**2) * n)
        )
        return n / self.mueff + 2 * n * noise + (1 + 8 * noise) * spread / 2


class CmaEs(Swarm):
    """A swarm whose `members` are those of the last generation."""

    first_step = 0.3

    @property
    def ranges(self):
        inner = np.subtract(self.problem.initial_upper, self.problem.initial_lower)
        outer = np.subtract(self.problem.upper, self.problem.lower)
        return np.where(inner > 0, inner, outer)

    def settle(self, size):
        self.next_size, self.restarts = size, 0
        n = self.problem.dimension
        by_fitness = sorted(self.members, key=lambda member: member.fitness)
        raw, mu = weights_of(len(by_fitness))
        self.mean = raw[:mu] / raw[:mu].sum() @ np.array([member.position for member in by_fitness[:mu]])
        self.spread(n, self.first_step)

    def spread(self, n, first_step):
        self.sigma, self.covariance, self.root = first_step, np.eye(n), np.eye(n)
        self.step_path, self.covariance_path, self.decay = np.zeros(n), np.zeros(n), 1.0
        self.since_root, self.degenerate, self.stalled = 0, False, False
        self.movement, self.filled = np.zeros(n + n * n), 0.0

    def begin(self, size):
        super().begin(size)
        self.settle(size)

    def adopt(self, positions):
        super().adopt(positions)
        self.settle(len(positions))

    def resize(self, size):
        self.next_size = size

    def newcomer(self, lower, upper):
        return naive_sources.newcomer(self.problem, self.source, self.stream, lower, upper)

    def begin_anew(self, first_step):
        self.mean = np.array(self.newcomer(self.problem.initial_lower, self.problem.initial_upper)[0])
        self.spread(self.problem.dimension, first_step)
        self.restarts += 1

    def iterate(self, repair_degree, first_step, step_factor, restart, restarts):
        if self.is_spent():
            return
        if restart >= 0.5 or self.degenerate or (self.stalled and restarts == 0):
            self.begin_anew(first_step)
        self.sigma *= step_factor
        size, n = self.next_size, self.problem.dimension
        positions = [member.position for member in self.members]
        box = naive.growth_box(positions, self.problem.lower, self.problem.upper)
        num_immigrants = min(math.floor(self.source.immigrants * size + 0.5), size - 1)
        drawn = []  # members, their steps, squared lengths and excesses
        while len(drawn) < size and not self.is_spent():
            own = len(drawn) < size - num_immigrants
            drawn.append(self.own_child(repair_degree) if own else self.immigrant(*box))
        self.members = [member for member, *_ in drawn]
        if len(drawn) == size:
            self.learn(Settings(n, size), drawn)

    def own_child(self, repair_degree):
        normals = [NormalDist().inv_cdf(max(share, LEAST_SHARE)) for share in self.uniform()]
        step = self.root @ normals
        wanted = self.mean + self.sigma * self.ranges * step
        inside = self.clipped(wanted.tolist())
        treated = self.treated(inside, repair_degree)
        if treated != inside:
            return self.injected(self.member(treated))
        beyond = (wanted - inside) / (self.sigma * self.ranges)
        excess = np.mean(beyond**2 / np.diag(self.covariance))
        return self.member(inside), step, float(np.dot(normals, normals)), excess

    def immigrant(self, lower, upper):
        position, smooth = self.newcomer(lower, upper)
        best = self.best[0]
        member = self.member(position)
        if smooth:
            self.best_smooth = min(self.best_smooth, member.fitness)
        self.became_best += member.fitness < best
        return self.injected(member)

    def injected(self, member):
        """Return a member from elsewhere with the step to it, clipped as in arXiv:1110.4181."""
        n = self.problem.dimension
        step = (np.array(member.position) - self.mean) / (self.sigma * self.ranges)
        length = np.linalg.norm(np.linalg.solve(self.root, step))
        share = min(1.0, (math.sqrt(n) + 2 * n / (n + 2)) / length) if length > 0 else 1.0
        return member, share * step, (share * length) ** 2, 0.0

    def learn(self, rates, drawn):
        n, weights = self.problem.dimension, rates.weights
        by_fitness = sorted(member.fitness for member, *_ in drawn)
        spread = by_fitness[3 * len(drawn) // 4] - by_fitness[len(drawn) // 4]
        ranked = sorted(drawn, key=lambda one: one[0].fitness + 2 * spread * one[3])
        steps = np.array([step for _, step, _, _ in ranked])
        mean_step = weights[: rates.mu] @ steps[: rates.mu]
        self.mean = self.mean + self.sigma * self.ranges * mean_step
        gain = math.sqrt(rates.cs * (2 - rates.cs) * rates.mueff)
        round_step = np.linalg.solve(self.root, mean_step)
        former = self.sigma**2 * self.root @ self.root
        self.step_path = (1 - rates.cs) * self.step_path + gain * round_step
        length = np.linalg.norm(self.step_path) / rates.chi
        self.sigma *= math.exp(min(1.0, rates.cs / rates.ds * (length - 1)))
        self.decay *= (1 - rates.cs) ** 2
        moves = length / math.sqrt(1 - self.decay) < 1.4 + 2 / (n + 1)
        gain = moves * math.sqrt(rates.cc * (2 - rates.cc) * rates.mueff)
        self.covariance_path = (1 - rates.cc) * self.covariance_path + gain * mean_step
        kept = 1 - rates.c1 - rates.cmu * weights.sum() + (1 - moves) * rates.c1 * rates.cc * (2 - rates.cc)
        self.covariance = kept * self.covariance + rates.c1 * np.outer(
            self.covariance_path, self.covariance_path
        )
        for weight, (_, step, square, _) in zip(weights, ranked, strict=True):
            factor = 1.0 if weight >= 0 else n / square
            self.covariance = self.covariance + rates.cmu * weight * factor * np.outer(step, step)
        self.filled = (1 - rates.cc) ** 2 * self.filled + moves * rates.cc * (2 - rates.cc)
        self.move(rates, round_step, former)
        self.since_root += 1
        if self.since_root >= 1 / (10 * n * (rates.c1 + rates.cmu)):
            self.since_root = 0
            values, vectors = np.linalg.eigh(self.covariance)
            self.root = (vectors * np.sqrt(values)) @ vectors.T

    def move(self, rates, round_step, former):
        """Follow the distribution by the Fisher information of the former one, as in PSA-CMA-ES."""
        values, vectors = np.linalg.eigh(former)
        inverse = (vectors / np.sqrt(values)) @ vectors.T
        change = inverse @ (self.sigma**2 * self.covariance - former) @ inverse
        step = np.concatenate([round_step, change.ravel() / math.sqrt(2)])
        expected = rates.expected_movement(self.problem.dimension, 1 - self.decay, self.filled)
        gain = math.sqrt(BETA * (2 - BETA) / expected)
        self.movement = (1 - BETA) * self.movement + gain * step
