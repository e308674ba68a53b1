"""Suites of the SPSFA paper: its three cases, and its studies of single parameters.

In a parameter study, one parameter varies, and the others are as published. To add one, enter it in
`PARAMETER_STUDIES`; the suite `parameters`, its tables and its figures follow.
"""

from collections.abc import Container
from dataclasses import dataclass

from experiments.runs.suite import SPSFA_TABLES, Suite
from experiments.studies.controllers import CASES, FIXED_SIZES
from experiments.studies.spsfa.published import PARAMETER_SECONDS
from swarm_gym.controllers.schedules import SelfAdaptiveSchedule

SCENARIO = "case3"


@dataclass(frozen=True)
class ParameterStudy:
    """Values of one parameter of SPSFA-TIP.

    Attributes:
        parameter: a parameter of `SelfAdaptiveSchedule`.
        symbol: symbol of the parameter in the SPSFA paper.
        values: grid of the SPSFA paper, ascending; the published setting is among them.
        table: number of the table of running times in the SPSFA paper; None if it has only figures.
    """

    parameter: str
    symbol: str
    values: tuple[float, ...]
    table: int | None

    @property
    def printed(self) -> float:
        """The value of the published setting, which ratios relate to."""
        return getattr(SelfAdaptiveSchedule, self.parameter)

    @property
    def seconds(self) -> dict[float, float]:
        """The published mean running times, by value; empty if there are none."""
        return PARAMETER_SECONDS.get(self.parameter, {})

    def controller(self, value: float) -> str:
        """Return the name of the controller with a value of the parameter."""
        return SelfAdaptiveSchedule(True, **{self.parameter: value}).name  # type: ignore[arg-type]

    def compared(self, controllers: Container[str]) -> dict[float, str]:
        """Return those of the controllers that this study compares, by value.

        The result is empty unless the published setting, which ratios relate to, and another value are there.
        """
        found = {v: self.controller(v) for v in self.values if self.controller(v) in controllers}
        return found if self.printed in found and len(found) > 1 else {}


PARAMETER_STUDIES = (
    ParameterStudy("growth", "ω", tuple(PARAMETER_SECONDS["growth"]), 12),
    ParameterStudy("decay", "η", tuple(PARAMETER_SECONDS["decay"]), 13),
    ParameterStudy("low_deviation", "T_low", tuple(float(value) for value in range(10, 101, 10)), None),
)
# Each controller once: the published setting belongs to all studies.
CONTROLLERS = tuple(
    dict.fromkeys(study.controller(value) for study in PARAMETER_STUDIES for value in study.values)
)


PAPER = Suite(
    name="paper",
    controllers=(*FIXED_SIZES, "spsfa", "spsfa-tip", "random", "learned:three-cases/0@1"),
    scenarios=CASES,
    num_seeds=20,
    baseline="spsfa-tip",
    snapshots=(("spsfa-tip", "case1", 0, (0, 3, 10, 30, 60, 100)),),
    tables=(*SPSFA_TABLES, "claims"),
    replayed=("spsfa-tip", "learned:three-cases/0@1", "fixed:80", "spsfa"),
)

PARAMETERS = Suite(
    name="parameters",
    controllers=CONTROLLERS,
    scenarios=(SCENARIO,),
    num_seeds=20,
    baseline="spsfa-tip",
    tables=("parameters",),
    figures=("parameters",),
)

SUITES = (PAPER, PARAMETERS)
