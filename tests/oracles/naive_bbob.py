"""The BBOB functions in plain Python, step by step as RR-6829 defines them, on lists.

What an instance draws (x_opt, R, Q, peaks) comes from the scenario; `ioh` checks that it is what BBOB draws.
"""

import itertools
import math


def sign(a):
    return (a > 0) - (a < 0)


def oscillated(a):
    """T_osz of one number."""
    if a == 0:
        return 0.0
    logarithm = math.log(abs(a))
    first, second = (10.0, 7.9) if a > 0 else (5.5, 3.1)
    return sign(a) * math.exp(
        logarithm + 0.049 * (math.sin(first * logarithm) + math.sin(second * logarithm))
    )


def asymmetric(x, beta):
    """T_asy^beta."""
    return [a ** (1 + beta * k / (len(x) - 1) * math.sqrt(a)) if a > 0 else a for k, a in enumerate(x)]


def conditioned(x, alpha):
    """Lambda^alpha x."""
    return [alpha ** (0.5 * k / (len(x) - 1)) * a for k, a in enumerate(x)]


def weighted(x, base):
    return math.fsum(base ** (k / (len(x) - 1)) * a**2 for k, a in enumerate(x))


def squares(x):
    return math.fsum(a**2 for a in x)


def times(matrix, x):
    return [math.fsum(m * a for m, a in zip(row, x, strict=True)) for row in matrix]


def outside(x):
    """f_pen."""
    return math.fsum(max(0.0, abs(a) - 5) ** 2 for a in x)


def rastrigin_of(z):
    return 10 * (len(z) - math.fsum(math.cos(2 * math.pi * a) for a in z)) + squares(z)


def rosenbrock_of(z):
    return math.fsum(100 * (a**2 - b) ** 2 + (a - 1) ** 2 for a, b in itertools.pairwise(z))


class Function:
    """One instance of a BBOB function, without f_opt."""

    def __init__(self, drawn):
        self.number, self.D = drawn.function, drawn.dimension
        self.x_opt = drawn.optimum.tolist()
        self.R, self.Q = drawn.first_rotation.tolist(), drawn.second_rotation.tolist()
        self.scale = max(1, math.sqrt(self.D) / 8)
        self.peaks = drawn.peaks if self.number in (21, 22) else None

    def __call__(self, x):
        from_optimum = [a - b for a, b in zip(x, self.x_opt, strict=True)]
        return getattr(self, f"f{self.number}")(list(x), from_optimum)

    def f1(self, x, d):
        return squares(d)

    def f2(self, x, d):
        return weighted([oscillated(a) for a in d], 1e6)

    def f3(self, x, d):
        return rastrigin_of(conditioned(asymmetric([oscillated(a) for a in d], 0.2), 10))

    def f4(self, x, d):
        z = [oscillated(a) for a in d]
        z = [
            (10 if a > 0 and k % 2 == 0 else 1) * math.sqrt(10) ** (k / (self.D - 1)) * a
            for k, a in enumerate(z)
        ]
        return rastrigin_of(z) + 100 * outside(x)

    def f5(self, x, d):
        value = 0.0
        for k, (a, best) in enumerate(zip(x, self.x_opt, strict=True)):
            slope = sign(best) * 10 ** (k / (self.D - 1))
            value += 5 * abs(slope) - slope * (a if best * a < 25 else best)
        return value

    def f6(self, x, d):
        z = times(self.Q, conditioned(times(self.R, d), 10))
        stretched = [(100 if a * best > 0 else 1) * a for a, best in zip(z, self.x_opt, strict=True)]
        return oscillated(squares(stretched)) ** 0.9

    def f7(self, x, d):
        hat = conditioned(times(self.R, d), 10)
        tilde = [math.floor(0.5 + a) if abs(a) > 0.5 else math.floor(0.5 + 10 * a) / 10 for a in hat]
        return 0.1 * max(abs(hat[0]) / 1e4, weighted(times(self.Q, tilde), 100)) + outside(x)

    def f8(self, x, d):
        return rosenbrock_of([self.scale * a + 1 for a in d])

    def f9(self, x, d):
        return rosenbrock_of([self.scale * a + 0.5 for a in times(self.R, x)])

    def f10(self, x, d):
        return weighted([oscillated(a) for a in times(self.R, d)], 1e6)

    def f11(self, x, d):
        z = [oscillated(a) for a in times(self.R, d)]
        return 1e6 * z[0] ** 2 + squares(z[1:])

    def f12(self, x, d):
        z = times(self.R, asymmetric(times(self.R, d), 0.5))
        return z[0] ** 2 + 1e6 * squares(z[1:])

    def f13(self, x, d):
        z = times(self.Q, conditioned(times(self.R, d), 10))
        return z[0] ** 2 + 100 * math.sqrt(squares(z[1:]))

    def f14(self, x, d):
        return math.sqrt(
            math.fsum(abs(a) ** (2 + 4 * k / (self.D - 1)) for k, a in enumerate(times(self.R, d)))
        )

    def f15(self, x, d):
        z = asymmetric([oscillated(a) for a in times(self.R, d)], 0.2)
        return rastrigin_of(times(self.R, conditioned(times(self.Q, z), 10)))

    def f16(self, x, d):
        z = [oscillated(a) for a in times(self.R, d)]
        z = times(self.R, conditioned(times(self.Q, z), 0.01))
        at_0 = math.fsum(math.cos(math.pi * 3**k) / 2**k for k in range(12))
        total = math.fsum(math.cos(2 * math.pi * 3**k * (a + 0.5)) / 2**k for a in z for k in range(12))
        return 10 * (total / self.D - at_0) ** 3 + 10 / self.D * outside(x)

    def schaffers(self, x, d, alpha):
        z = conditioned(times(self.Q, asymmetric(times(self.R, d), 0.5)), alpha)
        s = [math.hypot(a, b) for a, b in itertools.pairwise(z)]
        mean = math.fsum(math.sqrt(a) * (1 + math.sin(50 * a**0.2) ** 2) for a in s) / (self.D - 1)
        return mean**2 + 10 * outside(x)

    def f17(self, x, d):
        return self.schaffers(x, d, 10)

    def f18(self, x, d):
        return self.schaffers(x, d, 1000)

    def f19(self, x, d):
        z = [self.scale * a + 0.5 for a in times(self.R, x)]
        s = [100 * (a**2 - b) ** 2 + (a - 1) ** 2 for a, b in itertools.pairwise(z)]
        return 10 / (self.D - 1) * math.fsum(a / 4000 - math.cos(a) for a in s) + 10

    def f20(self, x, d):
        twice = [2 * abs(best) for best in self.x_opt]
        hat = [2 * sign(best) * a for a, best in zip(x, self.x_opt, strict=True)]
        tilde = [hat[0]] + [b + 0.25 * (a - best) for a, b, best in zip(hat, hat[1:], twice, strict=False)]
        moved = conditioned([a - best for a, best in zip(tilde, twice, strict=True)], 10)
        z = [100 * (a + best) for a, best in zip(moved, twice, strict=True)]
        total = math.fsum(a * math.sin(math.sqrt(abs(a))) for a in z)
        return 4.189828872724339 - total / (100 * self.D) + 100 * outside([a / 100 for a in z])

    def gallagher(self, x, d):
        best = 0.0
        for place, condition, height in zip(*self.peaks, strict=True):
            y = times(self.R, [a - b for a, b in zip(x, place.tolist(), strict=True)])
            quadratic = math.fsum(c * a**2 for c, a in zip(condition.tolist(), y, strict=True))
            best = max(best, float(height) * math.exp(-quadratic / (2 * self.D)))
        return oscillated(10 - best) ** 2 + outside(x)

    f21 = f22 = gallagher

    def f23(self, x, d):
        z = times(self.Q, conditioned(times(self.R, d), 100))
        product = 1.0
        for k, a in enumerate(z, 1):
            rough = math.fsum(abs(2**j * a - math.floor(2**j * a + 0.5)) / 2**j for j in range(1, 33))
            product *= (1 + k * rough) ** (10 / self.D**1.2)
        return 10 / self.D**2 * product - 10 / self.D**2 + outside(x)

    def f24(self, x, d):
        mu_0, depth = 2.5, 1.0
        s = 1 - 1 / (2 * math.sqrt(self.D + 20) - 8.2)
        mu_1 = -math.sqrt((mu_0**2 - depth) / s)
        hat = [2 * sign(best) * a for a, best in zip(x, self.x_opt, strict=True)]
        z = times(self.Q, conditioned(times(self.R, [a - mu_0 for a in hat]), 100))
        funnels = min(squares([a - mu_0 for a in hat]), depth * self.D + s * squares([a - mu_1 for a in hat]))
        waves = 10 * (self.D - math.fsum(math.cos(2 * math.pi * a) for a in z))
        return funnels + waves + 1e4 * outside(x)


class MetaBoxFunction(Function):
    """One instance of a function as MetaBox has it: the separable ones are of a rotated vector."""

    def f2(self, x, d):
        return super().f2(x, times(self.R, d))

    def f3(self, x, d):
        return super().f3(x, times(self.R, d))

    def f4(self, x, d):
        return super().f4(x, times(self.R, d))


class Problem:
    """The oracle of a `BbobProblem`."""

    unit_length = 1.0

    def __init__(self, problem):
        kind = MetaBoxFunction if problem.scenario.suite.title == "MetaBox" else Function
        self.function = kind(problem.scenario.drawn)
        self.dimension = problem.scenario.dimension
        self.lower, self.upper = [-5.0] * self.dimension, [5.0] * self.dimension
        self.initial_lower, self.initial_upper = self.lower, self.upper

    def cost(self, vector):
        return max(0.0, self.function(vector)), 0.0

    def repaired(self, vector, repair_degree):
        return list(vector)
