"""Driven curves beside RRT* of OMPL in Dubins' space: `python -m experiments.planners.curves`; needs OMPL.

Tasks have headings at start and goal, and a small robot that drives forwards only. Maps whose files are not
in the data folder are left out and named. Other code than the planners' says which curves obey all limits.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import tyro
from tqdm import tqdm

from experiments.documents.records import record_of, write_record
from experiments.planners.drive_check import check
from experiments.planners.drive_planners import DRIVE_PLANNERS, WISHES, drive_map_of, ours
from experiments.planners.drive_tasks import DriveTask, draw_drive_tasks
from experiments.planners.tasks import MAPS, draw_on_maps
from experiments.statistics import mean_interval
from experiments.tables.cell import MISSING, number, share, share_in
from experiments.tables.table import Row, Table
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.files import write_atomically
from swarm_gym.planning.drive_costs import costs_of
from swarm_gym.runs.provenance import git_commit

OURS = "curve search"
LONGER = 10.0  # times the limit, after which a task without a curve counts as not solvable


@dataclass(frozen=True)
class CurvesConfig:
    """Options of the study."""

    output: Path = Path("results/planners")
    """Folder that runs and tables are written to. Runs that it holds are not made again."""
    maps: tuple[str, ...] = tuple(MAPS)
    """Kinds of maps, e.g. maze caves; a wrong name lists the valid ones."""
    tasks: int = 3
    """Number of tasks on each map; the page has 20."""
    seconds: float = 1.0
    """CPU time of each planner on each task, in seconds."""
    seed: int = 0
    """Seed that tasks are drawn with."""


@dataclass(frozen=True)
class DriveRecord:
    """The result of a planner on a task.

    Attributes:
        kind: kind of the map.
        task: number of the task on it.
        planner: name of the planner.
        broken: limit that its curve breaks; "none found" without one; empty if it obeys all.
        first: seconds until its first curve.
        length: length over that of the shortest path of a robot that turns on the spot.
        total: sum of wishes, over the same.
        clearance: least distance of the centre from blocked cells, over the robot's radius.
        commit: commit of the code that made it; empty if unknown.
    """

    kind: str
    task: int
    planner: str
    broken: str
    first: float = math.nan
    length: float = math.nan
    total: float = math.nan
    clearance: float = math.nan
    commit: str = ""


def curves(config: CurvesConfig) -> list[Path]:
    """Run the planners, write the tables, and return their files.

    Raises:
        MissingExtraError: if OMPL is missing.
        UnknownNameError: if there is no such kind of map.
        ScenarioError: if no map is left.
    """
    drawn = draw_on_maps(
        config.maps, config.seed, lambda kind, seed: draw_drive_tasks(kind, config.tasks, seed)
    )
    config.output.mkdir(parents=True, exist_ok=True)
    records = measure(drawn, config.seconds, config.output / "curves.jsonl")
    write_record(record_of("curves", {one.commit for one in records} - {""}, {}), config.output)
    made = curve_tables(records, config.seconds)
    for table in made:
        table.write(config.output)
    write_atomically(config.output / "curves-all.md", "\n".join(table.markdown() for table in made))
    return [config.output / f"{table.name}.md" for table in made]


def measure(tasks: Sequence[DriveTask], seconds: float, file: Path) -> list[DriveRecord]:
    """Run every planner on every task, as far as records are missing in the file, and return all records."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    records = {
        (one.kind, one.task, one.planner): one for one in (DriveRecord(**json.loads(line)) for line in lines)
    }
    planners = {name: make() for name, make in DRIVE_PLANNERS.items()}
    longer, commit = ours(WISHES), git_commit()
    names = [*planners, "longer"]
    # One task of each map after the other, so that what is there after a stop has all maps.
    tasks = sorted(tasks, key=lambda task: task.number)
    wanted = [
        (task, name) for task in tasks for name in names if (task.kind, task.number, name) not in records
    ]
    if wanted:
        for planner in planners.values():
            planner(tasks[0], 0.1)  # kernels are loaded
    with file.open("a", encoding="utf-8") as out:
        for task, name in tqdm(wanted):
            if name == "longer":
                solved = any(not records[task.kind, task.number, one].broken for one in planners)
                found = None if solved else longer(task, LONGER * seconds)
            else:
                found = planners[name](task, seconds)
            record = DriveRecord(task.kind, task.number, name, "none found", commit=commit)
            if found is not None:
                verdict = check(task, found.poses)
                total = costs_of(drive_map_of(task, WISHES), found.curve, WISHES)["sum"]
                record = DriveRecord(
                    task.kind,
                    task.number,
                    name,
                    verdict.broken,
                    found.first,
                    verdict.length / task.shortest,
                    total / task.shortest,
                    verdict.clearance / task.radius,
                    commit,
                )
            records[task.kind, task.number, name] = record
            out.write(json.dumps(asdict(record)) + "\n")
            out.flush()
    return list(records.values())


def curve_tables(records: Sequence[DriveRecord], seconds: float) -> list[Table]:
    """Return the tables of all maps, by map, and of differences."""
    solvable = {(one.kind, one.task) for one in records if not one.broken}
    kept = [one for one in records if (one.kind, one.task) in solvable and one.planner != "longer"]
    kinds = dict.fromkeys(one.kind for one in kept)
    caption = (
        f"Curves for a small robot after {seconds:g} s of CPU time on {len(kinds)} maps: solvable tasks; "
        "share of them with a curve that obeys all limits, by other code at steps of a millimetre; "
        "curves that break one; mean sum of wishes and mean length of the others, over the length of the "
        "shortest path of a robot that turns on the spot; median least distance of the centre from "
        "obstacles, over the robot's radius; median CPU seconds until the first curve, and slowest 5 %"
    )
    rows = [_row({"planner": name}, _of(kept, name)) for name in _names(kept)]
    by_map = [
        _row({"map": kind, "planner": name}, [one for one in _of(kept, name) if one.kind == kind])
        for kind in kinds
        for name in _names(kept)
    ]
    differences = (
        "The curve search minus another planner, on tasks that both solved: mean of differences [95 % "
        "interval], over the length of the shortest path of a robot that turns on the spot; below 0 the "
        "curve search has less"
    )
    return [
        Table.of("curves", caption, rows),
        Table.of("curves-by-map", "The same by map", [_without(row, "slow, s") for row in by_map]),
        Table.of("curves-differences", differences, _differences(kept)),
    ]


def _without(row: Row, column: str) -> Row:
    return {name: cell for name, cell in row.items() if name != column}


def _names(records: Sequence[DriveRecord]) -> list[str]:
    return [name for name in DRIVE_PLANNERS if any(one.planner == name for one in records)]


def _of(records: Sequence[DriveRecord], name: str) -> list[DriveRecord]:
    return [one for one in records if one.planner == name]


def _row(key: Row, records: Sequence[DriveRecord]) -> Row:
    valid = [one for one in records if not one.broken]
    broken = sum(bool(one.broken) and one.broken != "none found" for one in records)

    columns = {
        name: np.array([getattr(one, name) for one in valid])
        for name in ("total", "length", "clearance", "first")
    }
    return {
        **key,
        "tasks": number(len(records), "d"),
        "obeys all": share(len(valid) / len(records)),
        "breaks one": number(broken, "d"),
        "sum": number(float(columns["total"].mean()), ".3f") if valid else MISSING,
        "length": number(float(columns["length"].mean()), ".3f") if valid else MISSING,
        "distance": number(float(np.median(columns["clearance"])), ".2f") if valid else MISSING,
        "first, s": number(float(np.median(columns["first"])), ".3f") if valid else MISSING,
        "slow, s": number(float(np.quantile(columns["first"], 0.95)), ".3f") if valid else MISSING,
    }


def _differences(records: Sequence[DriveRecord]) -> list[Row]:
    rows: list[Row] = []
    for name in _names(records):
        if not name.startswith("OMPL"):
            continue
        for mine, what in ((OURS, "sum"), (f"{OURS}, length alone", "length")):
            pairs = _pairs(records, mine, name)
            if len(pairs) < 2:
                continue
            values = np.array(
                [(a.total - b.total) if what == "sum" else (a.length - b.length) for a, b in pairs]
            )
            rows.append(
                {
                    "curve search": mine,
                    "other planner": name,
                    "of": what,
                    "tasks": number(len(pairs), "d"),
                    "difference": share_in(float(values.mean()), mean_interval(values), "+.1f"),
                }
            )
    return rows


def _pairs(records: Sequence[DriveRecord], name: str, other: str) -> list[tuple[DriveRecord, DriveRecord]]:
    others = {(one.kind, one.task): one for one in _of(records, other) if not one.broken}
    return [
        (one, others[one.kind, one.task])
        for one in _of(records, name)
        if not one.broken and (one.kind, one.task) in others
    ]


def main() -> None:
    """Make the tables and print where they are."""
    config = tyro.cli(CurvesConfig, description=__doc__)
    with command(MissingExtraError, kept="runs that were made are kept"):
        for file in curves(config):
            print(file)


if __name__ == "__main__":
    main()
