"""Suites of the study of new members, shown in docs/newcomers.md.

The second argument of `training_seeds` is the number of tuning or training seeds that ship.
"""

from functools import partial

from experiments.runs.suite import ControllerFamily, Suite
from experiments.studies.controllers import CASES, FIXED_SIZES, HEADLINE_EXTENDED, training_seeds
from swarm_gym.runs.seeds import VALIDATION
from swarm_gym.scenarios import expand_name

# Test seeds of other studies end below; no controller was chosen by results of these.
NEVER_USED = 20_000

PRICES = (0.1, 0.5, 1, 2, 5, 10)  # of 100,000 evaluations, which open loops with sources are tuned for

# Controllers of the three cases.
PRINTED = (*FIXED_SIZES, "spsfa-tip")
TUNED_SCHEDULE = ("tuned:three-cases",)
BASELINE = "open-loop:three-cases-extended@0.1"
EXTENDED_LOOPS = (
    "open-loop:three-cases-extended@2",
    "open-loop:three-cases-extended",
    "open-loop:three-cases-extended@0.1",
    "open-loop:three-cases-extended-13-knots@0.02",
    "open-loop:three-cases-extended-long@1",
)
# Tuned without sources on the objective of the open loops with sources, with as many steps in all.
RIVALS = training_seeds("open-loop:three-cases-extended-long", 5, 1)
CONSTANTS = training_seeds("open-loop:three-cases-sourced-constant", 5, 1)
RESTART = training_seeds("tuned:three-cases-restart", 5)
SOURCED_LOOPS = training_seeds("open-loop:three-cases-sourced", 5, *PRICES)
# These begin with the former of the same seed at price 1, and take as many steps again.
THIRTEEN_KNOTS = training_seeds("open-loop:three-cases-sourced-13-knots", 5, 0.1, 0.5, 1, 2)
LEARNED = training_seeds("learned:three-cases-sourced", 5)
LEARNED_PPO = training_seeds("learned:three-cases-sourced-ppo", 5)

# Controllers of random fields.
FIELD_LOOPS = training_seeds("open-loop:random-fields-sourced", 5, 1)
FIELD_LEARNED = training_seeds("learned:random-fields-sourced", 5)

# Keys of groups whose decisions the document shows; those that were not run are left out.
LOOKED_INTO = (
    "learned:three-cases-extended/*@2",
    "open-loop:three-cases-sourced/*@1",
    "tuned:three-cases-restart/*",
    "learned:three-cases-sourced/*",
    "learned:three-cases-sourced-ppo/*",
)


CASE_FAMILIES = (
    ControllerFamily("printed", PRINTED),
    ControllerFamily("tuned schedule", TUNED_SCHEDULE),
    ControllerFamily("open loops (extended)", EXTENDED_LOOPS),
    ControllerFamily("open loops (extended, as many steps)", RIVALS),
    ControllerFamily("learned (extended)", HEADLINE_EXTENDED),
    ControllerFamily("learned by PPO (extended)", training_seeds("learned:three-cases-extended-ppo", 5, 2)),
    ControllerFamily("constants (sourced)", CONSTANTS),
    ControllerFamily("restart rule", RESTART),
    ControllerFamily("open loops (sourced)", SOURCED_LOOPS),
    ControllerFamily("open loops (sourced, thirteen knots)", THIRTEEN_KNOTS),
    ControllerFamily("learned (sourced)", LEARNED),
    ControllerFamily("learned by PPO (sourced)", LEARNED_PPO),
)
# With sources against without, and seeing against not seeing; pairs that were not run are left out.
CASE_PAIRS = (
    ("learned:three-cases-extended/*@2", "open-loop:three-cases-extended@0.1"),
    ("learned:three-cases-extended-ppo/*@2", "learned:three-cases-extended/*@2"),
    ("open-loop:three-cases-sourced/*@1", "learned:three-cases-extended/*@2"),
    ("open-loop:three-cases-sourced/*@1", "open-loop:three-cases-extended-long/*@1"),
    ("open-loop:three-cases-sourced/*@1", "open-loop:three-cases-sourced-constant/*@1"),
    ("open-loop:three-cases-sourced-13-knots/*@1", "open-loop:three-cases-sourced/*@1"),
    ("learned:three-cases-sourced/*", "open-loop:three-cases-sourced/*@1"),
    ("learned:three-cases-sourced-ppo/*", "open-loop:three-cases-sourced-13-knots/*@1"),
    ("learned:three-cases-sourced-ppo/*", "learned:three-cases-sourced/*"),
    ("learned:three-cases-sourced-ppo/*", "open-loop:three-cases-sourced/*@1"),
    ("tuned:three-cases-restart/*", "open-loop:three-cases-sourced/*@1"),
)
NEWCOMERS = Suite.of(
    "newcomers",
    CASE_FAMILIES,
    CASES,
    200,
    baseline=BASELINE,
    pairs=CASE_PAIRS,
    first_seed=NEVER_USED,
    tables=("gaps", "near-optimum", "differences", "duels", "front", "corridors", "claims"),
    figures=("first-populations", "corridors", "front", "decisions", "profiles"),
)

FIELD_FAMILIES = (
    ControllerFamily("printed", ("fixed:60", "spsfa-tip")),
    ControllerFamily("tuned schedule", ("tuned:random-fields",)),
    ControllerFamily("open loops (extended)", ("open-loop:random-fields-extended",)),
    ControllerFamily("learned (extended)", training_seeds("learned:random-fields-extended", 5)),
    ControllerFamily(
        "learned by PPO (extended)", training_seeds("learned:random-fields-extended-ppo", 5, 2.5)
    ),
    ControllerFamily("open loops (sourced)", FIELD_LOOPS),
    ControllerFamily("learned (sourced)", FIELD_LEARNED),
    ControllerFamily(
        "of the cases (sourced)",
        (
            *CONSTANTS,
            *RESTART,
            *training_seeds("open-loop:three-cases-sourced", 5, 1),
            *LEARNED,
            *LEARNED_PPO,
        ),
    ),
)
FIELD_PAIRS = (
    ("learned:random-fields-extended/*", "open-loop:random-fields-extended"),
    ("learned:random-fields-extended-ppo/*@2.5", "learned:random-fields-extended/*"),
    ("open-loop:random-fields-sourced/*@1", "learned:random-fields-extended/*"),
    ("learned:random-fields-sourced/*", "open-loop:random-fields-sourced/*@1"),
)
# Fields that no other suite runs; each has a seed of its own.
FIELDS = Suite.of(
    "newcomers-fields",
    FIELD_FAMILIES,
    expand_name("random-fields:test:200-399"),
    1,
    baseline="open-loop:random-fields-extended",
    pairs=FIELD_PAIRS,
    first_seed=NEVER_USED,
    seed_step=1,
    tables=("gaps", "near-optimum", "differences", "duels", "front", "claims"),
    figures=("front", "profiles"),
)

# Open loops that were tuned alike, all of whose decisions are searched but those that the name takes away.
ALL_DECISIONS = "all-decisions"
TAKEN_AWAY = ("no-immigrants", "no-smooth-growth", "no-smooth-members", "only-smooth-members")
ABLATION_FAMILIES = tuple(
    ControllerFamily(name.replace("-", " "), training_seeds(f"open-loop:ablation-{name}", 5, 1))
    for name in (ALL_DECISIONS, *TAKEN_AWAY)
)
ABLATION = Suite.of(
    "newcomers-ablation",
    ABLATION_FAMILIES,
    CASES,
    100,
    baseline=f"open-loop:ablation-{ALL_DECISIONS}/*@1",
    first_seed=NEVER_USED,
    tables=("gaps", "near-optimum", "differences", "front", "claims"),
    figures=(),
)

# Optimizers whose members are whole paths. A swarm of constant size needs new members for its first
# population alone.
WHOLE_PATHS = (
    "firefly", "generational-firefly", "particle-swarm", "elite-genetic", "multivariate", "fish-swarm",
    "improved-fish-swarm", "hybrid-fish-swarm",
)  # fmt: skip
UNIFORM_MEMBERS = "fixed:60"
SMOOTH_MEMBERS = f"{UNIFORM_MEMBERS},smooth_share=1,amplitude=0.5"
OPTIMIZERS = Suite(
    name="newcomers-optimizers",
    controllers=tuple(
        f"{optimizer}+{members}" for optimizer in WHOLE_PATHS for members in (UNIFORM_MEMBERS, SMOOTH_MEMBERS)
    ),
    scenarios=CASES,
    num_seeds=100,
    baseline=f"firefly+{UNIFORM_MEMBERS}",
    first_seed=NEVER_USED,
    tables=("newcomers-optimizers",),
    figures=(),
)

# Both kinds of bends with the same controllers. The kind is chosen by them, so seeds and fields are those of
# validation.
BENDS = ("harmonics", "stomp")
BEND_CONTROLLERS = tuple(
    f"fixed:{size},smooth_share=1,amplitude={amplitude:g}"
    for size in (20, 60)
    for amplitude in (0.2, 0.35, 0.5)
)


# By kind: the suite on the cases, and that on fields. They are two, since each field has one seed only.
_bends = partial(
    Suite,
    controllers=BEND_CONTROLLERS,
    baseline=BEND_CONTROLLERS[0],
    first_seed=VALIDATION[0],
    tables=("gaps",),
    figures=(),
)
BEND_SUITES = {
    kind: (
        _bends(name=f"newcomers-{kind}", scenarios=CASES, num_seeds=64, options=options),
        _bends(
            name=f"newcomers-{kind}-fields",
            scenarios=expand_name("random-fields:validation:0-63"),
            num_seeds=1,
            seed_step=1,
            options=options,
        ),
    )
    for kind in BENDS
    for options in [{"source": "smooth", "bends": kind}]
}

SUITES = (
    NEWCOMERS,
    FIELDS,
    ABLATION,
    OPTIMIZERS,
    *(suite for pair in BEND_SUITES.values() for suite in pair),
)
COLLECTIONS = {"newcomers-study": tuple(suite.name for suite in SUITES)}
