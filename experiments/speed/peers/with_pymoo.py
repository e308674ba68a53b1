"""Runs of pymoo: its particle swarm and its genetic algorithm."""

from typing import Any

from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import Problem as PymooProblem
from pymoo.optimize import minimize

from experiments.speed.peers.cost import Cost, Floats
from swarm_gym.problem import Problem


class PathProblem(PymooProblem):
    """A problem for pymoo, which evaluates a population in one call."""

    def __init__(self, problem: Problem, cost: Cost):
        lower, upper = problem.bounds
        super().__init__(n_var=problem.dimension, n_obj=1, xl=lower, xu=upper)
        self.cost = cost

    def _evaluate(self, x: Floats, out: dict[str, Any], *_: Any, **__: Any) -> None:
        out["F"] = self.cost.of_many(x)


def particle_swarm(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the particle swarm with its default parameters; return the number of evaluations."""
    return _minimize(PathProblem(problem, cost), PSO(pop_size=size), iterations)


def genetic(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
    """Run the genetic algorithm with its default operators; return the number of evaluations."""
    return _minimize(PathProblem(problem, cost), GA(pop_size=size), iterations)


def _minimize(problem: PathProblem, algorithm: Any, iterations: int) -> int:
    # The first population counts as a generation.
    result = minimize(problem, algorithm, ("n_gen", iterations + 1), seed=0)
    return result.algorithm.evaluator.n_eval
