"""What is searched of the parameters of hand-designed controllers, as data."""

from dataclasses import dataclass, replace

from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.parameters import Number


@dataclass(frozen=True)
class Span:
    """From `low` to `high`, logarithmic except where zero shall be possible.

    Attributes:
        low: the least value.
        high: the largest.
        size: whether it is a population size, an integer within the limits.
        integer: whether it is another integer.
        logarithmic: whether its logarithm is searched.
    """

    low: float
    high: float
    size: bool = False
    integer: bool = False
    logarithmic: bool = True

    def within(self, limits: SizeLimits) -> "Span":
        """The part that these limits leave."""
        if not self.size:
            return self
        return replace(self, low=limits.clip(int(self.low)), high=limits.clip(int(self.high)))


@dataclass(frozen=True)
class ParameterSpace:
    """The parameters of a family of controllers.

    Attributes:
        family: what the parameters follow in a controller's name.
        first: where the search begins: the parameters that its authors, or this project, give.
        spans: of every parameter.
    """

    family: str
    first: dict[str, Number]
    spans: dict[str, Span]


# Some two decades around the paper's values, of which its own studies of parameters cover the middle.
SCHEDULE = ParameterSpace(
    "spsfa-tip",
    {
        "growth": 1000.0,
        "decay": 0.2,
        "low_deviation": 20.0,
        "initial_population_size": 80,
        "smallest": 2,
        "repair_factor": 1.0,
    },
    {
        "growth": Span(10.0, 10_000.0),
        "decay": Span(0.02, 2.0),
        "low_deviation": Span(1.0, 1000.0),
        "initial_population_size": Span(10, 200, size=True),
        "smallest": Span(2, 60, size=True),
        "repair_factor": Span(0.01, 100.0),
    },
)

_SIZES = {"start": Span(10, 200, size=True), "smallest": Span(2, 60, size=True)}
_REPAIR = {"repair_degree": Span(0.0, 1.0, logarithmic=False)}

LINEAR_REDUCTION = ParameterSpace(
    "linear-reduction", {"start": 100, "smallest": 10, "repair_degree": 0.0}, {**_SIZES, **_REPAIR}
)
DIVERSITY_LADDER = ParameterSpace(
    "diversity-ladder",
    {"start": 100, "smallest": 10, "repair_degree": 0.0, "rung": 3, "band": 0.1},
    {**_SIZES, **_REPAIR, "rung": Span(1, 30, integer=True), "band": Span(0.01, 1.0)},
)
STATUS_MONITOR = ParameterSpace(
    "status-monitor",
    {"start": 100, "smallest": 10, "repair_degree": 0.0, "patience": 3, "improvement": 0.001, "step": 0.1},
    {
        **_SIZES,
        **_REPAIR,
        "patience": Span(1, 10, integer=True),
        "improvement": Span(1e-5, 0.1),
        "step": Span(0.02, 0.5),
    },
)
