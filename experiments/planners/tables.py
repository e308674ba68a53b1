"""Tables of planning and replanning: what was found by when, and differences at equal time."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from experiments.planners.all_planners import SWARMS
from experiments.planners.measuring import NAMES, PlannerRun
from experiments.statistics import mean_interval
from experiments.tables.cell import MISSING, Cell, Entry, number, share, share_in
from experiments.tables.table import Row, Table

Floats = NDArray[np.float64]

# A path is near the optimum if it is longer by at most this share.
NEAR = 0.02
MOST = 1.0  # a run without a path counts as one that is longer by this share


def length_above(run: PlannerRun, seconds: float) -> float:
    """Return by which share the shortest path found by that time is above the optimum; else infinite."""
    lengths = [found.length for found in run.found if found.seconds <= seconds]
    return min(lengths) / run.optimum - 1.0 if lengths else np.inf


def seconds_to_near(run: PlannerRun) -> float:
    """Return the time after which a path was near the optimum; infinite if none was."""
    near = [found.seconds for found in run.found if found.length <= (1.0 + NEAR) * run.optimum]
    return min(near, default=np.inf)


def tables(runs: Sequence[PlannerRun], checkpoints: Sequence[float]) -> list[Table]:
    """Return the tables of planning over all maps, by map, and of differences."""
    return [
        _overall("planners", "Planners on all maps", runs, checkpoints),
        _by_map(runs, checkpoints[-1]),
        _differences("planners-differences", runs, checkpoints),
    ]


def replanning_tables(runs: Sequence[PlannerRun], checkpoints: Sequence[float]) -> list[Table]:
    """Return the tables of replanning over all maps, and of differences."""
    title = "Replanning on all maps after an obstacle has appeared on the shortest path"
    return [
        _overall("replanning", title, runs, checkpoints),
        _differences("replanning-differences", runs, checkpoints),
    ]


def _names(runs: Sequence[PlannerRun]) -> list[str]:
    present = {run.planner for run in runs}
    return [name for name in NAMES if name in present]


def _of(runs: Sequence[PlannerRun], planner: str, kind: str | None = None) -> list[PlannerRun]:
    return [run for run in runs if run.planner == planner and kind in (None, run.kind)]


def _overall(name: str, title: str, runs: Sequence[PlannerRun], checkpoints: Sequence[float]) -> Table:
    of_planners = {planner: _of(runs, planner) for planner in _names(runs)}
    return Table.of(
        name,
        f"{title}: share of runs that found a free path (by shapely); mean length above the "
        f"exact shortest path at any angle, of these, and share of runs within {NEAR:.0%} of it, by time; "
        "median seconds until then; median least distance from a blocked cell, in cells; share of runs "
        "whose last path is a swarm's, and not the path that it began around",
        [
            {
                "planner": planner,
                "runs": number(len(own), ",d"),
                "found": share(_found_share(own, checkpoints[-1])),
                **{f"above exact, {seconds:g} s": _mean_above(own, seconds) for seconds in checkpoints},
                **{f"near, {seconds:g} s": _near_share(own, seconds) for seconds in checkpoints},
                "seconds to near": _median_seconds(own),
                "clearance": _median_clearance(own),
                "by a swarm": _share_of_swarm(own),
            }
            for planner, own in of_planners.items()
        ],
    )


def _by_map(runs: Sequence[PlannerRun], seconds: float) -> Table:
    rows: list[Row] = []
    for kind in dict.fromkeys(run.kind for run in runs):
        for name in _names(runs):
            own = _of(runs, name, kind)
            rows.append(
                {
                    "map": kind,
                    "planner": name,
                    "found": share(_found_share(own, seconds)),
                    "above exact": _mean_above(own, seconds),
                    "near": _near_share(own, seconds),
                    "seconds to near": _median_seconds(own),
                    "clearance": _median_clearance(own),
                }
            )
    return Table.of("planners-by-map", f"The same by map, after {seconds:g} s", rows)


def _differences(name: str, runs: Sequence[PlannerRun], checkpoints: Sequence[float]) -> Table:
    names = _names(runs)
    return Table.of(
        name,
        "Length above the exact shortest path: a swarm's minus another planner's after the same time, "
        f"mean over tasks [95 % interval]; a run without a path counts as {MOST:.0%} above; below 0 the "
        "swarm's paths are shorter",
        [
            {
                "swarm": ours,
                "other planner": rival,
                **{f"after {s:g} s": _difference(runs, ours, rival, s) for s in checkpoints},
            }
            for ours in names
            if ours in SWARMS
            for rival in names
            if rival not in SWARMS
        ],
    )


def _difference(runs: Sequence[PlannerRun], ours: str, rival: str, seconds: float) -> Cell:
    differences = _by_task(runs, ours, seconds) - _by_task(runs, rival, seconds)
    return share_in(float(differences.mean()), mean_interval(differences), "+.1f")


def _by_task(runs: Sequence[PlannerRun], planner: str, seconds: float) -> Floats:
    """Return the mean length above the optimum of each task, (tasks,)."""
    tasks: dict[tuple[str, int], list[float]] = {}
    for run in _of(runs, planner):
        tasks.setdefault((run.kind, run.task), []).append(min(length_above(run, seconds), MOST))
    return np.array([np.mean(values) for values in tasks.values()])


def _found_share(runs: Sequence[PlannerRun], seconds: float) -> float:
    return float(np.mean([np.isfinite(length_above(run, seconds)) for run in runs]))


def _mean_above(runs: Sequence[PlannerRun], seconds: float) -> Entry:
    above = np.array([length_above(run, seconds) for run in runs])
    above = above[np.isfinite(above)]
    # Rounded, so that what rounding errors leave of 0 is printed without a sign.
    return share(float(np.round(above.mean(), 9)) + 0.0, ".2f") if above.size else MISSING


def _near_share(runs: Sequence[PlannerRun], seconds: float) -> Entry:
    return share(float(np.mean([seconds_to_near(run) <= seconds for run in runs])))


def _median_seconds(runs: Sequence[PlannerRun]) -> Entry:
    median = float(np.median([seconds_to_near(run) for run in runs]))
    return number(median, ".3f") if np.isfinite(median) else MISSING


def _median_clearance(runs: Sequence[PlannerRun]) -> Entry:
    clearances = [run.found[-1].clearance for run in runs if run.found]
    return number(float(np.median(clearances)), ".2f") if clearances else MISSING


def _share_of_swarm(runs: Sequence[PlannerRun]) -> Entry:
    known = [run.found[-1].of_swarm for run in runs if run.found and run.found[-1].of_swarm is not None]
    return share(float(np.mean(known))) if known else MISSING
