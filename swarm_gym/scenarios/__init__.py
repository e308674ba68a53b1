"""What is to be solved: maps with start and target, and test functions, made by name.

To add a map: write a function that returns a `Scenario` and enter it in `SCENARIOS`. To add a family of maps,
with names that go on after a colon: write a module like `random_fields` and enter its `Family` in `FAMILIES`.
A `Scenario` has a map of circles and polygons, a `GridScenario` one of cells, a `FunctionScenario` none. The
map of a `DynamicScenario` changes: it is one scenario after the other, its worlds.
"""

from collections.abc import Callable

from swarm_gym.errors import ScenarioError, UnknownNameError, shown
from swarm_gym.scenarios import (
    block_scene,
    iafsa_routes,
    made_maps,
    moa_tasks,
    paper_cases,
    random_fields,
    test_functions,
)
from swarm_gym.scenarios.dynamic import family as dynamic_family
from swarm_gym.scenarios.dynamic.events import Appear, Disappear, Drive, Event, Move
from swarm_gym.scenarios.dynamic.scenario import (
    AnyScenario,
    DynamicScenario,
    MapScenario,
    StaticScenario,
    World,
    drive_of,
    world_at,
    worlds_of,
)
from swarm_gym.scenarios.family import Family
from swarm_gym.scenarios.formats import moving_ai, ros_map
from swarm_gym.scenarios.function_scenario import FunctionScenario
from swarm_gym.scenarios.grid_map import GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.raster import rasterised
from swarm_gym.scenarios.scenario import Circle, Obstacle, Point, Polygon, Scenario

__all__ = [
    "FAMILIES",
    "SCENARIOS",
    "AnyScenario",
    "Appear",
    "Circle",
    "Disappear",
    "Drive",
    "DynamicScenario",
    "Event",
    "FunctionScenario",
    "GridMap",
    "GridScenario",
    "MapScenario",
    "Move",
    "Obstacle",
    "Point",
    "Polygon",
    "Scenario",
    "StaticScenario",
    "World",
    "drive_of",
    "expand_name",
    "make_scenario",
    "make_scenarios",
    "rasterised",
    "require_analytic",
    "sample_names",
    "world_at",
    "worlds_of",
]


SCENARIOS: dict[str, Callable[[], Scenario]] = {
    "case1": paper_cases.case1,
    "case2": paper_cases.case2,
    "case3": paper_cases.case3,
}

FAMILIES: dict[str, Family] = {
    "random-fields": random_fields.FAMILY,
    "rooms": made_maps.ROOMS,
    "caves": made_maps.CAVES,
    "moving-ai": moving_ai.FAMILY,
    "den400d": moa_tasks.FAMILY,
    "ros": ros_map.FAMILY,
    "function": test_functions.FAMILY,
    **block_scene.FAMILIES,
    iafsa_routes.NAME: iafsa_routes.FAMILY,
    dynamic_family.NAME: dynamic_family.FAMILY,
}


def make_scenario(scenario: str | AnyScenario) -> AnyScenario:
    """The scenario of that name; a scenario is returned as it is.

    Raises:
        UnknownNameError: if there is none of that name.
        ScenarioError: if the name stands for several, or has not the form of its family.
    """
    if isinstance(scenario, AnyScenario):
        return scenario
    names = expand_name(scenario)
    if names != (scenario,):
        raise ScenarioError(f"scenario {shown(scenario)}: expected one scenario, not a range of {len(names)}")
    return _make(scenario)


def make_scenarios(scenario: str | AnyScenario) -> tuple[AnyScenario, ...]:
    """All scenarios that a name stands for, in order; of a scenario that one.

    Raises:
        UnknownNameError: if there is none of that name.
        ScenarioError: if the name has not the form of its family.
    """
    if isinstance(scenario, AnyScenario):
        return (scenario,)
    return tuple(map(_make, expand_name(scenario)))


def require_analytic(scenario: AnyScenario) -> Scenario:
    """The scenario, if its map is one of circles and polygons.

    Raises:
        ScenarioError: if it has a grid map, or none, or several.
    """
    if not isinstance(scenario, Scenario):
        raise ScenarioError(
            f"scenario {shown(scenario.name)}: expected circles and polygons, not {_OTHERS[type(scenario)]}"
        )
    return scenario


def expand_name(name: str) -> tuple[str, ...]:
    """The names of single scenarios that a name stands for, in order: of a range of a family, or the name.

    Raises:
        UnknownNameError: if there is none of that name.
        ScenarioError: if the name has not the form of its family.
    """
    family = _family_of(name)
    if family is not None:
        return family.expand(name)
    if not isinstance(name, str) or name not in SCENARIOS:
        raise UnknownNameError("scenario", name, [*SCENARIOS, *(f.usage for f in FAMILIES.values())])
    return (name,)


def sample_names() -> tuple[str, ...]:
    """All scenarios of which there is a fixed number, and some of every family."""
    return (*SCENARIOS, *(name for family in FAMILIES.values() for name in family.samples))


def _make(name: str) -> AnyScenario:
    family = _family_of(name)
    return SCENARIOS[name]() if family is None else family.make(name)


def _family_of(name: object) -> Family | None:
    return FAMILIES.get(name.partition(":")[0]) if isinstance(name, str) else None


_OTHERS: dict[type, str] = {
    GridScenario: "a grid map",
    FunctionScenario: "a test function",
    DynamicScenario: "a map that changes (it has several `worlds`)",
}
