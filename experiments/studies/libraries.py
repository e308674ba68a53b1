"""Optimizers of other libraries on the same cost functions, with the defaults of their libraries.

A peer sees vectors in [0, 1]^D, whose bounds are those of the problem. Evaluations count alike: a call of
the cost function is one, also in the first population. CMA-ES begins again where a run has ended. Its first
step is `SIGMA`, and in pymoo the default of the library.

mealpy asks for NumPy 1.26 or older, so no extra of this package can bring it. It works with newer ones. `make
install` installs it without what it asks for, and its rows are there where it is installed.
"""

import time
import warnings
from collections.abc import Callable, Iterable, Mapping
from importlib.util import find_spec
from typing import Any

import numpy as np
from cmaes import CMA
from niapy.algorithms import Algorithm
from niapy.algorithms.basic import ParticleSwarmOptimization
from niapy.algorithms.modified import (
    LpsrSuccessHistoryAdaptiveDifferentialEvolution,
    SelfAdaptiveDifferentialEvolution,
)
from niapy.problems import Problem as NiapyProblem
from niapy.task import Task
from numpy.typing import NDArray
from pymoo.algorithms.soo.nonconvex.cmaes import CMAES
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import ElementwiseProblem
from pymoo.optimize import minimize

from swarm_gym.problem import Problem

Floats = NDArray[np.float64]
Cost = Callable[[Floats], float]

SIGMA = 0.3  # first step size of CMA-ES, as a share of the ranges
MOST_RESTARTS = 20


class Counted:
    """The cost of vectors in [0, 1]^D, which counts its calls and keeps the best of the first ones.

    Args:
        problem: the problem, whose fitness is the cost.
        evaluations: number of calls that count.
        is_timed: true to measure the time of the calls, which makes them slower.

    Attributes:
        dimension: length of a vector.
        calls: number of calls.
        seconds: processor time of all calls, or 0 if they are not timed.
        library_seconds: processor time of the run without timed calls; 0 before `run_peer` has ended.
        left: number of calls that still count.
        best: least cost so far.
        vector: decision vector of that cost, within the bounds of the problem.
    """

    def __init__(self, problem: Problem, evaluations: int, is_timed: bool = False):
        self._problem, self._is_timed = problem, is_timed
        self._lower, self._upper = problem.bounds
        self.dimension = problem.dimension
        self.calls, self.seconds, self.library_seconds = 0, 0.0, 0.0
        self.left = evaluations
        self.best = np.inf
        self.vector = np.zeros(0)

    def __call__(self, shares: Floats) -> float:
        """Return the cost of a vector of shares of the ranges."""
        if not self._is_timed:
            return self._cost(shares)
        before = time.process_time()
        cost = self._cost(shares)
        self.seconds += time.process_time() - before
        return cost

    def _cost(self, shares: Floats) -> float:
        inside = np.clip(np.asarray(shares, dtype=np.float64), 0.0, 1.0)
        vector = self._lower + inside * (self._upper - self._lower)
        cost, _ = self._problem.evaluate(vector)
        if self.left > 0:
            self.left -= 1
            if cost < self.best:
                self.best, self.vector = cost, vector
        self.calls += 1
        return cost


def _cmaes(cost: Counted, seed: int) -> None:
    ranges = np.tile([0.0, 1.0], (cost.dimension, 1))
    search = CMA(mean=np.full(cost.dimension, 0.5), sigma=SIGMA, bounds=ranges, seed=seed)
    while cost.left > 0:
        asked = [search.ask() for _ in range(search.population_size)]
        search.tell([(vector, cost(vector)) for vector in asked])
        if search.should_stop():  # begins again, as the library's examples do
            search = CMA(mean=np.full(cost.dimension, 0.5), sigma=SIGMA, bounds=ranges, seed=seed + cost.left)


def _pycma(cost: Counted, seed: int) -> None:
    import cma

    generator = np.random.default_rng(seed)
    options = {"bounds": [0.0, 1.0], "maxfevals": cost.left, "seed": seed + 1, "verbose": -9}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # on restarts
        cma.fmin2(
            None,
            lambda: generator.random(cost.dimension),
            SIGMA,
            options,
            parallel_objective=lambda members: [cost(member) for member in members],
            restarts=MOST_RESTARTS,
            bipop=True,
        )


def _pymoo(make: Callable[[], Any]) -> Callable[[Counted, int], None]:
    """Return a run of an algorithm of pymoo."""

    def run(cost: Counted, seed: int) -> None:
        class Function(ElementwiseProblem):
            def __init__(self) -> None:
                super().__init__(n_var=cost.dimension, n_obj=1, xl=0.0, xu=1.0)

            def _evaluate(self, x: Floats, out: dict[str, Any], *_: object, **__: object) -> None:
                out["F"] = cost(x)

        minimize(Function(), make(), ("n_eval", cost.left), seed=seed, verbose=False)

    return run


def _niapy(make: Callable[[int], Algorithm]) -> Callable[[Counted, int], None]:
    """Return a run of an algorithm of niapy."""

    def run(cost: Counted, seed: int) -> None:
        class Function(NiapyProblem):
            def _evaluate(self, x: Floats) -> float:
                return cost(x)

        function = Function(cost.dimension, 0.0, 1.0)
        make(seed).run(Task(problem=function, max_evals=cost.left))

    return run


def _mealpy(swarm: str) -> Callable[[Counted, int], None]:
    """Return a run of an algorithm of mealpy, with the population size that the library has for it."""

    def run(cost: Counted, seed: int) -> None:
        from mealpy import FloatVar
        from mealpy.evolutionary_based.SHADE import L_SHADE
        from mealpy.swarm_based.PSO import OriginalPSO

        make = {"PSO": OriginalPSO, "L-SHADE": L_SHADE}[swarm]
        # mealpy's L-SHADE keeps all members. Until the last of these iterations, trials move to ever fewer of
        # the best. With the first population they are more evaluations than were asked for; those that are
        # too many do not count.
        iterations = max(1, cost.left // make().pop_size)
        bounds = FloatVar(lb=[0.0] * cost.dimension, ub=[1.0] * cost.dimension)
        function = {"obj_func": cost, "bounds": bounds, "minmax": "min", "log_to": None}
        before = np.random.get_state()  # noqa: NPY002
        np.random.seed(seed)  # noqa: NPY002  # L-SHADE draws some numbers from NumPy's own generator
        try:
            make(epoch=iterations).solve(function, seed=seed)
        finally:
            np.random.set_state(before)  # noqa: NPY002

    return run


PEERS: Mapping[str, Callable[[Counted, int], None]] = {
    "cmaes CMA-ES": _cmaes,
    "pycma CMA-ES, BIPOP": _pycma,
    "pymoo CMA-ES, restarts": _pymoo(lambda: CMAES(restarts=MOST_RESTARTS)),
    "pymoo PSO": _pymoo(PSO),
    "pymoo DE": _pymoo(DE),
    "niapy PSO": _niapy(lambda seed: ParticleSwarmOptimization(seed=seed)),
    "niapy jDE": _niapy(lambda seed: SelfAdaptiveDifferentialEvolution(seed=seed)),
    "niapy L-SHADE": _niapy(lambda seed: LpsrSuccessHistoryAdaptiveDifferentialEvolution(seed=seed)),
    "mealpy PSO": _mealpy("PSO"),
    "mealpy L-SHADE": _mealpy("L-SHADE"),
}
OPTIONAL = "mealpy"  # a library whose rows are there where it is


def installed(peers: Iterable[str]) -> list[str]:
    """Return those of these peers whose libraries are installed."""
    missing = find_spec(OPTIONAL) is None
    return [peer for peer in peers if not (missing and peer.startswith(f"{OPTIONAL} "))]


def run_peer(peer: str, problem: Problem, evaluations: int, seed: int, is_timed: bool = False) -> Counted:
    """Return the cost function after a run of a peer, with the least cost and its vector.

    Args:
        peer: a key of `PEERS`.
        problem: the problem.
        evaluations: number of evaluations.
        seed: seed of the peer's random numbers.
        is_timed: true to measure the time of the calls of the cost function.
    """
    cost = Counted(problem, evaluations, is_timed)
    before = time.process_time()
    PEERS[peer](cost, seed)
    cost.library_seconds = time.process_time() - before - cost.seconds
    return cost
