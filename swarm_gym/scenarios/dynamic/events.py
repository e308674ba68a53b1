"""Events on a map during an episode: obstacles appear, move and disappear. A robot can drive meanwhile.

Obstacles are identified by numbers, which never change. On a map of circles and polygons, obstacles of the
first map have their indices in `Scenario.obstacles`. Obstacles that appear are numbered on from there. On
grid maps only obstacles that appeared have numbers, from 0 on.
"""

from dataclasses import dataclass

from swarm_gym.checks import require_integer, require_number
from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.obstacles import Circle, Obstacle, Point, Polygon, require_point

# Obstacles by number; None stands for an obstacle that has disappeared.
Obstacles = list[Obstacle | None]


@dataclass(frozen=True)
class Appear:
    """The event that an obstacle appears on the map.

    Attributes:
        iteration: number of the iteration that the event follows, from 1 on.
        obstacle: the obstacle, in map coordinates.
    """

    iteration: int
    obstacle: Obstacle

    def __post_init__(self) -> None:
        require_integer(f"{shown(self)}: iteration", self.iteration, 0)
        if not isinstance(self.obstacle, Circle | Polygon):
            raise ScenarioError(f"{shown(self)}: expected a Circle or a Polygon, got {shown(self.obstacle)}")

    def change(self, obstacles: Obstacles) -> None:
        """Apply the event to the obstacles."""
        obstacles.append(self.obstacle)


@dataclass(frozen=True)
class Move:
    """The event that an obstacle moves.

    Attributes:
        iteration: number of the iteration that the event follows, from 1 on.
        number: number of the obstacle.
        by: displacement (x, y) in map units.
    """

    iteration: int
    number: int
    by: Point

    def __post_init__(self) -> None:
        require_integer(f"{shown(self)}: iteration", self.iteration, 0)
        require_integer(f"{shown(self)}: number", self.number, 0)
        object.__setattr__(self, "by", require_point(self, "by", self.by))

    def change(self, obstacles: Obstacles) -> None:
        """Apply the event to the obstacles."""
        obstacles[self.number] = _present(self, obstacles).moved(self.by)


@dataclass(frozen=True)
class Disappear:
    """The event that an obstacle disappears from the map.

    Attributes:
        iteration: number of the iteration that the event follows, from 1 on.
        number: number of the obstacle.
    """

    iteration: int
    number: int

    def __post_init__(self) -> None:
        require_integer(f"{shown(self)}: iteration", self.iteration, 0)
        require_integer(f"{shown(self)}: number", self.number, 0)

    def change(self, obstacles: Obstacles) -> None:
        """Apply the event to the obstacles."""
        _present(self, obstacles)
        obstacles[self.number] = None


Event = Appear | Move | Disappear


@dataclass(frozen=True)
class Drive:
    """The times and distances of a robot's drives along the best path so far, while it is planned for.

    Attributes:
        first: number of the iteration that the first drive follows.
        every: number of iterations from one drive to the next.
        distance: length of each drive, in map units.
    """

    first: int
    every: int
    distance: float

    def __post_init__(self) -> None:
        require_integer(f"{shown(self)}: first", self.first, 1)
        require_integer(f"{shown(self)}: every", self.every, 1)
        require_number(f"{shown(self)}: distance", self.distance, 1e-9, 1e9)


def _present(event: Move | Disappear, obstacles: Obstacles) -> Obstacle:
    """Return the obstacle that an event is about."""
    obstacle = obstacles[event.number] if event.number < len(obstacles) else None
    if obstacle is None:
        there = [number for number, other in enumerate(obstacles) if other is not None]
        raise ScenarioError(
            f"{event}: there is no obstacle of that number at that time, expected one of {there}"
        )
    return obstacle
