"""The suite of maps that change: an obstacle appears in the middle of an episode."""

from experiments.runs.suite import FRESH_SEEDS, Suite
from experiments.studies.controllers import CASES, FIXED_SIZES, HEADLINE_EXTENDED, HEADLINE_LEARNED

# An obstacle closes the corridor that the population has settled in, in the middle of an episode.
DYNAMIC = Suite(
    name="dynamic",
    controllers=(
        *FIXED_SIZES,
        "spsfa",
        "spsfa-tip",
        "tuned:three-cases",
        "open-loop:three-cases",
        *HEADLINE_LEARNED,
        *HEADLINE_EXTENDED,
        "random",
    ),
    scenarios=tuple(f"dynamic:{case}-gate@50" for case in CASES),
    num_seeds=20,
    baseline="spsfa-tip",
    pairs=(("learned:three-cases/*@1", "open-loop:three-cases"), ("spsfa-tip", "fixed:80")),
    first_seed=FRESH_SEEDS,
    tables=("recovery", "differences", "duels"),
    figures=("recovery", "front"),
)

SUITES = (DYNAMIC,)
