"""The seeds of the next episodes of many swarms, each from a random generator of its own.

A seed is the entropy of a `numpy.random.SeedSequence`: eight words of 32 bits that the generator draws.
"""

from collections.abc import Iterable, Sequence
from typing import TypeGuard, cast

import numpy as np
from gymnasium.utils import seeding
from numpy.typing import NDArray

from swarm_gym.checks import refuse_negative_seed
from swarm_gym.errors import SettingError, shown

Words = NDArray[np.uint32]

NUM_WORDS = 8
_AHEAD = 16  # episodes whose seeds are drawn at once, since a call of a generator takes longer than its words


def draw_seeds(generator: np.random.Generator, episodes: int) -> Words:
    """Return the seeds of the next episodes, (episodes, 8); advances the generator."""
    return generator.integers(0, 2**32, size=(episodes, NUM_WORDS), dtype=np.uint32)


def read_seeds(seed: object, num_swarms: int) -> list[int | None]:
    """Return the seed of each of B swarms, (B,), from the argument of a vector's `reset`.

    Args:
        seed: seed of the first swarm, from which those of the others count up; or a list with one for each
            swarm, where None keeps the generator of the swarm.
        num_swarms: number of swarms B.

    Raises:
        SettingError: for anything else.
    """
    if _is_seed(seed):
        return [int(seed) + row for row in range(num_swarms)]
    is_list = isinstance(seed, Sequence) and not isinstance(seed, str | bytes)
    if not is_list and not (isinstance(seed, np.ndarray) and seed.ndim == 1):
        raise SettingError(f"seed must be an integer or a list of integers, got {shown(seed)}")
    given = list(cast(Iterable[object], seed))
    if len(given) != num_swarms:
        raise SettingError(f"seed: expected {num_swarms} seeds, one per swarm, got {len(given)}")
    seeds: list[int | None] = []
    for one in given:
        if one is not None and not _is_seed(one):
            raise SettingError(f"seed: expected integers in the list, got {shown(one)}")
        seeds.append(None if one is None else int(one))
    return seeds


def _is_seed(value: object) -> TypeGuard[int | np.integer]:
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


class EpisodeSeeds:
    """The seeds of the episodes of B swarms.

    Args:
        num_swarms: number of swarms B; until a swarm is given a seed, its generator has one from the
            operating system.
    """

    def __init__(self, num_swarms: int):
        self._generators = [seeding.np_random(None)[0] for _ in range(num_swarms)]
        self._drawn = np.empty((num_swarms, _AHEAD, NUM_WORDS), dtype=np.uint32)
        self._used = np.full(num_swarms, _AHEAD)

    def begin(self, seeds: dict[int, int]) -> None:
        """Give swarms new generators, by the numbers of the swarms; all seeds are checked first.

        Raises:
            gymnasium.error.Error: for a seed that is not a natural number.
        """
        made = {row: _make_generator(seed) for row, seed in seeds.items()}
        for row, generator in made.items():
            self._generators[row] = generator
            self._used[row] = _AHEAD

    def next_of(self, rows: NDArray[np.int64]) -> Words:
        """Return the seeds of the next episodes of these k swarms, (k, 8), which no later call returns."""
        for row in rows[self._used[rows] == _AHEAD].tolist():
            self._drawn[row] = draw_seeds(self._generators[row], _AHEAD)
            self._used[row] = 0
        found = self._drawn[rows, self._used[rows]]
        self._used[rows] += 1
        return found


def _make_generator(seed: int) -> np.random.Generator:
    refuse_negative_seed(seed)
    return seeding.np_random(seed)[0]
