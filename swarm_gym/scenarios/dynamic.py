"""Scenarios on whose maps something happens: `dynamic:<base>-<event>@<iteration>`, see `dynamic_scenario`.

The base is a scenario of a fixed map, the event one of those below for it, and the iteration the one that it
follows: on `dynamic:case1-block@70` the block is there from the 71st iteration on.
"""

import re
from dataclasses import replace

from swarm_gym.checks import look_up
from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.dynamic_scenario import DynamicScenario
from swarm_gym.scenarios.events import Appear, Disappear, Event, Move
from swarm_gym.scenarios.family import NUMBER, Family
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.scenario import Circle, Polygon, Scenario

NAME = "dynamic"
USAGE = f"{NAME}:<base>-<event>@<iteration>"

# By base and name, with iterations counted from the one in the scenario's name. A block closes the corridor
# that the shortest path takes, a gate the one that populations of fireflies have settled in by iteration 50;
# above each stand the lengths of the shortest path and, for maps of circles and polygons, the least fitness
# with 31 waypoints and mu = 0.3, before and after.
EVENTS: dict[str, dict[str, tuple[Event, ...]]] = {
    "case1": {
        # 994.23 to 1005.43, 299.00 to 302.43: over the circle at (680, 280), no longer below it.
        "block": (Appear(0, Polygon.rectangle(600, 100, 640, 270)),),
        # Somebody walks through the same corridor, from below it to the next one, and is gone.
        "passer": (
            Appear(0, Circle(640, 160, 25)),
            *(Move(iteration, 14, (0, 30)) for iteration in (5, 10, 15, 20, 25)),
            Disappear(30, 14),
        ),
        # 994.23 and 299.00 as before: in the other corridor, over the circle at (680, 280).
        "gate": (Appear(0, Polygon.rectangle(690, 290, 730, 400)),),
    },
    # 1053.55 to 1071.78, 316.63 to 325.17: through the middle, no longer below all obstacles.
    # 1053.55 and 316.63 as before: the gap between the obstacles at x = 600 is closed.
    "case2": {
        "block": (Appear(0, Polygon.rectangle(600, 60, 640, 200)),),
        "gate": (Appear(0, Polygon.rectangle(600, 220, 640, 400)),),
    },
    # 997.45 to 1011.18, 300.27 to 303.74: below the circle at (530, 240), no longer over it.
    # 997.45 to 1019.62, 300.27 to 306.52: the wall at x = 600 becomes longer.
    "case3": {
        "block": (Appear(0, Polygon.rectangle(560, 270, 620, 330)),),
        "gate": (Appear(0, Polygon.rectangle(600, 180, 640, 350)),),
    },
    # 109.46 to 124.40: the door from the corridor to the room of the target; another room leads there, too.
    "rooms:0": {"block": (Appear(0, Polygon.rectangle(103.5, 55.5, 111.5, 57.5)),)},
    # Brand and Yu's: 400.00 to 433.47, and 463.45 for a robot that has gone straight on for 175 by then.
    "open:500": {"block": (Appear(0, Polygon.rectangle(174.5, 269.5, 324.5, 329.5)),)},
}


def expand(name: str) -> tuple[str, ...]:
    """The name, if it is one.

    Raises:
        UnknownNameError: if there are no events for such a base, or none of that name.
        ScenarioError: if the name has another form.
    """
    base, event, _ = _parse(name)
    look_up(f"event on {base!r}", event, look_up("base of dynamic scenarios", base, EVENTS))
    return (name,)


def make(name: str) -> DynamicScenario:
    """The scenario of that name."""
    from swarm_gym.scenarios import make_scenario

    base, event, iteration = _parse(name)
    made = make_scenario(base)
    assert isinstance(made, Scenario | GridScenario)
    events = (replace(one, iteration=one.iteration + iteration) for one in EVENTS[base][event])
    return DynamicScenario(name, made, tuple(events))


def _parse(name: str) -> tuple[str, str, int]:
    """Base, event and iteration."""
    match = re.fullmatch(rf"{NAME}:(.+)-([a-z]+)@({NUMBER})", name)
    if match is None or int(match[3]) == 0:
        raise ScenarioError(f"scenario {name!r}: expected {USAGE} with an iteration from 1 on")
    return match[1], match[2], int(match[3])


FAMILY = Family(
    USAGE, tuple(f"{NAME}:{base}-{event}@70" for base in EVENTS for event in EVENTS[base]), expand, make
)
