"""The suite of the paper's cases at equal evaluations: CMA-ES and L-SHADE beside fireflies.

No number of an entrant was chosen for this suite. An entrant has as many iterations as the budget lasts at
its population size.
"""

from experiments.runs.suite import Suite
from experiments.studies.controllers import CASES, training_seeds

BUDGET = 100_000
TRAINING_SEEDS = 5  # of each learned entrant
SHOWN = (2_000, 10_000, 20_000, BUDGET)
FIRST_SEED = 73_000  # used by no other suite
SIZES_OF_CMA = (15, 40, 80)  # 14 is the default lambda in 31 dimensions
SIZES_OF_SHADE = (60, 120)
FIRST_MEMBERS = {"uniform": "", "smooth": ",smooth_share=1"}


def _constant(optimizer: str, size: int, source: str) -> str:
    """Return the name of an entrant with a constant size, whose first members come from a source."""
    return f"{optimizer}({BUDGET // size})+fixed:{size}{FIRST_MEMBERS[source]}"


# Controllers of each row, by its name.
ROWS: dict[str, tuple[str, ...]] = {
    **{
        f"CMA-ES, lambda {size}, {source} first members": (_constant("cma-es", size, source),)
        for source in FIRST_MEMBERS
        for size in SIZES_OF_CMA
    },
    **{
        f"L-SHADE, {size} members, {source} first members": (
            _constant("differential-evolution", size, source),
        )
        for source in FIRST_MEMBERS
        for size in SIZES_OF_SHADE
    },
    # The mean of the falling size is 62.
    "L-SHADE, from 120 to 4": ("differential-evolution(1600)+linear-reduction:start=120,smallest=4",),
    "fireflies, 30 members": ("firefly+fixed:30",),
    "fireflies, 60 members, smooth first members": ("firefly+fixed:60,smooth_share=1",),
    "fireflies, SPSFA-TIP": ("firefly+spsfa-tip",),
    "fireflies, learned size and phi": training_seeds("firefly+learned:three-cases", TRAINING_SEEDS, 1),
    "fireflies, learned with sources": training_seeds("firefly+learned:three-cases-sourced", TRAINING_SEEDS),
}
CONTROLLERS = tuple(name for controllers in ROWS.values() for name in controllers)
# What README.md shows of these rows; the figure has them in this order.
LADDER = (
    "fireflies, learned with sources", "L-SHADE, 120 members, smooth first members",
    "fireflies, learned size and phi", "CMA-ES, lambda 80, smooth first members", "fireflies, SPSFA-TIP",
)  # fmt: skip

CASES_AT_BUDGETS = Suite(
    name="cases-at-budgets",
    controllers=CONTROLLERS,
    scenarios=CASES,
    num_seeds=100,
    baseline="firefly+spsfa-tip",
    first_seed=FIRST_SEED,
    options={"max_evaluations": BUDGET},
    tables=("cases-at-budgets",),
    figures=(),
)

SUITES = (CASES_AT_BUDGETS,)
