"""What backends take beyond the work itself, and what the work takes, measured on this machine."""

import contextlib
import io
import multiprocessing
import os
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from agents.backends import Backend, Task
from agents.backends.local import LocalBackend
from agents.backends.ray_backend import RayBackend
from agents.training.presets import load_preset
from agents.training.run import TrainingRun
from experiments.runs.database import Results
from experiments.runs.run import Run, RunKey
from experiments.runs.runner import MOST_SEEDS, run_one
from experiments.runs.suite import Suite
from experiments.scaling.clusters import logical_cluster
from experiments.scaling.units import compute, compute_together, copies, wait
from experiments.speed.measurement import run_python, seconds_of


@dataclass(frozen=True)
class Timed:
    """Units that were carried out.

    Attributes:
        backend: by what.
        work: what they did.
        workers: how many at a time.
        units: how many.
        seconds: of each.
        wall: seconds that all took.
    """

    backend: str
    work: str
    workers: int
    units: int
    seconds: float
    wall: float

    @property
    def ideal(self) -> float:
        """Seconds without overhead."""
        return self.units * self.seconds / self.workers

    @property
    def overhead(self) -> float:
        """What was added to that, as a share of it."""
        return self.wall / self.ideal - 1.0


def time_units(backend: Backend, name: str, task: Task, units: int) -> Timed:
    """Carry out units of a task, whose last argument is how long they are; workers have started before."""
    workers, seconds = backend.workers(), task.common[-1]
    list(backend.run(Task(task.function, (0.5,)), range(2 * workers)))
    wall = seconds_of(lambda: list(backend.run(task, range(units))))
    return Timed(name, task.function.__name__, workers, units, seconds, wall)


def time_processes(units: int, seconds: float, processors: int) -> Timed:
    """Units that compute in processes that nobody hands anything: what this machine itself adds."""
    context = multiprocessing.get_context("spawn")
    barrier = context.Barrier(processors + 1)
    arguments = (barrier, units // processors, seconds)
    processes = [context.Process(target=compute_together, args=arguments) for _ in range(processors)]
    for process in processes:
        process.start()
    barrier.wait()
    begin = time.perf_counter()
    for process in processes:
        process.join()
    wall = time.perf_counter() - begin
    return Timed("none", "compute", processors, units // processors * processors, seconds, wall)


def time_backends(units: int, seconds: float, processors: int) -> Iterator[Timed]:
    """Units that compute: handed out by nobody, to processes of this machine, and by Ray on it."""
    yield time_processes(units, seconds, processors)
    for name, backend in (("local", LocalBackend(processors)), ("Ray", RayBackend(None, processors))):
        with closing(backend):
            yield time_units(backend, name, Task(compute, (seconds,)), units)


def time_nodes(nodes: int, processors: int, work: str, per_worker: int, seconds: float) -> Timed:
    """Units on logical nodes of so many processors each; there may be more of these than cores for `wait`."""
    task = Task({"compute": compute, "wait": wait}[work], (seconds,))
    with logical_cluster(nodes, processors) as (backend, _):
        name = f"{nodes} node{'s' if nodes > 1 else ''} of {processors}"
        return time_units(backend, name, task, per_worker * nodes * processors)


def time_start(processors: int) -> dict[str, float]:
    """Seconds until there is work, by what they are spent on."""
    backend = RayBackend(None, processors)
    with closing(backend):
        here = seconds_of(backend.workers)
    with logical_cluster(0, 1) as (backend, cluster):
        backend.workers()  # which connects
        node = seconds_of(lambda: cluster.add_node(num_cpus=1))
        first = seconds_of(lambda: list(backend.run(Task(compute, (0.0,)), [0])))
    return {
        "Ray is started here": here,
        "a node joins a cluster": node,
        "the first unit on a node, which unpacks code and maps": first,
        "the kernels of an optimizer are compiled": _time_compilation(),
    }


def _time_compilation() -> float:
    with TemporaryDirectory() as folder:
        environment = {**os.environ, "SWARM_GYM_CACHE": folder}
        return seconds_of(
            lambda: run_python("from swarm_gym.warm_up import warm_up_single as w; w('firefly')", environment)
        )


def count_units(units: int, processors: int) -> dict[str, float]:
    """Units per second of no length that go through a backend."""
    found = {}
    for name, backend in (("local", LocalBackend(processors)), ("Ray", RayBackend(None, processors))):
        with closing(backend):
            found[name] = units / time_units(backend, name, Task(compute, (0.0,)), units).wall
    return found


def count_results(units: int, processors: int, run: Run, folder: Path) -> dict[str, float]:
    """Units per second, and the driver's processor time of each, where Ray's workers make up runs.

    Args:
        units: how many, with as many runs as a unit of an evaluation has at most.
        processors: of Ray.
        run: which they copy.
        folder: for a database, on the disk that is measured.
    """
    task = Task(copies, (run, MOST_SEEDS))
    backend = RayBackend(None, processors)
    with closing(backend):
        list(backend.run(task, range(2 * processors)))
        with closing(Results(folder / "results.sqlite")) as results:
            begin, driver = time.perf_counter(), time.process_time()
            for _, runs in backend.run(task, range(units)):
                results.add(*runs)
            wall, driver = time.perf_counter() - begin, time.process_time() - driver
    return {"units per second": units / wall, "driver, seconds per unit": driver / units}


def count_rows(rows: int, run: Run, folder: Path) -> dict[int, float]:
    """Rows per second that the database takes, by how many come at a time."""
    found = {}
    for at_a_time in (1, MOST_SEEDS):
        with closing(Results(folder / f"{at_a_time}.sqlite")) as results:
            batches = [copies(number, run, at_a_time) for number in range(rows // at_a_time)]
            begin = time.perf_counter()
            for runs in batches:
                results.add(*runs)
            found[at_a_time] = len(batches) * at_a_time / (time.perf_counter() - begin)
    return found


def time_runs(suite: Suite, keys: list[RunKey], sample: int) -> list[float]:
    """Seconds of a core of some runs of a suite, drawn from its keys, with what surrounds them."""
    rng = np.random.default_rng(0)
    found = []
    for number in rng.choice(len(keys), min(sample, len(keys)), replace=False):
        run_one(keys[number], suite, {})  # what it loads is loaded
        begin = time.process_time()
        run_one(keys[number], suite, {})
        found.append(time.process_time() - begin)
    return found


def time_training(preset: str, steps: int) -> float:
    """Seconds of a step of training, with all that a training does now and then."""
    with TemporaryDirectory() as folder:
        run = TrainingRun(replace(load_preset(preset), runs=Path(folder), total_steps=steps))
        with contextlib.redirect_stderr(io.StringIO()):  # its progress bars
            seconds = seconds_of(run.run)
        return seconds / run.learner.num_steps
