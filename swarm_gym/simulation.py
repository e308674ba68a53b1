"""Episodes of an optimizer: many swarms at once, on one or several problems.

Everything here but the compiled kernels works on the arrays of any library, see `swarm_gym.arrays`. What a
subclass with other arrays defines is listed at `Simulation`.
"""

from collections.abc import Callable, Mapping
from functools import cached_property, partial
from typing import ClassVar, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from swarm_gym.arrays import Namespace, as_numpy, assign, floats, placed
from swarm_gym.best_paths import BestPaths
from swarm_gym.checks import require_integer
from swarm_gym.compiler.cache import announce_compilation
from swarm_gym.history import columns_of, end_iteration, forget, record
from swarm_gym.measures import Gaps, Prices
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.population import Swarms
from swarm_gym.problem import Problem
from swarm_gym.problem.onemax.table import OneMaxTable
from swarm_gym.reset_options import Beginning, Seeds, draw_beginnings, read_reset_options
from swarm_gym.robots import make_robots
from swarm_gym.settings import Settings
from swarm_gym.sources import KIND_OF_BENDS, kind_of_bends
from swarm_gym.worlds import Worlds

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

NO_BUDGET = np.iinfo(np.int64).max


class Decisions(NamedTuple):
    """The decisions on one iteration of B swarms."""

    sizes: Integers  # (B,) population sizes
    repair_degrees: Floats  # (B,) phi in [0, 1]
    parameters: Floats  # (B, number of parameters) of the optimizer, in the order of its class of parameters
    sources: Floats  # (B, 3) sources of new members, in the order of `sources.SOURCE_DECISIONS`


class Simulation:
    """A simulation of B swarms of one optimizer, advanced one iteration at a time.

    The result of a swarm depends only on its seed and decisions: not on B, the other swarms or the number of
    threads. All public arrays have B as their first axis and are changed in place.

    A subclass keeps this state in tensors if it sets `xp` and `device`, and runs kernels on them: it defines
    `begin`, `advance` and `re_evaluate`. It may also define `make_swarms` and `place`. Nothing in `step` asks
    for the value of a tensor.

    Attributes:
        xp: namespace of the arrays: the module `numpy`, or `swarm_gym.arrays.tensors()` in a subclass.
        device: device of the arrays, as the library of the arrays names it.
        number: type of the floats that kernels compute with.
        rows: (B,) numbers of the swarms, 0 to B - 1.
        worlds: problems of the scenarios that episodes draw from; `problems` is its attribute, too.
        robots: robots that drive during planning; None if no robot does.
        dimension: length of a decision vector.
        swarms: state that the kernels work on.
        paths: the best paths so far, as points on the map.
        gaps: gaps of the best fitness so far.
        prices: prices of evaluations in the present episodes.
        iteration: (B,) iterations done in this episode.
        running: (B,) whether an episode is under way.
        columns: names of the columns of `history`: `HISTORY`, then the optimizer's parameters, and
            `SOURCE_DECISIONS` if actions decide them.
        history: (B, iterations + 1, number of columns) the record.
        parameters: (B, number of parameters) of the optimizer, where no action decides them.
        sources: (B, 3) sources of new members, where no action decides them.
    """

    xp: ClassVar[Namespace] = np
    device: object = "cpu"
    number: ClassVar[type[np.floating]] = np.float64

    def __init__(
        self,
        optimizer: type[Optimizer],
        settings: Settings,
        num_swarms: int,
        num_threads: int | None = None,
        arrival_window: int = 0,
    ):
        require_integer("num_envs", num_swarms, 1)
        most = numba.config.NUMBA_NUM_THREADS
        if num_threads is not None:
            require_integer("num_threads", num_threads, 1, most)
        announce_compilation()
        self.optimizer = optimizer
        self.settings = settings
        self.num_threads = num_threads or most
        self.worlds = Worlds(settings, num_swarms)
        self._anything_happens = self.worlds.ever_change
        self._may_arrive = bool(np.isfinite(self.worlds.targets).any())
        self.worlds.place(self.place)
        self.problems = self.worlds.problems
        self.dimension = self.problems[0].dimension
        self.swarms = self.make_swarms(num_swarms, arrival_window)
        self.paths = BestPaths(self.swarms, self.worlds)
        self.gaps = Gaps(self.swarms, self.worlds, self.place(np.ones(num_swarms)))
        self.prices = Prices(self.place(np.zeros(num_swarms)), settings)
        self.swarms.source[:, KIND_OF_BENDS] = kind_of_bends(settings.bends)
        self.sources = self.place(np.tile(settings.new_members.decisions, (num_swarms, 1)))
        self._begun_otherwise = False  # whether a first population had another source than these
        self.swarms.iterations[:] = settings.iterations
        self.robots = make_robots(self.worlds, settings, optimizer, self.swarms, self.xp)
        self._anything_happens |= self.robots is not None
        self.parameters = self.place(optimizer.stacked_parameters(settings.knobs, num_swarms))
        self.iteration = self.swarms.iteration
        self.rows = self.place(np.arange(num_swarms))
        self.running = self.place(np.zeros(num_swarms, dtype=np.bool_))
        self.columns = columns_of(optimizer, settings)
        self.history = self.place(np.zeros((num_swarms, settings.iterations + 1, len(self.columns))))

    @property
    def may_end_early(self) -> bool:
        """True if an episode can end before its last iteration: by a budget, an arrival or an optimum."""
        return self.settings.max_evaluations is not None or self._may_arrive or self.robots is not None

    def full(self, value: float) -> Floats:
        """Return (B,) this value for each swarm."""
        return self.xp.full(self.num_swarms, value, dtype=self.xp.float64, device=self.device)

    def make_swarms(self, num_swarms: int, arrival_window: int) -> Swarms:
        """Return the state of this many empty swarms, in the arrays of this simulation.

        Args:
            num_swarms: number of swarms, B.
            arrival_window: number of iterations whose new members are recorded.
        """
        optimizer, capacity, tables = self.optimizer, self.settings.max_population_size, self.worlds.tables
        swarms = Swarms.allocate(
            num_swarms,
            capacity,
            self.dimension,
            optimizer.memory_columns(self.dimension),
            optimizer.num_registers(capacity),
            optimizer.field_size(tables),
            optimizer.walk_points(tables, self.settings.iterations),
            arrival_window,
        )
        return Swarms._make(map(self.place, swarms))

    def place(self, array: NDArray) -> NDArray:
        """Return a NumPy array as an array of this simulation, on its device.

        Words of random streams, uint64, become int64 with the same bits in tensors.
        """
        return placed(self.xp, array, self.device)

    @property
    def num_swarms(self) -> int:
        """Number of swarms, B."""
        return len(self.iteration)

    def reset(
        self,
        chosen: Flags,
        seeds: Seeds,
        options: Mapping[str, object] | None = None,
    ) -> None:
        """Begin new episodes in the chosen swarms.

        Args:
            chosen: (B,) swarms that begin an episode, an array of NumPy or of this simulation.
            seeds: one seed per chosen swarm, which determines the scenario and all random numbers: their
                entropies, (k, words), or a list of k seed sequences, which are left with two more children.
            options: `scenario` (the name of one of this environment's), `initial_population_size`,
                `smooth_share` and `amplitude` of the first population, or `initial_population` (decision
                vectors, shape (members, dimension), in map units).

        Raises:
            UnknownNameError: for an option or scenario that does not exist.
            SettingError: for a value that an option cannot have.
            ValueError: if there are not as many seeds as chosen swarms.
        """
        size, population, scenario, source = self.read_options(options)
        swarms, numbers = self.swarms, np.flatnonzero(as_numpy(chosen))
        budget = self.settings.max_evaluations
        if len(seeds) != len(numbers):
            raise ValueError(f"expected {len(numbers)} seeds, one per chosen swarm, got {len(seeds)}")
        drawn = draw_beginnings(seeds, self.settings, self.worlds, scenario)
        place, rows = self.place, self.place(numbers)
        swarms.problem[rows], swarms.stream[rows] = place(drawn.problem), place(drawn.stream)
        self.prices.of_reference[rows] = place(drawn.price)
        swarms.budget[rows] = NO_BUDGET if budget is None else budget
        if population is not None:
            given = np.asarray(population, dtype=self.number)
            swarms.positions[rows, :size, : self.dimension] = place(given)
        self._begun_otherwise |= source.decisions != self.settings.new_members.decisions
        swarms.source[rows, :KIND_OF_BENDS] = place(np.array(source.decisions, dtype=self.number))
        forget(self.history, rows, swarms)
        self.iteration[rows] = 0
        if self.robots is not None:
            self.robots.begin(rows)
        chosen = place(as_numpy(chosen))
        self.begin(chosen, size, population is not None)
        self.running[rows] = True
        self._record(chosen, self.full(0.0), self.parameters)
        self.gaps.initial[rows] = self.gaps.now()[rows]

    def begin(self, chosen: Flags, size: int, given: bool) -> None:
        """Begin the chosen swarms with first populations of this size, by the compiled kernels.

        Args:
            chosen: (B,) swarms to begin; `reset` has written their problems, streams, budgets and sources.
            size: size of the populations.
            given: whether the first `size` positions of each swarm are its population, which is else drawn.
        """
        sizes = np.full(self.num_swarms, size, dtype=np.int64)
        mean_weight, parameters = self.settings.mean_weight, self.parameters
        self.optimizer.initialise(
            self.swarms, self.worlds.tables, chosen, sizes, mean_weight, given, parameters
        )

    def step(self, chosen: Flags, decisions: Decisions, measured: bool = True) -> Floats:
        """Advance the chosen swarms by one iteration as decided, and apply the events that follow it.

        Args:
            chosen: (B,) swarms to advance.
            decisions: decisions on all swarms.
            measured: whether gaps are asked for.

        Returns:
            (B,) the gap after the iteration, before any event; anything if it is not asked for.
        """
        if decisions.sources is not self.sources or self._begun_otherwise:
            assign(self.xp, self.swarms.source[:, :KIND_OF_BENDS], decisions.sources, chosen[:, None])
        if self.xp is np and not self._anything_happens:
            self._advance(chosen, decisions, partial(self._end_iteration, decisions))
            return self.gaps.now() if measured else self.gaps.initial
        self.advance(chosen, decisions)
        self.iteration += chosen
        reached, ended = self.gaps.now(), self._ended()
        if self._anything_happens:
            self._let_happen(chosen & ~ended)
            ended = self._ended()
        self._record(chosen, decisions.repair_degrees, decisions.parameters)
        self.running &= ~(chosen & ended)
        return reached

    def _end_iteration(self, decisions: Decisions, part: Flags) -> None:
        """Count, record and end an iteration of a thread's swarms, (B,), without events, in one call."""
        targets = self.worlds.targets
        phi, parameters = decisions.repair_degrees, decisions.parameters
        end_iteration(self.history, part, self.swarms, self.running, targets, phi, parameters)

    def advance(self, chosen: Flags, decisions: Decisions) -> None:
        """Advance the chosen swarms by one iteration, by the compiled kernels.

        Args:
            chosen: (B,) swarms to advance; `step` has written their sources and counts the iteration.
            decisions: decisions on all swarms; those on other swarms than the chosen may be anything.
        """
        self._advance(chosen, decisions, None)

    def _advance(self, chosen: Flags, decisions: Decisions, then: Callable[[Flags], None] | None) -> None:
        """Do what `advance` does, and let each thread call a function at last, see `Optimizer.step`."""
        self.optimizer.step(
            self.swarms,
            self.worlds.tables,
            chosen,
            decisions.sizes,
            decisions.repair_degrees,
            decisions.parameters,
            self.settings.mean_weight,
            self.num_threads,
            then,
        )

    def _let_happen(self, going: Flags) -> None:
        """Apply what follows the iteration that these swarms, (B,), have done: events, then drives."""
        before, next_event = self.gaps.now(), self.worlds.next_event[self.swarms.problem]
        changed = going & (next_event > 0) & (next_event <= self.iteration)
        if self.robots is not None:
            changed = self.robots.enter_next_worlds(changed)
        else:
            self.swarms.problem[...] += changed
        self._re_evaluate(changed, before)
        if self.robots is not None:
            before = self.gaps.now()
            self._re_evaluate(self.robots.drive(going & ~self._ended()), before)

    def _re_evaluate(self, changed: Flags, before: Floats) -> None:
        """Evaluate the memory of swarms whose problems have changed, (B,), again.

        Args:
            changed: (B,) swarms whose problems have changed.
            before: (B,) gaps before the change.
        """
        if self.xp is np and not changed.any():
            return  # kernels on tensors get no swarm to evaluate instead, so that nothing waits for a GPU
        self.re_evaluate(changed)
        self.gaps.carry_over(before, changed)

    def re_evaluate(self, changed: Flags) -> None:
        """Evaluate the memory of these swarms, (B,), again, by the compiled kernels; there may be none."""
        mean_weight, num_threads = self.settings.mean_weight, self.num_threads
        self.optimizer.re_evaluate(self.swarms, self.worlds.tables, changed, mean_weight, num_threads)

    def _ended(self) -> Flags:
        swarms = self.swarms
        ended = (self.iteration >= self.settings.iterations) | (swarms.evaluations >= swarms.budget)
        if self._may_arrive:
            ended |= swarms.best_fitness <= self.worlds.targets[swarms.problem]
        return ended

    def copy_rows(self, rows: Integers) -> None:
        """Make swarm i, for every i, a copy of swarm rows[i]: state, random stream and record."""
        rows = self.place(as_numpy(rows))
        state = (self.running, self.history, self.gaps.initial, self.prices.of_reference)
        for array in (*self.swarms, *state):
            array[...] = array[rows]
        if self.robots is not None:
            self.robots.copy_rows(rows)

    def detours(self) -> Floats:
        """Return (B,) detours, see `Robots.detours`; infinity where no robot drives."""
        return self.full(np.inf) if self.robots is None else self.robots.detours()

    def lengths(self) -> Floats:
        """Return (B,) lengths of the bit strings; only on scenarios of bit strings."""
        tables = self.worlds.tables
        assert isinstance(tables, OneMaxTable)
        return floats(self.xp, tables.size[self.swarms.problem])

    def positions(self, row: int) -> Floats:
        """Return the positions of the living members of a swarm, (size, dimension), a view."""
        return self.swarms.positions[row, : self.swarms.size[row], : self.dimension]

    def best_position(self, row: int) -> Floats:
        """Return the best position so far of a swarm, (dimension,), a view."""
        return self.swarms.best_position[row, : self.dimension]

    def trajectory(self, row: int) -> Floats:
        """Return (k, 2) the points that the robot of a swarm has passed, in map coordinates.

        It is empty if the robot only plans.
        """
        if self.robots is not None:
            return np.array(self.robots.trajectories[row]).reshape(-1, 2)
        return as_numpy(self.swarms.walk[row, : self.swarms.walked[row]]).copy()

    def problem_of(self, row: int) -> Problem:
        """Return the problem that a swarm works on."""
        return self.problems[self.swarms.problem[row]]

    def read_options(self, options: Mapping[str, object] | None) -> Beginning:
        """Return how the episodes of these reset options begin.

        Raises:
            UnknownNameError: for an option or scenario that does not exist.
            SettingError: for a value that an option cannot have.
        """
        if options is None:
            return self._usual_beginning
        return read_reset_options(options, self.settings, self.optimizer, self.worlds)

    @cached_property
    def _usual_beginning(self) -> Beginning:
        return read_reset_options(None, self.settings, self.optimizer, self.worlds)

    def _record(self, chosen: Flags, repair_degrees: Floats, parameters: Floats) -> None:
        """Write the present state of the chosen swarms, (B,), into `history`."""
        feasible_fitness = self.paths.feasible_fitness()
        record(self.history, self.rows, chosen, self.swarms, feasible_fitness, repair_degrees, parameters)
