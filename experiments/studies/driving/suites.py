"""The suite of swarms that minimise length and nearness to obstacles, shown in docs/planning-wishes.md.

Every run has the same budget of evaluations, and members beside planned ways. The least sums are not known.
"""

from typing import Any

from experiments.runs.experiment import FRESH_SEEDS
from experiments.runs.suite import Suite
from experiments.studies.controllers import training_seeds

# Of rooms:2000, caves:2000 and those after them, the first 16 on which some path does not turn back. The maps
# of trainings have numbers from 1000 on, those of validation from 900 on.
ROOMS = (2000, 2001, 2002, 2003, 2004, 2005, 2006, 2007, 2009, 2010, 2011, 2012, 2013, 2014, 2016, 2017)
CAVES = (2001, 2002, 2004, 2005, 2006, 2007, 2008, 2009, 2012, 2013, 2014, 2015, 2016, 2017, 2019, 2020)
SCENARIOS = (*(f"rooms:{number}" for number in ROOMS), *(f"caves:{number}" for number in CAVES))

OPTIONS: dict[str, Any] = {
    "distance_weight": 2.0,
    "source": "guided",
    "iterations": 250,
    "max_evaluations": 2500,
}
TRAINING_SEEDS = 5
L_SHADE, FIREFLY = "differential-evolution", "firefly"
BASE = "open-loop:driving-start"  # that policies correct, set by hand
CONSTANT = "open-loop:driving-constant"
SCHEDULE = "open-loop:driving-schedule"
POLICIES = training_seeds("learned:driving", TRAINING_SEEDS)
BLINDED = training_seeds("blinded:driving", TRAINING_SEEDS)
FIXED = ("fixed:20", "fixed:60", "fixed:100")
# The rules of the paper as printed; L-SHADE needs four members.
RULES, RULES_OF_FIREFLIES = "spsfa-tip:smallest=4", f"{FIREFLY}+spsfa-tip"


def _with_l_shade(*controllers: str) -> tuple[str, ...]:
    return tuple(f"{L_SHADE}+{name}" for name in controllers)


DRIVING = Suite(
    "driving",
    (
        *_with_l_shade(*FIXED, RULES, BASE, CONSTANT, SCHEDULE, *POLICIES, *BLINDED),
        RULES_OF_FIREFLIES,
    ),
    SCENARIOS,
    3,
    baseline=f"{L_SHADE}+{SCHEDULE}",
    first_seed=FRESH_SEEDS,
    options=OPTIONS,
    tables=("driving",),
    figures=(),
)

SUITES = (DRIVING,)
