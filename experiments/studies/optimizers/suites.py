"""Suites of every optimizer under control, shown in docs/optimizers.md.

Each optimizer is a family: fixed sizes, the rules as printed, blind schedules of size, phi and the
optimizer's own parameters, and policies by PPO that correct one of these schedules.
"""

from pathlib import Path
from typing import Any

from experiments.runs.claims import claims_of
from experiments.runs.suite import Family, Suite, controllers_of
from experiments.studies.controllers import CASES, training_seeds

CLAIMS = Path(__file__).parent / "claims.toml"
NEVER_USED = 70_000  # first test seed; no earlier table has used it or those after it
TRAINING_SEEDS = 5

ON_CASES = (
    "particle-swarm", "elite-genetic", "multivariate", "generational-firefly", "fish-swarm",
    "improved-fish-swarm", "hybrid-fish-swarm",
)  # fmt: skip
ON_CELLS = ("ant-colony", "glowworm")
NOT_TUNED_FURTHER = ("ant-colony",)  # without blind schedules beside the base, since they take long
BLOCKS = ("block:30", "block:50", "block:80")

SIZES = ("fixed:20", "fixed:60", "fixed:100")
RULES = "spsfa-tip"
FIREFLY = "firefly"
FIREFLIES_LEARNED = training_seeds("learned:three-cases-extended-ppo", TRAINING_SEEDS, 1)
FIREFLIES_BLIND = training_seeds("open-loop:three-cases-extended-long", TRAINING_SEEDS, 1)


def base(optimizer: str) -> str:
    """Return the name of the blind schedule that the policies of an optimizer correct."""
    return f"open-loop:optimizers-{optimizer}-base"


def blind(optimizer: str) -> tuple[str, ...]:
    """Return the names of the blind schedules that were tuned with as many steps as the policies, if any."""
    if optimizer in NOT_TUNED_FURTHER:
        return ()
    return training_seeds(f"open-loop:optimizers-{optimizer}", TRAINING_SEEDS, 1)


def policies(optimizer: str) -> tuple[str, ...]:
    """Return the names of the policies of an optimizer, told price 1."""
    return training_seeds(f"learned:optimizers-{optimizer}", TRAINING_SEEDS, 1)


def blinded(optimizer: str) -> tuple[str, ...]:
    """Return the names of the policies of an optimizer with their inputs but the clock replaced by means."""
    return training_seeds(f"blinded:optimizers-{optimizer}", TRAINING_SEEDS, 1)


def _family(optimizer: str) -> Family:
    entrants = (*SIZES, RULES, base(optimizer), *blind(optimizer), *policies(optimizer))
    return Family(optimizer, tuple(f"{optimizer}+{name}" for name in entrants))


FIREFLIES = Family(
    FIREFLY,
    tuple(f"{FIREFLY}+{name}" for name in (*SIZES, RULES, *FIREFLIES_BLIND, *FIREFLIES_LEARNED)),
)


def _suite(
    name: str,
    families: tuple[Family, ...],
    scenarios: tuple[str, ...],
    figures: tuple[str, ...] = (),
    optimizer: str = FIREFLY,
    **options: Any,
) -> Suite:
    own = [family.name for family in families if family is not FIREFLIES]
    alone = tuple(f"{optimizer}+{policy}" for optimizer in own for policy in blinded(optimizer))
    return Suite(
        name=name,
        controllers=(*controllers_of(families), *alone),
        scenarios=scenarios,
        num_seeds=50,
        baseline=f"{families[0].name}+{RULES}",
        first_seed=NEVER_USED,
        optimizer=optimizer,
        options=options,
        families=families,
        reference=(1_000_000.0, 1.0),
        tables=("optimizers", "gains", "budgets", "areas", "claims"),
        figures=figures,
        claims=claims_of(CLAIMS, name),
    )


ON_THE_CASES = _suite(
    "optimizers", (*(_family(name) for name in ON_CASES), FIREFLIES), CASES, ("fronts", "policies")
)
ON_THE_CELLS = _suite(
    "optimizers-cells",
    tuple(_family(name) for name in ON_CELLS),
    BLOCKS,
    optimizer=ON_CELLS[0],
    encoding="walk",
)
SUITES = (ON_THE_CASES, ON_THE_CELLS)
COLLECTIONS = {"optimizers-study": tuple(suite.name for suite in SUITES)}
