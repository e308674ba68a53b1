"""Random fields whose obstacles appear, vanish or move: the scenarios `dynamic-fields:<split>:<number>`.

Each begins as a random field of its own, with one to three events in an episode of 100 iterations. Times are
drawn from nearly the whole episode. So is, for each event, whether it touches the corridor of the shortest
way. After every event there is a way without collision.

In the splits `train`, `validation` and `test` obstacles appear and vanish. In the split `moving` they move:
this kind of event is kept for tests.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from swarm_gym.scenarios.dynamic.corridor import MARGIN, Floats, corners, covered, shortest_way
from swarm_gym.scenarios.dynamic.events import Appear, Disappear, Event, Move
from swarm_gym.scenarios.dynamic.scenario import DynamicScenario
from swarm_gym.scenarios.family import Family, expand_split
from swarm_gym.scenarios.field_generators import Scatter, drawn
from swarm_gym.scenarios.obstacles import Circle, Obstacle, Polygon
from swarm_gym.scenarios.scenario import Scenario

NAME = "dynamic-fields"
USAGE = f"{NAME}:<split>:<number>"

MOST_EVENTS = 3
FIRST, LAST = 5, 89  # iterations that events can follow
REACH = Scatter.reach  # largest distance between the line from start to target and any obstacle
FREE_END = 60  # space without events after the start and before the target, in map units
SIZES = (25, 55)  # interval of the radius, or half the height, of an obstacle that appears
STEPS = (40, 120)  # interval of the distance that an obstacle moves
BESIDE = 22.0  # largest distance between the shortest way and an obstacle that it goes along
TRIALS = 200  # events that are tried before a field is drawn again

Generator = np.random.Generator


class ChangingSplit(NamedTuple):
    """A split of the changing fields.

    Attributes:
        first_seed: seed of field 0; field k is drawn by the generator of seed `first_seed` + k.
        size: number of fields.
        kinds: functions that propose an event: given the generator, the iteration, the field, the obstacles
            by number, the shortest way, and whether the event is to touch that way.
    """

    first_seed: int
    size: int
    kinds: tuple[Callable[..., Event | None], ...]


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single fields that a name stands for; `...:0-255` stands for 256 of them.

    Raises:
        UnknownNameError: if there is no such split.
        ScenarioError: if the name has another form, or a number is not in its split.
    """
    return expand_split(name, NAME, SPLITS, "0-255")


def make(name: str) -> DynamicScenario:
    """Return the single field of that name."""
    _, split, number = name.split(":")
    first_seed, _, kinds = SPLITS[split]
    rng = np.random.Generator(np.random.PCG64(first_seed + int(number)))
    while True:
        field = Scatter().draw(name, rng)
        events = _draw_events(rng, field, kinds)
        if events:
            return DynamicScenario(name, field, events)


def _draw_events(
    rng: Generator, field: Scenario, kinds: tuple[Callable[..., Event | None], ...]
) -> tuple[Event, ...]:
    """Return one to three events, or none if no way is left or no event of a drawn kind is found."""
    number = drawn(rng, (1, MOST_EVENTS))
    times = sorted(rng.choice(np.arange(FIRST, LAST + 1), number, replace=False).tolist())
    obstacles: list[Obstacle | None] = list(field.obstacles)
    way = shortest_way(field, list(field.obstacles))
    events: list[Event] = []
    for iteration in times:
        kind, touching = kinds[drawn(rng, (0, len(kinds) - 1))], bool(drawn(rng, (0, 1)))
        for _ in range(TRIALS):
            event = None if way is None else kind(rng, iteration, field, obstacles, way, touching)
            changed = list(obstacles)
            if event is not None:
                event.change(changed)
                after = shortest_way(field, [one for one in changed if one is not None])
                if after is not None:
                    break
        else:
            return ()
        obstacles, way = changed, after
        events.append(event)
    return tuple(events)


def _appear(
    rng: Generator,
    iteration: int,
    field: Scenario,
    obstacles: list[Obstacle | None],  # noqa: ARG001
    way: Floats,
    touching: bool,
) -> Appear | None:
    """Propose an obstacle on the way, or anywhere but there."""
    size = drawn(rng, SIZES)
    if touching:
        x, y = (int(part) for part in way[drawn(rng, (0, len(way) - 1))])
        y += drawn(rng, (-10, 10))
    else:
        x = drawn(rng, (int(field.start[0]), int(field.target[0])))
        y = int(field.start[1]) + drawn(rng, (-REACH, REACH))
    slim = size * drawn(rng, (25, 55)) // 100
    shapes = (Circle(x, y, size), Polygon.rectangle(x - slim, y - size, x + slim, y + size))
    obstacle = shapes[drawn(rng, (0, 1))]
    if not _fits(field, obstacle) or _touches(way, obstacle) != touching:
        return None
    return Appear(iteration, obstacle)


def _vanish(
    rng: Generator,
    iteration: int,
    field: Scenario,  # noqa: ARG001
    obstacles: list[Obstacle | None],
    way: Floats,
    touching: bool,
) -> Disappear | None:
    """Propose an obstacle that the way goes along, or one that is far from it."""
    number = _some_number(rng, obstacles)
    beside = covered(way, obstacles[number], BESIDE).any()  # type: ignore[arg-type]
    return Disappear(iteration, number) if beside == touching else None


def _move(
    rng: Generator,
    iteration: int,
    field: Scenario,
    obstacles: list[Obstacle | None],
    way: Floats,
    touching: bool,
) -> Move | None:
    """Propose a place for an obstacle, on the way or off it."""
    number, step = _some_number(rng, obstacles), drawn(rng, STEPS)
    # Of a step, from 0 to 3 quarters go along the line, the rest across.
    along = step * drawn(rng, (0, 3)) // 4
    by = (along * (1 - 2 * drawn(rng, (0, 1))), (step - along) * (1 - 2 * drawn(rng, (0, 1))))
    moved = obstacles[number].moved(by)  # type: ignore[union-attr]
    if not _fits(field, moved) or _touches(way, moved) != touching:
        return None
    return Move(iteration, number, by)


# The ranges of seeds are disjoint, also from those of `random_fields.SPLITS`. Never change the seeds or the
# generator of a split: results refer to them.
SPLITS = {
    "train": ChangingSplit(10_000_000, 1_000_000, (_appear, _vanish)),
    "validation": ChangingSplit(11_000_000, 100_000, (_appear, _vanish)),
    "test": ChangingSplit(11_100_000, 100_000, (_appear, _vanish)),
    "moving": ChangingSplit(11_200_000, 100_000, (_move,)),
}


def _some_number(rng: Generator, obstacles: list[Obstacle | None]) -> int:
    present = [number for number, obstacle in enumerate(obstacles) if obstacle is not None]
    return present[drawn(rng, (0, len(present) - 1))]


def _fits(field: Scenario, obstacle: Obstacle) -> bool:
    """Return whether an obstacle keeps away from start, target and the sides of the workspace."""
    (low_x, low_y), (high_x, high_y) = corners(obstacle)
    line = field.start[1]
    return bool(
        field.start[0] + FREE_END <= low_x
        and high_x <= field.target[0] - FREE_END
        and line - REACH <= low_y
        and high_y <= line + REACH
    )


def _touches(way: Floats, obstacle: Obstacle) -> bool:
    """Return whether an obstacle closes a way on its lattice."""
    return bool(covered(way, obstacle, MARGIN).any())


FAMILY = Family(USAGE, tuple(f"{NAME}:{split}:0" for split in SPLITS), expand, make)
