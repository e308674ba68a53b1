"""The runner of suites: a backend carries out missing runs, and a results database stores them."""

import time
from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Any, NamedTuple

from tqdm import tqdm

from agents.backends import Backend, Task, WorkLostError
from experiments.runs.database import Results, ResultsError
from experiments.runs.episode import Episode, warm_up
from experiments.runs.groups import group_key, set_key
from experiments.runs.run import Run, RunKey, Snapshot
from experiments.runs.suite import Suite
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


def all_runs(suite: Suite) -> list[RunKey]:
    """Return the keys of all runs of a suite, seed by seed.

    So a suite that was stopped has compared all controllers on the seeds that it completed.
    """
    return [
        (controller, scenario, seeds[k])
        for k in range(suite.num_seeds)
        for scenario, seeds in suite.seeds.items()
        for controller in suite.controllers
    ]


def missing_runs(suite: Suite, results: Results) -> list[RunKey]:
    """Return the keys of the runs that the database lacks."""
    finished = results.finished()
    return [key for key in all_runs(suite) if key not in finished]


def run_missing(suite: Suite, results: Results, backend: Backend) -> None:
    """Carry out the runs that the database lacks; store each as soon as it returns.

    Units of work that workers lose are run again.

    Raises:
        ResultsError: if worker processes are killed again and again, or if the database cannot be written.
        BackendError: if the backend cannot be used.
    """
    missing = missing_runs(suite, results)
    if not missing:
        print(f"{results.path}: all runs are stored already", flush=True)
        return
    if backend.on_this_machine:  # here once, or each worker would print that it compiles
        for optimizer in {entrant(name, suite.optimizer).optimizer for name in suite.controllers}:
            warm_up(optimizer, suite)
    units = make_units(missing, backend.workers())
    task = Task(run_unit, (suite, provenance("gymnasium", "numba", "numpy")), given())
    with tqdm(total=len(missing), unit="run", desc=suite.name) as bar:
        try:
            for _, runs in backend.run(task, units):
                results.add(*runs)
                bar.update(len(runs))
        except WorkLostError as error:
            raise ResultsError(
                f"{error} {len(missing_runs(suite, results))} runs are missing in {results.path}; the same "
                "command goes on from the stored runs"
            ) from error


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


def run_unit(unit: Unit, suite: Suite, made_with: dict[str, str]) -> list[Run]:
    """Carry out the runs of a unit, one after the other."""
    return [run_one((unit.controller, unit.scenario, seed), suite, made_with) for seed in unit.seeds]


def refuse_missing(suite: Suite, results: Results) -> None:
    """Raise an error if a run of the suite is missing in the database.

    Raises:
        ResultsError: if runs are missing; the message names them by group and set of scenarios.
    """
    missing = missing_runs(suite, results)
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


def run_one(key: RunKey, suite: Suite, made_with: dict[str, str]) -> Run:
    """Carry out one run in a single environment and measure its processor time."""
    name, scenario, seed = key
    keep = {it for c, s, k, its in suite.snapshots if (c, s, k) == key for it in its}
    episode = Episode(key, suite)
    begin = time.process_time()
    snapshots = [_snapshot(simulation) for simulation in episode if simulation.iteration[0] in keep]
    seconds = time.process_time() - begin
    simulation, info = episode.simulation, episode.info
    return Run(
        name,
        scenario,
        seed,
        float(info["best_fitness"]),
        float(info["best_collision"]),
        int(info["evaluations"]),
        seconds,
        info["best_path"],
        simulation.history[0].copy(),
        made_with,
        tuple(snapshots),
        simulation.columns,
        simulation.trajectory(0),
    )


def _snapshot(simulation: Any) -> Snapshot:
    """Return a copy of the current population."""
    return Snapshot(
        int(simulation.iteration[0]),
        simulation.problem_of(0).points(simulation.positions(0)),
        simulation.swarms.collision[0, : simulation.swarms.size[0]].copy(),
    )
