"""Files of scores, one CSV for each suite; claims about a policy are files of the same form."""

import csv
import io
import math
from collections.abc import Callable, Iterable
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any

from experiments.scoring.score import ScoreRow, digest_of_runs
from swarm_gym.controllers.packaged import read_bytes
from swarm_gym.errors import shown
from swarm_gym.files import write_atomically

SCORES = Path("scores")  # folder of the stored scores, in a checkout
COLUMNS = tuple(field.name for field in fields(ScoreRow))
MAX_FILE = 2**24  # bytes; the largest file of scores has less than 1 MB
MAX_SEED = 10**9


class ScoreFileError(ValueError):
    """A file of scores that cannot be used; the message names the file, the line and the column."""


def scores_file(folder: Path, suite: str) -> Path:
    """Return the path of the scores of a suite."""
    return folder / f"{suite}.csv"


def write_scores(path: Path, scores: Iterable[ScoreRow]) -> Path:
    """Write scores to a CSV file, atomically; numbers are written in full, so that no bit is lost."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([_text(value) for value in astuple(score)] for score in scores)
    return write_atomically(path, text.getvalue())


def read_scores(path: Path) -> list[ScoreRow]:
    """Return the scores of a CSV file.

    Raises:
        ScoreFileError: if the file is missing, lacks a column, or has a value that cannot be.
    """
    try:
        text = read_bytes(path, MAX_FILE).decode()
        rows = list(csv.reader(io.StringIO(text, newline=""), strict=True))
    except (OSError, ValueError, csv.Error) as error:
        raise ScoreFileError(f"{path}: not a readable file of scores ({error})") from error
    head = rows[0] if rows else []
    missing = [name for name in COLUMNS if name not in head]
    if missing:
        raise ScoreFileError(f"{path}: lacks the columns {', '.join(missing)}; expected {', '.join(COLUMNS)}")
    if unknown := [name for name in head if name not in COLUMNS or head.count(name) > 1]:
        raise ScoreFileError(
            f"{path}: unknown or repeated column {shown(unknown[0])}; expected {', '.join(COLUMNS)}"
        )
    if len(rows) == 1:
        raise ScoreFileError(f"{path}: has no row of scores")
    return [_read_row(f"{path}, line {line}", head, row) for line, row in enumerate(rows[1:], 2)]


def _read_row(where: str, head: list[str], row: list[str]) -> ScoreRow:
    if len(row) != len(head):
        raise ScoreFileError(f"{where}: expected {len(head)} values, got {len(row)}")
    texts = dict(zip(head, row, strict=True))
    values: dict[str, Any] = {}
    for name, (expected, read) in _READERS.items():
        try:
            values[name] = read(texts[name])
        except ValueError:
            raise ScoreFileError(f"{where}: {name} must be {expected}, got {shown(texts[name])}") from None
    score = ScoreRow(**values)
    fitness, evaluations = score.fitness_of_runs, score.evaluations_of_runs
    if len(fitness) != len(evaluations):
        raise ScoreFileError(
            f"{where}: fitness_of_runs has {len(fitness)} numbers, evaluations_of_runs has {len(evaluations)}"
        )
    if digest_of_runs(fitness, evaluations) != score.runs_digest:
        raise ScoreFileError(
            f"{where}: runs_digest {score.runs_digest[:12]}... is not the digest of fitness_of_runs and "
            "evaluations_of_runs: one of the three was changed"
        )
    return score


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return " ".join(map(_text, value))
    return repr(value) if isinstance(value, float) else str(value)


def _name(text: str) -> str:
    if not text or not text.isprintable():
        raise ValueError
    return text


def _integer(low: int, high: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        if len(text) > 20 or not text.isascii() or not text.isdigit() or not low <= int(text) <= high:
            raise ValueError
        return int(text)

    return read


def _number(low: float = -math.inf, high: float = math.inf) -> Callable[[str], float]:
    def read(text: str) -> float:
        value = float(text)
        if not math.isfinite(value) or not low <= value <= high:
            raise ValueError
        return value

    return read


def _several(read: Callable[[str], Any]) -> Callable[[str], tuple[Any, ...]]:
    def read_all(text: str) -> tuple[Any, ...]:
        if not text:
            raise ValueError
        return tuple(map(read, text.split(" ")))

    return read_all


def _digest(text: str) -> str:
    if len(text) != 64 or set(text) - set("0123456789abcdef"):
        raise ValueError
    return text


_HEXADECIMAL = "a digest of 64 hexadecimal digits"
_COUNT = 2**62
# By column: what is expected, in words, and a function that reads it or raises ValueError.
_READERS: dict[str, tuple[str, Callable[[str], Any]]] = {
    "controller": ("a name", _name),
    "environment": ("the id of an environment", _name),
    "scenario_set": ("the name of a set of scenarios", _name),
    "first_seed": (f"an integer from 0 to {MAX_SEED}", _integer(0, MAX_SEED)),
    "num_seeds": (f"an integer from 1 to {MAX_SEED}", _integer(1, MAX_SEED)),
    "gap": ("a finite number", _number()),
    "evaluations": ("a number from 0 on", _number(0.0)),
    "feasible": ("a share from 0 to 1", _number(0.0, 1.0)),
    "digest": (_HEXADECIMAL, _digest),
    "runs_digest": (_HEXADECIMAL, _digest),
    "fitness_of_runs": ("finite numbers with a blank between them", _several(_number())),
    "evaluations_of_runs": ("integers with a blank between them", _several(_integer(0, _COUNT))),
}
