"""A path-planning task whose map changes while it is worked on; checked when it is made."""

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

MapScenario = Scenario | GridScenario
StaticScenario = MapScenario | FunctionScenario


class World(NamedTuple):
    """What a scenario is from some time on.

    Attributes:
        iteration: after which this is in force; 0 is from the beginning.
        scenario: the map as it is then, and the task.
    """

    iteration: int
    scenario: StaticScenario


@dataclass(frozen=True)
class DynamicScenario:
    """A task on a map on which something happens: data, like the maps themselves.

    An event takes place between two iterations: after the one of its number is done, before the next one is
    decided on. What would take place after the end of an episode does not.

    Attributes:
        name: what results are filed under; all its worlds have it.
        base: the task before anything happened.
        events: in the order in which they happen; several may follow the same iteration.
        drive: how the robot drives meanwhile; None if it stays at the start.

    Raises:
        ScenarioError: if the events are malformed or not in order, or if one leaves start or target in an
            obstacle or, on a grid map, apart; the message names the event or the iteration.
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
                raise ScenarioError(f"{where}: {event}: events can follow iterations from 1 on")
        for before, after in pairwise(self.events):
            if before.iteration > after.iteration:
                raise ScenarioError(f"{where}: events must be in order, got {before} before {after}")
        assert self.worlds  # which refuses what is impossible

    @cached_property
    def worlds(self) -> tuple[World, ...]:
        """The base, and what becomes of it with the events of every iteration."""
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
        return replace(self.base, name=self.name, map=changed)


AnyScenario = StaticScenario | DynamicScenario


def worlds_of(scenario: AnyScenario) -> tuple[World, ...]:
    """What a scenario is, from which iteration on; that of one without events is one for ever."""
    return scenario.worlds if isinstance(scenario, DynamicScenario) else (World(0, scenario),)


def world_at(scenario: AnyScenario, iteration: int) -> StaticScenario:
    """What a scenario is when so many iterations are done, and what follows the last of them has happened."""
    return [world.scenario for world in worlds_of(scenario) if world.iteration <= iteration][-1]


def drive_of(scenario: AnyScenario) -> Drive | None:
    """How the robot of a scenario drives while it is planned for; None if it does not."""
    return scenario.drive if isinstance(scenario, DynamicScenario) else None


def _events(where: str, given: Any) -> tuple[Event, ...]:
    events = tuple(given) if isinstance(given, Iterable) else (given,)
    for event in events:
        if not isinstance(event, Appear | Move | Disappear):
            raise ScenarioError(
                f"{where}: events must be a sequence of Appear, Move and Disappear, got {shown(event)}"
            )
    return events
