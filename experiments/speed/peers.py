"""The same FA-60 run beside niapy's `FireflyAlgorithm` and NumPy: `python -m experiments.speed.peers`.

`make benchmark-peers` runs it in its own environment. The algorithm of niapy is the same but for `>=` instead
of `>`, so that every firefly also moves towards itself; what counts is the time per evaluation, overheads
included. It runs with a cost function in NumPy, as a user would write it, and with our compiled one. (mealpy
asks for a NumPy below 1.27, which is older than what swarm_gym runs with.)
"""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from niapy.algorithms.basic import FireflyAlgorithm
from niapy.problems import Problem as NiapyProblem
from niapy.task import Task
from tqdm import tqdm

from experiments.speed.measurement import (
    CASES,
    Measurement,
    Quantity,
    derived,
    measure,
    medians,
    write_measurements,
)
from experiments.speed.moves import SIZE, numpy_per_move, per_move
from experiments.speed.numpy_firefly import NumpyFirefly
from swarm_gym.problem import Problem
from swarm_gym.scenarios import make_scenario

OUTPUT = Path("results/benchmark/peers.json")
REPEATS = 5
NUMPY_COST, COMPILED_COST = "niapy, cost in NumPy", "niapy, our compiled cost"


class PathProblem(NiapyProblem):
    """A case of the paper for niapy."""

    def __init__(self, problem: Problem, cost: Callable[[Any], float]):
        lower, upper = problem.bounds
        super().__init__(problem.num_waypoints, lower.tolist(), upper.tolist())
        self.cost = cost

    def _evaluate(self, x: Any) -> float:
        return self.cost(x)


def niapy_per_evaluation(case: str, compiled: bool) -> Callable[[], float]:
    """Two iterations of FA-60 with the paper's parameters, per evaluation."""
    problem = Problem(make_scenario(case))
    cost: Callable[[Any], float] = (
        (lambda x: problem.evaluate(x)[0]) if compiled else NumpyFirefly(problem, 1, seed=0).evaluate
    )

    def once() -> float:
        task = Task(PathProblem(problem, cost), max_iters=2)
        width = task.range
        algorithm = FireflyAlgorithm(
            population_size=SIZE, alpha=2.0 / width, beta0=0.1, gamma=5e-6, theta=1.0, seed=0
        )
        begin = time.perf_counter()
        algorithm.run(task)
        return (time.perf_counter() - begin) / task.evals * 1e6

    return once


def quantities() -> Iterator[Quantity]:
    """All of this group."""
    for case in CASES:
        yield Quantity(f"{case}: swarm_gym", "us", per_move(case, 0.0))
        yield Quantity(f"{case}: NumPy", "us", numpy_per_move(case))
        yield Quantity(f"{case}: {NUMPY_COST}", "us", niapy_per_evaluation(case, compiled=False))
        yield Quantity(f"{case}: {COMPILED_COST}", "us", niapy_per_evaluation(case, compiled=True))


def summary(measurements: list[Measurement]) -> list[Measurement]:
    """Ratios of medians."""
    found = medians(measurements)
    return [
        derived(
            f"{case}: {peer} / swarm_gym", "times", found[f"{case}: {peer}"] / found[f"{case}: swarm_gym"]
        )
        for case in CASES
        for peer in ("NumPy", NUMPY_COST, COMPILED_COST)
    ]


def main() -> None:
    """Measure, print and store."""
    measured = [measure(q, REPEATS) for q in tqdm(list(quantities()), unit="quantity", desc="peers")]
    measured += summary(measured)
    write_measurements(OUTPUT, {"peers": measured})
    for m in measured:
        print(f"{m.name:45} {m.median:10.4g} {m.unit}")
    print(f"written: {OUTPUT}")


if __name__ == "__main__":
    main()
