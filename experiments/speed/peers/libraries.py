"""Runs of other libraries: fireflies, particle swarms, genetic algorithms and a fish swarm.

niapy's `FireflyAlgorithm` differs from ours in `>=` instead of `>`, so that every firefly also moves towards
itself.

`pso_gen` of pygmo evaluates a population in one call. `sga` of pygmo 2.20 evaluates one member per call, and
so does `pso`, which is therefore slower than `pso_gen`.

`AFSA` of scikit-opt 0.6.6 has no bounds and draws its fish in the unit cube; here they begin as ours do. Its
step is a share of the distance to a target, ours is a length. Its crowding is a factor between costs, ours is
a share of the fish. It evaluates fish in sight again before it follows one; every call of the cost counts.
The costs that it finds cannot be compared: its `move_to_target` compares with `best_Y` but stores into
`best_x, best_y`, so that the best fitness that it reports gets worse.
"""

import contextlib
import tempfile
from typing import Any

import numpy as np
import pygmo
from niapy.algorithms.basic import FireflyAlgorithm
from niapy.problems import Problem as NiapyProblem
from niapy.task import Task
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import Problem as PymooProblem
from pymoo.optimize import minimize
from sko.AFSA import AFSA

from experiments.speed.peers.cost import Cost, Floats
from swarm_gym.optimizers.fish.standard import FishSwarm
from swarm_gym.problem import Problem

# pyswarms has no defaults; these are c1, c2 and the last inertia weight of PSO-w in the MOA paper.
PYSWARMS_PARAMETERS = {"c1": 1.49445, "c2": 1.49445, "w": 0.5}


class NiapyPathProblem(NiapyProblem):
    """A problem for niapy, which evaluates one member per call."""

    def __init__(self, problem: Problem, cost: Cost):
        lower, upper = problem.bounds
        super().__init__(problem.dimension, lower.tolist(), upper.tolist())
        self.cost = cost

    def _evaluate(self, x: Floats) -> float:
        return self.cost.of_one(x)


def niapy_firefly(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the fireflies with the SPSFA paper's parameters; return the number of evaluations."""

    def first_population(task: Any, population_size: int, rng: Any, **_: Any) -> Any:
        population = rng.uniform(*problem.initial_bounds, (population_size, problem.dimension))
        return population, np.apply_along_axis(task.eval, 1, population)

    task = Task(NiapyPathProblem(problem, cost), max_iters=iterations)
    algorithm = FireflyAlgorithm(
        population_size=size,
        alpha=2.0 / task.range,
        beta0=0.1,
        gamma=5e-6,
        theta=1.0,
        seed=0,
        initialization_function=first_population,
    )
    algorithm.run(task)
    return task.evals


def pyswarms_particle_swarm(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the particle swarm with these parameters; return the number of evaluations."""
    # pyswarms opens a log file in the working directory when it is imported and when a swarm is made.
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        from pyswarms.single import GlobalBestPSO

        np.random.seed(0)  # noqa: NPY002 (pyswarms draws from NumPy's global generator)
        swarm = GlobalBestPSO(size, problem.dimension, PYSWARMS_PARAMETERS, bounds=problem.bounds)
        # The first population counts as an iteration.
        swarm.optimize(cost.of_many, iterations + 1, verbose=False)
    return size * len(swarm.cost_history)


class PymooPathProblem(PymooProblem):
    """A problem for pymoo, which evaluates a population in one call."""

    def __init__(self, problem: Problem, cost: Cost):
        lower, upper = problem.bounds
        super().__init__(n_var=problem.dimension, n_obj=1, xl=lower, xu=upper)
        self.cost = cost

    def _evaluate(self, x: Floats, out: dict[str, Any], *_: Any, **__: Any) -> None:
        out["F"] = self.cost.of_many(x)


def pymoo_particle_swarm(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the particle swarm with its default parameters; return the number of evaluations."""
    return _pymoo_minimize(PymooPathProblem(problem, cost), PSO(pop_size=size), iterations)


def pymoo_genetic(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the genetic algorithm with its default operators; return the number of evaluations."""
    return _pymoo_minimize(PymooPathProblem(problem, cost), GA(pop_size=size), iterations)


def _pymoo_minimize(problem: PymooPathProblem, algorithm: Any, iterations: int) -> int:
    # The first population counts as a generation.
    result = minimize(problem, algorithm, ("n_gen", iterations + 1), seed=0)
    return result.algorithm.evaluator.n_eval


class PygmoOneByOne:
    """A problem for pygmo that evaluates one member per call."""

    def __init__(self, problem: Problem, cost: Cost):
        self.bounds = tuple(bound.tolist() for bound in problem.bounds)
        self.cost = cost

    def get_bounds(self) -> tuple[list[float], ...]:
        """Return lower and upper bounds of decision vectors."""
        return self.bounds

    def fitness(self, vector: Floats) -> list[float]:
        """Return the fitness of one member, (dimension,), as a list."""
        return [self.cost.of_one(vector)]


class PygmoTogether(PygmoOneByOne):
    """A problem for pygmo that evaluates a population in one call."""

    def batch_fitness(self, vectors: Floats) -> Floats:
        """Return the fitness of all members, (m,), whose vectors follow each other in one flat array."""
        return self.cost.of_many(vectors.reshape(-1, len(self.bounds[0])))


def pygmo_particle_swarm(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the particle swarm with its default parameters; return the number of evaluations."""
    swarm = pygmo.pso_gen(gen=iterations, seed=0)
    swarm.set_bfe(pygmo.bfe())
    population = pygmo.population(PygmoTogether(problem, cost), size, b=pygmo.bfe(), seed=0)
    return _pygmo_evolve(swarm, population)


def pygmo_genetic(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the genetic algorithm with its default parameters; return the number of evaluations."""
    population = pygmo.population(PygmoOneByOne(problem, cost), size, seed=0)
    return _pygmo_evolve(pygmo.sga(gen=iterations, seed=0), population)


def _pygmo_evolve(algorithm: Any, population: Any) -> int:
    return pygmo.algorithm(algorithm).evolve(population).problem.get_fevals()


# Parameters of our fish swarm; lengths are in units of the range of a component.
VISUAL, STEP, CROWDING, TRIES = FishSwarm.parameter_values({})


def scikit_opt_fish_swarm(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the fish swarm with these parameters; return the number of calls of the cost."""
    calls = 0

    def counted(vector: Floats) -> float:
        nonlocal calls
        calls += 1
        return cost.of_one(vector)

    lower, upper = problem.bounds
    np.random.seed(0)  # noqa: NPY002 (scikit-opt draws from NumPy's global generator)
    swarm = AFSA(
        counted,
        problem.dimension,
        size_pop=size,
        max_iter=iterations,
        max_try_num=int(TRIES),
        step=STEP / VISUAL,
        visual=VISUAL * float(np.mean(upper - lower)),
        q=1.0,
        delta=CROWDING,
    )
    swarm.X[:] = np.random.default_rng(0).uniform(*problem.initial_bounds, swarm.X.shape)
    swarm.Y[:] = [counted(fish) for fish in swarm.X]
    swarm.run()
    return calls
