"""Dynamic scenarios by name: `dynamic:<base>-<event>@<iteration>`.

The base is a scenario of a fixed map, and the event is one of `EVENTS` for that base. The event follows the
iteration. On `dynamic:case1-block@70` the block is there from iteration 71 on. A range of iterations, as in
`dynamic:case1-gate@20-80`, stands for as many scenarios.

With the suffix `-drive@40,every=5,distance=60`, or with it instead of an event, the robot drives 60 map units
after iterations 40, 45, 50 and so on. Robots can drive on any map.
"""

import re
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple, cast

from swarm_gym.checks import look_up
from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.dynamic.events import Appear, Disappear, Drive, Event, Move
from swarm_gym.scenarios.dynamic.scenario import AnyScenario, DynamicScenario, MapScenario
from swarm_gym.scenarios.family import NUMBER, Family, parse_numbers
from swarm_gym.scenarios.obstacles import Circle, Polygon

NAME = "dynamic"
USAGE = f"{NAME}:<base>[-<event>@<iteration>[-<last>]][-drive@<first>,every=<iterations>,distance=<length>]"
# Pattern of a length in a name: without sign, exponent and superfluous zeros.
LENGTH = rf"{NUMBER}(?:\.[0-9]*[1-9])?"

# Events by base and name; their iterations are counted from the one in the name of the scenario. A block
# closes the corridor of the shortest path. A gate closes the corridor in which populations of fireflies have
# settled by iteration 50. The comment above each event has the length of the shortest path before and after
# it and, for maps of circles and polygons, the smallest fitness with 31 waypoints and mu = 0.3.
EVENTS: dict[str, dict[str, tuple[Event, ...]]] = {
    "case1": {
        # Length 994.23 to 1005.43, fitness 299.00 to 302.43: over the circle at (680, 280), not below it.
        "block": (Appear(0, Polygon.rectangle(600, 100, 640, 270)),),
        # A person walks through the same corridor, from below it to the next one, and disappears.
        "passer": (
            Appear(0, Circle(640, 160, 25)),
            *(Move(iteration, 14, (0, 30)) for iteration in (5, 10, 15, 20, 25)),
            Disappear(30, 14),
        ),
        # Length 994.23 and fitness 299.00 stay: this is the other corridor, over the circle at (680, 280).
        "gate": (Appear(0, Polygon.rectangle(690, 290, 730, 400)),),
    },
    # Block: 1053.55 to 1071.78, 316.63 to 325.17; through the middle, no longer below all obstacles.
    # Gate: 1053.55 and 316.63 stay; the gap between the obstacles at x = 600 is closed.
    "case2": {
        "block": (Appear(0, Polygon.rectangle(600, 60, 640, 200)),),
        "gate": (Appear(0, Polygon.rectangle(600, 220, 640, 400)),),
    },
    # Block: 997.45 to 1011.18, 300.27 to 303.74; below the circle at (530, 240), no longer over it.
    # Gate: 997.45 to 1019.62, 300.27 to 306.52; the wall at x = 600 becomes longer.
    "case3": {
        "block": (Appear(0, Polygon.rectangle(560, 270, 620, 330)),),
        "gate": (Appear(0, Polygon.rectangle(600, 180, 640, 350)),),
    },
    # 109.46 to 124.40: closes the door from the corridor to the target's room; another room leads there, too.
    "rooms:0": {"block": (Appear(0, Polygon.rectangle(103.5, 55.5, 111.5, 57.5)),)},
    # Brand and Yu's: 400.00 to 433.47, and 463.45 for a robot that has driven 175 straight on by then.
    "open:500": {"block": (Appear(0, Polygon.rectangle(174.5, 269.5, 324.5, 329.5)),)},
}


def make_family(
    expand_base: Callable[[str], tuple[str, ...]], make_base: Callable[[str], AnyScenario]
) -> Family:
    """Return the family, whose bases are scenarios of other families.

    Args:
        expand_base: function that returns the names of the single scenarios that a base stands for.
        make_base: function that returns the single scenario of a base.
    """
    samples = (
        *(f"{NAME}:{base}-{event}@70" for base in EVENTS for event in EVENTS[base]),
        f"{NAME}:case3-drive@40,every=5,distance=80",
        f"{NAME}:rooms:0-block@50-drive@40,every=5,distance=8",
    )

    def expand(name: str) -> tuple[str, ...]:
        return _expand(name, expand_base)

    def make(name: str) -> DynamicScenario:
        return _make(name, make_base)

    return Family(USAGE, samples, expand, make)


def _expand(name: str, expand_base: Callable[[str], tuple[str, ...]]) -> tuple[str, ...]:
    """Return the names of the single scenarios that a name stands for.

    Names with a range of iterations, or without event and with a range as base, stand for several scenarios.

    Raises:
        UnknownNameError: if there is no such base, or the base has no events, or none of that name.
        ScenarioError: if the name has another form.
    """
    parts = _parse(name)
    # Without this check, bases could be nested as deeply as a name is long.
    if parts.base.partition(":")[0] == NAME:
        raise ScenarioError(
            f"scenario {shown(name)}: the base must be a scenario of a fixed map, got {shown(parts.base)}"
        )
    if parts.event is not None:
        look_up(
            f"event on {shown(parts.base)}",
            parts.event,
            look_up("base of dynamic scenarios", parts.base, EVENTS),
        )
    events = [""] if parts.event is None else [f"-{parts.event}@{begin}" for begin in parts.begins]
    return tuple(
        f"{NAME}:{base}{event}{parts.drive_part}" for base in expand_base(parts.base) for event in events
    )


def _make(name: str, make_base: Callable[[str], AnyScenario]) -> DynamicScenario:
    """Return the scenario of that name.

    Raises:
        ScenarioError: if the base has no map, or a map that changes itself.
    """
    parts = _parse(name)
    events = () if parts.event is None else EVENTS[parts.base][parts.event]
    shifted = (replace(one, iteration=one.iteration + begin) for begin in parts.begins for one in events)
    base = cast("MapScenario", make_base(parts.base))  # `DynamicScenario` checks that it has a map
    return DynamicScenario(name, base, tuple(shifted), parts.drive)


class _NameParts(NamedTuple):
    """The parts of a name.

    Attributes:
        base: name of the scenario of a fixed map.
        event: name of the event, if there is one.
        begins: iterations that the event follows; empty if there is no event.
        drive: drives of the robot, if it drives.
        drive_part: part of the name that states the drives.
    """

    base: str
    event: str | None
    begins: range
    drive: Drive | None
    drive_part: str


def _parse(name: str) -> _NameParts:
    event_at = f"(?:-([a-z]+)@({NUMBER}(?:-{NUMBER})?))?"
    drive_at = f"(-drive@({NUMBER}),every=({NUMBER}),distance=({LENGTH}))?"
    match = re.fullmatch(f"{NAME}:(.+?){event_at}{drive_at}", name)
    usage = f"scenario {shown(name)}: expected {USAGE}, with iterations from 1 on"
    if match is None:
        raise ScenarioError(usage)
    base, event, when, drive_part, first, every, distance = match.groups()
    begins = range(0) if when is None else parse_numbers(when, name)
    if when is not None and not begins:
        raise ScenarioError(
            f"scenario {shown(name)}: expected a range from the first iteration to the last, such as 20-80, "
            f"got {shown(when)}"
        )
    # At least one of event and drive is there, and none of these numbers is 0.
    if (event is None and drive_part is None) or 0 in begins or "0" in (first, every):
        raise ScenarioError(usage)
    drive = None if drive_part is None else Drive(int(first), int(every), float(distance))
    return _NameParts(base, event, begins, drive, drive_part or "")
