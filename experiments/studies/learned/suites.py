"""Suites of the study of learned controllers of size and phi, shown in docs/study.md.

To add a controller, enter its name in a family. Training seeds of a recipe, such as
`*training_seeds("learned:three-cases", 10)`, are reported on together (see `experiments.runs.groups`).
"""

from functools import partial

from experiments.runs.suite import ControllerFamily, Suite
from experiments.studies.controllers import CASES, FIXED_SIZES, HEADLINE_LEARNED, training_seeds
from swarm_gym.scenarios import expand_name

# Test seeds and test fields that no earlier table has used: seeds 30,000 to 30,199, fields 400 to 599.
NEVER_USED = 30_000
FIELDS = expand_name("random-fields:test:400-599")
# Kinds of random fields that no controller is fitted to.
UNSEEN_KINDS = ("denser", "larger", "narrow", "large-obstacles", "rotated")
UNSEEN_FIELDS = tuple(name for kind in UNSEEN_KINDS for name in expand_name(f"random-fields:{kind}:0-39"))

PRICES = (1, 5, 0.5)  # told to policies; 1 is that of the headline
LEARNED = training_seeds("learned:three-cases", 10, *PRICES)
BY_EVOLUTION = (
    *training_seeds("learned:three-cases-linear", 5, 1),
    *training_seeds("learned:three-cases-evolution", 5, 1),
)
FIELD_LEARNED = training_seeds("learned:random-fields", 5, *PRICES)

# Tuned on the objective of the policies at price 1, with as many environment steps in all.
TUNED_SCHEDULES = training_seeds("tuned:three-cases-schedule", 5)
LOOPS = training_seeds("open-loop:three-cases-long", 5, 1)
THIRTEEN_KNOTS = training_seeds("open-loop:three-cases-13-knots", 5, 1)
CONSTANTS = training_seeds("open-loop:three-cases-constant-long", 5, 1)

# An earlier recipe, without groups, and ten numbers distilled from its policy.
IMITATING = ("learned:three-cases-ppo/0", "distilled:three-cases")

PRINTED = ControllerFamily("printed schedules", ("spsfa-tip", "spsfa", "diversity-ladder", "status-monitor"))
BLIND_RULES = ControllerFamily(
    "blind rules", (*FIXED_SIZES, "linear-reduction", "open-loop:three-cases-constant"), blind=True
)
LOOPS_OF_CASES = ControllerFamily(
    "open loops of the cases", ("open-loop:three-cases", *LOOPS, *THIRTEEN_KNOTS), blind=True
)

CASE_FAMILIES = (
    PRINTED,
    BLIND_RULES,
    ControllerFamily("tuned constants", CONSTANTS, blind=True),
    ControllerFamily("tuned schedules", ("tuned:three-cases", *TUNED_SCHEDULES)),
    LOOPS_OF_CASES,
    ControllerFamily("learned by PPO", LEARNED),
    ControllerFamily("learned by CMA-ES", BY_EVOLUTION),
    ControllerFamily("learned by imitation", IMITATING),
    ControllerFamily("blinded", training_seeds("blinded:three-cases", 10, 1)),
)
FIELD_FAMILIES = (
    PRINTED,
    BLIND_RULES,
    ControllerFamily("tuned schedules", ("tuned:random-fields",)),
    ControllerFamily("open loops of fields", ("open-loop:random-fields",), blind=True),
    LOOPS_OF_CASES,
    ControllerFamily("learned on fields", FIELD_LEARNED),
    ControllerFamily("learned on the cases", HEADLINE_LEARNED),
    ControllerFamily("blinded", training_seeds("blinded:random-fields", 5, 1)),
)
UNSEEN_FAMILIES = (
    ControllerFamily("printed schedules", ("spsfa-tip", "spsfa")),
    ControllerFamily("blind rules", ("fixed:80",), blind=True),
    ControllerFamily("tuned schedules", ("tuned:random-fields",)),
    ControllerFamily("open loops", ("open-loop:random-fields", "open-loop:three-cases"), blind=True),
    ControllerFamily("learned on fields", training_seeds("learned:random-fields", 5, 1)),
    ControllerFamily("learned on the cases", HEADLINE_LEARNED),
)
# Groups whose decisions the document shows.
LOOKED_INTO = ("learned:three-cases/*@1", "open-loop:three-cases-long/*@1", "tuned:three-cases")

STUDY_TABLES = ("headline", "claims", "gaps", "differences", "front", "near-optimum", "free-paths")
STUDY_FIGURES = ("profiles", "front", "decisions")


# Families of controllers, and chance as the floor of every comparison.
_study = partial(
    Suite.of,
    others=("random",),
    baseline="spsfa-tip",
    first_seed=NEVER_USED,
    tables=STUDY_TABLES,
    figures=STUDY_FIGURES,
)
# Suites of the cases that only compare objectives, beside the study.
_beside = partial(Suite.of, scenarios=CASES, first_seed=NEVER_USED, tables=("headline", "claims"), figures=())

HEADLINE = _study("headline", CASE_FAMILIES, CASES, 200)
# Each field has one seed, which no other field has.
GENERALISATION = _study("generalisation", FIELD_FAMILIES, FIELDS, 1, seed_step=1)
OUT_OF_DISTRIBUTION = _study("out-of-distribution", UNSEEN_FAMILIES, UNSEEN_FIELDS, 1, seed_step=1)

# Policies of one case each, on all cases.
SINGLE_CASE_FAMILIES = (
    ControllerFamily("the base", ("open-loop:three-cases",), blind=True),
    ControllerFamily("all cases", training_seeds("learned:three-cases", 10, 1)),
    *(ControllerFamily(f"{case} alone", training_seeds(f"learned:{case}", 5, 1)) for case in CASES),
)
SINGLE_CASES = _beside("single-cases", SINGLE_CASE_FAMILIES, num_seeds=200, baseline="open-loop:three-cases")

# Policies that were trained alike but for what their name says; `data/presets/ablation-*.toml`.
CHANGED = (
    "group-1", "group-4", "group-16", "step-noise", "critic", "lambda", "branching", "from-start",
    "imitation", "scratch", "steps-1M", "steps-3M", "steps-10M", "dqn",
)  # fmt: skip
ABLATION_FAMILIES = (
    ControllerFamily("the base", ("open-loop:three-cases",), blind=True),
    *(ControllerFamily(name, training_seeds(f"learned:ablation-{name}", 5)) for name in ("all", *CHANGED)),
)
ABLATION = _beside("ablation", ABLATION_FAMILIES, num_seeds=100, baseline="learned:ablation-all/*")

SUITES = (HEADLINE, GENERALISATION, OUT_OF_DISTRIBUTION, SINGLE_CASES, ABLATION)
