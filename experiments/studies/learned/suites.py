"""Suites of the study of learned controllers, shown in docs/study.md.

To add a controller, enter its name in a tuple of `FITTED_TO_CASES`, `FITTED_TO_FIELDS` or `ABLATED`. Training
seeds of a recipe, `*training_seeds("learned:three-cases", 10)`, are reported on together (see
`experiments.runs.groups`).
"""

import dataclasses
from dataclasses import dataclass

from experiments.runs.suite import FRESH_SEEDS, Family, Suite
from experiments.studies.controllers import (
    CASES,
    FIXED_SIZES,
    HEADLINE_EXTENDED,
    HEADLINE_LEARNED,
    SCHEDULES,
    training_seeds,
)
from swarm_gym.scenarios import expand_name

STUDY_TABLES = ("gaps", "differences", "duels", "front", "near-optimum")
STUDY_FIGURES = ("profiles", "front", "decisions")


@dataclass(frozen=True)
class Fitted:
    """Packaged controllers that were fitted to the same scenarios, by kind.

    Attributes:
        schedules: the schedule of the SPSFA paper with tuned parameters.
        open_loops: controllers with size and phi as functions of the iteration.
        open_loops_extended: open loops of the extended action, which has the optimizer's parameters.
        learned: policies that decide size and phi.
        learned_extended: policies that decide the optimizer's parameters too.
    """

    schedules: tuple[str, ...] = ()
    open_loops: tuple[str, ...] = ()
    open_loops_extended: tuple[str, ...] = ()
    learned: tuple[str, ...] = ()
    learned_extended: tuple[str, ...] = ()

    @property
    def all_learned(self) -> tuple[str, ...]:
        """All policies, with either action."""
        return self.learned + self.learned_extended

    @property
    def everything(self) -> tuple[str, ...]:
        """All controllers, policies first."""
        return self.all_learned + self.schedules + self.open_loops + self.open_loops_extended


def families_of(fitted: Fitted, *others: Family) -> tuple[Family, ...]:
    """Return families of controllers that are not fitted, of fitted ones, and others; none of them empty."""
    families = (
        Family("fixed sizes", FIXED_SIZES),
        Family("schedules", (*SCHEDULES, *fitted.schedules)),
        Family("open loops (size, φ)", fitted.open_loops),
        Family("open loops (extended)", fitted.open_loops_extended),
        Family("learned (size, φ)", fitted.learned),
        Family("learned (extended)", fitted.learned_extended),
        *others,
    )
    return tuple(family for family in families if family.controllers)


def controllers_of(families: tuple[Family, ...]) -> tuple[str, ...]:
    """Return the controllers of all families, and chance as the floor of every comparison."""
    return (*(controller for family in families for controller in family.controllers), "random")


FIELDS = expand_name("random-fields:test:0-199")
# Kinds of random fields that no controller is fitted to.
UNSEEN_KINDS = ("denser", "larger", "narrow", "large-obstacles", "rotated")
UNSEEN_FIELDS = tuple(name for kind in UNSEEN_KINDS for name in expand_name(f"random-fields:{kind}:0-39"))


FITTED_TO_CASES = Fitted(
    schedules=("tuned:three-cases",),
    # Tuned at different prices of an evaluation, the cheapest last.
    open_loops=("open-loop:three-cases@0.5", "open-loop:three-cases", "open-loop:three-cases@0.05"),
    open_loops_extended=(
        "open-loop:three-cases-extended@2",
        "open-loop:three-cases-extended",
        "open-loop:three-cases-extended@0.1",
        "open-loop:three-cases-extended-13-knots@0.02",
    ),
    learned=(
        *training_seeds("learned:three-cases", 10, 5, 1, 0.3),
        *training_seeds("learned:three-cases-cheap", 3, 10),
        "distilled:three-cases",
    ),
    learned_extended=(
        *training_seeds("learned:three-cases-extended", 7, 2),
        *training_seeds("learned:three-cases-extended-fine", 3),
        *training_seeds("learned:three-cases-extended-deep", 2),
        *training_seeds("learned:three-cases-extended-cheap", 5, 20, 3),
    ),
)
FITTED_TO_FIELDS = Fitted(
    schedules=("tuned:random-fields",),
    open_loops=("open-loop:random-fields",),
    open_loops_extended=("open-loop:random-fields-extended",),
    learned=training_seeds("learned:random-fields", 5, 5, 1, 0.3),
    learned_extended=training_seeds("learned:random-fields-extended", 5),
)
# Controllers fitted to fields, policies at one price, for suites without fronts over prices.
AT_ONE_PRICE = dataclasses.replace(FITTED_TO_FIELDS, learned=training_seeds("learned:random-fields", 5, 1))
# Controllers whose decisions the document shows.
LOOKED_INTO = (
    *HEADLINE_LEARNED,
    "distilled:three-cases",
    "tuned:three-cases",
    "open-loop:three-cases",
    *HEADLINE_EXTENDED,
    *training_seeds("learned:three-cases-extended-fine", 3),
    *training_seeds("learned:three-cases-extended-deep", 2),
    "open-loop:three-cases-extended@0.1",
)

# Ablations of controllers of the three cases: constant decisions, training on one case, other recipes.
ABLATED = (
    Family("constants", ("open-loop:three-cases-constant",)),
    Family(
        "learned on one case",
        tuple(c for k in (1, 2, 3) for c in training_seeds(f"learned:case{k}", 3, 1)),
    ),
    Family("learned by PPO (size, φ)", training_seeds("learned:three-cases-ppo", 1)),
    Family(
        "recipes (extended)",
        (
            *training_seeds("learned:ablation-short", 3, 2),
            *training_seeds("learned:ablation-from-start", 3, 2),
            *(
                policy
                for recipe in (
                    "one-price", "four-numbers", "log-reward",
                    "ppo-residual", "ppo-paired", "ppo-imitation", "ppo-paced", "ppo-scratch", "recurrent",
                )
                for policy in training_seeds(f"learned:ablation-{recipe}", 3)
            ),
        ),
    ),
)  # fmt: skip
# Policies learned on few maps and on many, to compare how far they generalise.
FROM_CASES = Family("learned on the cases", (*HEADLINE_LEARNED, *HEADLINE_EXTENDED, "distilled:three-cases"))
FROM_FIELDS = Family("learned on fields", AT_ONE_PRICE.all_learned)

HEADLINE_FAMILIES = families_of(FITTED_TO_CASES)
ABLATION_FAMILIES = (
    Family("open loops", ("open-loop:three-cases", "open-loop:three-cases-extended@0.1")),
    Family("learned", (*HEADLINE_LEARNED, *HEADLINE_EXTENDED)),
    *ABLATED,
    FROM_FIELDS,
)
FIELD_FAMILIES = families_of(FITTED_TO_FIELDS, FROM_CASES)
UNSEEN_FAMILIES = families_of(AT_ONE_PRICE, FROM_CASES)

# Learned controllers against the open loops that their training began with, and against the tuned schedule.
HEADLINE_PAIRS = (
    *((f"learned:three-cases/*@{price}", "open-loop:three-cases") for price in ("5", "1", "0.3")),
    *((f"learned:three-cases/*@{price}", "tuned:three-cases") for price in ("5", "1", "0.3")),
    ("learned:three-cases/*@0.3", "open-loop:three-cases@0.05"),
    ("learned:three-cases-cheap/*@10", "open-loop:three-cases@0.5"),
    ("learned:three-cases-extended/*@2", "open-loop:three-cases-extended@0.1"),
    ("learned:three-cases-extended-fine/*", "open-loop:three-cases-extended@0.1"),
    ("learned:three-cases-extended-fine/*", "open-loop:three-cases-extended-13-knots@0.02"),
    ("learned:three-cases-extended-deep/*", "open-loop:three-cases-extended-13-knots@0.02"),
    ("learned:three-cases-extended-cheap/*@20", "open-loop:three-cases-extended"),
    ("learned:three-cases-extended-cheap/*@3", "open-loop:three-cases-extended"),
)
FIELD_PAIRS = (
    *((f"learned:random-fields/*@{price}", "open-loop:random-fields") for price in ("5", "1", "0.3")),
    *((f"learned:random-fields/*@{price}", "tuned:random-fields") for price in ("5", "1", "0.3")),
    ("learned:random-fields-extended/*", "open-loop:random-fields-extended"),
    ("learned:random-fields-extended/*", "tuned:random-fields"),
)


def _study(
    name: str,
    families: tuple[Family, ...],
    scenarios: tuple[str, ...],
    num_seeds: int,
    seed_step: int = 0,
    pairs: tuple[tuple[str, str], ...] = (),
    baseline: str = "spsfa-tip",
) -> Suite:
    """Return a suite of the study: families of controllers against a baseline, on fresh seeds."""
    return Suite(
        name=name,
        controllers=controllers_of(families),
        scenarios=scenarios,
        num_seeds=num_seeds,
        baseline=baseline,
        pairs=pairs,
        first_seed=FRESH_SEEDS,
        seed_step=seed_step,
        families=families,
        tables=STUDY_TABLES,
        figures=STUDY_FIGURES,
    )


HEADLINE = _study("headline", HEADLINE_FAMILIES, CASES, 200, pairs=HEADLINE_PAIRS)
ABLATION = _study("ablation", ABLATION_FAMILIES, CASES, 100, baseline="open-loop:three-cases")
# Each field has one seed, which no other field has.
GENERALISATION = _study("generalisation", FIELD_FAMILIES, FIELDS, 1, seed_step=1, pairs=FIELD_PAIRS)
OUT_OF_DISTRIBUTION = _study("out-of-distribution", UNSEEN_FAMILIES, UNSEEN_FIELDS, 1, seed_step=1)

SUITES = (HEADLINE, GENERALISATION, OUT_OF_DISTRIBUTION, ABLATION)
