"""Runs of scikit-opt: its artificial fish swarm.

`AFSA` of scikit-opt 0.6.6 has no bounds and draws its fish in the unit cube; here they begin as ours do. Its
step is a share of the distance to a target, ours is a length. Its crowding is a factor between costs, ours is
a share of the fish. It evaluates fish in sight again before it follows one; every call of the cost counts.

The costs that it finds cannot be compared: its `move_to_target` compares with `best_Y` but stores into
`best_x, best_y`, so that the best fitness that it reports gets worse.
"""

import numpy as np
from sko.AFSA import AFSA

from experiments.speed.peers.cost import Cost, Floats
from swarm_gym.optimizers.fish.standard import FishSwarm
from swarm_gym.problem import Problem

# Parameters of our fish swarm; lengths are in units of the range of a component.
VISUAL, STEP, CROWDING, TRIES = FishSwarm.parameter_values({})


def fish_swarm(problem: Problem, cost: Cost, size: int, iterations: int) -> int:
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
