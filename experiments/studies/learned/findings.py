"""Findings on the page of the study of learned controllers, and the rows of its table."""

from experiments.runs.groups import EVERY_SET
from experiments.studies.learned.suites import GENERALISATION, HEADLINE
from experiments.tables.block_contents import Finding

TOGETHER = (HEADLINE.name, EVERY_SET, "All cases")
CASE1, CASE2, CASE3 = ((HEADLINE.name, f"case{k}", f"Case {k}") for k in (1, 2, 3))
ON_FIELDS = ((GENERALISATION.name, "random-fields:test", "Test fields"),)

SMALLER = "Policies by PPO have a smaller objective than"
SMALLER_ON_FIELDS = "On test fields, policies of fields by PPO have a smaller objective than"
TOLD_HALF = "Policies by PPO, told price 0.5, have a mean gap that is at least"
# What holds first; what does not hold follows.
FINDINGS = (
    Finding("Policies by PPO, told price 1, end closer to the optimum than SPSFA-TIP.", (TOGETHER,)),
    Finding(
        "Policies by PPO, told price 1, take at most three quarters of the evaluations of SPSFA-TIP.",
        (TOGETHER,),
    ),
    Finding(f"{SMALLER} tuned schedules with as many steps.", (TOGETHER,)),
    Finding(f"{SMALLER} open loops of thirteen knots with as many steps.", (TOGETHER, CASE2, CASE3)),
    Finding(f"{SMALLER} themselves blinded.", (TOGETHER, CASE3)),
    Finding(f"{SMALLER} linear policies by CMA-ES with as many steps.", (TOGETHER,)),
    Finding(f"{SMALLER} policies of the same network by CMA-ES with as many steps.", (TOGETHER,)),
    Finding("On test fields, policies of fields by PPO end closer to the optimum than SPSFA-TIP.", ON_FIELDS),
    Finding(f"{SMALLER_ON_FIELDS} the open loop of fields that they correct.", ON_FIELDS),
    Finding(f"{SMALLER_ON_FIELDS} themselves blinded.", ON_FIELDS),
    Finding("The paper: SPSFA-TIP ends closer to the optimum than FA-100.", (TOGETHER,)),
    Finding(
        f"{TOLD_HALF} 45 % smaller than SPSFA-TIP's in cases 1 and 3.",
        (CASE1, CASE3),
    ),
    Finding(f"{TOLD_HALF} 10 % smaller than SPSFA-TIP's in case 2.", (CASE2,)),
    Finding("Policies by PPO, told price 5, end closer to the optimum than SPSFA-TIP.", (CASE2, CASE3)),
)
# Keys of the groups that the page's table shows.
STRONGEST = (
    "learned:three-cases/*@0.5", "learned:three-cases/*@1", "learned:three-cases-linear/*@1",
    "learned:three-cases-evolution/*@1", "open-loop:three-cases-13-knots/*@1", "tuned:three-cases",
    "open-loop:three-cases-long/*@1", "spsfa-tip", "fixed:100", "learned:three-cases/*@5",
)  # fmt: skip
ON_THE_PAGE = "learned:three-cases/*@1"  # the group whose decisions the page itself shows
