"""Suites as data: controllers, scenarios and seeds that are run, and tables and figures of the runs."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from experiments.runs.claims import GroupClaim
from experiments.runs.groups import group_controllers

SPSFA_TABLES = ("summary", "cases", "comparison", "reproduction")
SPSFA_FIGURES = ("snapshots", "collision", "cases")

# Hyperparameters were chosen with results of seeds below 100; all seeds below 100,000 are for tests.
FRESH_SEEDS = 10_000


@dataclass(frozen=True)
class Family:
    """A family of controllers that trade quality for cost, reported as one front.

    Attributes:
        name: name as it is printed.
        controllers: names for `agents.make_controller`; figures connect their groups, ordered by evaluations.
        blind: whether the controllers see nothing but the iteration.
        alone: controllers of the family that are also reported on by themselves, beside their group: tunings
            that were chosen among all of their recipe.
    """

    name: str
    controllers: tuple[str, ...]
    blind: bool = False
    alone: tuple[str, ...] = ()

    @property
    def groups(self) -> tuple[str, ...]:
        """Return the keys of the groups of the controllers."""
        return tuple(group_controllers(self.controllers, self.alone))


def controllers_of(families: Iterable[Family]) -> tuple[str, ...]:
    """Return the controllers of families, in order."""
    return tuple(controller for family in families for controller in family.controllers)


@dataclass(frozen=True)
class Suite:
    """A suite of runs: every controller on every pair of scenario and seed, so that comparisons are paired.

    Attributes:
        name: name under which results are filed.
        controllers: names for `agents.make_controller`, or of entrants (`swarm_gym.comparing.entrants`).
        scenarios: names for `swarm_gym.scenarios.make_scenario`.
        num_seeds: number of seeds per scenario; training and validation never use them.
        baseline: controller, or key of a group, that the others are compared with.
        pairs: further pairs to compare, a challenger and its rival: controllers or keys of groups.
        snapshots: (controller, scenario, seed, iterations) of the populations to store.
        optimizer: name of the optimizer of controllers whose names do not begin with one.
        options: options of all environments.
        first_seed: first seed of the first scenario.
        seed_step: difference between the first seeds of consecutive scenarios; 0 if all have the same seeds.
        families: controllers whose fronts are measured.
        reference: evaluations and gap from which hypervolumes are measured; worse points contribute nothing.
        tables: names of tables in `experiments.catalogue`.
        figures: names of figures in `experiments.catalogue`.
        claims: comparative sentences about the suite's runs.
        yardsticks: functions by name that return a number for a set of scenarios, such as the length of A*'s
            path; claims compare with them as with controllers.
        replayed: controllers whose first runs a report replays; by default the baseline and the best one.
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
    pairs: tuple[tuple[str, str], ...] = ()
    families: tuple[Family, ...] = ()
    reference: tuple[float, float] = (1_000_000.0, 0.2)
    tables: tuple[str, ...] = SPSFA_TABLES
    figures: tuple[str, ...] = SPSFA_FIGURES
    claims: tuple[GroupClaim, ...] = ()
    yardsticks: Mapping[str, Callable[[str], float]] = field(default_factory=dict)
    replayed: tuple[str, ...] = ()

    @property
    def alone(self) -> tuple[str, ...]:
        """Return the controllers that are also reported on by themselves."""
        chosen = [controller for family in self.families for controller in family.alone]
        return tuple(controller for controller in chosen if controller in self.controllers)

    @cached_property
    def seeds(self) -> dict[str, range]:
        """Return the seeds of every scenario, by its name."""
        firsts = [self.first_seed + k * self.seed_step for k in range(len(self.scenarios))]
        return {
            name: range(first, first + self.num_seeds)
            for name, first in zip(self.scenarios, firsts, strict=True)
        }
