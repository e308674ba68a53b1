"""The plain-Python oracle of glowworms."""

import math
from typing import NamedTuple

from oracles.naive import added
from oracles.naive_walkers import Walkers, spin
from oracles.naive_walks import length_of

# The share of a step that rounding may be, of one away and back.
ROUNDING = 1e-9

GLOWS = ("relay", "sight", "distance")
SELECTIONS = ("brightest", "proportional")
LEVELS = ("raw", "differences")
DIMMINGS = ("rational", "exponential")
RANGE_RULES = ("fixed", "adaptive")
WANDERINGS = ("straight", "anywhere")


class GlowwormParameters(NamedTuple):
    decay: float = 0.4
    gain: float = 0.6
    absorption: float = 5.0
    step: float = 0.005
    first_luciferin: float = 5.0
    decision_range: float = 2.0
    glow: float = 0
    selection: float = 0
    levels: float = 0
    dimming: float = 0
    range_rule: float = 0
    wandering: float = 0


class Glowworm(Walkers):
    """Points that move to brighter points in sight; the path is the trajectory of the first, the robot."""

    parameters = GlowwormParameters()

    # The first population, and other ones.

    def begin(self, size):
        self.place_robot()
        k = math.isqrt(size - 1)
        lower, upper = self.problem.lower, self.problem.upper
        for a in range(k):
            for b in range(k):
                shares = (a + 0.5) / k, (b + 0.5) / k
                point = [
                    low + (high - low) * share for low, high, share in zip(lower, upper, shares, strict=True)
                ]
                self.place(point if self.problem.is_free(*self.problem.cell_of(point)) else None)
        while len(self.members) < size and not self.is_spent():
            self.place()

    def adopt(self, positions):
        self.place_robot()
        for position in positions[1:]:
            self.place(self.problem.freed([float(value) for value in position]))

    def place_robot(self):
        self.trajectory = [list(self.problem.start)]
        self.place(self.problem.start)
        self.offer_robot()

    def place(self, point=None, luciferin=None):
        """Add a member if an evaluation is left, at a given point or at one that is drawn."""
        if not self.is_spent():
            member = self.seen(self.problem.drawn(self.block()) if point is None else point)
            member.luciferin = self.parameters.first_luciferin if luciferin is None else luciferin
            member.range, member.heading = math.inf, None
            self.members.append(member)

    def full_range(self):
        return self.parameters.decision_range * self.problem.side

    def resize(self, size):
        mean = added(member.luciferin for member in self.members) / len(self.members)
        while len(self.members) < size and not self.is_spent():
            self.place(luciferin=mean)
        robot, others = self.members[0], self.members[1:]
        doomed = self.deletion_order(others)[: max(len(self.members) - size, 0)]
        self.members = [robot, *(member for i, member in enumerate(others) if i not in doomed)]

    def re_evaluate(self, problem):
        """Place all members but the robot anew, on a map that has changed."""
        self.problem, number, here = problem, len(self.members), self.members[0].position
        there = problem.freed(here)
        if there != here:
            self.trajectory.append(there)
        self.members = []
        self.place(there)
        for _ in range(number - 1):
            self.place()
        self.renew_best()
        self.offer_robot()

    # An iteration.

    def iterate(self, repair_degree, **parameters):
        here = [list(member.position) for member in self.members]
        target = self.problem.target
        sight = [[self.problem.sees(a, b) for b in [*here, target]] for a in here]
        self.shine(here, sight)
        glowing = [member.luciferin for member in self.members]
        for i in range(len(here)):
            there = self.next_place(i, here, glowing, sight[i])
            if there != here[i] and not self.is_spent():
                self.move(i, there)
        self.arrive()

    def shine(self, here, sight):
        decay, gain = self.parameters.decay, self.parameters.gain
        gamma = self.parameters.absorption / self.problem.side
        ways = [math.dist(point, self.problem.target) for point in here]
        glow = GLOWS[int(self.parameters.glow)]
        if glow == "distance":
            shares = [1 - way / self.problem.diagonal for way in ways]
        else:
            costs = [way if seen[-1] else math.inf for way, seen in zip(ways, sight, strict=True)]
            if glow == "relay":
                costs = relayed(costs, here, sight)
            shares = [0.0 if math.isinf(cost) else 1 / (1 + gamma * cost) for cost in costs]
        for member, share in zip(self.members, shares, strict=True):
            member.luciferin = (1 - decay) * member.luciferin + gain * share  # eq. 5

    def next_place(self, i, here, glowing, seen):
        """Return the next place of member i, by the present places of all; its own place if it stays."""
        eta = self.parameters.step * self.problem.side
        beacon = self.parameters.gain / self.parameters.decay if self.parameters.decay > 0 else math.inf
        places, levels = [*here, self.problem.target], [*glowing, beacon]
        member, own = self.members[i], here[i]
        reach = min(member.range, self.full_range())
        near = [
            k
            for k, place in enumerate(places)
            if k != i and levels[k] > glowing[i] and math.dist(own, place) < reach and seen[k]
        ]
        if RANGE_RULES[int(self.parameters.range_rule)] == "adaptive":
            wider = reach + 0.08 / 0.03 * eta * (5 - len(near))
            member.range = min(max(wider, 0.0), self.full_range())
        if not near:
            return self.wandered(member, own, eta)
        member.heading = None
        goal = places[self.chosen(near, levels, glowing[i], [math.dist(own, places[k]) for k in near])]
        distance = math.dist(own, goal)
        if distance <= eta * (1 + ROUNDING):
            return list(goal)
        return [a + eta * (b - a) / distance for a, b in zip(own, goal, strict=True)]  # eq. 4

    def wandered(self, member, own, eta):
        """Return the place a step further; draw the direction if there is none; stay if it is blocked."""
        if member.heading is None or WANDERINGS[int(self.parameters.wandering)] == "anywhere":
            member.heading = 2 * math.pi * self.block()[0]
        there = [own[0] + eta * math.cos(member.heading), own[1] + eta * math.sin(member.heading)]
        if self.problem.sees(own, there):
            return there
        member.heading = None
        return own

    def chosen(self, near, levels, own_level, distances):
        is_proportional = SELECTIONS[int(self.parameters.selection)] == "proportional"
        share = self.block()[0] if is_proportional else None
        if math.isinf(levels[near[-1]]):
            return near[-1]  # the target, where it outshines everything
        amounts = [levels[k] for k in near]
        if is_proportional and LEVELS[int(self.parameters.levels)] == "differences":
            amounts = [level - own_level for level in amounts]
        perceived = [self.dimmed(*pair) for pair in zip(amounts, distances, strict=True)]
        if not is_proportional:
            return near[perceived.index(max(perceived))]
        return near[spin(perceived, share)]  # eq. 1

    def dimmed(self, level, distance):
        gamma = self.parameters.absorption / self.problem.side
        if DIMMINGS[int(self.parameters.dimming)] == "exponential":
            return level * math.exp(-gamma * distance)  # eq. 2
        return level / (1 + gamma * distance)  # eq. 3

    def move(self, i, there):
        member, new = self.members[i], self.seen(there)
        member.position, member.fitness, member.collision = new.position, new.fitness, new.collision
        if i == 0:
            self.trajectory.append(list(there))
            self.offer_robot()

    def offer_robot(self):
        robot = self.members[0]
        walked = length_of(self.trajectory)
        self.offer(walked + robot.fitness, robot.collision, robot.position, self.trajectory)

    def arrive(self):
        """Put the robot at the target and end the episode, if it is within a step and sees it."""
        robot, target = self.members[0], self.problem.target
        eta = self.parameters.step * self.problem.side
        near = math.dist(robot.position, target) <= eta * (1 + ROUNDING)
        if near and self.problem.sees(robot.position, target):
            if robot.position != target:
                self.trajectory.append(list(target))
            robot.position, robot.fitness, robot.collision = list(target), 0.0, 0.0
            self.offer_robot()
            self.budget = self.evaluations


def relayed(costs, here, sight):
    """Return the lengths of shortest paths to the target from member to member in sight (Bellman-Ford)."""
    costs = list(costs)
    while True:
        before = list(costs)
        for i, a in enumerate(here):
            for k, b in enumerate(here):
                if k != i and sight[i][k]:
                    costs[i] = min(costs[i], math.dist(a, b) + costs[k])
        if costs == before:
            return costs
