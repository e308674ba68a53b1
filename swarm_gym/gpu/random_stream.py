"""The random stream of a swarm on the device: the eight SFC64 of the CPU, number for number.

Source: see `swarm_gym.compiler.random_stream`. Lane k of a warp draws the numbers of stream k modulo 8. Four
lanes share a stream: each of them computes all its numbers and keeps its own, so that nothing is exchanged.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.gpu.warps import BLOCK, kernel

_SHIFT_RIGHT = np.uint64(11)
_SHIFT_LEFT = np.uint64(3)
_ROTATE_LEFT = np.uint64(24)
_ROTATE_RIGHT = np.uint64(40)
_ONE = np.uint64(1)
_UNIT = 2.0**-53


class Stream(NamedTuple):
    """The words of the stream that a lane draws from."""

    a: np.uint64
    b: np.uint64
    c: np.uint64
    counter: np.uint64


@kernel
def load_stream(streams: NDArray[np.uint64], b: int, lane: int) -> Stream:
    """Return the stream of a lane, from the streams of all swarms, (B, 4, 8)."""
    column = lane % BLOCK
    return Stream(streams[b, 0, column], streams[b, 1, column], streams[b, 2, column], streams[b, 3, column])


@kernel
def store_stream(streams: NDArray[np.uint64], b: int, lane: int, stream: Stream) -> None:
    """Write the stream of a lane to where `load_stream` reads it."""
    if lane < BLOCK:
        streams[b, 0, lane] = stream.a
        streams[b, 1, lane] = stream.b
        streams[b, 2, lane] = stream.c
        streams[b, 3, lane] = stream.counter


@kernel
def draw(stream: Stream, lane: int, rounds: int) -> tuple[float, Stream]:
    """Return a number uniform in [0, 1) for this lane, 0 from lane 8 * rounds on, and the stream after it.

    Lane k gets number k of `swarm_gym.compiler.random_stream.fill_uniform` on 8 * rounds numbers.
    """
    a, b, c, counter = stream.a, stream.b, stream.c, stream.counter
    number = 0.0
    for turn in range(rounds):
        word = a + b + counter
        counter = counter + _ONE
        a = b ^ (b >> _SHIFT_RIGHT)
        b = c + (c << _SHIFT_LEFT)
        c = ((c << _ROTATE_LEFT) | (c >> _ROTATE_RIGHT)) + word
        if turn == lane // BLOCK:
            number = float(word >> _SHIFT_RIGHT) * _UNIT
    return number, Stream(a, b, c, counter)
