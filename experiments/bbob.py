"""Run controllers on BBOB functions and write logs that others read: `python -m experiments.bbob --help`.

The folder `<output>/coco/<controller>` is for COCO: `python -m cocopp <folder> <folder> ...`. The folder
`<output>/iohprofiler/<controller>` is for IOHanalyzer and `iohinspector`. A log has the value of the first
evaluation, then the best value at the end of each iteration. So a value counts as found when its iteration
ends, up to an iteration too late.
"""

from collections.abc import Iterator
from pathlib import Path

import tyro

from experiments.bbob_logs import coco, iohprofiler
from experiments.bbob_logs.logged_run import BbobConfig, LoggedExperiment, folder_name
from swarm_gym.command import command
from swarm_gym.errors import SettingError, SwarmGymError, shown
from swarm_gym.runs.provenance import provenance
from swarm_gym.scenarios.bbob.scenario import require_parts

FORMATS = {"coco": coco.write_function, "iohprofiler": iohprofiler.write_function}


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
    if config.seed < 0:
        raise SettingError(f"--seed must be a natural number, got {config.seed}")
    experiments = [
        LoggedExperiment.of(controller, config) for controller in dict.fromkeys(config.controllers)
    ]
    for experiment in experiments:
        _refuse_old_logs(config.output, experiment.name)
    for experiment in experiments:
        made_with = ", ".join(f"{name} {value}" for name, value in provenance().items())
        settings = f"{made_with}; {experiment.settings}"
        for groups in experiment.run():
            for form, write in FORMATS.items():
                folder = config.output / form / folder_name(experiment.name)
                yield write(folder, experiment.name, settings, groups)


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
