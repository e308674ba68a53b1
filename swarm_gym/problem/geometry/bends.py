"""Smooth bends: paths whose offsets from a middle path are sums of a few smooth modes.

The middle path is the start-target line, or one of some planned ways, see `swarm_gym.ways`.

A bend has no zigzag, unlike a path whose components are drawn one by one. There are two kinds of modes:

* `harmonics`: sin(h pi t) / h^1.5 for h = 1, 2, 3, with coefficients uniform in [-1, 1].
* `stomp`: the six widest principal components of the noise of STOMP, with normal coefficients. Its covariance
  is the inverse of A^T A for the matrix A of second differences (M. Kalakrishnan et al., "STOMP: stochastic
  trajectory optimization for motion planning", ICRA 2011, section III-A).

In both, t in (0, 1) is the place along the line. The sum is scaled so that its largest offset is uniform in
[0, amplitude times the width of the workspace].
"""

import math
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import power, sin
from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.simd import NUM_LANES, broadcast, load, maximum, minimum, store
from swarm_gym.problem.geometry.stiffness import least_stiff
from swarm_gym.problem.padding import columns

Floats = NDArray[np.float64]


class BentTable(Protocol):
    """The fields of a problem table from which bends are drawn; vectors of C columns are paths."""

    @property
    def lower(self) -> Floats:
        """(C,) lower bounds of the offsets."""

    @property
    def upper(self) -> Floats:
        """(C,) upper bounds of the offsets."""

    @property
    def width(self) -> float:
        """Largest extent of the workspace across the line."""

    @property
    def middles(self) -> Floats:
        """(K, C) vectors of the middle paths."""

    @property
    def across(self) -> Floats:
        """(C,) change of the components per unit of offset."""

    @property
    def modes(self) -> Floats:
        """(2, NUM_MODES, C) modes of both kinds."""


# Kinds of modes by the name of the option `bends`; the numbers are rows of `modes`.
HARMONICS, STOMP = range(2)
BENDS = {"harmonics": HARMONICS, "stomp": STOMP}

NUM_HARMONICS = 3
DECAY = 1.5  # exponent of the decay of harmonics; see docs/readings.md
NUM_MODES = 6  # with two more random numbers they fit into the smallest number of columns, 8
LARGEST_OFFSET, FIRST_COEFFICIENT = 1, 2  # places in an array of random numbers


@lru_cache(maxsize=64)
def modes(count: int) -> Floats:
    """Return the modes of both kinds at `count` points evenly spaced between start and target.

    Returns:
        (2, NUM_MODES, count) offsets; rows beyond the modes of a kind are zeros.
    """
    out = np.zeros((len(BENDS), NUM_MODES, count))
    t = np.arange(1.0, count + 1) / (count + 1)
    for h in range(1, NUM_HARMONICS + 1):
        out[HARMONICS, h - 1] = sin(h * np.pi * t) / float(power(h, DECAY))
    stiffness, directions = least_stiff(count, min(NUM_MODES, count))
    out[STOMP, : len(stiffness)] = directions * np.sqrt(stiffness[0] / stiffness)[:, None]
    out.setflags(write=False)
    return out


def modes_of_components(offsets: NDArray[np.int64], count: int) -> Floats:
    """Return `modes` for every component of a decision vector, padded to (2, NUM_MODES, C).

    Args:
        offsets: (dimension,) number of the point, from 0, that a component belongs to.
        count: number of points.
    """
    out = np.zeros((len(BENDS), NUM_MODES, columns(len(offsets))))
    out[..., : len(offsets)] = modes(count)[..., offsets]
    return out


@kernel(borrows=True)
def draw_bend(table: BentTable, amplitude: float, kind: int, noise: Floats, path: Floats) -> None:
    """Write a bend into a path, (C + 1,).

    Args:
        table: problem table.
        amplitude: largest offset as a share of the width of the workspace, in (0, 1].
        kind: kind of modes, a value of `BENDS`.
        noise: (C,) numbers uniform in [0, 1); that in place 0 chooses the middle path; changed in place.
        path: path that is written; components stay within the bounds of the table.
    """
    num_middles = table.middles.shape[0]
    middle = table.middles[min(int(noise[0] * num_middles), num_middles - 1)]
    if kind == HARMONICS:
        count = NUM_HARMONICS
        for h in range(count):
            noise[FIRST_COEFFICIENT + h] = 2.0 * noise[FIRST_COEFFICIENT + h] - 1.0
    else:
        count = NUM_MODES
        for h in range(0, count, 2):  # Box-Muller
            k = FIRST_COEFFICIENT + h
            radius, angle = math.sqrt(-2.0 * math.log(1.0 - noise[k])), 2.0 * math.pi * noise[k + 1]
            noise[k], noise[k + 1] = radius * math.cos(angle), radius * math.sin(angle)
    num_columns = middle.shape[0]
    for h in range(count):
        mode, weight = table.modes[kind, h], broadcast(noise[FIRST_COEFFICIENT + h])
        for k in range(0, num_columns, NUM_LANES):
            if h == 0:
                store(path, k + 1, weight * load(mode, k))
            else:
                store(path, k + 1, load(path, k + 1) + weight * load(mode, k))
    drawn, zero = noise[LARGEST_OFFSET], broadcast(0.0)
    heights = zero
    for k in range(0, num_columns, NUM_LANES):
        offset = load(path, k + 1)
        heights = maximum(heights, maximum(offset, zero - offset))
    store(noise, 0, heights)  # its numbers are used up
    largest = 0.0
    for lane in range(NUM_LANES):
        largest = max(largest, noise[lane])
    scale = broadcast(drawn * amplitude * table.width / largest if largest > 0.0 else 0.0)
    for k in range(0, num_columns, NUM_LANES):
        place = load(middle, k) + scale * load(path, k + 1) * load(table.across, k)
        store(path, k + 1, minimum(maximum(place, load(table.lower, k)), load(table.upper, k)))


@kernel(borrows=True)
def no_bend(table: object, amplitude: float, kind: int, noise: Floats, path: Floats) -> None:
    """Do nothing: decision vectors of this kind of problem are not paths next to a line."""
