"""Suites of every optimizer under control, shown in docs/optimizers.md.

Each optimizer is a family: fixed sizes, the rules as printed and tuned, blind schedules of size, phi and own
parameters, and policies by PPO that correct a schedule.
"""

from functools import partial
from typing import Any

from experiments.runs.suite import ControllerFamily, Suite
from experiments.studies.controllers import CASES, training_seeds

NEVER_USED = 70_000  # first test seed; no earlier table has used it or those after it
LATER_SEEDS = 71_000  # first test seed of grid maps and of policies that drive other optimizers
TRAINING_SEEDS = 5

ON_CASES = (
    "particle-swarm", "elite-genetic", "multivariate", "generational-firefly", "fish-swarm",
    "improved-fish-swarm", "hybrid-fish-swarm",
)  # fmt: skip
ON_CELLS = ("ant-colony", "glowworm")
# Of rooms:0 to rooms:7 and caves:0 to caves:7, those on which 60 members of particle swarms, elite genetic
# algorithms, multivariate optimization and HAAFSA end with a free path in each of six validation runs. On the
# others the penalty of paths that are not free decides all means.
GRIDS = ("rooms:1", "rooms:7", "caves:5")
BLOCKS = ("block:30", "block:50", "block:80")

SIZES = ("fixed:20", "fixed:60", "fixed:100")
RULES = "spsfa-tip"
FIREFLY = "firefly"
FIREFLIES_LEARNED = training_seeds("learned:three-cases-extended-ppo", TRAINING_SEEDS, 1)
FIREFLIES_BLIND = training_seeds("open-loop:three-cases-extended-long", TRAINING_SEEDS, 1)
RULES_TUNED_FOR_FIREFLIES = training_seeds("tuned:three-cases-schedule", TRAINING_SEEDS)
BASE_OF_SIZES = "fixed:60"  # what policies that decide size and phi only correct
DRIVEN = (*ON_CASES, FIREFLY)  # optimizers that policies of each other drive
FOR_ALL = training_seeds("learned:optimizers-all", TRAINING_SEEDS, 1)
FOR_ALL_NAMED = training_seeds("learned:optimizers-all-named", TRAINING_SEEDS, 1)


def rules_tuned(optimizer: str) -> tuple[str, ...]:
    """Return the names of the rules that were tuned for an optimizer, with as many steps as the policies."""
    if optimizer == FIREFLY:
        return RULES_TUNED_FOR_FIREFLIES
    return training_seeds(f"tuned:optimizers-{optimizer}-schedule", TRAINING_SEEDS)


def base(optimizer: str) -> str:
    """Return the name of the blind schedule that the policies of an optimizer correct."""
    return f"open-loop:optimizers-{optimizer}-base"


def blind(optimizer: str) -> tuple[str, ...]:
    """Return the names of the blind schedules that were tuned with as many steps as the policies."""
    return training_seeds(f"open-loop:optimizers-{optimizer}", TRAINING_SEEDS, 1)


def policies(optimizer: str) -> tuple[str, ...]:
    """Return the names of the policies of an optimizer, told price 1."""
    return training_seeds(f"learned:optimizers-{optimizer}", TRAINING_SEEDS, 1)


def blinded(optimizer: str) -> tuple[str, ...]:
    """Return the names of the policies of an optimizer with their inputs but the clock replaced by means."""
    return training_seeds(f"blinded:optimizers-{optimizer}", TRAINING_SEEDS, 1)


def of_sizes(optimizer: str) -> tuple[str, ...]:
    """Return the names of the policies of an optimizer that decide size and phi only, told price 1."""
    return training_seeds(f"learned:optimizers-{optimizer}-sizes", TRAINING_SEEDS, 1)


def _family(optimizer: str) -> ControllerFamily:
    rules = (RULES, *rules_tuned(optimizer))
    entrants = (*SIZES, *rules, base(optimizer), *blind(optimizer), *policies(optimizer))
    return ControllerFamily(optimizer, tuple(f"{optimizer}+{name}" for name in entrants))


FIREFLIES = ControllerFamily(
    FIREFLY,
    tuple(
        f"{FIREFLY}+{name}"
        for name in (*SIZES, RULES, *rules_tuned(FIREFLY), *FIREFLIES_BLIND, *FIREFLIES_LEARNED)
    ),
)


_suite = partial(
    Suite.of,
    first_seed=NEVER_USED,
    reference=(1_000_000.0, 1.0),
    tables=("optimizers", "gains", "budgets", "areas", "claims"),
    figures=(),
)


def _blinded_of(optimizers: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"{optimizer}+{policy}" for optimizer in optimizers for policy in blinded(optimizer))


def _transfer(
    name: str,
    driven: tuple[str, ...],
    scenarios: tuple[str, ...],
    more: tuple[str, ...] = (),
    **changes: Any,
) -> Suite:
    """Return a suite in which policies of size and phi, and `more` of them, drive the optimizers `driven`."""
    policies_of_sizes = [policy for trained_on in DRIVEN for policy in of_sizes(trained_on)]
    names = (BASE_OF_SIZES, RULES, *policies_of_sizes, *FOR_ALL, *more)
    return Suite(
        name=name,
        controllers=tuple(f"{optimizer}+{controller}" for optimizer in driven for controller in names),
        scenarios=scenarios,
        num_seeds=5,
        baseline=f"{driven[0]}+{RULES}",
        first_seed=LATER_SEEDS,
        tables=("transfer", "one-for-all", "claims"),
        figures=(),
        **changes,
    )


_FAMILIES = (*(_family(name) for name in ON_CASES), FIREFLIES)
ON_CELLS_ONLY: dict[str, Any] = {"optimizer": ON_CELLS[0], "options": {"encoding": "walk"}}

ON_THE_CASES = _suite(
    "optimizers",
    _FAMILIES,
    CASES,
    50,
    _blinded_of(ON_CASES),
    baseline=f"{ON_CASES[0]}+{RULES}",
    figures=("fronts", "policies"),
)
ON_THE_GRIDS = _suite(
    "optimizers-grids",
    _FAMILIES,
    GRIDS,
    10,
    baseline=f"{ON_CASES[0]}+{RULES}",
    first_seed=LATER_SEEDS,
    options={"encoding": "bezier"},
)
ON_THE_CELLS = _suite(
    "optimizers-cells",
    tuple(_family(name) for name in ON_CELLS),
    BLOCKS,
    50,
    _blinded_of(ON_CELLS),
    baseline=f"{ON_CELLS[0]}+{RULES}",
    **ON_CELLS_ONLY,
)
TRANSFER = _transfer("optimizers-transfer", DRIVEN, CASES, FOR_ALL_NAMED)
TRANSFER_ON_CELLS = _transfer("optimizers-transfer-cells", ON_CELLS, BLOCKS, **ON_CELLS_ONLY)

SUITES = (ON_THE_CASES, ON_THE_GRIDS, ON_THE_CELLS, TRANSFER, TRANSFER_ON_CELLS)
COLLECTIONS = {"optimizers-study": tuple(suite.name for suite in SUITES)}
