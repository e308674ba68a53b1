"""Layouts of actions: the numbers by which a controller decides population size, repair degree and more.

A layout is a list of decisions, each one number of the action:

| layout | dtype | population size | repair degree phi | parameters of the optimizer |
|---|---|---|---|---|
| `natural` | float64 | members | in [0, 1] | fixed |
| `normalised` | float32 | logarithm, scaled to [-1, 1] | scaled to [-1, 1] | fixed |
| `paced` | float32 | relative to the budget, in [-1, 1] | scaled to [-1, 1] | fixed |
| `centred` | float32 | 0.3^(1 - a) of the largest, a in [-1, 1] | 0 is 1/16, in [-1, 1] | fixed |
| `extended` | float64 | members | in [0, 1] | in their own units |
| `extended-normalised` | float32 | logarithm, scaled to [-1, 1] | scaled to [-1, 1] | logarithms, scaled |
| `extended-paced` | float32 | relative to the budget, in [-1, 1] | scaled to [-1, 1] | logarithms, scaled |
| `extended-centred` | float32 | as in `centred` | as in `centred` | logarithms, 0 is the default |

Extended layouts have one number for each parameter of the optimizer that may change at every iteration. A
paced size asks for 6^a times the population size at which `max_evaluations` would just last, for a in [-1,
1].

The layouts `sourced`, `sourced-normalised`, `sourced-paced` and `sourced-centred` are the extended ones and
then three numbers about new members (see `swarm_gym.sources`):

| number | natural unit | scaled | 0 in `sourced-centred` |
|---|---|---|---|
| smooth share: probability that a new member is a smooth bend | in [0, 1] | linear | 0.9 |
| amplitude: largest offset of bends, a share of the workspace's width | in [0.01, 1] | logarithm | 0.4 |
| immigrants: share of the members that are replaced, the worst first | in [0, 1] | linear | 0.3 |

The output of a network begins near 0. In a centred layout that is a decision with which a swarm makes
progress, so learners begin with these. In `normalised`, 0 asks for phi = 0.5, which ruins most swarms; it is
the layout of policies that correct another controller. In `sourced-centred`, 0 asks for a tenth of the
largest size, 20 of 200 members, and for an attractiveness of fireflies of 0.3.
"""

from dataclasses import dataclass

from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter
from swarm_gym.own_code import find
from swarm_gym.scales import (
    AsItIs,
    Centred,
    FourthPower,
    Kinked,
    Linear,
    Logarithmic,
    Paced,
    Scale,
    WithoutEffect,
)
from swarm_gym.settings import Settings
from swarm_gym.sources import SOURCE_RANGES

# Population size that a 0 in a centred layout asks for, as a share of the largest; -1 asks for 0.3 of that.
CENTRE_OF_SIZES = 0.3
# The same where sources are decided, too.
CENTRE_OF_SOURCED_SIZES = 0.1
# What a 0 in `sourced-centred` asks for: near the best constants that were tuned on the three cases.
# Parameters of optimizers that are not listed keep their defaults.
CENTRES_WITH_SOURCES = {"attractiveness": 0.3, "smooth_share": 0.9, "amplitude": 0.4, "immigrants": 0.3}


@dataclass(frozen=True)
class Layout:
    """The parts of a layout of actions; `make_action` fills in the settings.

    Attributes:
        size: scale of the population size: `natural` (members), or `logarithmic`, `paced` or `centred`, which
            are in [-1, 1].
        extended: whether the action decides parameters of the optimizer, too.
        sourced: whether it decides the source of new members, too.
    """

    size: str
    extended: bool
    sourced: bool = False


ACTIONS: dict[str, Layout] = {
    "natural": Layout("natural", False),
    "normalised": Layout("logarithmic", False),
    "paced": Layout("paced", False),
    "centred": Layout("centred", False),
    "extended": Layout("natural", True),
    "extended-normalised": Layout("logarithmic", True),
    "extended-paced": Layout("paced", True),
    "extended-centred": Layout("centred", True),
    "sourced": Layout("natural", True, True),
    "sourced-normalised": Layout("logarithmic", True, True),
    "sourced-paced": Layout("paced", True, True),
    "sourced-centred": Layout("centred", True, True),
}


def layout_of(name: str) -> Layout:
    """Return the parts of the layout of a name.

    Raises:
        UnknownNameError: if there is no layout of that name.
        OwnCodeError: if own code cannot be imported, or is no layout.
    """
    return find("action layout", name, ACTIONS, lambda found: isinstance(found, Layout), "a Layout")


def includes(name: str, natural: str) -> bool:
    """Return whether a layout has all decisions of a layout in natural units, such as `extended`."""
    layout, part = layout_of(name), layout_of(natural)
    return part.size == "natural" and layout.extended >= part.extended and layout.sourced >= part.sourced


def scale_of_size(layout: Layout, settings: Settings) -> Scale:
    """Return the scale of population sizes."""
    smallest, largest = settings.min_population_size, settings.max_population_size
    if layout.size == "natural":
        return AsItIs(smallest, largest)
    if layout.size == "paced":
        return Paced()
    if layout.size == "centred":
        share = CENTRE_OF_SOURCED_SIZES if layout.sourced else CENTRE_OF_SIZES
        centre = max(smallest, share * largest)
        return Centred(max(smallest, CENTRE_OF_SIZES * centre), centre, largest)
    return Logarithmic(smallest, largest)


def scale_of_repair(layout: Layout, optimizer: type[Optimizer]) -> Scale:
    """Return the scale of phi; where repair has no meaning, it is 0, and a scaled number has no effect."""
    if not optimizer.repairs:
        return AsItIs(0.0, 0.0) if layout.size == "natural" else WithoutEffect()
    if layout.size == "natural":
        return AsItIs(0.0, 1.0)
    return FourthPower() if layout.size == "centred" else Linear(0.0, 1.0)


def scale_of_parameter(layout: Layout, name: str, parameter: Parameter) -> Scale:
    """Return the scale of a positive parameter of the optimizer that may be decided."""
    assert parameter.decided is not None
    smallest, largest = parameter.decided
    if layout.size == "natural":
        return AsItIs(smallest, largest)
    if layout.size == "centred":
        centre = CENTRES_WITH_SOURCES.get(name, parameter.default) if layout.sourced else parameter.default
        return Centred(smallest, min(max(centre, smallest), largest), largest)
    return Logarithmic(smallest, largest)


def scale_of_source(layout: Layout, decision: str) -> Scale:
    """Return the scale of a decision on new members, a key of `SOURCE_RANGES`."""
    smallest, largest = SOURCE_RANGES[decision]
    if layout.size == "natural":
        return AsItIs(smallest, largest)
    if layout.size == "centred":
        centre = CENTRES_WITH_SOURCES[decision]
        return Centred(smallest, centre, largest) if smallest > 0.0 else Kinked(smallest, centre, largest)
    return Logarithmic(smallest, largest) if smallest > 0.0 else Linear(smallest, largest)
