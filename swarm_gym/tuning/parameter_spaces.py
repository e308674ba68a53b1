"""Search spaces of the parameters of hand-designed controllers, as data."""

from dataclasses import dataclass, replace

from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.parameters import Number


@dataclass(frozen=True)
class Span:
    """Values of a parameter from `low` to `high`, searched in the logarithm unless zero is possible.

    Attributes:
        low: smallest value.
        high: largest value.
        size: whether the parameter is a population size, an integer within the limits.
        integer: whether the parameter is another integer.
        logarithmic: whether the logarithm of the parameter is searched.
    """

    low: float
    high: float
    size: bool = False
    integer: bool = False
    logarithmic: bool = True

    def within(self, limits: SizeLimits) -> "Span":
        """Return the span, clipped to the limits if it is one of population sizes."""
        if not self.size:
            return self
        return replace(self, low=limits.clip(int(self.low)), high=limits.clip(int(self.high)))


@dataclass(frozen=True)
class ParameterSpace:
    """The parameters of a family of controllers.

    Attributes:
        family: family of the controllers, as in their names.
        first: parameters at the start of the search, given by the authors or by this project.
        spans: span of every parameter by name.
    """

    family: str
    first: dict[str, Number]
    spans: dict[str, Span]


# About two decades around the values of the SPSFA paper, whose own parameter studies cover the middle.
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
EVALUATION_REDUCTION = ParameterSpace(
    "lpsr", {"start": 100, "smallest": 10, "repair_degree": 0.0}, {**_SIZES, **_REPAIR}
)
NON_LINEAR_REDUCTION = ParameterSpace(
    "nlpsr", {"start": 100, "smallest": 10, "repair_degree": 0.0}, {**_SIZES, **_REPAIR}
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
_CONSTANT = {
    "start": Span(10, 200, size=True),
    "size": Span(2, 100, size=True),
    **_REPAIR,
    "noise": Span(0.02, 100.0),
    "attractiveness": Span(0.01, 1.0),
    "amplitude": Span(0.05, 1.0),
}
_FIRST: dict[str, Number] = {
    "start": 150,
    "size": 20,
    "repair_degree": 0.3,
    "noise": 2.0,
    "attractiveness": 0.1,
    "amplitude": 0.5,
}
_IMMIGRANTS = Span(0.0, 1.0, logarithmic=False)


def _rule_of_immigrants(family: str, first: dict[str, Number], spans: dict[str, Span]) -> ParameterSpace:
    return ParameterSpace(
        family,
        {**_FIRST, **first, "immigrants": 0.5},
        {**_CONSTANT, **spans, "immigrants": _IMMIGRANTS},
    )


RESTART = _rule_of_immigrants(
    "restart",
    {"patience": 10, "improvement": 0.001},
    {"patience": Span(1, 50, integer=True), "improvement": Span(1e-5, 0.1)},
)
PERIODIC = _rule_of_immigrants(
    "periodic",
    {"period": 10, "phase": 10},
    {"period": Span(1, 50, integer=True), "phase": Span(1, 50, integer=True)},
)
REACTION = _rule_of_immigrants(
    "reaction",
    {"jump": 0.5, "duration": 3, "hypermutation": 1.0},
    {"jump": Span(0.01, 4.0), "duration": Span(1, 20, integer=True), "hypermutation": Span(1.0, 50.0)},
)
# Of CMA-ES; the first values are of a short search by hand on the functions that MetaBox trains on.
EARLY_RESTARTS = ParameterSpace(
    "early-restarts",
    {"start": 42, "later": 10, "short": 0.35, "wait": 63, "step": 0.03},
    {
        "start": Span(6, 200, size=True),
        "later": Span(4, 200, size=True),
        "short": Span(0.1, 0.7, logarithmic=False),
        "wait": Span(5, 63, integer=True),
        "step": Span(1e-5, 0.5),
    },
)
