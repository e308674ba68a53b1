"""Experiments as data: the controllers, scenarios and seeds that are run, and what is kept of the runs."""

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field
from functools import cached_property
from typing import Any

from experiments.runs.run import RunKey

# Hyperparameters were chosen with results of seeds below 100; all seeds below 100,000 are for tests.
FRESH_SEEDS = 10_000


@dataclass(frozen=True)
class Experiment:
    """Runs of every controller on every pair of scenario and seed, so that comparisons are paired.

    Attributes:
        name: name under which results are filed.
        controllers: names for `agents.make_controller`, or of entrants (`swarm_gym.comparing.entrants`).
        scenarios: names for `swarm_gym.scenarios.make_scenario`.
        num_seeds: number of seeds per scenario; training and validation never use them.
        optimizer: name of the optimizer of controllers whose names do not begin with one.
        options: options of all environments.
        first_seed: first seed of the first scenario.
        seed_step: difference between the first seeds of consecutive scenarios; 0 if all have the same seeds.
        snapshots: (controller, scenario, seed, iterations) of the populations to store.
    """

    name: str
    controllers: tuple[str, ...]
    scenarios: tuple[str, ...]
    num_seeds: int
    _: KW_ONLY
    optimizer: str = "firefly"
    options: Mapping[str, Any] = field(default_factory=dict)
    first_seed: int = 0
    seed_step: int = 0
    snapshots: tuple[tuple[str, str, int, tuple[int, ...]], ...] = ()

    @cached_property
    def seeds(self) -> dict[str, range]:
        """Return the seeds of every scenario, by its name."""
        firsts = [self.first_seed + k * self.seed_step for k in range(len(self.scenarios))]
        return {
            name: range(first, first + self.num_seeds)
            for name, first in zip(self.scenarios, firsts, strict=True)
        }

    def all_runs(self) -> list[RunKey]:
        """Return the keys of all runs, seed by seed.

        So an experiment that was stopped has compared all controllers on the seeds that it completed.
        """
        return [
            (controller, scenario, seeds[k])
            for k in range(self.num_seeds)
            for scenario, seeds in self.seeds.items()
            for controller in self.controllers
        ]

    def kept_iterations(self, key: RunKey) -> set[int]:
        """Return the iterations of a run after which its population is stored."""
        return {iteration for *kept, its in self.snapshots if tuple(kept) == key for iteration in its}
