"""CMA-ES with the restarts of BIPOP beside pycma, the library of its author, on the 24 functions of BBOB.

Both have the default size, a first step of 0.3 ranges, and the same bounds and budget. pycma maps members
into the bounds by a transformation, and draws smaller steps for small restarts. See docs/readings.md.
"""

from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.stats import mannwhitneyu
from tqdm import tqdm

from experiments.statistics import holm
from experiments.studies.libraries import run_peer
from experiments.studies.strong.entrants import Entrant, entrants_on_bbob
from experiments.studies.strong.grounds import INSTANCES, NUM_FUNCTIONS, Ground
from experiments.studies.strong.measured_gaps import Floats, file_name, kept, timed_runs
from experiments.tables import Table
from experiments.tables.cell import Entry, number
from experiments.tables.table import Row
from swarm_gym.reward import LEAST_GAP
from swarm_gym.runs.seeds import TEST
from swarm_gym.scenarios.bbob.instance import FUNCTION_NAMES
from swarm_gym.worlds import make_problem

PYCMA = "pycma CMA-ES, BIPOP"
SIDE_BY_SIDE = 64  # runs of the optimizer here whose speed is measured
LEVEL = 0.05  # p-values below it count


class Both(NamedTuple):
    """Runs of both on one scenario.

    Attributes:
        ours: (runs,) gaps of the optimizer here.
        theirs: (runs,) gaps of pycma.
        our_speed: evaluations in a second of processor time, the cost function included, (1,).
        their_speed: evaluations of pycma in a second of its processor time, without the cost function, (1,).
    """

    ours: Floats
    theirs: Floats
    our_speed: Floats
    their_speed: Floats


def run_both(ground: Ground, dimension: int, num_runs: int, folder: Path) -> list[Both]:
    """Return the runs on each scenario of a ground; what is in the folder is not run again.

    Args:
        ground: the functions of BBOB in a dimension, and the budget.
        dimension: the dimension.
        num_runs: number of runs of each on a scenario.
        folder: folder of the files, one for each scenario.
    """
    (row,) = (one for one in entrants_on_bbob(dimension) if one.name == "CMA-ES, BIPOP")
    (rule,), found = row.controllers, []
    for scenario in tqdm(ground.scenarios, desc="pycma", unit="scenario"):
        asked: dict[str, object] = {
            "rule": rule,
            "scenario": scenario,
            "runs": num_runs,
            "evaluations": ground.evaluations,
            "pycma": version("cma"),
        }
        file = folder / file_name("pycma", scenario, str(num_runs))
        run = partial(_run, row, scenario, num_runs, ground.evaluations)
        found.append(kept(file, asked, Both, run))
    return found


def _run(row: Entrant, scenario: str, num_runs: int, evaluations: int) -> Both:
    ours, _ = timed_runs(row, scenario, num_runs, evaluations)  # compiles, too
    _, our_speed = timed_runs(row, scenario, SIDE_BY_SIDE, evaluations)
    problem = make_problem(scenario)
    theirs, speeds = [], []
    for seed in TEST[:num_runs]:
        cost = run_peer(PYCMA, problem, evaluations, seed, is_timed=True)
        speeds.append(cost.calls / cost.library_seconds)
        theirs.append(cost.best)
    return Both(ours, np.array(theirs), np.array([our_speed]), np.array([np.mean(speeds)]))


def beside_pycma(found: list[Both], dimension: int, evaluations: int) -> Table:
    """Return the table by function, with a row for all of them at the end.

    Args:
        found: runs on the scenarios, all instances of a function one after the other.
        dimension: dimension of the functions.
        evaluations: evaluations of a run.
    """
    by_function = [found[i : i + len(INSTANCES)] for i in range(0, len(found), len(INSTANCES))]
    ours = [_logarithms(*(one.ours for one in instances)) for instances in by_function]
    theirs = [_logarithms(*(one.theirs for one in instances)) for instances in by_function]
    ratios = [
        float(np.mean([one.our_speed / one.their_speed for one in instances])) for instances in by_function
    ]
    chances = holm([float(mannwhitneyu(*pair).pvalue) for pair in zip(ours, theirs, strict=True)])
    rows = [
        _row(f"{k + 1} {FUNCTION_NAMES[k]}", ours[k], theirs[k], ratios[k], number(chances[k], ".2g"))
        for k in range(len(by_function))
    ]
    different = sum(chance < LEVEL for chance in chances)
    rows.append(
        _row("all", np.stack(ours), np.stack(theirs), float(np.median(ratios)), f"{different} below {LEVEL}")
    )
    caption = (
        f"CMA-ES with BIPOP here, and as pycma has it, on the {NUM_FUNCTIONS} functions of BBOB in "
        f"{dimension} dimensions, {len(INSTANCES)} instances, {len(found[0].ours)} runs on each, "
        f"{evaluations:,} evaluations. Mean log10 of the gap, at least 1e-8, of both, and its difference; p "
        "of the Mann-Whitney test on the gaps, by Holm's procedure over all functions; how many times as "
        f"many evaluations in a second of processor time: {SIDE_BY_SIDE} runs of ours side by side with the "
        "cost function, pycma without its time (last row: the median). Lower gaps are closer"
    )
    return Table.of("beside-pycma", caption, rows)


def _row(name: str, ours: Floats, theirs: Floats, ratio: float, chance: Entry) -> Row:
    return {
        "function": name,
        "here": number(ours.mean(), ".2f"),
        "pycma": number(theirs.mean(), ".2f"),
        "difference": number(ours.mean() - theirs.mean(), "+.2f"),
        "p": chance,
        "times as many a second": number(ratio, ".0f"),
    }


def _logarithms(*gaps: Floats) -> Floats:
    return np.log10(np.maximum(np.concatenate(gaps), LEAST_GAP))
