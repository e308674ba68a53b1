"""The suite of BBOB functions: fixed sizes and rules, for the particle swarms of three libraries.

All runs have the same budget of evaluations. An entrant has as many iterations as the budget lasts at its
sizes, since the inertia of this project's particle swarm falls over the episode. No number of a rule or
algorithm was chosen for this suite. The schedule of the SPSFA paper is not in it: the degree of collision of
a function is 0, so that it keeps its first size.
"""

from experiments.runs.experiment import FRESH_SEEDS
from experiments.runs.suite import Suite

DIMENSION, INSTANCES = 5, (1, 2, 3, 4, 5)
BUDGET = 500 * DIMENSION
OPTIMIZERS = {
    "swarm_gym": "particle-swarm",
    "pymoo": "swarm_gym.adapters.pymoo:ParticleSwarm",
    "niapy": "swarm_gym.adapters.niapy:ParticleSwarm",
}
# Controllers by the names of the tables, with the iterations that the budget lasts: the first population is
# evaluated, too. The size of the falling rule is 55 on average; the one that sees progress begins with 60.
CONTROLLERS = {
    "20 members": (124, "fixed:20"),
    "60 members": (40, "fixed:60"),
    "100 members": (24, "fixed:100"),
    "falling from 100 to 10": (42, "linear-reduction:start=100,smallest=10"),
    "grows on stagnation": (40, "status-monitor:start=60"),
}
BASELINE = "60 members"


def name_of(optimizer: str, controller: str) -> str:
    """Return the name of an entrant, by keys of `OPTIMIZERS` and `CONTROLLERS`."""
    iterations, rule = CONTROLLERS[controller]
    return f"{OPTIMIZERS[optimizer]}({iterations})+{rule}"


# It needs the extra `adapters`.
BBOB = Suite(
    name="bbob",
    controllers=tuple(
        name_of(optimizer, controller) for optimizer in OPTIMIZERS for controller in CONTROLLERS
    ),
    scenarios=tuple(
        f"function:bbob-{function}-{DIMENSION}-{instance}"
        for function in range(1, 25)
        for instance in INSTANCES
    ),
    num_seeds=1,
    baseline=name_of("swarm_gym", BASELINE),
    first_seed=FRESH_SEEDS,
    seed_step=1,
    options={"max_evaluations": BUDGET},
    tables=("bbob-groups", "bbob-rules", "claims"),
    figures=(),
)

SUITES = (BBOB,)
