"""The interface between an optimizer and the simulation."""

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from itertools import pairwise
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from swarm_gym.optimizers import loop
from swarm_gym.optimizers.parameter import Parameter, Parameters, declared_parameters
from swarm_gym.population import Swarms
from swarm_gym.problem.tables import Tables

Flags = NDArray[np.bool_]


class Optimizer:
    """Names, parameters and kernels of an optimizer, and the calls that advance swarms with them.

    All arrays have a leading swarm axis of length B. All calls change `swarms` in place, and leave
    E(P), mean and standard deviation of the collision and the feasible share in `swarms.summary`.

    Attributes:
        name: name under which the optimizer is registered.
        parameter_class: NamedTuple whose fields declare the parameters; no other optimizer has the same.
        parameters: declarations of the parameters, by name; made from `parameter_class`.
        defaults: object of `parameter_class` with the defaults; its class chooses the kernels.
        smallest_population: smallest population size.
        encodings: possible names of `Settings.encoding`; the first is the default.
        adopts: whether a given population can be the first one.
        begins_with_robot: whether the first member is a robot that moves while its path is being planned.
        evaluations_per_member: evaluations that a member takes in an iteration, about.
        repairs: whether a repair degree above 0 has a meaning.
        default_options: options of environments whose defaults differ for this optimizer.
        kernels: kernels that work on one swarm.
    """

    name: ClassVar[str]
    parameter_class: ClassVar[type]
    parameters: ClassVar[dict[str, Parameter]]
    defaults: ClassVar[Parameters]
    smallest_population: ClassVar[int] = 1
    encodings: ClassVar[tuple[str, ...]] = ("waypoints", "bezier", "shifted", "spherical")
    adopts: ClassVar[bool] = True
    begins_with_robot: ClassVar[bool] = False
    evaluations_per_member: ClassVar[float] = 1.0
    repairs: ClassVar[bool] = True
    default_options: ClassVar[Mapping[str, object]] = {}
    kernels: ClassVar[loop.Kernels]

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.parameters = declared_parameters(cls.parameter_class)
        cls.defaults = cls.parameter_values({})
        loop.register(cls.parameter_class, cls.kernels)

    @classmethod
    def initialise(
        cls,
        swarms: Swarms,
        tables: Tables,
        chosen: Flags,
        sizes: NDArray[np.int64],
        mean_weight: float,
        given: bool = False,
        parameters: NDArray[np.float64] | None = None,
    ) -> None:
        """Begin the chosen swarms with first populations of these sizes, (B,).

        Populations are drawn, or are the first rows of the positions if these are `given`. Without
        `parameters`, see `step`, all have their defaults.
        """
        if parameters is None:
            parameters = cls.stacked_parameters({}, len(sizes))
        begin = loop.adopt_chosen if given else loop.begin_chosen
        begin(cls.defaults, swarms, tables, chosen, sizes, parameters, mean_weight)

    @classmethod
    def step(
        cls,
        swarms: Swarms,
        tables: Tables,
        chosen: Flags,
        sizes: NDArray[np.int64],
        repair_degrees: NDArray[np.float64],
        parameters: NDArray[np.float64],
        mean_weight: float,
        num_threads: int = 1,
        then: Callable[[Flags], None] | None = None,
    ) -> None:
        """Resize the chosen swarms and advance them by one iteration.

        Args:
            swarms: state of the swarms.
            tables: stacked problem tables.
            chosen: (B,) which swarms take part.
            sizes: (B,) population sizes of this iteration.
            repair_degrees: (B,) phi in [0, 1]; 0 is no repair.
            parameters: (B, number of parameters), in the order of the fields of `parameter_class`.
            mean_weight: k of eq. 7.
            num_threads: number of threads that share the swarms; results do not depend on it.
            then: function that each thread calls at last, with the flags (B,) of its swarms.
        """

        def run(part: Flags) -> None:
            loop.step_chosen(
                cls.defaults, swarms, tables, part, sizes, repair_degrees, parameters, mean_weight
            )
            if then is not None:
                then(part)

        spread(run, chosen, num_threads)

    @classmethod
    def re_evaluate(
        cls,
        swarms: Swarms,
        tables: Tables,
        chosen: Flags,
        mean_weight: float,
        num_threads: int = 1,
    ) -> None:
        """Evaluate again what the chosen swarms remember, since their problems have changed.

        Members come first, in order; members for which the budget does not suffice are deleted. The budget
        must have at least one evaluation left. The best so far stays only if it is still the best.
        """

        def run(part: Flags) -> None:
            loop.re_evaluate_chosen(cls.defaults, swarms, tables, part, mean_weight)

        spread(run, chosen, num_threads)

    @staticmethod
    def decision_vectors(swarms: Swarms, row: int, dimension: int) -> list[NDArray[np.float64]]:
        """Return all decision vectors that a swarm remembers, views (m, dimension), its members first."""
        size = swarms.size[row]
        return [swarms.positions[row, :size, :dimension], swarms.best_position[row : row + 1, :dimension]]

    @staticmethod
    def memory_columns(dimension: int) -> int:  # noqa: ARG004
        """Return K, how many numbers a swarm stores for each member, for this length of decision vectors."""
        return 0

    @staticmethod
    def num_registers(capacity: int) -> int:  # noqa: ARG004
        """Return R, how many integers a swarm of up to `capacity` members stores."""
        return 0

    @staticmethod
    def walk_points(tables: Tables, iterations: int) -> int:  # noqa: ARG004
        """Return L, the most points of a remembered walk, in episodes on these problems."""
        return 0

    @staticmethod
    def field_size(tables: Tables) -> int:  # noqa: ARG004
        """Return F, how many numbers a swarm stores for the cells of the largest of these maps."""
        return 0

    @staticmethod
    def counts(swarms: Swarms) -> Mapping[str, NDArray[np.int64]]:  # noqa: ARG004
        """Return what `info` tells besides of an optimizer's swarms, by name: views (B,) of its registers."""
        return {}

    @classmethod
    def affordable_size(cls, evaluations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return real-valued population sizes, (B,), whose iterations take about these evaluations, (B,)."""
        return evaluations / cls.evaluations_per_member

    @classmethod
    def decided_parameters(cls) -> dict[str, Parameter]:
        """Return the parameters that extended actions set, by name."""
        return {name: each for name, each in cls.parameters.items() if each.decided is not None}

    @classmethod
    def parameter_values(cls, chosen: Mapping[str, float | str]) -> Parameters:
        """Return the parameters of one swarm: chosen values, else defaults; names become their indices.

        Raises:
            SettingError: if a value is not a number in its range.
            UnknownNameError: if a value is none of the parameter's choices.
        """
        return cls.parameter_class(
            **{
                name: each.number(name, chosen[name]) if name in chosen else each.default
                for name, each in cls.parameters.items()
            }
        )

    @classmethod
    def stacked_parameters(cls, chosen: Mapping[str, float | str], num_swarms: int) -> NDArray[np.float64]:
        """Return `parameter_values` for B swarms, (B, number of parameters), see `step`."""
        return np.tile(cls.parameter_values(chosen), (num_swarms, 1))


def spread(run: Callable[[Flags], None], chosen: Flags, num_threads: int) -> None:
    """Call `run` with the chosen swarms, (B,), or with parts of them in up to `num_threads` threads.

    These are Python's threads and not Numba's: kernels need not be compiled for them again, and an idle
    thread does not spin. Kernels release the interpreter lock. The calling thread takes part. All parts are
    done when the function returns.

    Args:
        run: function of a boolean array (B,) of swarms.
        chosen: (B,) swarms to run.
        num_threads: number of threads, the calling one included.
    """
    if min(num_threads, len(chosen)) < 2:  # the fast path of a single environment, at every step
        run(chosen)
        return
    rows = np.flatnonzero(chosen)
    num_parts = min(num_threads, len(rows))
    if num_parts < 2:
        run(chosen)
        return
    parts = np.zeros((num_parts, len(chosen)), dtype=np.bool_)
    edges = [0, *(rows[k * len(rows) // num_parts] for k in range(1, num_parts)), len(chosen)]
    for part, (first, last) in zip(parts, pairwise(edges), strict=True):
        part[first:last] = chosen[first:last]
    others = [_pool(os.getpid(), num_threads - 1).submit(run, part) for part in parts[1:]]
    try:
        run(parts[0])
    finally:
        wait(others)
    for other in others:
        other.result()


@cache
def _pool(process: int, num_threads: int) -> ThreadPoolExecutor:  # noqa: ARG001
    # Each process has its own pool, since threads do not survive a fork.
    return ThreadPoolExecutor(num_threads, thread_name_prefix="swarm_gym")
