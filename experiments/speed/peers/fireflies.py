"""An FA-60 run of swarm_gym, of NumPy and of other libraries on the three cases: time per evaluation.

All have the SPSFA paper's parameters and first population. Times include overheads.
"""

from collections.abc import Iterator

from experiments.speed.measurement import CASES, Measurement, Quantity
from experiments.speed.moves import SIZE, numpy_per_move, per_move
from experiments.speed.numpy_firefly import analytic_problem
from experiments.speed.peers.cost import compiled_cost
from experiments.speed.peers.fish import numpy_cost
from experiments.speed.peers.runs import Peer, of_member, per_evaluation, ratios

ITERATIONS = 2
CALL = "of that, the call of the cost"


def quantities(peers: tuple[Peer, ...]) -> Iterator[Quantity]:
    """Yield the quantities of this group."""
    for case in CASES:
        problem = analytic_problem(case)
        compiled = compiled_cost(problem)
        yield Quantity(f"{case}: swarm_gym", "us", per_move(case, 0.0, ITERATIONS))
        yield Quantity(f"{case}: NumPy", "us", numpy_per_move(case, ITERATIONS))
        for peer in peers:
            for cost in (numpy_cost(case), compiled):
                once = per_evaluation(peer.run, problem, cost, SIZE, ITERATIONS)
                yield Quantity(f"{case}: {peer.name}, {cost.name}", "us", once)
        yield Quantity(f"{case}: {CALL}", "us", of_member(problem, compiled))


def summary(measurements: list[Measurement]) -> list[Measurement]:
    """Return ratios of medians, but none of the call of the cost, which is part of a run."""
    return ratios([measured for measured in measurements if not measured.name.endswith(CALL)])
