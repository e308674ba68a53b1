"""The suite of the MOA paper, six tasks on a map of a computer game.

The tasks of that paper are in a figure only. Ours stand in for them (`swarm_gym.scenarios.papers.moa`), so
that lengths are alike, not equal.
"""

from experiments.runs.experiment import FRESH_SEEDS
from experiments.runs.suite import Suite
from experiments.studies.moa.published import METHODS
from swarm_gym.scenarios import expand_name

# The MOA paper has 450 iterations, of which the first population is one.
MOA_PAPER = Suite(
    name="moa-paper",
    controllers=tuple(f"{method}+fixed:65" for method in METHODS),
    scenarios=expand_name("den400d:P1-P6"),
    num_seeds=30,
    baseline="multivariate+fixed:65",
    # The number of control points was chosen on lower seeds.
    first_seed=FRESH_SEEDS,
    options={"encoding": "bezier", "iterations": 449},
    tables=("claims", "moa"),
    figures=("maps",),
)

SUITES = (MOA_PAPER,)
