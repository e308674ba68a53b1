"""CMA-ES and L-SHADE beside those of other libraries on the 24 functions of BBOB, at equal evaluations."""

from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import numpy as np
from tqdm import tqdm

from experiments.studies.libraries import installed, run_peer
from experiments.studies.strong.entrants import EARLY_RESTARTS, Entrant, entrants
from experiments.studies.strong.grounds import INSTANCES, NUM_FUNCTIONS, Ground
from experiments.studies.strong.measured_gaps import Floats, file_name, kept, timed_runs
from experiments.studies.strong.tables_of_gaps import mean
from experiments.tables import Table
from experiments.tables.cell import number
from experiments.tables.table import Row
from swarm_gym.reward import LEAST_GAP
from swarm_gym.runs.seeds import TEST
from swarm_gym.worlds import make_problem

# Rows of this package, in ten dimensions.
OURS = ("CMA-ES, lambda 10", "CMA-ES, BIPOP", EARLY_RESTARTS, "L-SHADE, linear", "L-SHADE, constant tuned")
PEERS = {
    "pycma CMA-ES, BIPOP": "cma",
    "cmaes CMA-ES": "cmaes",
    "pymoo CMA-ES, restarts": "pymoo",
    "pymoo DE": "pymoo",
    "niapy jDE": "niapy",
    "niapy L-SHADE": "niapy",
    "mealpy L-SHADE": "mealpy",
}
SIDE_BY_SIDE = 32  # runs of a row of this package whose speed is measured


class Timed(NamedTuple):
    """Runs of a row.

    Attributes:
        final: (scenarios, runs) gaps after all evaluations.
        speed: (scenarios,) evaluations in a second of processor time.
    """

    final: Floats
    speed: Floats


def run_all(ground: Ground, num_runs: int, folder: Path) -> dict[str, Timed]:
    """Return the runs of all rows; what is in the folder is not run again.

    Args:
        ground: the functions of BBOB in ten dimensions, and the budget.
        num_runs: number of runs of each row on a scenario.
        folder: folder of the files, one for each row.
    """
    rows = {one.name: one for one in entrants()}
    runs = {name: (partial(_our_run, rows[name]), "") for name in OURS}
    for peer in installed(PEERS):
        runs[peer] = partial(_their_run, peer), f"{PEERS[peer]} {version(PEERS[peer])}"
    found = {}
    for name, (run, library) in tqdm(runs.items(), desc="beside libraries", unit="row"):
        asked: dict[str, object] = {
            "row": name,
            "library": library,
            "scenarios": [*ground.scenarios],
            "evaluations": ground.evaluations,
            "runs": num_runs,
        }
        file = folder / file_name("beside", name, str(num_runs))
        found[name] = kept(file, asked, Timed, partial(_run, run, ground, num_runs))
    return found


def _run(run: partial[tuple[Floats, float]], ground: Ground, num_runs: int) -> Timed:
    parts = [run(scenario, num_runs, ground.evaluations) for scenario in ground.scenarios]
    gaps, speeds = zip(*parts, strict=True)
    return Timed(np.stack(gaps), np.array(speeds))


def _our_run(row: Entrant, scenario: str, num_runs: int, evaluations: int) -> tuple[Floats, float]:
    """Return gaps, and evaluations in a second of processor time, of many runs side by side."""
    timed_runs(row, scenario, 1, evaluations)  # compiles
    gaps, speed = timed_runs(row, scenario, max(SIDE_BY_SIDE, num_runs), evaluations)
    return gaps[:num_runs], speed


def _their_run(peer: str, scenario: str, num_runs: int, evaluations: int) -> tuple[Floats, float]:
    """Return gaps, and evaluations in a second of processor time without the time of the function."""
    problem, gaps, calls, seconds = make_problem(scenario), [], 0, 0.0
    for seed in TEST[:num_runs]:
        cost = run_peer(peer, problem, evaluations, seed, is_timed=True)
        seconds += cost.library_seconds
        calls += cost.calls
        gaps.append(cost.best)
    return np.array(gaps), calls / seconds


def beside_libraries(found: dict[str, Timed], evaluations: int) -> Table:
    """Return the table: gaps and speed of each row.

    Args:
        found: runs by the name of the row.
        evaluations: evaluations of a run.
    """
    logarithms = {name: np.log10(np.maximum(timed.final, LEAST_GAP)) for name, timed in found.items()}
    means = np.stack([gaps.reshape(NUM_FUNCTIONS, -1).mean(axis=1) for gaps in logarithms.values()])
    first = (means <= means.min(axis=0) + 1e-9).sum(axis=1)
    rows: list[Row] = [
        {
            "row": name if name in OURS else f"{name}, library",
            "log10 gap at the end": mean(logarithms[name][None], len(INSTANCES)),
            "first on functions": number(count, ".0f"),
            "evaluations in a second": number(float(np.median(timed.speed)), ",.0f"),
        }
        for (name, timed), count in zip(found.items(), first, strict=True)
    ]
    runs = next(iter(found.values())).final.shape[1]
    caption = (
        f"The {NUM_FUNCTIONS} functions of BBOB in ten dimensions, {len(INSTANCES)} instances, {runs} runs "
        f"on each, {evaluations:,} evaluations. Mean log10 of the gap, at least 1e-8, with its 95 % interval "
        "over instances and runs; functions on which its mean is the least, or equal to it; median over "
        f"functions of evaluations in a second of processor time, of {SIDE_BY_SIDE} runs side by side with "
        "the function, of libraries without the time of the function. Libraries have their defaults; CMA-ES "
        "begins again where it has ended"
    )
    return Table.of("beside-libraries", caption, rows)
