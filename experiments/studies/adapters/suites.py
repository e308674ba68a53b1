"""The suite of adapted algorithms: a fixed size beside the rules, on the three cases."""

from experiments.runs.experiment import FRESH_SEEDS
from experiments.runs.suite import Suite
from experiments.tables.document import document_of_suite

ALGORITHMS = (
    "swarm_gym.adapters.pymoo:Genetic",
    "swarm_gym.adapters.pymoo:ParticleSwarm",
    "swarm_gym.adapters.niapy:ParticleSwarm",
)
RULES = ("fixed:60", "linear-reduction", "spsfa", "spsfa-tip")

# It needs the extra `adapters`. No number of a rule or algorithm was chosen for it.
ADAPTERS = Suite(
    name="adapters",
    controllers=("spsfa-tip", *(f"{algorithm}+{rule}" for algorithm in ALGORITHMS for rule in RULES)),
    scenarios=("case1", "case2", "case3"),
    num_seeds=10,
    baseline="spsfa-tip",
    first_seed=FRESH_SEEDS,
    pairs=tuple(
        (f"{algorithm}+{rule}", f"{algorithm}+fixed:60") for algorithm in ALGORITHMS for rule in RULES[1:]
    ),
    tables=("summary", "duels"),
    figures=(),
)

SUITES = (ADAPTERS,)


DOCUMENTS = {"adapters": (document_of_suite("docs/adapters.md", "adapters"),)}
