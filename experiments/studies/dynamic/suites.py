"""The suites of maps that change, shown in docs/dynamic.md: the cases, random fields, and robots that drive.

To add a controller, enter its name in a family. All training seeds of a recipe are reported on together.
"""

from functools import partial

from experiments.runs.suite import ControllerFamily, Suite
from experiments.studies.controllers import CASES, training_seeds
from swarm_gym.scenarios import expand_name

NEVER_USED = 56_000  # test seeds that no earlier commit has used: 56,000 to 56,299

# An obstacle appears on a case, at times that nothing was tuned or trained with: it closes the corridor that
# most runs settle in (gate), or stands in the shortest way (block).
CASE_EVENTS = tuple(
    f"dynamic:{case}-{event}@{time}" for case in CASES for event in ("gate", "block") for time in (23, 47, 71)
)
FIELDS = expand_name("dynamic-fields:test:400-599")
# The kind of event that nothing was tuned or trained on.
MOVING = expand_name("dynamic-fields:moving:200-299")
DRIVES = tuple(
    f"dynamic:{case}-gate@{time}-drive@40,every=5,distance=120" for case in CASES for time in (47, 53)
)

# The tunings of rules with the smallest objective on the validation scenarios of the preset dynamic.
CHOSEN_PERIODIC, CHOSEN_REACTION = "tuned:dynamic-periodic/5@1", "tuned:dynamic-reaction/0@1"
# The loops with the smallest objective there, of five each, tuned further.
LONG_LOOP, LONG_REACTING = "open-loop:dynamic-long@1", "reacting-loop:dynamic-reacting-long@1"

PRINTED = ControllerFamily("printed", ("fixed:60", "spsfa-tip"))
STILL = ControllerFamily(
    "tuned or trained on maps that stay",
    ("tuned:random-fields", *training_seeds("learned:three-cases-sourced-ppo", 5)),
)
BLIND = ControllerFamily(
    "blind",
    (
        *training_seeds("open-loop:random-fields-sourced", 5, 1),
        *training_seeds("open-loop:dynamic-fields", 5, 1),
        *training_seeds("open-loop:dynamic", 5, 1),
        LONG_LOOP,
        *training_seeds("tuned:dynamic-periodic", 10, 1),
    ),
    blind=True,
    alone=(CHOSEN_PERIODIC,),
)
REACTING = ControllerFamily(
    "reacting",
    (
        "restart",
        *training_seeds("tuned:dynamic-reaction", 5, 1),
        *training_seeds("reacting-loop:dynamic-fields-reacting", 5, 1),
        *training_seeds("reacting-loop:dynamic-reacting", 5, 1),
        LONG_REACTING,
    ),
    alone=(CHOSEN_REACTION,),
)
LEARNED = ControllerFamily("learned", training_seeds("learned:dynamic", 5))
BLINDED = ControllerFamily("blinded", training_seeds("blinded:dynamic", 5))
TOLD = "told the times of events"  # name of the family that is the upper bound in the table `seeing`
INFORMED = ControllerFamily(TOLD, training_seeds("learned:dynamic-told", 5))
FAMILIES = (PRINTED, STILL, BLIND, REACTING, LEARNED, BLINDED, INFORMED)
DRIVING = ControllerFamily("trained with robots that drive", training_seeds("learned:dynamic-robots", 5))


# Replayed by a report, side by side: what was learned, and what sees nothing.
REPLAYED = ("learned:dynamic/0", LONG_LOOP, LONG_REACTING, "spsfa-tip")
OVER_TIME = ("over-time", "seeing", "recovery", "claims")

_suite = partial(Suite.of, baseline="spsfa-tip", first_seed=NEVER_USED, replayed=REPLAYED)
DYNAMIC = _suite("dynamic", FAMILIES, CASE_EVENTS, 10, tables=OVER_TIME, figures=("events", "recovery"))
# Each field has one seed, which no other field has.
DYNAMIC_FIELDS = _suite(
    "dynamic-fields", FAMILIES, (*FIELDS, *MOVING), 1, seed_step=1, tables=OVER_TIME, figures=()
)
DYNAMIC_ROBOTS = _suite("dynamic-robots", (*FAMILIES, DRIVING), DRIVES, 16, tables=("robots",), figures=())

SUITES = (DYNAMIC, DYNAMIC_FIELDS, DYNAMIC_ROBOTS)
COLLECTIONS = {"dynamic-study": tuple(suite.name for suite in SUITES)}
