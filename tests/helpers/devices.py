"""A simulation on the CPU and one on the device, side by side."""

import numba
import numpy as np

from swarm_gym.arrays import as_numpy
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings
from swarm_gym.simulation import Decisions, Simulation

# The simulator computes as the CPU does. A GPU rounds a * b + c once, and has functions of its own.
ROUNDING = {"rtol": 0.0, "atol": 0.0} if numba.config.ENABLE_CUDASIM else {"rtol": 1e-9, "atol": 1e-9}
NUMBERS = ("size", "evaluations", "iteration", "problem")
FLOATS = ("fitness", "collision", "positions", "best_fitness", "best_collision", "best_position")
FLOATS_TOO = ("feasible_fitness", "feasible_position", "memory", "arrivals")


class Pair:
    """A simulation on the CPU and its twin on the device; every call goes to both."""

    def __init__(self, optimizer="firefly", num_swarms=1, window=0, precision="float64", **options):
        from swarm_gym.gpu.simulation import DeviceSimulation, SinglePrecisionSimulation

        on_device = {"float64": DeviceSimulation, "float32": SinglePrecisionSimulation}[precision]
        optimizer = get_optimizer(optimizer)
        settings = Settings.from_options(
            optimizer, {"initial_population_size": 4, "max_population_size": 8, **options}
        )
        self.cpu = Simulation(optimizer, settings, num_swarms, 1, window)
        self.gpu = on_device(optimizer, settings, num_swarms, 1, window)

    def reset(self, seed=0, **options):
        everyone = np.ones(self.cpu.num_swarms, dtype=np.bool_)
        for simulation in (self.cpu, self.gpu):
            seeds = [np.random.SeedSequence([seed, row]) for row in range(self.cpu.num_swarms)]
            simulation.reset(everyone, seeds, options)

    def step(self, size=4, phi=0.0, source=None):
        for simulation in (self.cpu, self.gpu):
            place, number = simulation.place, simulation.num_swarms
            sources = simulation.sources if source is None else place(np.tile(source, (number, 1)))
            decisions = Decisions(
                place(np.full(number, size)), place(np.full(number, phi)), simulation.parameters, sources
            )
            simulation.step(place(np.ones(number, dtype=np.bool_)), decisions)

    def assert_alike(self):
        """Assert that both are in the same state, up to rounding on a GPU."""
        ours, theirs = self.cpu.swarms, self.gpu.swarms
        for name in NUMBERS:
            np.testing.assert_array_equal(getattr(ours, name), as_numpy(getattr(theirs, name)), err_msg=name)
        words = as_numpy(theirs.stream).view(np.uint64)
        np.testing.assert_array_equal(ours.stream, words, err_msg="stream")
        dimension = self.cpu.dimension
        for b in range(self.cpu.num_swarms):
            size = ours.size[b]
            for name in (*FLOATS, *FLOATS_TOO):
                mine, its = getattr(ours, name)[b], as_numpy(getattr(theirs, name))[b]
                if name == "memory":
                    mine, its = _particles(mine[:size], its[:size], dimension)
                elif name.endswith(("position", "positions")):
                    mine, its = mine[..., :dimension], its[..., :dimension]
                if name in ("fitness", "collision", "positions"):
                    mine, its = mine[:size], its[:size]
                np.testing.assert_allclose(its, mine, **ROUNDING, err_msg=name)
        summary = as_numpy(theirs.summary)
        np.testing.assert_allclose(summary[:, :4], ours.summary[:, :4], **ROUNDING)
        np.testing.assert_allclose(summary[:, 4], ours.summary[:, 4], rtol=1e-9, atol=1e-9)


def _particles(mine, its, dimension):
    """Return velocities, best positions and their fitness, whose columns are padded differently."""
    if not mine.shape[1]:
        return mine, its
    found = []
    for memory in (mine, its):
        width = (memory.shape[1] - 1) // 2
        parts = (memory[:, :dimension], memory[:, width : width + dimension], memory[:, -1:])
        found.append(np.hstack(parts))
    return found
