"""Carrying out the runs of a suite, on several processes, into a results database."""

import dataclasses
import time
from collections import Counter
from typing import Any

from joblib import Parallel, delayed
from joblib.externals.loky.process_executor import TerminatedWorkerError
from tqdm import tqdm

from agents import Controller
from agents.distilled import DistilledRule
from agents.feedforward import FeedforwardController
from agents.open_loop import OpenLoop
from agents.provenance import provenance
from agents.tuned import load_tuned
from experiments.contestants import contestant
from experiments.episode import Episode, controller_of, warm_up
from experiments.groups import group_key, set_key
from experiments.results import Results, ResultsError
from experiments.run import Run, RunKey, Snapshot
from experiments.suite import Suite
from swarm_gym.optimizers import get_optimizer
from swarm_gym.reference.optima import digest
from swarm_gym.settings import Settings, make_problem

MOST_NAMED = 10  # in a message
MOST_DEATHS = 3  # of worker processes, without a run that finishes between them


def missing_runs(suite: Suite, results: Results) -> list[RunKey]:
    """What the database lacks.

    Seeds are outermost: a suite that is stopped has compared everything on the seeds it has done.
    """
    finished = results.finished()
    return [
        key
        for k in range(suite.num_seeds)
        for scenario, seeds in suite.seeds.items()
        for controller in suite.controllers
        if (key := (controller, scenario, seeds[k])) not in finished
    ]


def run_missing(suite: Suite, results: Results, jobs: int) -> None:
    """Run what the database lacks on this many processes; each run is stored as it finishes.

    What a worker process that was killed leaves unfinished is run again.

    Raises:
        ResultsError: if worker processes are killed again and again, or the database cannot be written.
    """
    missing = missing_runs(suite, results)
    if not missing:
        print(f"{results.path}: all runs are there", flush=True)
        return
    made_with = provenance("gymnasium", "numba", "numpy")
    for optimizer in {contestant(name, suite.optimizer).optimizer for name in suite.controllers}:
        warm_up(optimizer, suite)
    deaths = 0
    with tqdm(total=len(missing), unit="run", desc=suite.name) as bar:
        while missing:
            tasks = (delayed(run_one)(key, suite, made_with) for key in missing)
            workers = Parallel(n_jobs=jobs, return_as="generator_unordered", batch_size=1)
            try:
                for run in workers(tasks):
                    results.add(run)
                    bar.update()
                    deaths = 0
            except TerminatedWorkerError as error:
                deaths += 1
                if deaths == MOST_DEATHS:
                    raise ResultsError(
                        f"worker processes were killed {deaths} times before one could finish a run; is "
                        f"memory short? {len(missing_runs(suite, results))} runs are missing in "
                        f"{results.path}, and the same command goes on"
                    ) from error
                bar.write("a worker process was killed; the runs that were under way are made again")
            missing = missing_runs(suite, results)


def refuse_missing(suite: Suite, results: Results) -> None:
    """Make sure that nothing has to be run.

    Raises:
        ResultsError: naming what is missing.
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
    """One run in a single environment, timed."""
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
        simulation.way(0),
    )


def configuration(suite: Suite) -> dict[str, Any]:
    """What the runs of a suite depend on, for the database to hold them against."""
    found = environment_configuration(suite)
    for name in suite.controllers:
        controller_name = contestant(name, suite.optimizer).controller
        found[f"controller {name}"] = _identity(controller_name, controller_of(controller_name))
    return found


def _identity(name: str, controller: Controller) -> Any:
    """What a controller is, where its name does not say: files may be replaced."""
    family, _, argument = name.partition(":")
    if family == "tuned":
        return load_tuned(argument)
    if isinstance(controller, FeedforwardController):
        manifest = controller.manifest
        base = manifest["base"]
        if base == "none":
            return manifest["weights_sha256"]
        return (
            manifest["weights_sha256"],
            manifest.get("corrected_from", 0),
            _identity(base, controller_of(base)),
        )
    if isinstance(controller, OpenLoop):
        return controller.initial_population_size, controller.table.tolist()
    return controller.lines() if isinstance(controller, DistilledRule) else name


def environment_configuration(suite: Suite) -> dict[str, Any]:
    """The part of `configuration` that takes no controllers, whose policies may be elsewhere."""
    settings = dataclasses.asdict(
        Settings.from_options(
            get_optimizer(suite.optimizer), {"scenario": suite.scenarios[0], **suite.options}
        )
    )
    # These vary within a suite and are part of the controllers and the runs.
    for name in ("scenario", "observation", "action", "initial_population_size", "max_evaluations", "price"):
        del settings[name]
    # These are part of the scenarios' problems.
    for name in ("encoding", "num_control_points", "penalty"):
        del settings[name]
    found: dict[str, Any] = {"optimizer": suite.optimizer, "settings": settings}
    for name in suite.scenarios:
        problem = make_problem(name, **suite.options)
        found[f"scenario {name}"] = [digest(problem), getattr(problem.scenario, "initial_range", None)]
    return found


def _snapshot(simulation: Any) -> Snapshot:
    return Snapshot(
        int(simulation.iteration[0]),
        simulation.problem_of(0).points(simulation.positions(0)),
        simulation.swarms.collision[0, : simulation.swarms.size[0]].copy(),
    )
