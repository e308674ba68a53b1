"""Maps and problems of the Moving AI benchmarks: the scenarios `moving-ai:<map>...`.

Source: N. R. Sturtevant, "Benchmarks for grid-based pathfinding", IEEE Transactions on Computational
Intelligence and AI in Games 4(2):144-148, 2012, doi 10.1109/TCIAIG.2012.2197681.

Map coordinates are as in the benchmark: cells have side 1 and their centres at integers, x grows to the
right from 0, and y grows downwards from 0. Swamp counts as free and water as blocked. On maps with swamp or
water, the lengths in the problem files may therefore differ from the shortest paths'.
"""

import itertools
import os
import re
import warnings
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.family import NUMBER, Family, parse_numbers, spaceless_beside_path
from swarm_gym.scenarios.formats.data_files import find_data_file, open_file, stamp_of
from swarm_gym.scenarios.graded_map import GradedMap, Grading, terrain_map
from swarm_gym.scenarios.grid_map import MAX_SIDE, Cell, GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario

NAME = "moving-ai"
USAGE = f"{NAME}:<map>#<problem> or {NAME}:<map>?start=<x>,<y>&goal=<x>,<y>"

PASSABLE = b".GS"
BLOCKED = b"@OTW"
MAX_PROBLEMS = 100_000
MAX_PROBLEM_FILE = 2**24  # bytes, more than MAX_PROBLEMS problems need

_HEADER_LINES = 4
_LONGEST_LINE = 1024
_BLANK_END = 64  # maximum number of bytes of white space after the last row

# Meaning of each byte of a cell: 0 free, 1 blocked, 2 neither.
_MEANING = np.full(256, 2, dtype=np.uint8)
_MEANING[list(PASSABLE)] = 0
_MEANING[list(BLOCKED)] = 1


class BenchmarkProblem(NamedTuple):
    """A line of a `.scen` file.

    Attributes:
        bucket: group of problems of similar length.
        map: name of the map, as the file has it.
        width: number of columns of the map.
        height: number of rows of the map.
        start: cell (x, y) of the start.
        goal: cell (x, y) of the goal.
        length: length of the shortest path, in sides of a cell.
    """

    bucket: int
    map: str
    width: int
    height: int
    start: Cell
    goal: Cell
    length: float


def read_map(path: str | Path) -> GridMap:
    """Read the map in a `.map` file; its lines may end with CR LF.

    Raises:
        ScenarioError: if the file cannot be read or is malformed; the message names file, line and reason.
    """
    path = Path(path)
    return GridMap(path.stem, _MEANING[_read_letters(path)] == 1)


def read_graded_map(path: str | Path, grading: Grading) -> GradedMap:
    """Read the map in a `.map` file with costs of ground by its letters.

    Raises:
        ScenarioError: if the file cannot be read or is malformed; the message names file, line and reason.
        SettingError: for a letter that maps do not have, or a cost that is negative or no number.
    """
    path = Path(path)
    letters = _read_letters(path)
    return terrain_map(GridMap(path.stem, _MEANING[letters] == 1), letters, PASSABLE + BLOCKED, grading)


def read_scenarios(path: str | Path) -> list[BenchmarkProblem]:
    """Read the problems in a `.scen` file; blank lines are skipped.

    Raises:
        ScenarioError: if the file cannot be read or is malformed; the message names file, line and reason.
    """
    return [problem for _, problem in _read_numbered(Path(path))]


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single problems that a name stands for; `...#0-799` stands for 800 problems.

    The first problem of a file is number 0. Problems of a range that begin or end in a blocked cell are left
    out, with one warning. Files are read for ranges only.

    Raises:
        ScenarioError: if the name has another form, or all problems of a range begin or end in blocked cells.
    """
    given, problems, cells = _parse(name)
    if cells:
        return (name,)
    blocked = _problems_in_blocked_cells(given) if len(problems) > 1 else frozenset()
    kept = [number for number in problems if number not in blocked]
    if not kept:
        raise ScenarioError(f"scenario {shown(name)}: all of its problems begin or end in a blocked cell")
    if len(kept) < len(problems):
        left_out = f"{len(problems) - len(kept)} of {len(problems)} problems"
        warnings.warn(
            f"scenario {shown(name)}: {left_out} begin or end in a blocked cell; they are left out",
            stacklevel=2,
        )
    return tuple(f"{NAME}:{given}#{number}" for number in kept)


def tidy(name: str) -> str:
    """Return the name without spaces between its parts, and without `.map` in the data folder.

    Raises:
        ScenarioError: if the name has another form.
    """
    name = spaceless_beside_path(name)
    given, *_ = _parse(name)
    short = given if Path(given).is_absolute() else given.removesuffix(".map")
    return name.replace(f":{given}", f":{short}", 1)


def make(name: str) -> GridScenario:
    """Return the single problem of that name.

    The map is the file `<map>.map` in the data folder, or an absolute path that ends with `.map`. Problems
    are read from `<map>.map.scen` or `<map>.scen`.

    Raises:
        ScenarioError: if a file is missing or malformed, or there is no such problem, or it has no solution.
    """
    given, problems, cells = _parse(name)
    grid = _map_of(given)
    if cells:
        return GridScenario(name, grid, *cells)
    path = _problem_file_of(given)
    listed = _cached_problems(path, stamp_of(path))
    if problems[0] >= len(listed):
        raise ScenarioError(f"scenario {shown(name)}: {path} has only the problems 0 to {len(listed) - 1}")
    line, problem = listed[problems[0]]
    if (problem.width, problem.height) != (grid.width, grid.height):
        raise _malformed(
            path,
            line,
            f"expected a map of {grid.width} x {grid.height} cells, as the map file has it, "
            f"got {problem.width} x {problem.height}",
        )
    try:
        return GridScenario(name, grid, problem.start, problem.goal)
    except ScenarioError as error:
        raise ScenarioError(f"{path}, line {line}: {error}") from error


def cached_map(path: Path) -> GridMap:
    """Return the map of a file, which is read again only if the file has changed."""
    return _cached_map(path, stamp_of(path))


FAMILY = Family(USAGE, (), expand, make, tidy)


def _map_of(given: str) -> GridMap:
    return cached_map(find_data_file(f"{given.removesuffix('.map')}.map"))


def _problem_file_of(given: str) -> Path:
    stem = given.removesuffix(".map")
    return find_data_file(f"{stem}.map.scen", f"{stem}.scen")


def _problems_in_blocked_cells(given: str) -> frozenset[int]:
    """Return the numbers of problems of a map that begin or end in a blocked cell; none without the files."""
    try:
        grid, path = _map_of(given), _problem_file_of(given)
    except ScenarioError:
        return frozenset()  # whoever makes the scenario is told what is missing
    listed = _cached_problems(path, stamp_of(path))
    return frozenset(
        number
        for number, (_, problem) in enumerate(listed)
        if (problem.width, problem.height) == (grid.width, grid.height)
        and not (grid.is_free(problem.start) and grid.is_free(problem.goal))
    )


@lru_cache(maxsize=8)
def _cached_map(path: Path, _stamp: tuple[int, int]) -> GridMap:
    return read_map(path)


@lru_cache(maxsize=8)
def _cached_problems(path: Path, _stamp: tuple[int, int]) -> list[tuple[int, BenchmarkProblem]]:
    return _read_numbered(path)


def _parse(name: str) -> tuple[str, range, tuple[Cell, Cell] | None]:
    """Return the map, the numbers of problems and, instead of numbers, the cells of start and goal."""
    cell = rf"({NUMBER}),({NUMBER})"
    if match := re.fullmatch(rf"{NAME}:(.+)\?start={cell}&goal={cell}", name):
        x, y, goal_x, goal_y = map(int, match.groups()[1:])
        cells, problems = ((x, y), (goal_x, goal_y)), range(0)
    else:
        match = re.fullmatch(rf"{NAME}:(.+)#([^#]*)", name)
        cells, problems = None, parse_numbers(match[2], name) if match else range(0)
    if not match or not (cells or (problems and problems[-1] < MAX_PROBLEMS)):
        raise ScenarioError(
            f"scenario {shown(name)}: expected {USAGE}, with integers, where <problem> is a number from 0 to "
            f"{MAX_PROBLEMS - 1} or a range of them such as 0-799"
        )
    if Path(match[1]).is_absolute() and not match[1].endswith(".map"):
        raise ScenarioError(
            f"scenario {shown(name)}: an absolute path to a map must end with .map, got {shown(match[1])}"
        )
    return match[1], problems, cells


def _malformed(path: Path, line: int, reason: str) -> ScenarioError:
    return ScenarioError(f"{path}, line {line}: {reason}")


def _read_letters(path: Path) -> NDArray[np.uint8]:
    """Return the letters of the cells of a `.map` file, (height, width)."""
    try:
        with open_file(path) as file:
            width, height = _read_header(path, file)
            rows = _read_rows(path, file, width, height)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    letters = np.frombuffer(rows, dtype=np.uint8).reshape(height, width)
    meaning = _MEANING[letters]
    if (meaning == 2).any():
        row, column = np.argwhere(meaning == 2)[0].tolist()
        character = rows[row * width + column : row * width + column + 1]
        raise _malformed(
            path,
            row + _HEADER_LINES + 1,
            f"expected one of {PASSABLE.decode()} (passable) or {BLOCKED.decode()} (blocked) in column "
            f"{column + 1}, got {character!r}",
        )
    return letters


def _read_header(path: Path, file: BinaryIO) -> tuple[int, int]:
    """Return width and height."""
    patterns = (rb"type\s+octile", rb"height\s+([1-9][0-9]{0,8})", rb"width\s+([1-9][0-9]{0,8})", b"map")
    expected = ("'type octile'", "'height' and a positive number", "'width' and a positive number", "'map'")
    sizes = []
    for line, (pattern, wanted) in enumerate(zip(patterns, expected, strict=True), start=1):
        text = file.readline(_LONGEST_LINE).rstrip(b" \t\r\n")
        match = re.fullmatch(pattern, text)
        if not match:
            raise _malformed(path, line, f"expected {wanted}, got {_shown(text)}")
        if match.re.groups:
            sizes.append(int(match[1]))
            if sizes[-1] > MAX_SIDE:
                raise _malformed(
                    path, line, f"expected at most {MAX_SIDE} cells along a side, got {sizes[-1]}"
                )
    height, width = sizes
    return width, height


def _read_rows(path: Path, file: BinaryIO, width: int, height: int) -> bytes:
    """Return the cells, row by row; never read more of the file than the header announces."""
    rows: list[bytes] = []
    for line in range(_HEADER_LINES + 1, _HEADER_LINES + 1 + height):
        text = file.readline(width + len(b"\r\n"))
        row = text.removesuffix(b"\n").removesuffix(b"\r")
        if not text:
            raise _malformed(path, line, f"expected {height} rows, but the file ends after {len(rows)}")
        if len(row) != width:
            got = f"{len(row)}" if len(row) < width else "more"
            raise _malformed(path, line, f"expected a row of {width} cells, got {got}")
        rows.append(row)
    end = file.read(_BLANK_END + 1)
    if end.strip() or len(end) > _BLANK_END:
        raise _malformed(
            path, _HEADER_LINES + 1 + height, f"expected the file to end after {height} rows, but it goes on"
        )
    return b"".join(rows)


def _read_numbered(path: Path) -> list[tuple[int, BenchmarkProblem]]:
    """Return the problems, each with its line in the file."""
    try:
        with open_file(path) as file:
            size = os.fstat(file.fileno()).st_size
            if size > MAX_PROBLEM_FILE:
                raise ScenarioError(f"{path}: expected at most {MAX_PROBLEM_FILE} bytes, got {size}")
            numbered = list(_problems(path, file))
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from error
    if not numbered:
        raise ScenarioError(f"{path}: expected at least one problem after line 1, got none")
    return numbered


def _problems(path: Path, file: BinaryIO) -> Iterator[tuple[int, BenchmarkProblem]]:
    """Yield the problems, each with its line; memory holds one line at a time."""
    first = file.readline(_LONGEST_LINE)
    if not re.fullmatch(rb"version\s+1(\.0)?\s*", first):
        raise _malformed(path, 1, f"expected 'version 1', got {_shown(first)}")
    found = 0
    for line in itertools.count(2):
        text = file.readline(_LONGEST_LINE)
        if not text:
            return
        text = text.removesuffix(b"\n")
        if found == MAX_PROBLEMS or line > 2 * MAX_PROBLEMS:
            raise _malformed(path, line, f"expected at most {MAX_PROBLEMS} problems, and as many blank lines")
        if text.strip():
            found += 1
            yield line, _parse_problem(path, line, text)


def _parse_problem(path: Path, line: int, text: bytes) -> BenchmarkProblem:
    # If tabs separate the fields, names of maps may have spaces.
    fields = [field.strip() for field in (text.split(b"\t") if b"\t" in text else text.split())]
    if len(fields) != 9:
        raise _malformed(path, line, f"expected 9 fields, got {len(fields)} in {_shown(text)}")
    if not text.isascii():
        raise _malformed(path, line, f"expected ASCII, got {_shown(text)}")
    integers = []
    for field in (fields[0], *fields[2:8]):
        if not re.fullmatch(NUMBER, field.decode()):
            raise _malformed(path, line, f"expected an integer, got {_shown(field)}")
        integers.append(int(field))
    if not re.fullmatch(rb"[0-9]{1,15}(\.[0-9]{0,30})?(e[+-]?[0-9]{1,2})?", fields[8]):
        raise _malformed(path, line, f"expected a length, got {_shown(fields[8])}")
    bucket, width, height, x, y, goal_x, goal_y = integers
    if not (0 < width <= MAX_SIDE and 0 < height <= MAX_SIDE):
        raise _malformed(
            path, line, f"expected a map of 1 to {MAX_SIDE} cells a side, got {width} x {height}"
        )
    for cell in ((x, y), (goal_x, goal_y)):
        if not (cell[0] < width and cell[1] < height):
            raise _malformed(path, line, f"expected a cell on the map of {width} x {height}, got {cell}")
    name, length = fields[1].decode(), float(fields[8])
    return BenchmarkProblem(bucket, name, width, height, (x, y), (goal_x, goal_y), length)


def _shown(text: bytes) -> str:
    return repr(text[:60])[1:] + ("..." if len(text) > 60 else "")
