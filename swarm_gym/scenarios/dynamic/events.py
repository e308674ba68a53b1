"""What can happen on a map while a robot is planned for: obstacles appear, move and disappear; it drives.

Obstacles are named by their numbers, which nothing changes: those of a map of circles and polygons have the
numbers of their places in `Scenario.obstacles`, and what appears has the next one. On grid maps only what
appeared has a number, from 0 on.
"""

from dataclasses import dataclass

from swarm_gym.checks import require_integer, require_number
from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.scenario import Circle, Obstacle, Point, Polygon, require_numbers

# By number; None is one that is gone.
Obstacles = list[Obstacle | None]


@dataclass(frozen=True)
class Appear:
    """An obstacle comes onto the map, after an iteration of that number."""

    iteration: int
    obstacle: Obstacle

    def __post_init__(self) -> None:
        require_integer(f"{shown(self)}: iteration", self.iteration, 0)
        if not isinstance(self.obstacle, Circle | Polygon):
            raise ScenarioError(f"{shown(self)}: expected a Circle or a Polygon, got {shown(self.obstacle)}")

    def change(self, obstacles: Obstacles) -> None:
        """Let it happen."""
        obstacles.append(self.obstacle)


@dataclass(frozen=True)
class Move:
    """An obstacle moves by (x, y), in map units, after an iteration of that number."""

    iteration: int
    number: int
    by: Point

    def __post_init__(self) -> None:
        require_integer(f"{shown(self)}: iteration", self.iteration, 0)
        require_integer(f"{shown(self)}: number", self.number, 0)
        object.__setattr__(self, "by", require_numbers(self, "by", self.by, 2))

    def change(self, obstacles: Obstacles) -> None:
        """Let it happen."""
        obstacles[self.number] = _present(self, obstacles).moved(self.by)


@dataclass(frozen=True)
class Disappear:
    """An obstacle goes from the map, after an iteration of that number."""

    iteration: int
    number: int

    def __post_init__(self) -> None:
        require_integer(f"{shown(self)}: iteration", self.iteration, 0)
        require_integer(f"{shown(self)}: number", self.number, 0)

    def change(self, obstacles: Obstacles) -> None:
        """Let it happen."""
        _present(self, obstacles)
        obstacles[self.number] = None


Event = Appear | Move | Disappear


@dataclass(frozen=True)
class Drive:
    """How a robot drives while it is planned for: after some iterations a piece of the best path so far.

    Attributes:
        first: the iteration that it first drives after.
        every: iterations from one drive to the next.
        distance: how far it drives each time, in map units.
    """

    first: int
    every: int
    distance: float

    def __post_init__(self) -> None:
        require_integer(f"{shown(self)}: first", self.first, 1)
        require_integer(f"{shown(self)}: every", self.every, 1)
        require_number(f"{shown(self)}: distance", self.distance, 1e-9, 1e9)


def _present(event: Move | Disappear, obstacles: Obstacles) -> Obstacle:
    """The obstacle that an event is about."""
    obstacle = obstacles[event.number] if event.number < len(obstacles) else None
    if obstacle is None:
        there = [number for number, other in enumerate(obstacles) if other is not None]
        raise ScenarioError(f"{event}: there is no obstacle of that number then, but {there}")
    return obstacle
