"""The tables of the MOA paper, its numbers beside ours and the true optimum."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import ttest_ind

from experiments.runs.entrants import entrant
from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.run import Run
from experiments.runs.suite import Suite
from experiments.studies.moa.published import PRINTED, THRESHOLDS
from experiments.tables.table import Table, percent
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.problem.geometry.traversal import blocked_length, path_is_free
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import GridMap, GridScenario, make_scenario


def moa_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Lengths and feasibility (table 1), success and evaluations until then (table 2)."""
    lengths: list[tuple[str, ...]] = []
    successes: list[tuple[str, ...]] = []
    for scenario in suite.scenarios:
        task = scenario.rpartition(":")[2]
        runs = {controller: outcomes.runs(controller, scenario) for controller in suite.controllers}
        lengths += _length_rows(suite, scenario, task, runs)
        successes += _success_rows(suite, task, runs)
    return [
        Table(
            "moa-lengths",
            f"Table 1. Mean length of the best paths of the feasible runs of {suite.num_seeds}, above the "
            "shortest path at any angle; p of Welch's t-test against the shortest mean length; the paper's "
            "numbers are of other tasks of about these lengths, h says whether its t-test found a difference",
            (
                "task", "shortest path", "method", "feasible", "mean length", "above shortest", "p",
                "exactly free", "longest in blocked cells", "paper feasible", "paper length", "paper h",
            ),
            lengths,
        ),
        Table(
            "moa-success",
            "Table 2. Share of runs whose path became shorter than the threshold, and mean evaluations until "
            "then, all of them where a run never succeeds",
            (
                "task", "threshold", "method", "success", "evaluations to success", "paper success",
                "paper evaluations", "evaluations made", "seconds",
            ),
            successes,
        ),
    ]  # fmt: skip


def _length_rows(suite: Suite, scenario: str, task: str, runs: dict[str, list[Run]]) -> list[tuple[str, ...]]:
    problem = make_scenario(scenario)
    assert isinstance(problem, GridScenario)
    optimum, _ = shortest_path(problem)
    lengths = {name: _feasible_lengths(found) for name, found in runs.items()}
    reached = [name for name in runs if lengths[name].size]
    shortest = min(reached, key=lambda name: lengths[name].mean()) if reached else None
    rows: list[tuple[str, ...]] = []
    for name, found in runs.items():
        own = lengths[name]
        printed = PRINTED.get((task, entrant(name, suite.optimizer).optimizer))
        mean = own.mean() if own.size else np.nan
        free = [run for run in found if _is_free(problem.map, run)]
        rows.append(
            (
                task,
                f"{optimum:.1f}",
                label(name),
                f"{own.size / len(found):.2f}",
                f"{mean:.1f}" if own.size else "–",
                percent(mean / optimum - 1.0) if own.size else "–",
                "–" if shortest in (name, None) else _p_value(own, lengths[str(shortest)]),
                f"{len(free) / len(found):.2f}",
                _longest_blocked(problem.map, found),
                f"{printed.feasible:.2f}" if printed else "–",
                f"{printed.length:.1f}" if printed else "–",
                _verdict(printed.differs) if printed else "–",
            )
        )
    return rows


def _success_rows(
    suite: Suite,
    task: str,
    runs: dict[str, list[Run]],
) -> list[tuple[str, ...]]:
    threshold = THRESHOLDS[task]
    rows: list[tuple[str, ...]] = []
    for name, found in runs.items():
        printed = PRINTED.get((task, entrant(name, suite.optimizer).optimizer))
        spent = np.array([evaluations_to(run, threshold) for run in found])
        success = np.mean([run.course("best_fitness")[-1] < threshold for run in found])
        rows.append(
            (
                task,
                f"{threshold:g}",
                label(name),
                f"{success:.2f}",
                f"{spent.mean():,.0f}",
                f"{printed.success:.2f}" if printed else "–",
                f"{printed.evaluations:,.0f}" if printed and printed.evaluations else "–",
                f"{np.mean([run.evaluations for run in found]):,.0f}",
                f"{np.mean([run.seconds for run in found]):.3f}",
            )
        )
    return rows


def evaluations_to(run: Run, threshold: float) -> float:
    """Evaluations until the best path is shorter, to the end of that iteration; all if it never is."""
    below = np.flatnonzero(run.course("best_fitness") < threshold)
    return float(run.course("evaluations")[below[0] if below.size else -1])


def _feasible_lengths(runs: Sequence[Run]) -> np.ndarray:
    # Of a feasible path, the fitness is the length.
    return np.array([run.final_fitness for run in runs if run.final_collision <= FEASIBILITY_TOLERANCE])


def _p_value(own: np.ndarray, shortest: np.ndarray) -> str:
    if min(own.size, shortest.size) < 2:
        return "–"
    return f"{ttest_ind(own, shortest, equal_var=False).pvalue:.2g}"


def _is_free(grid: GridMap, run: Run) -> bool:
    return path_is_free(grid.blocked, grid.to_cells(run.best_path))


def _longest_blocked(grid: GridMap, runs: Sequence[Run]) -> str:
    """Of the runs whose samples are all free: the length that lies in blocked cells between them."""
    feasible = [run for run in runs if run.final_collision <= FEASIBILITY_TOLERANCE]
    if not feasible:
        return "–"
    lengths = [blocked_length(grid.blocked, grid.to_cells(run.best_path)) for run in feasible]
    return f"{max(lengths) * grid.resolution:.2f}"


def _verdict(differs: bool | None) -> str:
    return "–" if differs is None else str(int(differs))
