"""What is to be solved: maps with start and target, and test functions, made by name.

To add a map: write a function that returns a `Scenario` and enter it in `SCENARIOS`. To add a family of maps,
with names that go on after a colon: write a module like `random_fields` and enter its `Family` in `FAMILIES`.
A `Scenario` has a map of circles and polygons, a `GridScenario` one of cells, a `FunctionScenario` none. The
map of a `DynamicScenario` changes: it is one scenario after the other, its worlds.
"""

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
