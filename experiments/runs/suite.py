"""Suites as data: experiments, and the tables, figures and claims that are made of their runs."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import Any

from experiments.runs.claims import GroupClaim
from experiments.runs.experiment import Experiment
from experiments.runs.groups import group_controllers

SPSFA_TABLES = ("summary", "cases", "comparison", "reproduction")
SPSFA_FIGURES = ("snapshots", "collision", "cases")


@dataclass(frozen=True)
class ControllerFamily:
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


def controllers_of(families: Iterable[ControllerFamily]) -> tuple[str, ...]:
    """Return the controllers of families, in order."""
    return tuple(controller for family in families for controller in family.controllers)


@dataclass(frozen=True)
class Suite(Experiment):
    """An experiment and how it is reported; only the part of `Experiment` decides what is run.

    Attributes:
        baseline: controller, or key of a group, that the others are compared with.
        pairs: further pairs to compare, a challenger and its rival: controllers or keys of groups.
        families: controllers whose fronts are measured.
        reference: evaluations and gap from which hypervolumes are measured; worse points contribute nothing.
        tables: names of tables in `experiments.catalogue`.
        figures: names of figures in `experiments.catalogue`.
        claims: comparative sentences about the suite's runs; the catalogue enters those of the study.
        yardsticks: functions by name that return a number for a set of scenarios, such as the length of A*'s
            path; claims compare with them as with controllers.
        replayed: controllers whose first runs a report replays; by default the baseline and the best one.
    """

    baseline: str
    _: KW_ONLY
    pairs: tuple[tuple[str, str], ...] = ()
    families: tuple[ControllerFamily, ...] = ()
    reference: tuple[float, float] = (1_000_000.0, 0.2)
    tables: tuple[str, ...] = SPSFA_TABLES
    figures: tuple[str, ...] = SPSFA_FIGURES
    claims: tuple[GroupClaim, ...] = ()
    yardsticks: Mapping[str, Callable[[str], float]] = field(default_factory=dict)
    replayed: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        name: str,
        families: tuple[ControllerFamily, ...],
        scenarios: tuple[str, ...],
        num_seeds: int,
        others: tuple[str, ...] = (),
        **fields: Any,
    ) -> "Suite":
        """Return a suite of the controllers of families, then others; `fields` are further attributes."""
        controllers = (*controllers_of(families), *others)
        return cls(name, controllers, scenarios, num_seeds, families=families, **fields)

    @property
    def alone(self) -> tuple[str, ...]:
        """Return the controllers that are also reported on by themselves."""
        chosen = [controller for family in self.families for controller in family.alone]
        return tuple(controller for controller in chosen if controller in self.controllers)
