"""Generated terrains, in any number: the scenarios `terrain:<split>:<number>`.

The splits `train`, `validation` and `test` are drawn alike and are disjoint. `train-few` and `validation-few`
have 15 threats, `train-many` and `validation-many` have 30; `train` and `validation` alternate, even numbers
have 15.

`terrain:test:0` to `terrain:test:27` have 15 threats, `terrain:test:28` to `terrain:test:55` have 30. MetaBox
makes these terrains in its mode `custom` with its own seed and the difficulty `all`. Two are others, 33 and
36, since their goal lies in a threat. The next two of the same stream follow the others instead.

A terrain whose goal lies in a threat is left out in the other splits, too: the stream of its seed goes on.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from swarm_gym.scenarios.family import Family, expand_split
from swarm_gym.scenarios.terrain import heights_cache
from swarm_gym.scenarios.terrain.generator import BAND, DANGER, DRONE, FIRST_CELL, Terrain, TerrainDraws, draw
from swarm_gym.scenarios.terrain.scenario import TOP, TerrainScenario

NAME = "terrain"
USAGE = f"{NAME}:<split>:<number>"

FEW, MANY = 15, 30  # threats
SEED = 3849  # of MetaBox
TESTS = 56
KEPT = 8  # terrains in memory, of 6.5 MB each


class Split(NamedTuple):
    """A split of the generated terrains.

    Attributes:
        first_seed: seed of terrain 0; terrain k has the seed `first_seed` + k.
        size: number of terrains.
        threats: numbers of threats, which terrains have in turn.
    """

    first_seed: int
    size: int
    threats: tuple[int, ...]


TEST = Split(SEED, TESTS, (FEW, MANY))
# The ranges of seeds are disjoint. Never change the seeds or the generator of a split: results refer to them.
SPLITS = {
    "train": Split(1_000_000, 1_000_000, (FEW, MANY)),
    "train-few": Split(2_000_000, 1_000_000, (FEW,)),
    "train-many": Split(3_000_000, 1_000_000, (MANY,)),
    "validation": Split(4_000_000, 100_000, (FEW, MANY)),
    "validation-few": Split(4_100_000, 100_000, (FEW,)),
    "validation-many": Split(4_200_000, 100_000, (MANY,)),
    "test": TEST,
}


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single terrains that a name stands for; `...:0-27` stands for 28 of them.

    Raises:
        UnknownNameError: if there is no such split.
        ScenarioError: if the name has another form, or a number is not in its split.
    """
    return expand_split(name, NAME, SPLITS, "0-27")


def make(name: str) -> TerrainScenario:
    """Return the single terrain of that name: in seconds at first, later from a cache."""
    return as_scenario(name, terrain_of(name))


FAMILY = Family(USAGE, (), expand, make)


@lru_cache(maxsize=KEPT)
def terrain_of(name: str) -> Terrain:
    """Return the terrain of a name, with the heights of its threats, as the published generator makes it."""
    return heights_cache.terrain_of(name.replace(":", "-"), draws_of(name))


def draws_of(name: str) -> TerrainDraws:
    """Return the random numbers of the terrain of a name, without its height map: in milliseconds."""
    _, kind, number = name.split(":")
    split, k = SPLITS[kind], int(number)
    if split is TEST:
        return _test_draws(k)
    return _next_possible(np.random.RandomState(split.first_seed + k), split.threats[k % len(split.threats)])


def as_scenario(name: str, terrain: Terrain) -> TerrainScenario:
    """Return the task on a terrain. Its threats block every altitude, as in the published cost."""
    threats = terrain.threats.copy()
    threats[:, TOP] = np.inf
    return TerrainScenario(
        name,
        terrain.heights,
        terrain.start,
        terrain.goal,
        origin=(FIRST_CELL, FIRST_CELL),
        threats=threats,
        band=BAND,
        drone_size=DRONE,
        danger_distance=DANGER,
    )


def _test_draws(number: int) -> TerrainDraws:
    """Return terrain `number` of the one stream of the tests."""
    stream = np.random.RandomState()
    stream.set_state(_test_states()[number])
    return _next_possible(stream, _test_threats(number))


@lru_cache(maxsize=1)
def _test_states() -> tuple[dict[str, Any], ...]:
    """Return the states of the stream of the tests before each of its terrains."""
    stream, states = np.random.RandomState(SEED), []
    for number in range(TESTS):
        states.append(stream.get_state(legacy=False))
        _next_possible(stream, _test_threats(number))
    return tuple(states)


def _test_threats(number: int) -> int:
    return FEW if number < TESTS // 2 else MANY


def _next_possible(stream: np.random.RandomState, threats: int) -> TerrainDraws:
    """Return the next terrain of a stream whose goal is free."""
    while True:
        found = draw(stream, threats)
        if found.is_possible:
            return found
