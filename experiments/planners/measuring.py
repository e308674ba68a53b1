"""Runs of planners on tasks, stored line by line so that they go on where they were stopped."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from tqdm import tqdm

from experiments.planners.all_planners import DETERMINISTIC, OMPL, SWARMS, Planner, of_ompl, of_swarm
from experiments.planners.found import Valid, validate
from experiments.planners.tasks import PlannerTask
from swarm_gym.runs.provenance import git_commit

SHORT = 0.05  # seconds of a run before all others, for kernels to be compiled


NAMES = (*SWARMS, *(f"OMPL {name}" for name in OMPL), *DETERMINISTIC)
GOING_ON = ("previous path, final repair", *(name for name, swarm in SWARMS.items() if swarm.goes_on))
# Planners of tasks without and with a previous path.
ON_MAPS = tuple(name for name in NAMES if name not in GOING_ON)
AFTER_EVENTS = tuple(name for name in NAMES if name != "exact, any angle")


@dataclass(frozen=True)
class PlannerRun:
    """A run of a planner.

    Attributes:
        kind: kind of the map.
        task: number of the task on it.
        planner: name of the planner.
        seed: seed of the run.
        optimum: length of the exact shortest path, in map units.
        found: the paths that it found and that are free, in order of time.
        refused: number of paths that it found and that are not.
        commit: commit that the run was made with; empty in files of earlier versions.
    """

    kind: str
    task: int
    planner: str
    seed: int
    optimum: float
    found: tuple[Valid, ...]
    refused: int
    commit: str = ""


def planner_of(name: str) -> Planner:
    """Return the planner of a name in `NAMES`."""
    if name in SWARMS:
        return of_swarm(name)
    if name in DETERMINISTIC:
        return DETERMINISTIC[name]
    return of_ompl(name.removeprefix("OMPL "))


def measure(
    tasks: Sequence[PlannerTask], num_seeds: int, checkpoints: Sequence[float], file: Path
) -> list[PlannerRun]:
    """Run every planner on every task, as far as runs are missing in the file, and return all runs.

    Either all tasks have a previous path or none has; this decides which planners there are.
    Planners take turns, since the machine may be slow for a while; those without chance run once a task.
    """
    runs = {(run.kind, run.task, run.planner, run.seed): run for run in read(file)}
    names = ON_MAPS if tasks[0].previous is None else AFTER_EVENTS
    planners = {name: planner_of(name) for name in names}
    for planner in planners.values():
        planner(tasks[0], (SHORT,), 0)
    number: dict[str, int] = {}
    commit = git_commit()
    with file.open("a", encoding="utf-8") as out, tqdm(total=len(tasks), unit="task") as bar:
        for task in tasks:
            index = number[task.kind] = number.get(task.kind, -1) + 1
            bar.set_postfix_str(task.scenario.name)
            for seed in range(num_seeds):
                for name, planner in planners.items():
                    key = (task.kind, index, name, seed)
                    if key in runs or (seed > 0 and name in DETERMINISTIC):
                        continue
                    found = planner(task, checkpoints, seed)
                    valid = [one for path in found if (one := validate(task.scenario, path)) is not None]
                    run = PlannerRun(*key, task.optimum, tuple(valid), len(found) - len(valid), commit)
                    runs[key] = run
                    out.write(json.dumps(asdict(run)) + "\n")
                    out.flush()
            bar.update()
    return list(runs.values())


def read(file: Path) -> list[PlannerRun]:
    """Return the runs of a file; none if there is no such file."""
    if not file.exists():
        return []
    lines = file.read_text(encoding="utf-8").splitlines()
    return [
        PlannerRun(**{**stored, "found": tuple(Valid(**one) for one in stored["found"])})
        for stored in map(json.loads, lines)
    ]
