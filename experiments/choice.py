"""The suite that a command line asks for: one of the catalogue, or the same with other parts."""

import dataclasses
from dataclasses import dataclass
from typing import Annotated

import tyro

from experiments.catalogue import get_suite
from experiments.runs.suite import Suite
from swarm_gym.optimizers import get_optimizer
from swarm_gym.own_code import allow
from swarm_gym.scenarios import OneMaxScenario, expand_name, make_scenario

# Tables and figures that can be made of any controllers on any scenarios.
TABLES = ("summary", "comparison")
FIGURES = ("collision", "maps")
# Tables of runs on bit strings, which have no path and no gap of fitness.
TABLES_OF_BITS = ("evaluations",)


@dataclass(frozen=True)
class Choice:
    """Parts of a suite that replace its own; names of your own code are `module:attribute`."""

    scenarios: tuple[str, ...] = ()
    """Scenarios to run instead of those of the suite, e.g. case1 rooms:0-9 mine:my_map; seeds stay. Only
    tables and figures that fit any scenario are made then."""
    optimizer: str = ""
    """Optimizer to run instead of that of the suite, e.g. particle-swarm or mine:MySwarm."""
    allow: Annotated[tuple[str, ...], tyro.conf.arg(metavar="MODULE:ATTRIBUTE")] = ()
    """Names of own code that files may name, e.g. mine:Rule, the base of a policy. A name in a file imports
    no code otherwise."""

    def suite(self, name: str) -> Suite:
        """Return the suite of a name, with these parts.

        Raises:
            UnknownNameError: if there is no such suite, scenario or optimizer.
            OwnCodeError: if own code cannot be imported, or is of another kind.
        """
        allow(*self.allow)
        suite = get_suite(name)
        if self.optimizer:
            get_optimizer(self.optimizer)
            suite = dataclasses.replace(suite, optimizer=self.optimizer, claims=(), yardsticks={})
        if not self.scenarios:
            return suite
        scenarios = tuple(dict.fromkeys(one for given in self.scenarios for one in expand_name(given)))
        made = [make_scenario(scenario) for scenario in scenarios]
        of_bits = all(isinstance(scenario, OneMaxScenario) for scenario in made)
        return dataclasses.replace(
            suite,
            scenarios=scenarios,
            snapshots=(),
            claims=(),
            yardsticks={},
            tables=TABLES_OF_BITS if of_bits else TABLES,
            figures=() if of_bits else FIGURES,
        )
