"""Algorithms of pymoo under control: its genetic algorithm and its particle swarm.

Source: J. Blank, K. Deb, "pymoo: multi-objective optimization in Python", IEEE Access 2020. Before every
iteration an algorithm is made and told the members. Then it is asked for new vectors, which are repaired,
evaluated and told. This is pymoo's own ask-and-tell interface.
"""

from abc import abstractmethod
from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.adapters.library import LibraryOptimizer, OwnParameters
from swarm_gym.adapters.swarm_view import SwarmView
from swarm_gym.errors import MissingExtraError
from swarm_gym.optimizers.parameter import Parameter
from swarm_gym.problem.tables import Tables

try:
    from pymoo.algorithms.soo.nonconvex.ga import GA
    from pymoo.algorithms.soo.nonconvex.pso import PSO
    from pymoo.core.algorithm import Algorithm
    from pymoo.core.population import Population
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination
    from pymoo.operators.crossover.sbx import SBX
    from pymoo.operators.mutation.pm import PM
except ImportError as error:
    raise MissingExtraError("swarm_gym.adapters.pymoo", "pymoo", "adapters") from error

Floats = NDArray[np.float64]

COLLISION = "collision"  # what individuals carry beside pymoo's own data


class PymooOptimizer(LibraryOptimizer[OwnParameters]):
    """A single-objective algorithm of pymoo; a subclass implements `make`.

    That is enough for an algorithm whose whole memory is its population, as most evolutionary ones are. One
    that remembers more implements `restore` and `store`, too; `PymooParticleSwarm` is the example.
    """

    @classmethod
    @abstractmethod
    def make(cls, size: int, parameters: OwnParameters) -> Algorithm:
        """Return the algorithm for a population of this size."""

    @classmethod
    def restore(cls, algorithm: Algorithm, swarm: SwarmView) -> None:
        """Tell a new algorithm the members, and write what it remembered of the known ones into it."""
        algorithm.tell(infills=individuals(swarm))

    @classmethod
    def store(cls, algorithm: Algorithm, swarm: SwarmView) -> Population:  # noqa: ARG003
        """Write what the algorithm remembers into `memory` and `notes`; return the members."""
        return algorithm.pop

    @classmethod
    def iterate(cls, swarm: SwarmView, parameters: OwnParameters) -> None:
        """Advance one swarm by one iteration: ask, repair, evaluate, tell.

        Where pymoo finds no vector that differs from the members, they stay.
        """
        algorithm = cls.make(len(swarm.positions), parameters)
        problem = Problem(n_var=len(swarm.lower), n_obj=1, xl=swarm.lower, xu=swarm.upper)
        algorithm.setup(problem, termination=NoTermination())
        algorithm.random_state = swarm.random
        cls.restore(algorithm, swarm)
        asked = algorithm.ask()
        if asked is None:
            return
        asked.set("X", swarm.repaired(asked.get("X")))
        fitness, collision = swarm.evaluate(asked.get("X"))
        asked.set("F", fitness[:, None], COLLISION, collision)
        algorithm.tell(infills=asked)
        members = cls.store(algorithm, swarm)
        swarm.replace(members.get("X"), members.get("F")[:, 0], members.get(COLLISION))


def individuals(swarm: SwarmView) -> Population:
    """Return the members of a swarm as a population that is evaluated."""
    return _evaluated(swarm.positions, swarm.fitness, swarm.collision)


def _evaluated(positions: Floats, fitness: Floats, collision: Floats) -> Population:
    members = Population.new(X=positions, F=np.reshape(fitness, (-1, 1)))
    members.set(COLLISION, collision)
    return members


class PymooGeneticParameters(NamedTuple):
    """Parameters of pymoo's genetic algorithm, with its defaults."""

    crossover: Annotated[
        float, Parameter(0.9, 0.0, 1.0, "p_c", "probability that two parents are crossed", (0.1, 1.0))
    ]
    crossover_index: Annotated[
        float, Parameter(15.0, 1.0, 100.0, "eta_c", "closeness of children to their parents", (2.0, 50.0))
    ]
    mutation_index: Annotated[
        float, Parameter(20.0, 1.0, 500.0, "eta_m", "closeness of mutants to their origin", (2.0, 200.0))
    ]


class Genetic(PymooOptimizer[PymooGeneticParameters]):
    """pymoo's `GA`: tournaments, simulated binary crossover, polynomial mutation, survival of the fittest."""

    name = "swarm_gym.adapters.pymoo:Genetic"
    parameter_class = PymooGeneticParameters

    @classmethod
    def make(cls, size: int, parameters: PymooGeneticParameters) -> Algorithm:
        """Return the algorithm for a population of this size."""
        crossover = SBX(prob=parameters.crossover, eta=parameters.crossover_index)
        return GA(pop_size=size, crossover=crossover, mutation=PM(eta=parameters.mutation_index))


class PymooSwarmParameters(NamedTuple):
    """Parameters of pymoo's particle swarm, with its defaults."""

    velocity_limit: Annotated[
        float, Parameter(0.2, 1e-3, 1.0, "v_max", "largest velocity as a share of the range", (0.01, 0.5))
    ]


class PymooParticleSwarm(PymooOptimizer[PymooSwarmParameters]):
    """pymoo's `PSO`, which adapts inertia and weights itself; members are the particles where they are now.

    Each member remembers its velocity, its best position and that fitness and collision.
    """

    name = "swarm_gym.adapters.pymoo:ParticleSwarm"
    parameter_class = PymooSwarmParameters
    smallest_population = 2  # pymoo adapts itself by distances between particles
    adapted: ClassVar[tuple[str, ...]] = ("w", "c1", "c2")

    @staticmethod
    def memory_columns(dimension: int) -> int:
        """Return K: velocity and best position, (D,) each, and fitness and collision of that position."""
        return 2 * dimension + 2

    @staticmethod
    def field_size(tables: Tables) -> int:  # noqa: ARG004
        """Return F: the numbers that pymoo adapts, inertia and two weights."""
        return len(PymooParticleSwarm.adapted)

    @classmethod
    def make(cls, size: int, parameters: PymooSwarmParameters) -> Algorithm:
        """Return the algorithm for a population of this size."""
        return PSO(pop_size=size, max_velocity_rate=parameters.velocity_limit)

    @classmethod
    def restore(cls, algorithm: Algorithm, swarm: SwarmView) -> None:
        """Begin with the members; known ones get back their velocities and best positions."""
        known, dimension = swarm.num_known, swarm.positions.shape[1]
        velocity, best, scores = np.split(swarm.memory[:known], [dimension, 2 * dimension], axis=1)
        positions = np.vstack([best, swarm.positions[known:]])
        fitness = np.append(scores[:, 0], swarm.fitness[known:])
        algorithm.tell(
            infills=_evaluated(positions, fitness, np.append(scores[:, 1], swarm.collision[known:]))
        )
        drawn = algorithm.particles.get("V")  # velocities that pymoo draws for new members
        algorithm.particles = individuals(swarm)
        algorithm.particles.set("V", np.vstack([velocity, drawn[known:]]))
        if known:
            for name, value in zip(cls.adapted, swarm.notes.tolist(), strict=True):
                setattr(algorithm, name, value)

    @classmethod
    def store(cls, algorithm: Algorithm, swarm: SwarmView) -> Population:
        """Write velocities, best positions and adapted numbers; return the particles."""
        velocity = algorithm.particles.get("V")
        best, fitness, collision = algorithm.pop.get("X", "F", COLLISION)
        swarm.memory[:] = np.column_stack([velocity, best, fitness, collision])
        swarm.notes[:] = [getattr(algorithm, name) for name in cls.adapted]
        return algorithm.particles


ParticleSwarm = PymooParticleSwarm  # what users name, `swarm_gym.adapters.pymoo:ParticleSwarm`
