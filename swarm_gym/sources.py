"""Sources of new members: where members of a first population, of growth and of immigration come from.

| source | new members |
|---|---|
| `uniform` | uniform in a box |
| `smooth` | smooth bends next to the start-target line, see `swarm_gym.problem.geometry.bends` |
| `mixed` | smooth with the probability `smooth_share`, else uniform |
| `guided` | smooth bends next to planned ways through different corridors, see `swarm_gym.ways` |

The box of a first population has the scenario's initial bounds; later it is the box that the population spans
(eq. 12 of the SPSFA paper).

Immigrants replace the worst members of a population, those that shrinking would delete (J. Grefenstette,
"Genetic algorithms for changing environments", PPSN 2, 1992).
"""

from dataclasses import astuple, dataclass, fields
from typing import Self

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import look_up, require_number
from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform
from swarm_gym.errors import SettingError, shown
from swarm_gym.problem.geometry.bends import BENDS
from swarm_gym.problem.tables import Table, draw_bend

Floats = NDArray[np.float64]

UNIFORM, SMOOTH, MIXED, GUIDED = "uniform", "smooth", "mixed", "guided"
SOURCES = (UNIFORM, SMOOTH, MIXED, GUIDED)
# Largest offset of bends as a share of the workspace's width, where nothing else is asked for.
AMPLITUDES = {UNIFORM: 0.5, SMOOTH: 0.5, MIXED: 0.5, GUIDED: 0.05}

# Decisions on new members in the order of a sourced action, and their smallest and largest values.
SOURCE_RANGES = {"smooth_share": (0.0, 1.0), "amplitude": (0.01, 1.0), "immigrants": (0.0, 1.0)}
SOURCE_DECISIONS = tuple(SOURCE_RANGES)

# Columns of `population.Swarms.source`: the decisions, and the kind of bends.
NUM_SOURCE_NUMBERS = 4
SMOOTH_SHARE, AMPLITUDE, IMMIGRANTS, KIND_OF_BENDS = range(NUM_SOURCE_NUMBERS)

# Rows of records of new members, (2, W), whose columns are the last W iterations: iteration g is in column
# g % W. They hold the best fitness of smooth members, and the number of those that became the best so far.
BEST_SMOOTH, BECAME_BEST = range(2)


@dataclass(frozen=True)
class Source:
    """A source of new members.

    Attributes:
        smooth_share: probability that a new member is a smooth bend, in [0, 1].
        amplitude: largest offset of bends as a share of the workspace's width, in [0.01, 1].

    Raises:
        SettingError: for a number outside its range.
    """

    smooth_share: float = 0.0
    amplitude: float = 0.5

    def __post_init__(self) -> None:
        for one in fields(self):
            require_number(one.name, getattr(self, one.name), *SOURCE_RANGES[one.name])

    @classmethod
    def of(cls, numbers: object) -> Self:
        """Return the source of a file's entry `first_source`, the numbers by name.

        Raises:
            SettingError: for an entry that is not exactly these numbers, or a number outside its range.
        """
        names = [one.name for one in fields(cls)]
        if not isinstance(numbers, dict) or sorted(numbers) != sorted(names):
            raise SettingError(f"first_source must have {' and '.join(names)}, got {shown(numbers)}")
        return cls(**numbers)

    @property
    def decisions(self) -> tuple[float, float, float]:
        """The source as decisions in the order of `SOURCE_DECISIONS`, without immigrants."""
        return self.smooth_share, self.amplitude, 0.0

    @property
    def name(self) -> str:
        """Name of the source, one of `SOURCES`."""
        return {0.0: UNIFORM, 1.0: SMOOTH}.get(self.smooth_share, MIXED)

    def identity(self) -> tuple[float, ...]:
        """Return all numbers, as a part of the identity of a controller."""
        return tuple(float(number) for number in astuple(self))

    def options(self) -> dict[str, str | float]:
        """Return the options of an environment whose new members come from this source."""
        share = {"smooth_share": self.smooth_share} if self.name == MIXED else {}
        amplitude = {} if self.name == UNIFORM else {"amplitude": self.amplitude}
        return {"source": self.name, **share, **amplitude}


def kind_of_bends(name: str) -> int:
    """Return the number of a kind of bends, a row of the modes in problem tables.

    Raises:
        UnknownNameError: if there is no kind of that name.
    """
    return look_up("kind of bends", name, BENDS)


@kernel(borrows=True)
def draw_newcomer(
    source: Floats,
    stream: NDArray[np.uint64],
    table: Table,
    noise: Floats,
    path: Floats,
    lower: Floats,
    upper: Floats,
) -> bool:
    """Write the position of a new member into a path, (C + 1,); return whether it is a smooth bend.

    Args:
        source: (NUM_SOURCE_NUMBERS,) source of the swarm.
        stream: random stream of the swarm, advanced by C numbers, or 2 C if the source is mixed.
        table: problem table.
        noise: (C,) scratch array.
        path: path that is written.
        lower: (C,) lower corner of the box of a uniform member.
        upper: (C,) its upper corner.
    """
    fill_uniform(stream, noise)
    share = source[SMOOTH_SHARE]
    if share > 0.0:
        if noise[0] < share:
            noise[0] = noise[0] / share  # uniform in [0, 1) again
            draw_bend(table, source[AMPLITUDE], int(source[KIND_OF_BENDS]), noise, path)
            return True
        fill_uniform(stream, noise)  # the first of the old numbers is known to be large
    for k in range(lower.shape[0]):
        path[k + 1] = lower[k] + (upper[k] - lower[k]) * noise[k]  # eq. 12
    return False


@kernel(borrows=True)
def note_arrival(arrivals: Floats, iteration: int, smooth: bool, fitness: float, best: float) -> None:
    """Record a new member of this fitness, where `best` was the best fitness so far, if W > 0."""
    window = arrivals.shape[1]
    if window > 0:
        now = iteration % window
        if smooth:
            arrivals[BEST_SMOOTH, now] = min(arrivals[BEST_SMOOTH, now], fitness)
        if fitness < best:
            arrivals[BECAME_BEST, now] += 1.0


@kernel(borrows=True)
def begin_arrivals(arrivals: Floats, iteration: int) -> None:
    """Delete the old records that the records of an iteration replace."""
    window = arrivals.shape[1]
    if window > 0:
        now = iteration % window
        arrivals[BEST_SMOOTH, now] = np.inf
        arrivals[BECAME_BEST, now] = 0.0


@kernel(borrows=True)
def forget_arrivals(arrivals: Floats) -> None:
    """Delete all records: the records of a first population say nothing about later members."""
    for k in range(arrivals.shape[1]):
        arrivals[BEST_SMOOTH, k] = np.inf
        arrivals[BECAME_BEST, k] = 0.0
