"""The plain-Python oracle of ants: a dense array of trails, all of which evaporate at once."""

import math
from typing import NamedTuple

from oracles.naive_walkers import MARGIN, Walkers, spin
from oracles.naive_walks import length_of


class AntParameters(NamedTuple):
    trail_weight: float = 1.0
    sight_weight: float = 0.25
    evaporation: float = 0.2
    deposit: float = 0.02
    elite_weight: float = 10.0


# Columns and rows of the moves of ants, in order.
MOVES = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
FIRST_TRAIL, LEAST_TRAIL, LARGEST_TRAIL = 1.0, 1e-4, 10.0
NEAREST = 0.5


class Ant:
    """A walk, as cells and as points, and its fitness."""

    def __init__(self, cells, arrived, problem):
        self.cells, self.arrived = cells, arrived
        self.points = [list(problem.start), *(problem.centre_of(cell) for cell in cells[1:])]
        if arrived:  # in the cell of the target, whose centre it need not pass
            self.points = [*([self.points[0]] if len(cells) == 1 else self.points[:-1]), problem.target]
        self.position, self.length = list(self.points[-1]), length_of(self.points)
        rest, self.collision = (0.0, 0.0) if arrived else problem.cost(self.position)
        self.fitness = self.length + rest

    def way(self):
        return self.points[:-1] if self.arrived else self.points

    def moves(self):
        """Yield (column, row, number of the move) of each move."""
        for (column, row), (to_column, to_row) in zip(self.cells, self.cells[1:], strict=False):
            yield column, row, MOVES.index((to_column - column, to_row - row))


class AntColony(Walkers):
    """Ants that walk from cell to cell, by the trails of the iteration before."""

    parameters = AntParameters()

    def begin(self, size):
        rows, columns = range(self.problem.height), range(self.problem.width)
        self.trails = [[[FIRST_TRAIL] * len(MOVES) for _ in columns] for _ in rows]
        self.num_ants = size
        self.iterate(0.0)

    def resize(self, size):
        self.num_ants = size

    def iterate(self, repair_degree, **parameters):
        if not self.is_spent():
            self.walk_all()
            self.lay_trails()

    def re_evaluate(self, problem):
        """Let ants walk on a map that has changed, without new trails."""
        self.problem = problem
        before, self.num_ants = self.best_ant, len(self.members)
        self.best, self.best_ant = (math.inf, math.inf, None), None
        way = self.best_walk
        self.walk_all()
        found, found_ant, found_walk = self.best, self.best_ant, self.best_walk
        if not self.is_spent():
            self.best, self.best_ant, self.best_walk = (0.0, 0.0, before.position), before, way
            self.renew_best()
            if found[0] < self.best[0] * (1 - MARGIN):
                self.best, self.best_ant, self.best_walk = found, found_ant, found_walk

    def walk_all(self):
        self.members = []
        while len(self.members) < self.num_ants and not self.is_spent():
            ant = self.walk()
            self.evaluations += 1
            self.members.append(ant)
            if self.best[2] is None or ant.fitness < self.best[0] * (1 - MARGIN):
                self.best_ant = ant
            self.offer(ant.fitness, ant.collision, ant.position, ant.way())

    def walk(self):
        problem = self.problem
        target, most = problem.cell_of(problem.target), 4 * (problem.width + problem.height)
        way, numbers = [problem.cell_of(problem.start)], []
        visited = set(way)
        for _ in range(most):
            if way[-1] == target:
                break
            column, row = way[-1]
            allowed = [k for k in range(len(MOVES)) if self.is_allowed(column, row, k, visited)]
            if allowed:
                numbers = numbers or self.block()
                weights = [self.weight(column, row, k, target) for k in allowed]
                by_column, by_row = MOVES[allowed[spin(weights, numbers.pop(0))]]
                way.append((column + by_column, row + by_row))
                visited.add(way[-1])
            elif len(way) == 1:
                break
            else:
                way.pop()
        return Ant(self.without_loops(way), way[-1] == target, problem)

    def without_loops(self, way):
        """Return the walk in which each cell is followed by the last one that a move reaches."""
        kept, rest = [way[0]], way[1:]
        while rest:
            column, row = kept[-1]
            moves = [k for k in range(len(MOVES)) if self.is_allowed(column, row, k, ())]
            reached = {(column + MOVES[k][0], row + MOVES[k][1]) for k in moves}
            last = max(i for i, cell in enumerate(rest) if cell in reached)
            kept.append(rest[last])
            rest = rest[last + 1 :]
        return kept

    def is_allowed(self, column, row, k, visited):
        is_free, (by_column, by_row) = self.problem.is_free, MOVES[k]
        cell = column + by_column, row + by_row
        beside = is_free(column + by_column, row) and is_free(column, row + by_row)
        return is_free(*cell) and cell not in visited and beside

    def weight(self, column, row, k, target):
        by_column, by_row = MOVES[k]
        distance = math.dist((column + by_column, row + by_row), target)
        trail = self.trails[row][column][k]
        exponent = self.parameters.sight_weight * math.dist(self.problem.cell_of(self.problem.start), target)
        return trail**self.parameters.trail_weight * (1 / (NEAREST + distance)) ** exponent

    def lay_trails(self):
        for row in self.trails:
            for cell in row:
                cell[:] = [(1 - self.parameters.evaporation) * trail for trail in cell]
        for ant in self.members:
            if ant.arrived:
                self.lay(ant, 1.0)
        if self.best_ant.arrived and self.best[1] == 0:  # on another map it may cross what was not there
            self.lay(self.best_ant, self.parameters.elite_weight)
        for row in self.trails:
            for cell in row:
                cell[:] = [min(max(trail, LEAST_TRAIL), LARGEST_TRAIL) for trail in cell]

    def lay(self, ant, weight):
        straight = math.dist(self.problem.start, self.problem.target)
        for column, row, k in ant.moves():
            self.trails[row][column][k] += weight * self.parameters.deposit * straight / ant.length
