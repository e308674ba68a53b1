"""Optimal controls of the (1 + (lambda, lambda)) genetic algorithm that ship with the package.

`python -m swarm_gym.reference.onemax.optima --ship` computes them again, which takes about two hours. Each is
optimal among named choices, from n / 2 ones on, where runs begin.
"""

import argparse
import json
import math
from functools import cache
from importlib import resources
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import look_up
from swarm_gym.errors import ScenarioError
from swarm_gym.files import write_atomically
from swarm_gym.reference.onemax.runtimes import Choices, LambdaDecisions, optimal_control
from swarm_gym.scenarios import OneMaxScenario

FILE = "optima.json"

PORTFOLIO = tuple(2**k for k in range(7))
PUBLISHED_RATES = (0.25, 0.542, 0.833, 1.125, 1.417, 1.708, 2.0)

# Choices by name. The published ones are those of Nguyen et al. 2025, see `one_plus_lambda_lambda`.
CHOICES = {
    "onemax": Choices(tuple(range(1, 65))),
    "onemax-portfolio": Choices(PORTFOLIO),
    "onemax-four-published": Choices(PORTFOLIO, PORTFOLIO, PUBLISHED_RATES, PUBLISHED_RATES),
    "onemax-four": Choices(
        (1, 2, 3, 4, 6, 8, 12, 16),
        (1, 2, 4, 8, 16, 32, 64, 128, 256),
        (0.001, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 4.0, 16.0),
        (0.5, 0.75, 1.0, 1.25, 1.5, 2.0),
    ),
}
# Costs of children that equal parent or mutant: none, as published, or one evaluation each.
COUNTINGS = ("copies-free", "all")

_SHORT = (50, 100, 150, 200, 300)
_LONG = (5000, 10_000, 20_000, 40_000)
# Lengths whose optima ship, by choices and counting; what takes hours is left out.
SHIPPED: dict[tuple[str, str], tuple[int, ...]] = {
    ("onemax", "copies-free"): (*_SHORT, 400, 500, 1000, 1500, 2000),
    ("onemax", "all"): (*_SHORT, 500),
    ("onemax-portfolio", "copies-free"): (*_SHORT, *_LONG, 400, 500, 1000, 1500, 2000),
    ("onemax-portfolio", "all"): (*_SHORT, 400, 500, 1000, 1500, 2000),
    ("onemax-four-published", "copies-free"): (*_SHORT, 400, 500),
    ("onemax-four-published", "all"): _SHORT,
    ("onemax-four", "copies-free"): (*_SHORT, 400, 500),
    ("onemax-four", "all"): (50, 100, 200),
}


class Optimum(NamedTuple):
    """An optimal control.

    Attributes:
        evaluations: expected evaluations of a run from n / 2 ones, the first one included.
        decisions: decisions of the control; below n / 2 ones, those at n / 2.
    """

    evaluations: float
    decisions: LambdaDecisions


def compute(size: int, choices: str, counting: str = "copies-free") -> Optimum:
    """Return the optimal control among choices of this name; minutes for long strings.

    Args:
        size: n, the length of the string.
        choices: a name in `CHOICES`.
        counting: a name in `COUNTINGS`.

    Raises:
        UnknownNameError: if there are no such choices, or no such counting.
    """
    look_up("counting", counting, dict.fromkeys(COUNTINGS))
    start = size // 2
    later, found = optimal_control(
        size,
        look_up("choices", choices, CHOICES),
        start,
        counting == COUNTINGS[0],
        size / 2.0,  # a mutant with more flips comes near the complement, which is no way to gain
    )
    columns = (found.mutants, found.children, found.strength, found.bias)
    for column in columns:
        column[:start] = column[start]
    return Optimum(float(later[start]) + 1.0, LambdaDecisions(*columns))


def packaged(size: int, choices: str, counting: str = "copies-free") -> Optimum:
    """Return an optimal control that ships with the package; arguments as of `compute`.

    Raises:
        ScenarioError: if none ships for this length.
    """
    found = _packaged().get((choices, counting, size))
    if found is None:
        sizes = sorted(n for one, other, n in _packaged() if (one, other) == (choices, counting))
        raise ScenarioError(
            f"optimal:{choices} with counting {counting!r}: optima ship for n = "
            f"{', '.join(map(str, sizes)) or 'no length'}, got n = {size}; "
            "swarm_gym.reference.onemax.optima.compute computes others"
        )
    return found


def least_evaluations(scenario: OneMaxScenario, counting: str) -> float:
    """Return the expected evaluations of the optimal control of lambda up to 64; NaN where none ships.

    Optima ship for runs that begin with half of the ones.

    Args:
        scenario: length and start of a run.
        counting: a name in `COUNTINGS`.
    """
    if scenario.start != scenario.size // 2 or not is_packaged(scenario.size, "onemax", counting):
        return math.nan
    return packaged(scenario.size, "onemax", counting).evaluations


def is_packaged(size: int, choices: str, counting: str = "copies-free") -> bool:
    """Return whether an optimal control for this length ships with the package."""
    return (choices, counting, size) in _packaged()


@cache
def _packaged() -> dict[tuple[str, str, int], Optimum]:
    text = resources.files("swarm_gym.reference.onemax").joinpath(FILE).read_text(encoding="utf-8")
    found = {}
    for entry in json.loads(text):
        columns = [_repeated(runs) for runs in entry["decisions"]]
        mutants, children = (column.astype(np.int64) for column in columns[:2])
        decisions = LambdaDecisions(mutants, children, columns[2], columns[3])
        key = entry["choices"], entry["counting"], entry["size"]
        found[key] = Optimum(entry["evaluations"], decisions)
    return found


def _repeated(runs: list[tuple[float, int]]) -> NDArray[np.float64]:
    """Return each value as often as it says."""
    values, counts = zip(*runs, strict=True)
    return np.repeat(np.array(values, dtype=np.float64), counts)


def _entry(size: int, choices: str, counting: str) -> dict[str, object]:
    """Return an optimum as JSON: decisions as runs of [value, how many numbers of ones have it]."""
    optimum = compute(size, choices, counting)
    decisions = optimum.decisions
    columns = (decisions.mutants, decisions.children, decisions.strength, decisions.bias)
    runs = [[[value, len(list(same))] for value, same in groupby(column.tolist())] for column in columns]
    return {
        "choices": choices,
        "counting": counting,
        "size": size,
        "evaluations": round(optimum.evaluations, 6),
        "decisions": runs,
    }


def main() -> None:
    """Compute the optima that ship, and write them, one line for each."""
    parser = argparse.ArgumentParser(
        prog="python -m swarm_gym.reference.onemax.optima",
        description="Compute the optimal controls of the (1 + (lambda, lambda)) genetic algorithm on OneMax.",
    )
    parser.add_argument("--ship", action="store_true", required=True, help="write the file of the package")
    parser.parse_args()
    file = Path(__file__).with_name(FILE)
    entries = []
    for size in sorted({size for sizes in SHIPPED.values() for size in sizes}):
        for (choices, counting), sizes in SHIPPED.items():
            if size in sizes:
                entries.append(json.dumps(_entry(size, choices, counting), separators=(",", ":")))
                print(f"n = {size}, {choices}, {counting}", flush=True)
    write_atomically(file, "[\n" + ",\n".join(entries) + "\n]\n")


if __name__ == "__main__":
    main()
