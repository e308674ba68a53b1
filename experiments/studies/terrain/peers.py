"""Optimizers of other libraries on the same cost of flights, with the defaults of their libraries.

A peer sees vectors in [0, 1]^D, whose bounds are those of the encoding. Evaluations count alike: a call of
the cost function is one, also in the first population.

mealpy asks for NumPy 1.26 or older, so no extra of this package can bring it. It works with newer ones. `make
install` installs it without what it asks for, and its rows are there where it is installed.
"""

from collections.abc import Callable, Mapping
from importlib.util import find_spec
from typing import Any

import numpy as np
from cmaes import CMA
from niapy.algorithms import Algorithm
from niapy.algorithms.basic import ParticleSwarmOptimization
from niapy.algorithms.modified import LpsrSuccessHistoryAdaptiveDifferentialEvolution
from niapy.problems import Problem as NiapyProblem
from niapy.task import Task
from numpy.typing import NDArray
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import ElementwiseProblem
from pymoo.optimize import minimize

from swarm_gym.problem import TerrainProblem

Floats = NDArray[np.float64]
Cost = Callable[[Floats], float]

SIGMA = 0.3  # first step size of CMA-ES, as a share of the ranges


class Counted:
    """The cost of vectors in [0, 1]^D, which counts its calls and keeps the best of the first ones.

    Args:
        problem: problem of a flight.
        evaluations: number of calls that count.

    Attributes:
        dimension: length of a vector.
        left: number of calls that still count.
        best: least cost so far.
        vector: decision vector of that cost, within the bounds of the problem.
    """

    def __init__(self, problem: TerrainProblem, evaluations: int):
        self._problem = problem
        self._lower, self._upper = problem.bounds
        self.dimension = problem.dimension
        self.left = evaluations
        self.best = np.inf
        self.vector = np.zeros(0)

    def __call__(self, shares: Floats) -> float:
        """Return the cost of a vector of shares of the ranges."""
        inside = np.clip(np.asarray(shares, dtype=np.float64), 0.0, 1.0)
        vector = self._lower + inside * (self._upper - self._lower)
        cost = float(self._problem.costs(vector))
        if self.left > 0:
            self.left -= 1
            if cost < self.best:
                self.best, self.vector = cost, vector
        return cost


def _cmaes(cost: Counted, seed: int) -> None:
    ranges = np.tile([0.0, 1.0], (cost.dimension, 1))
    search = CMA(mean=np.full(cost.dimension, 0.5), sigma=SIGMA, bounds=ranges, seed=seed)
    while cost.left > 0:
        asked = [search.ask() for _ in range(search.population_size)]
        search.tell([(vector, cost(vector)) for vector in asked])
        if search.should_stop():  # begins again, as the library's examples do
            search = CMA(mean=np.full(cost.dimension, 0.5), sigma=SIGMA, bounds=ranges, seed=seed + cost.left)


def _pymoo(make: Callable[[], Any]) -> Callable[[Counted, int], None]:
    """Return a run of an algorithm of pymoo."""

    def run(cost: Counted, seed: int) -> None:
        class Flight(ElementwiseProblem):
            def __init__(self) -> None:
                super().__init__(n_var=cost.dimension, n_obj=1, xl=0.0, xu=1.0)

            def _evaluate(self, x: Floats, out: dict[str, Any], *_: object, **__: object) -> None:
                out["F"] = cost(x)

        minimize(Flight(), make(), ("n_eval", cost.left), seed=seed, verbose=False)

    return run


def _niapy(make: Callable[[int], Algorithm]) -> Callable[[Counted, int], None]:
    """Return a run of an algorithm of niapy."""

    def run(cost: Counted, seed: int) -> None:
        class Flight(NiapyProblem):
            def _evaluate(self, x: Floats) -> float:
                return cost(x)

        flight = Flight(cost.dimension, 0.0, 1.0)
        make(seed).run(Task(problem=flight, max_evals=cost.left))

    return run


def _mealpy(swarm: str) -> Callable[[Counted, int], None]:
    """Return a run of an algorithm of mealpy, with the population size that the library has for it."""

    def run(cost: Counted, seed: int) -> None:
        from mealpy import FloatVar
        from mealpy.evolutionary_based.SHADE import L_SHADE
        from mealpy.swarm_based.PSO import OriginalPSO

        make = {"PSO": OriginalPSO, "L-SHADE": L_SHADE}[swarm]
        # L-SHADE shrinks until the last of these iterations. With the first population they are more
        # evaluations than were asked for; those that are too many do not count.
        iterations = max(1, cost.left // make().pop_size)
        bounds = FloatVar(lb=[0.0] * cost.dimension, ub=[1.0] * cost.dimension)
        flight = {"obj_func": cost, "bounds": bounds, "minmax": "min", "log_to": None}
        before = np.random.get_state()  # noqa: NPY002
        np.random.seed(seed)  # noqa: NPY002  # L-SHADE draws some numbers from NumPy's own generator
        try:
            make(epoch=iterations).solve(flight, seed=seed)
        finally:
            np.random.set_state(before)  # noqa: NPY002

    return run


PEERS: Mapping[str, Callable[[Counted, int], None]] = {
    "cmaes CMA-ES": _cmaes,
    "pymoo PSO": _pymoo(PSO),
    "pymoo DE": _pymoo(DE),
    "niapy PSO": _niapy(lambda seed: ParticleSwarmOptimization(seed=seed)),
    "niapy L-SHADE": _niapy(lambda seed: LpsrSuccessHistoryAdaptiveDifferentialEvolution(seed=seed)),
    "mealpy PSO": _mealpy("PSO"),
    "mealpy L-SHADE": _mealpy("L-SHADE"),
}
OPTIONAL = "mealpy"  # a library whose rows are there where it is


def installed_peers() -> list[str]:
    """Return the peers whose libraries are installed."""
    missing = find_spec(OPTIONAL) is None
    return [peer for peer in PEERS if not (missing and peer.startswith(f"{OPTIONAL} "))]


def best_flight(peer: str, problem: TerrainProblem, evaluations: int, seed: int) -> tuple[float, Floats]:
    """Return the least cost that a peer finds, and the vector of that flight.

    Args:
        peer: a key of `PEERS`.
        problem: problem of a flight.
        evaluations: number of evaluations.
        seed: seed of the peer's random numbers.
    """
    cost = Counted(problem, evaluations)
    PEERS[peer](cost, seed)
    return float(cost.best), cost.vector
