"""Scenarios: the tasks that optimizers solve, on maps or as test functions, made by name.

A scenario of a fixed map has a start and a target. `Scenario` has a map of circles and polygons,
`GridScenario` a map of cells. `FunctionScenario` has no map: the task is to find the minimum of a function;
`BbobScenario` is one of the benchmark BBOB, and `MetaBoxScenario` the same as MetaBox has it. `IohScenario`
is one that the package `ioh` keeps, and `OneMaxScenario` counts the ones of a bit string. `TerrainScenario`
is a flight over a height map. The map of a `DynamicScenario` changes during an episode. Such a scenario is a
sequence of worlds; a `World` is a fixed map and the iteration after which it replaces the one before.

`registry` has the names. CONTRIBUTING.md lists the steps to add a scenario, or a family of them.
"""

from swarm_gym.scenarios.bbob.scenario import BbobScenario
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
from swarm_gym.scenarios.function_scenario import FunctionScenario
from swarm_gym.scenarios.grid_map import GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.growing import grown
from swarm_gym.scenarios.ioh_scenario import IohScenario
from swarm_gym.scenarios.metabox import MetaBoxScenario
from swarm_gym.scenarios.obstacles import Circle, Obstacle, Point, Polygon
from swarm_gym.scenarios.onemax import OneMaxScenario
from swarm_gym.scenarios.raster import rasterised
from swarm_gym.scenarios.registry import (
    FAMILIES,
    SCENARIOS,
    expand_name,
    make_scenario,
    make_scenarios,
    require_analytic,
    sample_names,
)
from swarm_gym.scenarios.scenario import Scenario
from swarm_gym.scenarios.terrain.scenario import TerrainScenario, hill_shade

__all__ = [
    "FAMILIES",
    "SCENARIOS",
    "AnyScenario",
    "Appear",
    "BbobScenario",
    "Circle",
    "Disappear",
    "Drive",
    "DynamicScenario",
    "Event",
    "FunctionScenario",
    "GridMap",
    "GridScenario",
    "IohScenario",
    "MapScenario",
    "MetaBoxScenario",
    "Move",
    "Obstacle",
    "OneMaxScenario",
    "Point",
    "Polygon",
    "Scenario",
    "StaticScenario",
    "TerrainScenario",
    "World",
    "drive_of",
    "expand_name",
    "grown",
    "hill_shade",
    "make_scenario",
    "make_scenarios",
    "rasterised",
    "require_analytic",
    "sample_names",
    "world_at",
    "worlds_of",
]
