"""The state of CMA-ES in the arrays of `Swarms`.

`Swarms.field` holds first the numbers below, which observations read by their column. The arrays of
`FirstColumns` follow. `Swarms.registers` holds counts.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.jit import kernel
from swarm_gym.problem.tables import Table

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Numbers of a swarm, columns of `Swarms.field`: the step size sigma in ranges of the initial bounds; the
# condition number of the covariance; the length of the step size's evolution path relative to its expected
# length; the product of (1 - c_sigma)^2 since the last restart; best and median fitness of the last
# generation; the squared length of the movement's path, and gamma_c of `movement`.
STEP_SIZE, CONDITION, PATH_LENGTH, DECAY, GENERATION_BEST, GENERATION_MEDIAN, MOVEMENT, FILLED = range(8)
_NUM_NUMBERS = 8  # a whole block of lanes

# Counts of a swarm, columns of `Swarms.registers`: size of the next generation; restarts of this episode;
# generations since the last restart, since the best fitness last improved, and since the square root of the
# covariance was computed; generations in the history of fitness; and the reason for the next restart.
NUM_COUNTS = 7
NEXT_SIZE, RESTARTS, GENERATION, SINCE_BEST, SINCE_ROOT, RECORDED, REASON = range(NUM_COUNTS)
# Reasons.
NO_REASON, STALLED, DEGENERATE = range(3)

# Longest history of fitness, in generations.
LONGEST_HISTORY = 320


class FirstColumns(NamedTuple):
    """The first columns of the arrays in a swarm's `field`, for positions of C columns.

    Matrices have C columns in each row; only the rows and columns below the dimension are in use.
    """

    mean: int  # C columns: mean of the distribution, in the units of positions
    step_path: int  # C columns: evolution path of the step size
    covariance_path: int  # C columns: evolution path of the covariance, in ranges
    covariance: int  # C x C: covariance, in ranges
    root: int  # C x C: symmetric square root of the covariance, as last computed
    inverse: int  # C x C: inverse of this root
    bests: int  # best fitness of the last generations, a ring
    medians: int  # their median fitness, a ring
    mean_movement: int  # C columns: path of the movement of the mean, see `movement`
    movement: int  # C x C: path of the movement of the covariance
    end: int  # number of columns


@kernel(inline="late")
def layout(width: int) -> FirstColumns:
    """Return the first columns for positions of C = `width` columns."""
    mean, square = _NUM_NUMBERS, width * width
    covariance = mean + 3 * width
    bests = covariance + 3 * square
    mean_movement = bests + 2 * LONGEST_HISTORY
    return FirstColumns(
        mean,
        mean + width,
        mean + 2 * width,
        covariance,
        covariance + square,
        covariance + 2 * square,
        bests,
        bests + LONGEST_HISTORY,
        mean_movement,
        mean_movement + width,
        mean_movement + width + square,
    )


@kernel(borrows=True)
def spread_out(state: Floats, registers: Integers, width: int, dimension: int, first_step: float) -> None:
    """Let the distribution be round, with this step size, and forget paths and history."""
    at = layout(width)
    state[STEP_SIZE], state[CONDITION], state[PATH_LENGTH], state[DECAY] = first_step, 1.0, 0.0, 1.0
    state[MOVEMENT] = state[FILLED] = 0.0
    for k in range(at.step_path, at.bests):
        state[k] = 0.0
    for k in range(at.mean_movement, at.end):
        state[k] = 0.0
    for k in range(dimension):
        for first in (at.covariance, at.root, at.inverse):
            state[first + k * width + k] = 1.0
    registers[GENERATION] = registers[SINCE_ROOT] = registers[RECORDED] = 0
    registers[REASON] = NO_REASON


@kernel(borrows=True)
def write_ranges(table: Table, ranges: Floats) -> None:
    """Write the ranges of the initial bounds, (C,); where one is empty, the range of the bounds."""
    for k in range(ranges.shape[0]):
        ranges[k] = table.initial_upper[k] - table.initial_lower[k]
        if not ranges[k] > 0.0:
            ranges[k] = table.upper[k] - table.lower[k]
