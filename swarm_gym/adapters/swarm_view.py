"""One swarm as a library sees it: arrays of its members, an evaluation that counts, a random generator."""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import shown
from swarm_gym.ioh_problem import IohTable, IohTables, value
from swarm_gym.ioh_problem import select as select_ioh
from swarm_gym.population import Swarms
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.problem.tables import Tables, evaluate_entry, repair_entry, select
from swarm_gym.sources import note_arrival

Floats = NDArray[np.float64]


class BudgetSpentError(Exception):
    """The evaluation budget of the episode does not suffice for the rest of this iteration."""


class SwarmView:
    """One swarm during an iteration that a library carries out.

    Attributes:
        positions: (m, D) decision vectors of the members, in map units; a copy.
        fitness: (m,) their fitness, which is minimised; a copy.
        collision: (m,) their degrees of collision, map units; a copy.
        best_position: (D,) best decision vector so far; a copy.
        best_fitness: fitness of that vector.
        lower: (D,) lower bounds of decision vectors.
        upper: (D,) upper bounds.
        num_known: number of members that the library has seen before. They are the first ones.
        memory: (m, K) numbers that the library stored for each of the known members; a view.
        notes: (F,) numbers that it stored for the whole swarm; valid if any member is known; a view.
        repair_degree: phi in [0, 1] of this iteration.
        random: generator of this iteration. The seed of the episode and the past decisions determine it.

    Args:
        swarms: state of the swarms.
        tables: stacked problem tables.
        row: number of the swarm.
        num_known: number of its members that the library has seen before.
        repair_degree: phi in [0, 1].
    """

    def __init__(
        self, swarms: Swarms, tables: Tables | IohTables, row: int, num_known: int, repair_degree: float
    ):
        self._swarms, self._row = swarms, row
        number = swarms.problem[row]
        self._table = select_ioh(tables, number) if isinstance(tables, IohTable) else select(tables, number)
        dimension, size = int(self._table.dimension), int(swarms.size[row])
        self.positions = swarms.positions[row, :size, :dimension].copy()
        self.fitness = swarms.fitness[row, :size].copy()
        self.collision = swarms.collision[row, :size].copy()
        self.best_position = swarms.best_position[row, :dimension].copy()
        self.best_fitness = float(swarms.best_fitness[row])
        self.lower, self.upper = self._table.lower[:dimension], self._table.upper[:dimension]
        self.num_known = num_known
        self.memory, self.notes = swarms.memory[row, :size], swarms.field[row]
        self.repair_degree = repair_degree
        # The stream advances whenever members are drawn, and the iteration counts where none are.
        words = [int(word) for word in swarms.stream[row].ravel()]
        seed = np.random.SeedSequence(words, spawn_key=(int(swarms.iteration[row]),))
        self.random = np.random.default_rng(seed)
        self._path = np.zeros(swarms.positions.shape[2] + 1)

    def repaired(self, vectors: Floats) -> Floats:
        """Return decision vectors (n, D) inside the bounds, after one repair pass of degree phi."""
        inside = np.clip(vectors, self.lower, self.upper)
        if self.repair_degree > 0.0 and not isinstance(self._table, IohTable):
            for vector in inside:
                repair_entry(self._table, self._filled(vector), self.repair_degree)
                vector[:] = self._path[1 : len(vector) + 1]
        return inside

    def evaluate(self, vectors: Floats) -> tuple[Floats, Floats]:
        """Return fitness and degree of collision, (n,) each, of decision vectors (n, D) inside the bounds.

        Every vector counts as one evaluation, and the best so far is remembered.

        Raises:
            ValueError: if a number is not finite.
            BudgetSpentError: if the budget is spent before the last vector.
        """
        if not np.isfinite(vectors).all():
            raise ValueError(f"decision vectors must be finite, got {shown(vectors.tolist())}")
        swarms, row = self._swarms, self._row
        fitness, collision = np.empty(len(vectors)), np.empty(len(vectors))
        for i, vector in enumerate(vectors):
            if swarms.evaluations[row] >= swarms.budget[row]:
                raise BudgetSpentError
            fitness[i], collision[i] = self._scores(vector)
            swarms.evaluations[row] += 1
        return fitness, collision

    def evaluate_drawn(self, arrived: bool = False) -> None:
        """Evaluate the members that compiled code has drawn and counted, but could not evaluate.

        Their fitness is NaN, see `swarm_gym.ioh_problem`. Problems with kernels have no such members.

        Args:
            arrived: whether they are recorded as arrivals, which members of a first population are not.
        """
        swarms, row = self._swarms, self._row
        for i in np.flatnonzero(np.isnan(self.fitness)):
            best = swarms.best_fitness[row]
            scores = self._scores(self.positions[i])
            self.fitness[i], self.collision[i] = swarms.fitness[row, i], swarms.collision[row, i] = scores
            if arrived:
                note_arrival(swarms.arrivals[row], swarms.iteration[row], False, scores[0], best)
        self.best_position[:] = swarms.best_position[row, : len(self.lower)]
        self.best_fitness = float(swarms.best_fitness[row])

    def replace(self, positions: Floats, fitness: Floats, collision: Floats) -> None:
        """Make these the members: (n, D), (n,) and (n,), as `evaluate` gave them, n at most m.

        Raises:
            ValueError: if there are more members than before, or none.
        """
        swarms, row, size = self._swarms, self._row, len(positions)
        if not 1 <= size <= len(self.positions):
            raise ValueError(f"expected 1 to {len(self.positions)} members after an iteration, got {size}")
        swarms.positions[row, :size, : positions.shape[1]] = positions
        swarms.fitness[row, :size], swarms.collision[row, :size] = fitness, collision
        swarms.size[row] = size

    def _scores(self, vector: Floats) -> tuple[float, float]:
        """Return fitness and collision of a decision vector, (D,); remember it if it is the best so far."""
        swarms, row, path = self._swarms, self._row, self._filled(vector)
        if isinstance(self._table, IohTable):
            fitness, collision = value(self._table, vector), 0.0
        else:
            fitness, collision = evaluate_entry(self._table, path)
        if fitness < swarms.best_fitness[row]:
            swarms.best_fitness[row], swarms.best_collision[row] = fitness, collision
            swarms.best_position[row] = path[1:]
        if collision <= FEASIBILITY_TOLERANCE and fitness < swarms.feasible_fitness[row]:
            swarms.feasible_fitness[row] = fitness
            swarms.feasible_position[row] = path[1:]
        return fitness, collision

    def _filled(self, vector: Floats) -> Floats:
        """Return the scratch path (C + 1,) with this decision vector (D,)."""
        self._path[1 : len(vector) + 1] = vector
        return self._path
