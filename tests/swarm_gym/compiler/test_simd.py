"""Compiled SIMD lanes give what their Python forms give."""

import os
import subprocess
import sys
from functools import cache

import numba
import numpy as np
import pytest
from numba.core.errors import TypingError

from helpers.loops import looped
from swarm_gym.compiler.jit import entry
from swarm_gym.compiler.simd import (
    as_float,
    bits,
    broadcast,
    floor,
    load,
    look_up,
    maximum,
    minimum,
    padded,
    read,
    square_root,
    store,
    total,
    where,
)

compiled = cache(entry)

# Each takes three arrays of eight and returns a list of results that are arrays of eight.


def arithmetic(a, b, c):
    x, y, z = load(a, 0), load(b, 0), load(c, 0)
    out = np.empty((9, 8))
    store(out, 0, x + y)
    store(out, 1, x - y)
    store(out, 2, x * y)
    store(out, 3, x / y)
    store(out, 4, 2.0 - x)
    store(out, 5, x * 3.0 + 0.5)
    store(out, 6, x + y * z)
    store(out, 7, 1.0 / (y * y))
    store(out, 8, square_root(x * x + 1.0))
    return out


def selections(a, b, c):
    x, y, z = load(a, 0), load(b, 0), load(c, 0)
    out = np.empty((8, 8))
    store(out, 0, maximum(x, y))
    store(out, 1, minimum(x, y))
    store(out, 2, where((x > y) & (y < z), x, z))
    store(out, 3, where((x >= y) | (y <= z), x, z))
    store(out, 4, where(x > 0.0, x, broadcast(-1.0)))
    store(out, 5, maximum(x, broadcast(0.25)))
    store(out, 6, where(x > 0.0, y, z))
    store(out, 7, broadcast(total(x)))
    return out


def roundings(a, b, c):
    x, y, z = load(a, 0), load(b, 0), load(c, 0)
    out = np.empty((4, 8))
    store(out, 0, floor(x))
    store(out, 1, floor(y * 10.0 + 0.5))
    store(out, 2, floor(floor(z)))
    store(out, 3, floor(x + y) - floor(x))
    return out


def numbers(a, b, c):
    """Return the results of the functions on single numbers, and masks as bits."""
    out = np.empty((5, 8))
    for k in range(8):
        out[0, k] = maximum(a[k], b[k])
        out[1, k] = minimum(a[k], b[k])
        out[2, k] = where((a[k] > b[k]) & (b[k] < c[k]), a[k], c[k])
        out[3, k] = bits(load(a, 0) > load(b, 0))
        out[4, k] = floor(c[k])
    return out


def places(a, b, c):
    long, rows = np.zeros(24), np.zeros((3, 8))
    long[5:13], rows[1] = a, b
    store(rows, 2, load(long, 5) + load(long, 6))
    store(long, 9, read(rows, 1, None))
    store(rows, 0, broadcast(read(rows, 1, 3)) + c[0])
    return np.concatenate((long.reshape(3, 8), rows))


def mixed(a, b, c):
    """Numbers beside lanes."""
    x, out = load(a, 0), np.empty((4, 8))
    store(out, 0, maximum(x, 0.5))
    store(out, 1, minimum(0, x))
    store(out, 2, where(x > b[0], 1, x))
    store(out, 3, broadcast(maximum(a[0], 2) + where(a[1] > 0.0, 1, 2.5)))
    return out


FUNCTIONS = (arithmetic, selections, roundings, numbers, places, mixed)
AWKWARD = np.array([0.0, -0.0, 1e-310, 1e308, -1e308, np.inf, -np.inf, np.nan])


def inputs(seed):
    rng = np.random.default_rng(seed)
    drawn = rng.normal(size=(3, 8))
    return {0: drawn, 1: np.round(drawn), 2: rng.choice(AWKWARD, (3, 8))}[seed % 3]


@looped("seed", range(30))
@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_compiled_lanes_give_the_bits_of_the_python_ones(function, seed):
    arrays = inputs(seed)
    np.testing.assert_array_equal(compiled(function)(*arrays), function(*arrays))


def words(a, b):
    x, y = load(a, 0), load(b, 0)
    five = np.uint64(5)
    out = np.empty((7, 8), dtype=np.uint64)
    store(out, 0, x + y)
    store(out, 1, x - y)
    store(out, 2, x * y)
    store(out, 3, (x ^ y) & (x | y))
    store(out, 4, (x << five) | (x >> five))
    store(out, 5, where(x > y, x, y))
    store(out, 6, x + five)
    return out, bits(x < y)


def floats_of_words(a):
    out = np.empty((1, 8))
    store(out, 0, as_float(load(a, 0) >> np.uint64(1)))
    return out


@looped("seed", range(20))
def test_compiled_words_wrap_as_those_of_numpy(seed):
    a, b = np.random.default_rng(seed).integers(0, 2**64, (2, 8), dtype=np.uint64)
    found, mask = compiled(words)(a, b)
    expected, expected_mask = words(a, b)
    assert found.tolist() == expected.tolist()
    assert mask == expected_mask == sum(1 << k for k in range(8) if a[k] < b[k])
    assert compiled(floats_of_words)(a).tolist() == floats_of_words(a).tolist()


def entries(values, a):
    out = np.empty((1, 8))
    store(out, 0, look_up(values, load(a, 0)) * 2.0)
    return out


@pytest.mark.parametrize("seed", range(5))
def test_entries_are_looked_up_lane_by_lane(seed):
    rng = np.random.default_rng(seed)
    values, indices = rng.integers(0, 256, 99, dtype=np.uint8), rng.integers(0, 99, 8).astype(np.float64)
    indices[:2] = 98.0, 0.0
    expected = [[2.0 * values[int(index)] for index in indices]]
    assert compiled(entries)(values, indices).tolist() == entries(values, indices).tolist() == expected


def test_the_floor_of_numbers_is_the_one_known_by_hand():
    given = np.array([0.5, -0.5, 1.0, -1.0, -0.0, 1e300, np.nextafter(1.0, 0.0), -1e-300])
    expected = [0.0, -1.0, 1.0, -1.0, -0.0, 1e300, 0.0, -1.0]
    assert compiled(roundings)(given, given, given)[0].tolist() == expected
    assert floor(given).tolist() == expected


FLOATS, WORDS = np.arange(8.0), np.arange(8, dtype=np.uint64)
BYTES = np.arange(16, dtype=np.uint8)
READ_ONLY = np.arange(8.0)
READ_ONLY.flags.writeable = False


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        pytest.param(lambda a: total(load(a, 0)), (np.ones(8, dtype=np.float32),), id="float32"),
        pytest.param(lambda a: bits(load(a, 0)), (np.ones(8, dtype=np.bool_),), id="bool"),
        pytest.param(lambda a: total(load(a, 0)), (np.ones(16)[::2],), id="strided"),
        pytest.param(lambda a: total(read(a, 1, None)), (np.ones((8, 8)).T,), id="transposed rows"),
        pytest.param(lambda a, b: store(a, 0, load(b, 0)), (FLOATS, WORDS), id="words into floats"),
        pytest.param(lambda a: store(a, 0, load(a, 0)), (READ_ONLY,), id="read-only"),
        pytest.param(lambda a: where(True, a, a), (FLOATS,), id="where of arrays"),
        pytest.param(lambda a: maximum(a, a), (FLOATS,), id="maximum of arrays"),
        pytest.param(lambda a: as_float(load(a, 0) * 0.5), (WORDS,), id="words and a float"),
        pytest.param(lambda a: as_float(load(a, 0) / np.uint64(2)), (WORDS,), id="division of words"),
        pytest.param(lambda a: bits((load(a, 0) > 1.0) + (load(a, 0) > 2.0)), (FLOATS,), id="sum of masks"),
        pytest.param(lambda a: as_float(floor(load(a, 0))), (WORDS,), id="floor of words"),
        pytest.param(lambda a: total(look_up(a, load(a, 0))), (FLOATS,), id="look-up in floats"),
        pytest.param(lambda a, b: total(look_up(a, load(b, 0))), (BYTES, WORDS), id="look-up at words"),
        pytest.param(lambda a, b: total(look_up(a, load(b, 0))), (BYTES[::2], FLOATS), id="strided look-up"),
        pytest.param(lambda a, b: total(look_up(a, b)), (BYTES, FLOATS), id="look-up at an array"),
    ],
)
@pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="NUMBA_DISABLE_JIT=1 turns off the compiler"
)
def test_what_would_read_or_mean_something_else_does_not_compile(function, arguments):
    assert numba.njit(lambda a: total(maximum(load(a, 0), load(a, 0) * 0.5)))(FLOATS) == 28.0
    with pytest.raises(TypingError):
        numba.njit(function)(*arguments)


def test_a_total_adds_by_halves():
    values = np.array([1e16, 1.0, -1e16, 1.0, 3.0, 1e-3, 7.0, -1.0])
    v = values.tolist()
    expected = ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]))
    assert total(values) == expected
    assert selections(values, values, values)[7, 0] == expected


def test_loaded_lanes_are_a_copy():
    array = np.zeros(8)
    lanes = load(array, 0)
    array[:] = 1.0
    assert lanes.tolist() == [0.0] * 8


@pytest.mark.parametrize(("length", "expected"), [(1, 8), (8, 8), (9, 16), (32, 32)])
def test_padding_is_to_whole_blocks(length, expected):
    assert padded(length) == expected


OUTSIDE = """
import numba
import numpy as np
from swarm_gym.compiler.simd import load, look_up, store, total

@numba.njit
def reach(array, index, write):
    if write:
        store(array, index, load(array, 0))
    return total(load(array, index))

for shape, last in (((12,), 4), ((3, 8), 2), ((3, 4), -1)):
    for write in (False, True):
        if last >= 0:
            reach(np.ones(shape), last, write)
        try:
            reach(np.ones(shape), last + 1, write)
        except IndexError as error:
            print(error)

@numba.njit
def find(values, places):
    return total(look_up(values, load(places, 0)))

values = np.arange(8, dtype=np.uint8)
assert find(values, np.arange(8.0)) == 28.0
for place in (8.0, -9.0):
    try:
        find(values, np.append(np.arange(7.0), place))
    except IndexError as error:
        print(error)
"""


@pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="NUMBA_DISABLE_JIT=1 turns off the compiler"
)
def test_with_bounds_checks_on_no_lane_is_beyond_an_array():
    found = subprocess.run(
        [sys.executable, "-c", OUTSIDE],
        env={**os.environ, "NUMBA_BOUNDSCHECK": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert found.stdout.splitlines() == ["index is out of bounds"] * 8, found.stderr
