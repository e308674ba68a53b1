"""Groups of controllers that are training seeds of one recipe, and sets of scenarios.

Controllers `learned:three-cases/0`, `learned:three-cases/1`, ... form one group, whose key is
`learned:three-cases/*`, or `learned:three-cases/*@0.3` with a price. Any other controller is a group of its
own, under its own name. A tuning that was chosen among those of its recipe can stand alone, too. Scenarios
`random-fields:test:0`, `random-fields:test:1`, ... are drawn from one set, `random-fields:test`. Events of
one kind at several times are a set, too: `dynamic:case1-gate@20` is of `dynamic:case1-gate`, with or without
a robot that drives. The instances of a BBOB function in one dimension are a set, `function:bbob-8-5`. Any
other scenario is a set of its own.
"""

import re
from collections.abc import Iterable

from swarm_gym.controllers.names import ControllerName

EVERY_SET = "all"  # name of the union of all sets, if there are several


def group_key(controller: str) -> str:
    """Return the key of the group that a controller belongs to."""
    return ControllerName.parse(controller).group_key


def group_controllers(controllers: Iterable[str], alone: Iterable[str] = ()) -> dict[str, tuple[str, ...]]:
    """Return the members of every group by its key, both in the given order.

    Args:
        controllers: names of the controllers.
        alone: names of those that are also groups of their own, after the others.
    """
    groups: dict[str, tuple[str, ...]] = {}
    for controller in controllers:
        key = group_key(controller)
        groups[key] = (*groups.get(key, ()), controller)
    return groups | {controller: (controller,) for controller in alone}


def set_key(scenario: str) -> str:
    """Return the key of the set that a scenario is drawn from."""
    pattern = r"(.+):[0-9]+|(function:bbob-[0-9]+-[0-9]+)-[0-9]+|(dynamic:.+?-[a-z]+)@[0-9]+(-drive@.+)?"
    member = re.fullmatch(pattern, scenario)
    return scenario if member is None else member[1] or member[2] or member[3] + (member[4] or "")


def scenario_sets(scenarios: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Return the scenarios of every set by its key, both in the given order."""
    sets: dict[str, tuple[str, ...]] = {}
    for scenario in scenarios:
        key = set_key(scenario)
        sets[key] = (*sets.get(key, ()), scenario)
    return sets
