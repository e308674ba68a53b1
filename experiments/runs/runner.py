"""The runner of experiments: a backend carries out missing runs, and a results database stores them."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from tqdm import tqdm

from agents.backends import Backend, Task, WorkLostError
from experiments.runs.configuration import changed_since
from experiments.runs.database import Results, ResultsError
from experiments.runs.episode import Episode, warm_up
from experiments.runs.experiment import Experiment
from experiments.runs.groups import group_key, set_key
from experiments.runs.run import Run, RunKey
from experiments.runs.side_by_side import can_be_side_by_side, run_side_by_side
from swarm_gym.comparing.entrants import entrant
from swarm_gym.own_code import given
from swarm_gym.runs.provenance import provenance

MOST_NAMED = 10  # groups of missing runs that a message names

# A unit of work is long compared with the milliseconds of handing it out, and short compared with all work.
MOST_SEEDS = 10
UNITS_PER_WORKER = 8


class Unit(NamedTuple):
    """A unit of work that one worker carries out: runs that differ in their seeds only."""

    controller: str
    scenario: str
    seeds: tuple[int, ...]


def missing_runs(experiment: Experiment, results: Results) -> list[RunKey]:
    """Return the keys of the runs that the database lacks."""
    finished = results.finished()
    return [key for key in experiment.all_runs() if key not in finished]


def run_missing(experiment: Experiment, results: Results, backend: Backend) -> None:
    """Carry out the runs that the database lacks, with a progress bar; `store_missing` lists the errors."""
    missing = missing_runs(experiment, results)
    if not missing:
        print(f"{results.path}: all runs are stored already", flush=True)
        return
    if backend.on_this_machine:  # here once, or each worker would print that it compiles
        warm_up_all(experiment)
    with tqdm(total=len(missing), unit="run", desc=experiment.name) as bar:
        for count in store_missing(experiment, results, backend):
            bar.update(count)


def store_missing(experiment: Experiment, results: Results, backend: Backend) -> Iterator[int]:
    """Carry out the runs that the database lacks; store each unit of work, and yield the number of its runs.

    Units of work that workers lose are run again.

    Raises:
        ResultsError: if worker processes are killed again and again, if the database cannot be written, or
            if the file of a controller changes meanwhile.
        BackendError: if the backend cannot be used.
    """
    units = make_units(missing_runs(experiment, results), backend.workers())
    made_with = provenance("gymnasium", "numba", "numpy")
    task = Task(run_unit, (experiment, made_with, results.identities), given())
    try:
        for _, runs in backend.run(task, units):
            results.add(*runs)
            yield len(runs)
    except WorkLostError as error:
        raise ResultsError(
            f"{error} {len(missing_runs(experiment, results))} runs are missing in {results.path}; the same "
            "command goes on from the stored runs"
        ) from error


def warm_up_all(experiment: Experiment) -> None:
    """Compile or load the kernels that the runs of an experiment need, in this process."""
    for name in experiment.controllers:
        warm_up(entrant(name, experiment.optimizer), experiment)


def make_units(runs: Sequence[RunKey], workers: int) -> list[Unit]:
    """Return units of work, the first seeds first; each has several seeds if all workers have work then."""
    size = min(max(len(runs) // (UNITS_PER_WORKER * workers), 1), MOST_SEEDS)
    seeds: dict[tuple[str, str], list[int]] = defaultdict(list)
    for controller, scenario, seed in runs:
        seeds[controller, scenario].append(seed)
    units = [
        (place, Unit(*names, tuple(found[place : place + size])))
        for names, found in seeds.items()
        for place in range(0, len(found), size)
    ]
    return [unit for _, unit in sorted(units, key=lambda entry: entry[0])]


def run_unit(
    unit: Unit, experiment: Experiment, made_with: dict[str, str], identities: Mapping[str, str]
) -> list[Run]:
    """Carry out the runs of a unit, side by side where they can be.

    Args:
        unit: controller, scenario and seeds.
        experiment: experiment that gives the optimizer and the options.
        made_with: versions and commit that the runs are made with.
        identities: identities of controllers that the database states, as JSON by name; no others count.

    Raises:
        ResultsError: if the controller that this process loads is another one than the database states.
    """
    if changed_since(unit.controller, experiment, identities):
        raise ResultsError(
            f"{unit.controller} has changed since this command began; the runs that are stored so far are of "
            "the earlier one; run the command again"
        )
    if can_be_side_by_side(*unit, experiment):
        return run_side_by_side(*unit, experiment, made_with)
    return [Episode((unit.controller, unit.scenario, seed), experiment).run(made_with) for seed in unit.seeds]


def refuse_missing(experiment: Experiment, results: Results) -> None:
    """Raise an error if a run of an experiment is missing in the database.

    Raises:
        ResultsError: if runs are missing; the message names them by group and set of scenarios.
    """
    missing = missing_runs(experiment, results)
    if missing:
        counts = Counter(
            f"{group_key(controller)} on {set_key(scenario)}" for controller, scenario, _ in missing
        )
        named = [f"{count} of {what}" for what, count in counts.most_common(MOST_NAMED)]
        more = f" and {len(counts) - MOST_NAMED} more" if len(counts) > MOST_NAMED else ""
        raise ResultsError(
            f"{results.path} lacks {len(missing)} runs, which --no-simulate forbids to make: "
            f"{', '.join(named)}{more}"
        )
