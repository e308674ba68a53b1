"""What a suite is: which controllers run on which scenarios and seeds, and what is made of the runs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from experiments.runs.groups import group_controllers

PAPER_TABLES = ("summary", "cases", "comparison", "reproduction")
PAPER_FIGURES = ("snapshots", "collision", "cases")

# Seeds below 100 were looked at when a hyper-parameter was chosen; all below 100,000 are for tests.
FRESH_SEEDS = 10_000


@dataclass(frozen=True)
class Family:
    """Controllers that trade quality for cost, reported as one front.

    Attributes:
        name: as printed.
        controllers: names for `agents.make_controller`; figures connect their groups in the order of their
            evaluations.
    """

    name: str
    controllers: tuple[str, ...]

    @property
    def groups(self) -> tuple[str, ...]:
        """Keys of the groups of the controllers."""
        return tuple(group_controllers(self.controllers))


@dataclass(frozen=True)
class Suite:
    """Every controller runs every (scenario, seed) pair, so that all comparisons are paired.

    Attributes:
        name: what results are filed under.
        controllers: names for `agents.make_controller`, or of entrants (`experiments.runs.entrants`).
        scenarios: names for `swarm_gym.scenarios.make_scenario`.
        num_seeds: seeds per scenario, none of which training or validation ever uses.
        baseline: the controller, or key of the group, that the others are compared with.
        duels: further pairs that are compared, controllers or keys of groups: a challenger and its rival.
        snapshots: (controller, scenario, seed, iterations) of runs whose populations are kept.
        optimizer: name of the optimizer, of controllers whose names do not begin with one.
        options: of all environments.
        first_seed: the first seed of the first scenario.
        seed_step: how far the seeds of a scenario start after those of the one before it; 0: the same.
        families: controllers whose fronts are measured.
        reference: evaluations and gap that hypervolumes are measured from; what is worse counts for nothing.
        tables: names in `experiments.tables.TABLES`.
        figures: names in `experiments.documents.figures.FIGURES`.
        replayed: controllers whose first runs a report replays; empty for the baseline and the best one.
    """

    name: str
    controllers: tuple[str, ...]
    scenarios: tuple[str, ...]
    num_seeds: int
    baseline: str
    snapshots: tuple[tuple[str, str, int, tuple[int, ...]], ...] = ()
    optimizer: str = "firefly"
    options: Mapping[str, Any] = field(default_factory=dict)
    first_seed: int = 0
    seed_step: int = 0
    duels: tuple[tuple[str, str], ...] = ()
    families: tuple[Family, ...] = ()
    reference: tuple[float, float] = (1_000_000.0, 0.2)
    tables: tuple[str, ...] = PAPER_TABLES
    figures: tuple[str, ...] = PAPER_FIGURES
    replayed: tuple[str, ...] = ()

    @cached_property
    def seeds(self) -> dict[str, range]:
        """The seeds of every scenario, by its name."""
        firsts = [self.first_seed + k * self.seed_step for k in range(len(self.scenarios))]
        return {
            name: range(first, first + self.num_seeds)
            for name, first in zip(self.scenarios, firsts, strict=True)
        }
