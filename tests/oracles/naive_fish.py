"""Plain-Python oracles for artificial fish swarms: standard, improved (IAFSA) and hybrid (HAAFSA-R).

Ways and lengths are in ranges of the workspace, component by component. A candidate is None where the budget
forbids it; no random numbers are drawn for it then.
"""

import math

from oracles.naive import added
from oracles.naive_swarm import Swarm


class FishSwarm(Swarm):
    """Fish that swarm and follow, and prey instead of either if it is no improvement."""

    def ranges(self):
        return [high - low for low, high in zip(self.problem.lower, self.problem.upper, strict=True)]

    def way(self, here, there):
        """Return the displacement from one position to another, in ranges."""
        return [
            (b - a) / extent if extent > 0 else 0.0
            for a, b, extent in zip(here, there, self.ranges(), strict=True)
        ]

    def distance(self, here, there):
        return norm(self.way(here, there)) / self.problem.unit_length

    def companions(self, position):
        return [
            member for member in self.members if 0 < self.distance(position, member.position) < self.visual
        ]

    def is_crowded(self, companions):
        return len(companions) / len(self.members) >= self.crowding

    def looked_at(self, position):
        return None if self.is_spent() else self.seen(position)

    def arrived(self, position):
        """Return the member that a fish becomes if it moves to this position."""
        return self.member(self.treated(self.clipped(position), self.repair_degree))

    def centre(self, members):
        sums = [0.0] * self.problem.dimension
        for member in members:
            sums = [total + x for total, x in zip(sums, member.position, strict=True)]
        return self.clipped([total / len(members) for total in sums])

    def displaced(self, position, displacement):
        """Return a position after a displacement in ranges."""
        parts = zip(position, displacement, self.ranges(), strict=True)
        return [x + by * extent for x, by, extent in parts]

    def scattered(self, position, reach):
        return self.displaced(position, [reach * (2 * u - 1) for u in self.uniform()])

    def approached(self, position, target, most, start=None):
        """Return a point up to this length from `start`, in the direction from a position to a target."""
        way = self.way(position, target)
        length = most * self.uniform()[0] * self.problem.unit_length
        whole = norm(way)
        directions = [part / whole if whole > 0 else 0.0 for part in way]
        return self.displaced(start or position, [length * part for part in directions])

    def step_to(self, fish, target):
        if self.is_spent():
            return None
        return self.arrived(self.approached(fish.position, target, self.stride))

    def leap(self, fish):
        if self.is_spent():
            return None
        return self.arrived(self.scattered(fish.position, self.visual))

    def prey(self, fish):
        for _ in range(self.tries):
            if self.is_spent():
                return None
            seen = self.seen(self.clipped(self.scattered(fish.position, self.visual)))
            if seen.fitness < fish.fitness:
                return self.step_to(fish, seen.position)
        return self.leap(fish)

    def swarm(self, fish, near):
        if not near:
            return self.prey(fish)
        centre = self.looked_at(self.centre(near))
        if centre is None:
            return None
        if centre.fitness < fish.fitness and not self.is_crowded(near):
            return self.step_to(fish, centre.position)
        return self.prey(fish)

    def follow(self, fish, near):
        if not near:
            return self.prey(fish)
        leader = min(near, key=lambda member: member.fitness)
        if leader.fitness < fish.fitness and not self.is_crowded(self.companions(leader.position)):
            return self.step_to(fish, leader.position)
        return self.prey(fish)

    def iterate(self, repair_degree, visual, step, crowding, tries):
        self.repair_degree, self.crowding, self.tries = repair_degree, crowding, int(tries)
        self.visual, self.stride = visual, step
        for i, fish in enumerate(self.members):
            if self.is_spent():
                return
            near = self.companions(fish.position)
            self.members[i] = better_of(fish, self.swarm(fish, near), self.follow(fish, near))


class ImprovedFishSwarm(FishSwarm):
    """Fish that begin as the better of opposites, follow the best so far, and move by a share beta."""

    def begin(self, size):
        super().begin(size)
        lower, upper = self.problem.initial_lower, self.problem.initial_upper
        for i, fish in enumerate(self.members):
            if self.is_spent():
                return
            parts = zip(lower, upper, fish.position, strict=True)
            opposite = self.member(self.clipped([low + high - x for low, high, x in parts]))
            if opposite.fitness < fish.fitness:
                self.members[i] = opposite

    def pulled(self, position):
        """Return the start of a move: nearer to the origin if eq. 15, 17 and 18 are as printed."""
        return [(1 - self.origin_pull * self.beta) * x for x in position]

    def prey(self, fish):
        for _ in range(self.tries):
            if self.is_spent():
                return None
            new = self.arrived(self.scattered(self.pulled(fish.position), self.beta * self.stride))
            if new.fitness < fish.fitness:
                return new
        return self.leap(fish)

    def step_to(self, fish, target):
        """Return the member after a step towards a target, or after preying if that is not better."""
        if self.is_spent():
            return None
        start = self.pulled(fish.position)
        new = self.arrived(self.approached(fish.position, target, self.beta * self.stride, start))
        return new if new.fitness < fish.fitness else self.prey(fish)

    def iterate(
        self,
        repair_degree,
        visual,
        step,
        smallest_visual,
        smallest_step,
        first_beta,
        last_beta,
        crowding,
        tries,
        origin_pull,
    ):
        x = self.iteration / self.iterations
        self.visual = visual * math.exp(-25 * x**3) + smallest_visual
        self.stride = step * math.exp(-math.pi * x**2) + smallest_step
        self.beta = first_beta - (first_beta - last_beta) * x
        self.repair_degree, self.crowding, self.tries = repair_degree, crowding, int(tries)
        self.origin_pull = origin_pull
        centre = self.looked_at(self.centre(self.members))
        if centre is None:
            return
        is_crowded = self.is_crowded(self.companions(centre.position))
        for i, fish in enumerate(self.members):
            if self.is_spent():
                return
            if centre.fitness < fish.fitness and not is_crowded:
                swarming = self.step_to(fish, centre.position)
            else:
                swarming = self.prey(fish)
            following = self.step_to(fish, self.best[2])
            self.members[i] = better_of(fish, swarming, following)


class HybridFishSwarm(FishSwarm):
    """Fish whose sight and step fall by segments of the run; prey has up to three rounds of tries."""

    def prey(self, fish):
        here = fish
        for _ in range(3):
            seen = []
            for _ in range(self.tries):
                if not self.is_spent():
                    seen.append(self.arrived(self.scattered(here.position, self.visual)))
            best = min(seen, key=lambda member: member.fitness, default=here)
            if best.fitness >= here.fitness:
                break
            here = best
        if here is not fish:
            return here
        if self.is_spent():
            return None
        return self.step_to(fish, self.best[2]) if self.uniform()[0] < 0.5 else self.leap(fish)

    def iterate(self, repair_degree, visual, step, smallest_visual, smallest_step, crowding, tries):
        x = self.iteration / self.iterations
        if x < 1 / 3:
            share = 1.0
        elif x < 2 / 3:
            share = 1 - 0.75 * (3 * x - 1)
        else:
            share = 0.25 * math.exp(-5 * (3 * x - 2))
        visual, step = share * visual, share * step
        if x >= 2 / 3:
            visual, step = max(smallest_visual, visual), max(smallest_step, step)
        tries = int(tries) * (1 + math.floor(3 * x))
        super().iterate(repair_degree, visual, step, crowding, tries)


def norm(way):
    return math.sqrt(added(part**2 for part in way))


def better_of(fish, *candidates):
    """Return the first of the best candidates; the fish if there are none."""
    return min((new for new in candidates if new is not None), key=lambda new: new.fitness, default=fish)
