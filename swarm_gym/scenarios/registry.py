"""Registry of scenarios: every name, and the function or family that makes the scenario of that name."""

from collections.abc import Callable
from typing import cast

from swarm_gym.errors import ScenarioError, UnknownNameError, shown
from swarm_gym.own_code import OwnCodeError, is_own, own
from swarm_gym.scenarios import (
    function_family,
    ioh_scenario,
    metabox,
    onemax,
    random_fields,
    rooms_and_caves,
)
from swarm_gym.scenarios.bbob.scenario import BbobScenario
from swarm_gym.scenarios.dynamic import family as dynamic_family
from swarm_gym.scenarios.dynamic import fields as dynamic_fields
from swarm_gym.scenarios.dynamic.scenario import AnyScenario, DynamicScenario
from swarm_gym.scenarios.family import Family
from swarm_gym.scenarios.formats import moving_ai, ros_map
from swarm_gym.scenarios.function_scenario import FunctionScenario
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.papers import brand_yu, iafsa, moa, spsfa
from swarm_gym.scenarios.scenario import Scenario
from swarm_gym.scenarios.terrain import file_family, generated, uav56
from swarm_gym.scenarios.terrain.scenario import TerrainScenario

SCENARIOS: dict[str, Callable[[], AnyScenario]] = {
    "case1": spsfa.case1,
    "case2": spsfa.case2,
    "case3": spsfa.case3,
}


def make_scenario(scenario: str | AnyScenario) -> AnyScenario:
    """Return the scenario of a name; a scenario is returned as it is.

    Raises:
        UnknownNameError: if there is no scenario of that name.
        OwnCodeError: if own code, `module:attribute`, cannot be imported, or gives no scenario.
        ScenarioError: if the name stands for several scenarios, or does not have the form of its family.
    """
    if isinstance(scenario, AnyScenario):
        return scenario
    names = expand_name(scenario)
    if names != (_tidied(scenario),):
        raise ScenarioError(f"scenario {shown(scenario)}: expected one scenario, got a range of {len(names)}")
    return _make(names[0])


def make_scenarios(scenario: str | AnyScenario) -> tuple[AnyScenario, ...]:
    """Return all scenarios that a name stands for, in order; a scenario is returned as the only one.

    Raises:
        UnknownNameError: if there is no scenario of that name.
        ScenarioError: if the name does not have the form of its family.
    """
    if isinstance(scenario, AnyScenario):
        return (scenario,)
    return tuple(map(_make, expand_name(scenario)))


def require_analytic(scenario: AnyScenario) -> Scenario:
    """Return the scenario if its map consists of circles and polygons.

    Raises:
        ScenarioError: if it has a grid map, no map, or a map that changes.
    """
    if not isinstance(scenario, Scenario):
        raise ScenarioError(
            f"scenario {shown(scenario.name)}: expected a map of circles and polygons, "
            f"got {_OTHERS[type(scenario)]}"
        )
    return scenario


def expand_name(name: str) -> tuple[str, ...]:
    """Return the names of the single scenarios that a name stands for, in order.

    A range of a family, such as `rooms:0-9`, stands for several scenarios; any other name stands for one.

    Raises:
        UnknownNameError: if there is no scenario of that name.
        ScenarioError: if the name does not have the form of its family.
    """
    name = _tidied(name)
    family = _family_of(name)
    if family is not None:
        return family.expand(name)
    if isinstance(name, str) and (name in SCENARIOS or is_own("scenario", name)):
        return (name,)
    forms = [*SCENARIOS, *(family.usage for family in FAMILIES.values())]
    raise UnknownNameError("scenario", name, forms, "docs/scenarios.md")


def is_known(name: object) -> bool:
    """Return whether a name stands for a scenario here, or begins with a family; its form is not checked."""
    return name in SCENARIOS or _family_of(name) is not None


def sample_names() -> tuple[str, ...]:
    """Return the names of all scenarios outside families, and some names of every family."""
    return (*SCENARIOS, *(name for family in FAMILIES.values() for name in family.samples))


def _make(name: str) -> AnyScenario:
    family = _family_of(name)
    if family is not None:
        return family.make(name)
    return SCENARIOS[name]() if name in SCENARIOS else _own_scenario(name)


def _own_scenario(name: str) -> AnyScenario:
    """Return the scenario of own code."""
    expected = "a scenario, or a function that is called without arguments and returns one"
    found = own("scenario", name, lambda found: isinstance(found, AnyScenario) or callable(found), expected)
    if isinstance(found, AnyScenario):
        return found
    try:
        made = cast(Callable[[], object], found)()
    except Exception as error:  # own code may raise anything
        raise OwnCodeError(f"scenario {shown(name)}: {error!r} when called without arguments") from error
    if not isinstance(made, AnyScenario):
        raise OwnCodeError(f"scenario {shown(name)}: expected {expected}, but it returned {shown(made)}")
    return made


def _tidied(name: str) -> str:
    """Return the one form of a name; what is no text is returned as it is."""
    name = name.strip(" ") if isinstance(name, str) else name
    family = _family_of(name)
    return name if family is None else family.tidy(name)


def _family_of(name: object) -> Family | None:
    return FAMILIES.get(name.partition(":")[0]) if isinstance(name, str) else None


# Below the functions, which dynamic scenarios call to read their bases.
FAMILIES: dict[str, Family] = {
    "random-fields": random_fields.FAMILY,
    "rooms": rooms_and_caves.ROOMS,
    "caves": rooms_and_caves.CAVES,
    "moving-ai": moving_ai.FAMILY,
    "den400d": moa.FAMILY,
    "ros": ros_map.FAMILY,
    "function": function_family.FAMILY,
    metabox.NAME: metabox.FAMILY,
    ioh_scenario.NAME: ioh_scenario.FAMILY,
    onemax.NAME: onemax.FAMILY,
    generated.NAME: generated.FAMILY,
    file_family.NAME: file_family.FAMILY,
    uav56.NAME: uav56.FAMILY,
    **brand_yu.FAMILIES,
    iafsa.NAME: iafsa.FAMILY,
    dynamic_family.NAME: dynamic_family.make_family(expand_name, make_scenario),
    dynamic_fields.NAME: dynamic_fields.FAMILY,
}

_OTHERS: dict[type, str] = {
    GridScenario: "a grid map",
    FunctionScenario: "a test function",
    BbobScenario: "a test function",
    metabox.MetaBoxScenario: "a test function",
    ioh_scenario.IohScenario: "a test function",
    onemax.OneMaxScenario: "a bit string",
    TerrainScenario: "a flight over terrain",
    DynamicScenario: "a map that changes; choose one of its `worlds`",
}
