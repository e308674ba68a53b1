"""Compare the swarms with planners that people use: `python -m experiments.planners --help`; needs OMPL.

Keep the machine quiet meanwhile. Maps whose files are not in the data folder are left out and named.
"""

from dataclasses import dataclass
from pathlib import Path

import tyro

from experiments.documents.records import record_of, write_record
from experiments.planners.measuring import measure
from experiments.planners.tables import replanning_tables, tables
from experiments.planners.tasks import MAPS, draw_on_maps, draw_tasks, planning_task, replanning_task
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.files import write_atomically


@dataclass(frozen=True)
class PlannersConfig:
    """Options of the comparison."""

    output: Path = Path("results/planners")
    """Folder that runs and tables are written to. Runs that it holds are not made again."""
    maps: tuple[str, ...] = tuple(MAPS)
    """Kinds of maps, e.g. maze caves; a wrong name lists the valid ones."""
    tasks: int = 20
    """Number of tasks on each map."""
    seeds: int = 10
    """Number of runs of each planner on each task."""
    replanning: bool = False
    """Compare replanning: an obstacle has appeared on the shortest path, and planners plan again."""
    seconds: tuple[float, ...] = (0.1, 0.5)
    """Times after which paths are compared, in seconds; a run ends at the last."""
    seed: int = 0
    """Seed that tasks are drawn with."""


def compare(config: PlannersConfig) -> list[Path]:
    """Run the planners, write the tables, and return their files.

    Raises:
        MissingExtraError: if OMPL is missing.
        UnknownNameError: if there is no such kind of map.
        ValueError: if the times do not grow.
        ScenarioError: if no map is left.
    """
    if sorted(set(config.seconds)) != list(config.seconds) or not config.seconds or config.seconds[0] <= 0.0:
        raise ValueError(f"--seconds: expected growing numbers above 0, got {config.seconds}")
    make_task = replanning_task if config.replanning else planning_task
    drawn = draw_on_maps(
        config.maps, config.seed, lambda kind, seed: draw_tasks(kind, config.tasks, seed, make_task)
    )
    config.output.mkdir(parents=True, exist_ok=True)
    name, make = ("replanning", replanning_tables) if config.replanning else ("planning", tables)
    runs = measure(drawn, config.seeds, config.seconds, config.output / f"{name}.jsonl")
    made = make(runs, config.seconds)
    record = "replanning" if config.replanning else "planners"
    write_record(record_of(record, {run.commit for run in runs}, {}), config.output)
    for table in made:
        table.write(config.output)
    write_atomically(config.output / f"{name}.md", "\n".join(table.markdown() for table in made))
    return [config.output / f"{table.name}.md" for table in made]


def main() -> None:
    """Compare, then print where the tables are."""
    config = tyro.cli(PlannersConfig, description=__doc__)
    with command(MissingExtraError, kept="runs that were made are kept"):
        for file in compare(config):
            print(file)


if __name__ == "__main__":
    main()
