"""Costs of runs of other libraries, in a file of the study: these runs take many hours.

`measured_costs` takes runs from this file before it makes any. `keep` adds stored runs to it. To make runs
anew, delete their lines, and their files in the folder of runs. On another processor, new runs of cmaes and
niapy may differ from kept ones, since NumPy has other code there. Last digits of heights differ, too. So a
line tells its problem by the costs of some flights, which are compared with a tolerance.
"""

import csv
import io
import json
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from experiments.studies.terrain.rows import Setting
from swarm_gym.files import write_atomically
from swarm_gym.problem import Problem
from swarm_gym.scenarios import make_scenario
from swarm_gym.worlds import make_problem

FILE = Path(__file__).parent / "data" / "library_runs.csv"
LEAST_EVALUATIONS = 20_000  # runs of fewer are made again in an hour or two
NUM_FLIGHTS = 5
TOLERANCE = 1e-9  # relative, of the costs of flights


class KeptRuns(NamedTuple):
    """Runs of a library on a terrain, one for each test seed from the first on.

    Attributes:
        flights: costs of the flights of `flights_of` in the problem; runs of another problem are not used.
        commit: commit of this project that made the last of them; its `constraints.txt` and `Makefile`
            have the versions of the libraries.
        costs: costs of their best flights.
    """

    flights: list[float]
    commit: str
    costs: list[float]

    def is_for(self, flights: list[float]) -> bool:
        """Return whether these runs are of a problem in which the flights have these costs."""
        return np.allclose(self.flights, flights, rtol=TOLERANCE, atol=0.0)


COLUMNS = (*Setting._fields, *KeptRuns._fields)


def all_kept_runs(file: Path = FILE) -> dict[Setting, KeptRuns]:
    """Return all kept runs by their settings.

    Args:
        file: file of the runs; one that is missing has none.
    """
    if not file.is_file():
        return {}
    found = {}
    with file.open(encoding="utf-8", newline="") as lines:
        for line in csv.DictReader(lines):
            setting = Setting(line["row"], line["cost"], int(line["evaluations"]), line["terrain"])
            flights, costs = ([float(cost) for cost in line[name].split()] for name in ("flights", "costs"))
            found[setting] = KeptRuns(flights, line["commit"], costs)
    return found


def flights_of(problem: Problem) -> list[float]:
    """Return costs of flights, drawn around the middle of the bounds, by which a problem is known."""
    lower, upper = problem.bounds
    shares = 0.4 + 0.2 * np.random.default_rng(0).random((NUM_FLIGHTS, problem.dimension))
    return [problem.evaluate(lower + one * (upper - lower))[0] for one in shares]


def kept_runs(setting: Setting, problem: Problem, file: Path = FILE) -> KeptRuns | None:
    """Return the kept runs of a setting, or None where there are none of this problem.

    Args:
        setting: row, cost, budget and terrain.
        problem: the problem.
        file: file of the runs; one that is missing has none.
    """
    kept = all_kept_runs(file).get(setting)
    return kept if kept is not None and kept.is_for(flights_of(problem)) else None


def keep(files: Iterable[Path], rows: Iterable[str], file: Path = FILE) -> int:
    """Add stored runs to the file, and return the number of settings that changed.

    Runs of fewer evaluations than `LEAST_EVALUATIONS` are passed over. Stored runs replace kept ones if they
    are more, or if the problem has changed.

    Args:
        files: files that `measured_costs` has written or read, of the problems as they are.
        rows: names of the rows of libraries.
        file: file of the runs.
    """
    kept, changed = all_kept_runs(file), set()
    wanted = set(rows)
    for one in sorted(files):
        stored = json.loads(one.read_text(encoding="utf-8"))
        if stored["row"] not in wanted or stored["evaluations"] < LEAST_EVALUATIONS:
            continue
        setting = Setting(*(stored[field] for field in Setting._fields))
        encoding = stored["flight"]["encoding"]
        problem = make_problem(make_scenario(setting.terrain), encoding=encoding, cost=setting.cost)
        found = KeptRuns(flights_of(problem), stored["provenance"]["commit"], stored["costs"])
        before = kept.get(setting)
        if before is None or not before.is_for(found.flights) or len(before.costs) < len(found.costs):
            kept[setting] = found
            changed.add(setting)
    if changed:
        write_atomically(file, _table(kept))
    return len(changed)


def _table(kept: dict[Setting, KeptRuns]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for setting, runs in sorted(kept.items()):
        flights, costs = (" ".join(map(repr, one)) for one in (runs.flights, runs.costs))
        writer.writerow([*setting, flights, runs.commit, costs])
    return text.getvalue()
