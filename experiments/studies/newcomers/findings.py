"""Findings on the page of the study of new members, and the controllers of its table."""

from experiments.studies.newcomers.suites import ABLATION, BASELINE, FIELDS, NEWCOMERS
from experiments.tables.block_contents import Finding

ON_CASES = ((NEWCOMERS.name, "all", "Three cases"),)
ON_CASE3 = ((NEWCOMERS.name, "case3", "Case 3"),)
ON_FIELDS = ((FIELDS.name, "random-fields:test", "Test fields"),)
ABLATED = ((ABLATION.name, "all", "Three cases"),)

LOOPS = "Open loops that decide sources"
POLICIES = "Policies that decide sources"

# What holds first, the largest difference first; what does not hold follows.
FINDINGS = (
    Finding(f"{POLICIES}, by PPO, have a mean gap below 0.2 %.", ON_CASES),
    Finding(f"{POLICIES}, by PPO, take fewer than 20,000 evaluations.", ON_CASES),
    Finding(
        "Less than one in twenty runs of policies that decide sources, by PPO, is not within 1 % of the "
        "optimum.",
        ON_CASES,
    ),
    Finding(
        f"{LOOPS} (price 1) end closer to the optimum than open loops without sources that were tuned with "
        "as many steps.",
        ON_CASES + ON_CASE3,
    ),
    Finding(
        f"{POLICIES}, by PPO, have a smaller objective than open loops at thirteen knots (price 1).", ON_CASES
    ),
    Finding(f"{POLICIES} have a smaller objective by PPO than by CMA-ES.", ON_CASES),
    Finding(
        "On test fields, open loops that decide sources have at most half the gap of policies that decide "
        "size, φ, noise and attractiveness.",
        ON_FIELDS,
    ),
    Finding(f"{LOOPS} have a smaller objective than those whose later members are uniform.", ABLATED),
    Finding(f"{LOOPS} have a smaller objective than those without immigrants.", ABLATED),
    Finding(f"{LOOPS} have a smaller objective than those whose members are all smooth.", ABLATED),
    Finding(
        f"{LOOPS} at thirteen knots (price 1) have a smaller objective than those at six knots that they "
        "began with.",
        ON_CASES,
    ),
    Finding(
        "On test fields, policies that decide sources have a smaller objective than open loops that decide "
        "them.",
        ON_FIELDS,
    ),
    Finding(
        "Policies that decide size, φ, noise and attractiveness have a smaller objective by PPO than by "
        "CMA-ES (price 2).",
        ON_CASES,
    ),
)
# Keys of the groups that the page's table shows.
STRONGEST = (
    "learned:three-cases-sourced-ppo/*",
    "learned:three-cases-sourced/*",
    "open-loop:three-cases-sourced/*@0.1",
    "open-loop:three-cases-sourced/*@1",
    "open-loop:three-cases-sourced/*@10",
    "open-loop:three-cases-sourced-constant/*@1",
    "tuned:three-cases-restart/*",
    "open-loop:three-cases-extended-13-knots@0.02",
    BASELINE,
    "spsfa-tip",
)
