"""Episodes of many swarms on a GPU: the simulation whose state stays on the device."""

from typing import cast

import numpy as np
import torch
from numpy.typing import NDArray

from swarm_gym.arrays import tensors
from swarm_gym.errors import DeviceError, SettingError
from swarm_gym.gpu.host import Entry
from swarm_gym.gpu.loop import OPTIMIZERS, PROBLEMS, Entries, entries_for
from swarm_gym.gpu.state import (
    allocate,
    as_kernels_see,
    beside_torch,
    bytes_of,
    require_memory,
    tables_with_lanes,
    torch_device,
    with_numbers,
)
from swarm_gym.gpu.warps import NUM_LANES, launch
from swarm_gym.history import HISTORY
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.population import Swarms
from swarm_gym.problem.padding import columns
from swarm_gym.settings import Settings
from swarm_gym.simulation import Decisions, Simulation
from swarm_gym.worlds import problems_for


class DeviceSimulation(Simulation):
    """A simulation whose swarms live on a GPU, one warp each; see `swarm_gym.simulation.Simulation`.

    Its arrays are tensors on that GPU, which is torch's current one when the simulation is made. A swarm has
    the random numbers that it has on the CPU. Results differ in the last digits, since a GPU rounds
    `a * b + c` once and has functions of its own. Every launch of a kernel waits for its end.

    Raises:
        SettingError: for an optimizer, a kind of map or a length of decision vectors that has no kernels on
            the device, for more swarms than fit into its memory, or if there is no GPU.
    """

    xp = tensors()
    device: torch.device

    def __init__(
        self,
        optimizer: type[Optimizer],
        settings: Settings,
        num_swarms: int,
        num_threads: int | None = None,
        arrival_window: int = 0,
    ):
        self.device = torch_device()
        _refuse_what_has_no_kernels(optimizer, settings)
        memory = _memory_columns(optimizer)
        decided = len(HISTORY) + len(optimizer.parameters) + 3
        needed = bytes_of(num_swarms, settings.max_population_size, memory, decided, settings.iterations)
        require_memory(needed, num_swarms)
        super().__init__(optimizer, settings, num_swarms, num_threads, arrival_window)
        tables = self.worlds.tables
        self._entries: Entries = entries_for(optimizer.name, type(tables))  # type: ignore[arg-type]
        laid_out = tables_with_lanes(tables, self.number)
        placed = type(tables)._make(self.place(np.asarray(array)) for array in laid_out)
        self._tables = as_kernels_see(placed)
        self._seen = as_kernels_see(self.swarms)
        # Tensors that kernels read, so that no argument has to be made for a launch.
        self._sizes = _tensor(self.place(np.zeros(num_swarms, dtype=np.int64)))
        self._degrees = _tensor(self.place(np.zeros(num_swarms, dtype=self.number)))
        self._chosen = _tensor(self.place(np.zeros(num_swarms, dtype=np.bool_)))
        self._decided = _tensor(self.place(np.zeros(self.parameters.shape, dtype=self.number)))

    def make_swarms(self, num_swarms: int, arrival_window: int) -> Swarms:
        """Return the state of this many empty swarms on the device."""
        capacity = self.settings.max_population_size
        swarms = allocate(num_swarms, capacity, _memory_columns(self.optimizer), arrival_window)
        return Swarms._make(self.place(with_numbers(array, self.number)) for array in swarms)

    def begin(self, chosen: NDArray[np.bool_], size: int, given: bool) -> None:
        """Begin the chosen swarms with first populations of this size."""
        self._sizes.fill_(size)
        self._launch(self._entries.begin, chosen, self.parameters, given)

    def advance(self, chosen: NDArray[np.bool_], decisions: Decisions) -> None:
        """Advance the chosen swarms by one iteration."""
        self._sizes.copy_(_tensor(decisions.sizes))
        self._degrees.copy_(_tensor(decisions.repair_degrees))
        self._launch(self._entries.step, chosen, decisions.parameters, self._degrees)

    def re_evaluate(self, chosen: NDArray[np.bool_]) -> None:
        """Evaluate again what the chosen swarms remember, since their problems have changed."""
        self._launch(self._entries.re_evaluate, chosen, self.parameters, False)

    def _launch(
        self, entry: Entry, chosen: NDArray[np.bool_], parameters: NDArray, last: torch.Tensor | bool
    ) -> None:
        """Run an entry for the chosen swarms, and wait for it.

        Raises:
            DeviceError: naming the swarm and the iteration whose state is not a number afterwards, or what
                CUDA says of a kernel that did not run to its end.
        """
        self._chosen.copy_(_tensor(chosen))
        self._decided.copy_(_tensor(parameters))
        weight = self.settings.mean_weight
        try:
            with beside_torch(self.device) as stream:
                read = map(as_kernels_see, (self._chosen, self._sizes, self._decided))
                more = as_kernels_see(last) if isinstance(last, torch.Tensor) else last
                seen = (self._seen, self._tables, *read, weight, more)
                launch(entry, self.num_swarms, *seen, stream=stream)
            # What a position, a fitness or a collision that is no number leaves behind.
            lost = self._chosen & self.xp.isnan(self.swarms.summary).any(axis=1)
            failed = bool(lost.any())
        except Exception as error:
            raise DeviceError(
                f"a kernel for {self.num_swarms} swarms of {self.optimizer.name!r} did not run to its "
                f"end: {error}"
            ) from error
        if failed:
            b = int(lost.nonzero()[0])
            raise DeviceError(
                f"a kernel of {self.optimizer.name!r} failed on swarm {b} in iteration "
                f"{int(self.iteration[b]) + 1}: positions or costs of its members are NaN"
            )


class SinglePrecisionSimulation(DeviceSimulation):
    """A `DeviceSimulation` whose kernels compute in float32.

    Decisions, gaps and records stay in float64.
    """

    number = np.float32


def _tensor(array: NDArray) -> torch.Tensor:
    """Return an array of the simulation as what it is, a tensor."""
    return cast(torch.Tensor, array)


def _memory_columns(optimizer: type[Optimizer]) -> int:
    """Return the numbers that an optimizer stores for a member whose position has a component per lane."""
    return optimizer.memory_columns(NUM_LANES - 1)


def _refuse_what_has_no_kernels(optimizer: type[Optimizer], settings: Settings) -> None:
    if optimizer.name not in OPTIMIZERS:
        raise SettingError(
            f"device 'cuda': optimizer {optimizer.name!r} runs on the CPU only; on a GPU there are "
            f"{', '.join(OPTIMIZERS)}"
        )
    problem = problems_for(settings)[0]
    kind = type(problem.table)
    if kind not in PROBLEMS:
        raise SettingError(
            f"device 'cuda': scenario {problem.scenario.name!r} with encoding {settings.encoding!r} runs on "
            "the CPU only; on a GPU there are waypoints on maps of circles and polygons, and test functions"
        )
    if columns(problem.dimension) > NUM_LANES:
        raise SettingError(
            f"device 'cuda': decision vectors of length {problem.dimension} do not fit into the "
            f"{NUM_LANES} lanes of a warp; at most {NUM_LANES - 1}"
        )
