"""Algorithms of niapy under control: its particle swarm and its firefly algorithm.

Source: G. Vrbančič et al., "NiaPy: Python microframework for building nature-inspired algorithms", Journal of
Open Source Software 2018. Before every iteration an algorithm is made, and `run_iteration` is called with the
members. Algorithms of niapy move one member after the other and evaluate it at once. The repair of degree phi
takes the place of niapy's repair function, which algorithms call before each evaluation.
"""

from abc import abstractmethod
from typing import Annotated, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.adapters.library import LibraryOptimizer, OwnParameters
from swarm_gym.adapters.swarm_view import SwarmView
from swarm_gym.errors import MissingExtraError
from swarm_gym.optimizers.firefly import Firefly as CompiledFirefly
from swarm_gym.optimizers.parameter import Parameter
from swarm_gym.problem.tables import Tables

try:
    from niapy.algorithms.algorithm import Algorithm
    from niapy.algorithms.basic import FireflyAlgorithm, ParticleSwarmAlgorithm
    from niapy.problems import Problem
    from niapy.task import Task
except ImportError as error:
    raise MissingExtraError("swarm_gym.adapters.niapy", "niapy", "adapters") from error

Floats = NDArray[np.float64]


class NiapyOptimizer(LibraryOptimizer[OwnParameters]):
    """An algorithm of niapy; a subclass implements `make`, and names what the algorithm remembers.

    niapy hands what an algorithm remembers from iteration to iteration by name, as additional arguments. The
    algorithm itself gives them to members that are new.

    Attributes:
        vectors: names of arguments that are one vector (D,) for each member.
        numbers: names of arguments that are one number for each member.
        scalars: names of arguments that are one number for the swarm.
    """

    vectors: ClassVar[tuple[str, ...]] = ()
    numbers: ClassVar[tuple[str, ...]] = ()
    scalars: ClassVar[tuple[str, ...]] = ()

    @classmethod
    @abstractmethod
    def make(cls, size: int, swarm: SwarmView, parameters: OwnParameters, **options: object) -> Algorithm:
        """Return the algorithm for a population of this size; `options` are passed on to its constructor."""

    @classmethod
    def memory_columns(cls, dimension: int) -> int:
        """Return K, how many numbers a swarm stores for each member, for this length of decision vectors."""
        return len(cls.vectors) * dimension + len(cls.numbers)

    @classmethod
    def field_size(cls, tables: Tables) -> int:  # noqa: ARG003
        """Return F, how many numbers a swarm stores for itself."""
        return len(cls.scalars)

    @classmethod
    def iterate(cls, swarm: SwarmView, parameters: OwnParameters) -> None:
        """Advance one swarm by one iteration of niapy's `run_iteration`."""
        problem = _CountedProblem(swarm)
        task = Task(problem, repair_function=problem.repaired)
        members = {"initialization_function": lambda **_: (swarm.positions.copy(), swarm.fitness.copy())}
        algorithm = cls.make(len(swarm.positions), swarm, parameters, **members)
        algorithm.rng = swarm.random
        positions, fitness, arguments = algorithm.init_population(task)
        cls._restore(arguments, swarm)
        best = swarm.best_position.copy(), swarm.best_fitness
        positions, _, _, _, arguments = algorithm.run_iteration(task, positions, fitness, *best, **arguments)
        found = problem.scores(np.asarray(positions))
        cls._store(arguments, swarm)
        swarm.replace(positions, *found)

    @classmethod
    def _restore(cls, arguments: dict[str, Any], swarm: SwarmView) -> None:
        """Overwrite the arguments of known members by those that are stored."""
        known = swarm.num_known
        for name, columns in cls._columns(len(swarm.lower)).items():
            arguments[name][:known] = swarm.memory[:known, columns]
        if known:
            arguments.update(zip(cls.scalars, swarm.notes.tolist(), strict=True))

    @classmethod
    def _store(cls, arguments: dict[str, Any], swarm: SwarmView) -> None:
        for name, columns in cls._columns(len(swarm.lower)).items():
            swarm.memory[:, columns] = arguments[name]
        swarm.notes[:] = [arguments[name] for name in cls.scalars]

    @classmethod
    def _columns(cls, dimension: int) -> dict[str, slice | int]:
        """Return the columns of `SwarmView.memory` by name of the argument."""
        columns: dict[str, slice | int] = {}
        for k, name in enumerate(cls.vectors):
            columns[name] = slice(k * dimension, (k + 1) * dimension)
        for k, name in enumerate(cls.numbers, start=len(cls.vectors) * dimension):
            columns[name] = k
        return columns


class _CountedProblem(Problem):
    """The problem of a swarm as niapy asks for it, one decision vector at a time."""

    def __init__(self, swarm: SwarmView):
        super().__init__(len(swarm.lower), swarm.lower, swarm.upper)
        self._swarm = swarm
        scores = zip(swarm.fitness, swarm.collision, strict=True)
        self._known = {x.tobytes(): score for x, score in zip(swarm.positions, scores, strict=True)}

    def _evaluate(self, x: Floats) -> float:
        fitness, collision = self._swarm.evaluate(x[None])
        self._known[x.tobytes()] = fitness[0], collision[0]
        return float(fitness[0])

    def repaired(self, x: Floats, *_: object, **__: object) -> Floats:
        """Return a decision vector (D,) inside the bounds, after one repair pass."""
        return self._swarm.repaired(x[None])[0]

    def scores(self, positions: Floats) -> tuple[Floats, Floats]:
        """Return fitness and collision, (m,) each, of positions (m, D).

        Those that the algorithm moved without an evaluation are evaluated here, and counted.
        """
        for x in positions:
            if x.tobytes() not in self._known:
                self._evaluate(x)
        fitness, collision = np.array([self._known[x.tobytes()] for x in positions]).T
        return fitness, collision


class NiapySwarmParameters(NamedTuple):
    """Parameters of niapy's particle swarm; the velocity limit, 1.5 map units in niapy, is a share here."""

    inertia: Annotated[float, Parameter(0.7, 0.0, 1.5, "w", "share of the velocity that stays", (0.1, 1.2))]
    cognitive: Annotated[
        float, Parameter(2.0, 0.0, 10.0, "c1", "pull towards a particle's best position", (0.1, 4.0))
    ]
    social: Annotated[float, Parameter(2.0, 0.0, 10.0, "c2", "pull towards the swarm's best", (0.1, 4.0))]
    velocity_limit: Annotated[
        float, Parameter(0.2, 1e-3, 1.0, "v_max", "largest velocity as a share of the range", (0.01, 0.5))
    ]


class NiapyParticleSwarm(NiapyOptimizer[NiapySwarmParameters]):
    """niapy's `ParticleSwarmAlgorithm`, with an inertia and a velocity limit."""

    name = "swarm_gym.adapters.niapy:ParticleSwarm"
    parameter_class = NiapySwarmParameters
    vectors = ("v", "personal_best")
    numbers = ("personal_best_fitness",)

    @classmethod
    def make(
        cls, size: int, swarm: SwarmView, parameters: NiapySwarmParameters, **options: object
    ) -> Algorithm:
        """Return the algorithm for a population of this size."""
        limit = parameters.velocity_limit * (swarm.upper - swarm.lower)
        return ParticleSwarmAlgorithm(
            size,
            c1=parameters.cognitive,
            c2=parameters.social,
            w=parameters.inertia,
            min_velocity=-limit,
            max_velocity=limit,
            **options,
        )


class NiapyFireflyParameters(NamedTuple):
    """Parameters of niapy's firefly algorithm; by default near the values of the SPSFA paper."""

    noise: Annotated[
        float, Parameter(0.004, 0.0, 1.0, "alpha", "width of the noise as a share of the range", (1e-4, 0.1))
    ]
    attractiveness: Annotated[
        float,
        Parameter(0.1, 0.0, 1.0, "beta0", "share of the distance to a neighbour at distance 0", (0.01, 1.0)),
    ]
    absorption: Annotated[
        float, Parameter(5e-6, 0.0, 1e3, "gamma", "decay of the attraction, per squared map unit")
    ]
    cooling: Annotated[
        float, Parameter(1.0, 0.5, 1.0, "theta", "factor of the noise from iteration to iteration")
    ]


class NiapyFirefly(NiapyOptimizer[NiapyFireflyParameters]):
    """niapy's `FireflyAlgorithm`; a firefly moves towards each that is as bright or brighter, itself too."""

    name = "swarm_gym.adapters.niapy:Firefly"
    parameter_class = NiapyFireflyParameters
    scalars = ("alpha",)

    @classmethod
    def make(
        cls,
        size: int,
        swarm: SwarmView,  # noqa: ARG003
        parameters: NiapyFireflyParameters,
        **options: object,
    ) -> Algorithm:
        """Return the algorithm for a population of this size."""
        return FireflyAlgorithm(
            size,
            alpha=parameters.noise,
            beta0=parameters.attractiveness,
            gamma=parameters.absorption,
            theta=parameters.cooling,
            **options,
        )

    @classmethod
    def affordable_size(cls, evaluations: Floats) -> Floats:
        """Return the size that compiled fireflies could afford: about half of the pairs move."""
        return CompiledFirefly.affordable_size(evaluations)


# What users name, as in `swarm_gym.adapters.niapy:Firefly`.
ParticleSwarm, Firefly = NiapyParticleSwarm, NiapyFirefly
