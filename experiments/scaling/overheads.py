"""Overheads of backends, measured on this machine with units of known length."""

import dataclasses
import multiprocessing
import os
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, cast

from agents.backends import Backend, Task
from agents.backends.local import LocalBackend
from agents.backends.ray_backend import RayBackend
from experiments.runs.database import Results
from experiments.runs.run import Run
from experiments.runs.runner import MOST_SEEDS
from experiments.speed.measurement import run_python, seconds_of
from swarm_gym.errors import MissingExtraError


@dataclass(frozen=True)
class Timed:
    """A measurement of units of work that were carried out.

    Attributes:
        backend: name of the backend.
        work: name of the function of a unit.
        workers: number of units at a time.
        units: number of units.
        seconds: length of a unit.
        wall: wall time of all units in seconds.
    """

    backend: str
    work: str
    workers: int
    units: int
    seconds: float
    wall: float

    @property
    def ideal(self) -> float:
        """Return the wall time without overhead, in seconds."""
        return self.units * self.seconds / self.workers

    @property
    def overhead(self) -> float:
        """Return the overhead as a share of the ideal wall time."""
        return self.wall / self.ideal - 1.0


def compute(_: int, seconds: float) -> None:
    """Use a processor for some seconds of processor time; on a shared processor, this takes longer."""
    begin = time.process_time()
    while time.process_time() - begin < seconds:
        pass


def compute_together(barrier: Any, units: int, seconds: float) -> None:
    """Wait until all processes are ready, then compute some units."""
    barrier.wait()
    for number in range(units):
        compute(number, seconds)


def wait(_: int, seconds: float) -> None:
    """Sleep for some seconds without using a processor, so that there can be more workers than cores."""
    time.sleep(seconds)


def copies(number: int, run: Run, count: int) -> list[Run]:
    """Return copies of a run with seeds of their own, as a unit of an evaluation returns runs."""
    return [dataclasses.replace(run, seed=number * count + k) for k in range(count)]


@contextmanager
def logical_cluster(nodes: int, processors: int) -> Iterator[tuple[RayBackend, Any]]:
    """Start a cluster of logical nodes on this machine, beside a head node without processors.

    Args:
        nodes: number of nodes.
        processors: number of processors of each node; it may exceed that of the machine.

    Yields:
        A backend that uses the nodes, and the cluster, a `ray.cluster_utils.Cluster`.

    Raises:
        MissingExtraError: if Ray is missing.
    """
    try:
        from ray.cluster_utils import Cluster
    except ImportError as error:
        raise MissingExtraError("a logical cluster", "Ray", "ray") from error
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    backend = RayBackend(cluster.address, 0)
    try:
        for _ in range(nodes):
            cluster.add_node(num_cpus=processors)
        yield backend, cluster
    finally:
        backend.close()
        cluster.shutdown()


def time_units(backend: Backend, name: str, task: Task, units: int) -> Timed:
    """Measure units of a task, whose last argument is their length; workers are started before."""
    workers, seconds = backend.workers(), cast(float, task.common[-1])
    list(backend.run(Task(task.function, (0.5,)), range(2 * workers)))
    wall = seconds_of(lambda: list(backend.run(task, range(units))))
    return Timed(name, task.function.__name__, workers, units, seconds, wall)


def time_processes(units: int, seconds: float, processors: int) -> Timed:
    """Measure units that compute in plain processes, without a backend: the machine's own overhead."""
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
    """Measure units that compute: without a backend, with the local one, and with Ray on this machine."""
    yield time_processes(units, seconds, processors)
    for name, backend in (("local", LocalBackend(processors)), ("Ray", RayBackend(None, processors))):
        with closing(backend):
            yield time_units(backend, name, Task(compute, (seconds,)), units)


def time_nodes(nodes: int, processors: int, work: str, per_worker: int, seconds: float) -> Timed:
    """Measure units on logical nodes, which may have more processors than the machine if units only wait."""
    task = Task({"compute": compute, "wait": wait}[work], (seconds,))
    with logical_cluster(nodes, processors) as (backend, _):
        name = f"{nodes} node{'s' if nodes > 1 else ''} of {processors}"
        return time_units(backend, name, task, per_worker * nodes * processors)


def time_start(processors: int) -> dict[str, float]:
    """Return the seconds before the first unit begins, by what they are spent on."""
    backend = RayBackend(None, processors)
    with closing(backend):
        here = seconds_of(backend.workers)
    with logical_cluster(0, 1) as (backend, cluster):
        backend.workers()  # connects
        node = seconds_of(lambda: cluster.add_node(num_cpus=1))
        first = seconds_of(lambda: list(backend.run(Task(compute, (0.0,)), [0])))
    return {
        "Ray is started here": here,
        "a node joins a cluster": node,
        "the first unit on a node, which unpacks code and maps": first,
        "the kernels of an optimizer are compiled": _time_compilation(),
    }


def _time_compilation() -> float:
    """Return the seconds for compiling the kernels of an optimizer in a fresh interpreter."""
    with TemporaryDirectory() as folder:
        environment = {**os.environ, "SWARM_GYM_CACHE": folder}
        return seconds_of(
            lambda: run_python("from swarm_gym.warm_up import warm_up_single as w; w('firefly')", environment)
        )


def count_units(units: int, processors: int) -> dict[str, float]:
    """Return how many units of no length each backend carries out per second."""
    found = {}
    for name, backend in (("local", LocalBackend(processors)), ("Ray", RayBackend(None, processors))):
        with closing(backend):
            found[name] = units / time_units(backend, name, Task(compute, (0.0,)), units).wall
    return found


def count_results(units: int, processors: int, run: Run, folder: Path) -> dict[str, float]:
    """Return units per second, and the driver's processor time per unit, if Ray's workers return copied runs.

    Args:
        units: number of units, each with as many runs as a unit of an evaluation has at most.
        processors: number of processors that Ray uses.
        run: run that is copied.
        folder: folder for a database, on the disk to measure.
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
    """Return how many rows per second the database stores, by the number of rows per transaction."""
    found = {}
    for at_a_time in (1, MOST_SEEDS):
        with closing(Results(folder / f"{at_a_time}.sqlite")) as results:
            batches = [copies(number, run, at_a_time) for number in range(rows // at_a_time)]
            begin = time.perf_counter()
            for runs in batches:
                results.add(*runs)
            found[at_a_time] = len(batches) * at_a_time / (time.perf_counter() - begin)
    return found
