"""Which names belong together: training seeds of one recipe, scenarios of one set.

Controllers `learned:three-cases/0`, `learned:three-cases/1`, ... are training seeds of one group, whose key
is `learned:three-cases/*`, or `learned:three-cases/*@0.3` where they are told a price; any other controller
is a group of its own, under its own name. Scenarios `random-fields:test:0`, `random-fields:test:1`, ... are
drawn from one set, `random-fields:test`; any other scenario is a set of its own.
"""

from collections.abc import Iterable

EVERY_SET = "all"  # name of the union of the sets, where there are several


def group_key(controller: str) -> str:
    """The group that a controller belongs to."""
    recipe, _, rest = controller.rpartition("/")
    training_seed, at, price = rest.partition("@")
    return f"{recipe}/*{at}{price}" if recipe and training_seed.isdigit() else controller


def group_controllers(controllers: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Members of every group by its key, both in the order given."""
    groups: dict[str, tuple[str, ...]] = {}
    for controller in controllers:
        key = group_key(controller)
        groups[key] = (*groups.get(key, ()), controller)
    return groups


def set_key(scenario: str) -> str:
    """The set that a scenario is drawn from."""
    kind, _, number = scenario.rpartition(":")
    return kind if kind and number.isdigit() else scenario


def scenario_sets(scenarios: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Scenarios of every set by its key, both in the order given."""
    sets: dict[str, tuple[str, ...]] = {}
    for scenario in scenarios:
        key = set_key(scenario)
        sets[key] = (*sets.get(key, ()), scenario)
    return sets
