"""Path-planning tasks whose map changes during an episode; values are checked when an object is made."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.dynamic.events import Appear, Disappear, Drive, Event, Move, Obstacles
from swarm_gym.scenarios.function_scenario import FunctionScenario
from swarm_gym.scenarios.grid_map import GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.raster import cells_of
from swarm_gym.scenarios.scenario import Scenario
from swarm_gym.scenarios.terrain.scenario import TerrainScenario

MapScenario = Scenario | GridScenario
StaticScenario = MapScenario | FunctionScenario | TerrainScenario


class World(NamedTuple):
    """A fixed map with its task, and the iteration after which it is in force.

    Attributes:
        iteration: number of the iteration after which this world is in force; 0 for the first one.
        scenario: the task on the map as it is then.
    """

    iteration: int
    scenario: StaticScenario


@dataclass(frozen=True)
class DynamicScenario:
    """A task on a map that changes by events, or on which a robot drives during planning.

    An event takes place between two iterations: after the iteration of its number, and before the decision on
    the next one. Environments refuse events that no iteration follows.

    Attributes:
        name: name under which results are filed; all worlds of the scenario have it.
        base: the task before the first event.
        events: events in the order in which they happen; several may follow the same iteration.
        drive: times and distances of the robot's drives; None if it stays at the start.

    Raises:
        ScenarioError: if the events are malformed or not in order, or if an event makes the task impossible:
            an obstacle covers start or target, or no path connects them on a grid map. The message names the
            event or the iteration.
    """

    name: str
    base: MapScenario
    events: tuple[Event, ...]
    drive: Drive | None = None

    def __post_init__(self) -> None:
        where = f"scenario {shown(self.name)}"
        if not isinstance(self.base, Scenario | GridScenario):
            raise ScenarioError(
                f"{where}: the base must be a Scenario or a GridScenario, got {shown(self.base)}"
            )
        object.__setattr__(self, "events", _events(where, self.events))
        if not isinstance(self.drive, Drive | None):
            raise ScenarioError(f"{where}: drive must be a Drive or None, got {shown(self.drive)}")
        for event in self.events:
            if event.iteration < 1:
                raise ScenarioError(
                    f"{where}: {event}: expected an iteration from 1 on, got {event.iteration}"
                )
        for before, after in pairwise(self.events):
            if before.iteration > after.iteration:
                raise ScenarioError(f"{where}: events must be in order, got {before} before {after}")
        assert self.worlds  # making them checks every event

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """The worlds: the base, and the map after the events of every iteration."""
        worlds = [World(0, replace(self.base, name=self.name))]
        obstacles: Obstacles = list(self.base.obstacles) if isinstance(self.base, Scenario) else []
        for iteration in sorted({event.iteration for event in self.events}):
            try:
                for event in self.events:
                    if event.iteration == iteration:
                        event.change(obstacles)
                worlds.append(World(iteration, self._with(obstacles, iteration)))
            except ScenarioError as error:
                raise ScenarioError(f"after iteration {iteration} of {shown(self.name)}: {error}") from error
        return tuple(worlds)

    def _with(self, obstacles: Obstacles, iteration: int) -> MapScenario:
        present = tuple(obstacle for obstacle in obstacles if obstacle is not None)
        if isinstance(self.base, Scenario):
            return replace(self.base, name=self.name, obstacles=present)
        grid = self.base.map
        blocked = grid.blocked.copy()
        for obstacle in present:
            blocked |= cells_of(obstacle, grid)
        changed = GridMap(
            f"{grid.name} after iteration {iteration}", blocked, grid.resolution, grid.origin, grid.y_up
        )
        return replace(self.base, name=self.name).on(changed)


AnyScenario = StaticScenario | DynamicScenario


def worlds_of(scenario: AnyScenario) -> tuple[World, ...]:
    """Return the worlds of a scenario in order; a scenario without events has one."""
    return scenario.worlds if isinstance(scenario, DynamicScenario) else (World(0, scenario),)


def world_at(scenario: AnyScenario, iteration: int) -> StaticScenario:
    """Return the world's scenario after so many iterations, and after the events that follow the last one."""
    return [world.scenario for world in worlds_of(scenario) if world.iteration <= iteration][-1]


def drive_of(scenario: AnyScenario) -> Drive | None:
    """Return the times and distances of the drives of a scenario's robot; None if it does not drive."""
    return scenario.drive if isinstance(scenario, DynamicScenario) else None


def _events(where: str, given: Any) -> tuple[Event, ...]:
    events = tuple(given) if isinstance(given, Iterable) else (given,)
    for event in events:
        if not isinstance(event, Appear | Move | Disappear):
            raise ScenarioError(
                f"{where}: events must be a sequence of Appear, Move and Disappear, got {shown(event)}"
            )
    return events
