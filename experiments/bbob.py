"""Run controllers on BBOB functions and write logs that others read: `python -m experiments.bbob --help`.

The folder `<output>/coco/<controller>` is for COCO: `python -m cocopp <folder> <folder> ...`. The folder
`<output>/iohprofiler/<controller>` is for IOHanalyzer and `iohinspector`. A log has the value of the first
evaluation, then the best value at the end of each iteration. So a value counts as found when its iteration
ends, up to an iteration too late.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import tyro

from experiments.bbob_logs import coco, iohprofiler
from experiments.bbob_logs.logged_run import LoggedExperiment, folder_name
from swarm_gym.command import command
from swarm_gym.comparing.entrants import entrant
from swarm_gym.errors import SettingError, SwarmGymError, shown
from swarm_gym.runs.provenance import provenance
from swarm_gym.scenarios.bbob.scenario import FUNCTIONS, require_parts

FORMATS = {"coco": coco.write_function, "iohprofiler": iohprofiler.write_function}


@dataclass(frozen=True)
class BbobConfig:
    """Options of runs on BBOB functions."""

    controllers: tuple[str, ...] = ("fixed:40",)
    """Controllers to run, e.g. fixed:40 random. The name of an optimizer may precede one with +, e.g.
    fish-swarm+fixed:20."""
    optimizer: str = "particle-swarm"
    """Optimizer of controllers that name none, e.g. particle-swarm."""
    functions: tuple[int, ...] = tuple(FUNCTIONS)
    """Numbers of functions, 1 to 24, e.g. 1 8 15. By default all."""
    dimensions: tuple[int, ...] = (2, 5, 10)
    """Dimensions, 2 to 100, e.g. 2 3 5 10 20, which are those that cocopp compares."""
    instances: tuple[int, ...] = tuple(range(1, 16))
    """Numbers of instances, 1 to 1000, e.g. 1 2 3; a run for each. By default 1 to 15."""
    budget: int = 1000
    """Evaluations of a run for each dimension, e.g. 1000: then runs in 5 dimensions end after 5000. A
    controller that was made for a budget of its own keeps that one."""
    iterations: int | None = None
    """Iterations of a run, e.g. 100, if the budget lasts. By default as many as the budget allows at the
    first population size."""
    parameters: dict[str, float] = field(default_factory=dict)
    """Parameters of the optimizer that differ from its defaults, in units of the components where they are
    lengths, e.g. noise 0.05."""
    output: Path = Path("results/bbob")
    """Folder for logs, by default results/bbob. Logs of another run that are there are not touched."""
    seed: int = 0
    """Seed of the run on the first instance, e.g. 0; that on the next instance has the next seed."""


def run(config: BbobConfig) -> Iterator[Path]:
    """Make all runs and write their logs; yield each file that lists the runs of a function.

    Raises:
        ScenarioError: for a function, a dimension or an instance that does not exist.
        SettingError: for an option without a value, or if there are logs of an entrant already.
        UnknownNameError: if there is no such controller, optimizer or parameter.
        OSError: if a file cannot be written.
    """
    for name, given in (
        ("controllers", config.controllers),
        ("functions", config.functions),
        ("dimensions", config.dimensions),
        ("instances", config.instances),
    ):
        if not given:
            raise SettingError(f"--{name} needs at least one value")
    for function in config.functions:
        for dimension in config.dimensions:
            for instance in config.instances:
                require_parts("BBOB", function, dimension, instance)
    if config.budget < 1:
        raise SettingError(f"--budget must be at least 1 evaluation for each dimension, got {config.budget}")
    experiments = [_experiment(config, controller) for controller in dict.fromkeys(config.controllers)]
    for experiment in experiments:
        _refuse_old_logs(config.output, experiment.name)
    for experiment in experiments:
        made_with = ", ".join(f"{name} {value}" for name, value in provenance().items())
        settings = f"{made_with}; {experiment.settings}"
        for groups in experiment.run():
            for form, write in FORMATS.items():
                folder = config.output / form / folder_name(experiment.name)
                yield write(folder, experiment.name, settings, groups)


def _experiment(config: BbobConfig, controller: str) -> LoggedExperiment:
    found = entrant(controller, config.optimizer)
    return LoggedExperiment(
        controller if controller != found.controller else f"{found.optimizer}+{controller}",
        found,
        _unique(config.functions),
        _unique(config.dimensions),
        _unique(config.instances),
        config.budget,
        config.iterations,
        config.seed,
        config.parameters,
    )


def _unique(numbers: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(dict.fromkeys(numbers))


def _refuse_old_logs(output: Path, name: str) -> None:
    for form in FORMATS:
        folder = output / form / folder_name(name)
        if folder.exists() and any(folder.iterdir()):
            raise SettingError(
                f"{folder} has logs already, which would mix with those of {shown(name)}; delete it, or "
                f"choose another --output"
            )


def main() -> None:
    """Run and write as the command line says."""
    config = tyro.cli(BbobConfig, description=__doc__)
    with command(SwarmGymError, kept="functions whose files are written are complete"):
        for path in run(config):
            print(path, flush=True)


if __name__ == "__main__":
    main()
