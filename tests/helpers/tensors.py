"""Simulations on tensors of the CPU, moved by the compiled kernels, and NumPy's that decide as they do."""

import numpy as np
import pytest
import torch
from torch.utils._python_dispatch import TorchDispatchMode

from swarm_gym.arrays import as_numpy, tensors
from swarm_gym.population import Swarms
from swarm_gym.simulation import Decisions, Simulation

pytest.importorskip("array_api_compat", reason="needs the extra `gpu`")


class TensorSimulation(Simulation):
    """A simulation whose state is tensors; kernels work on NumPy arrays that share their memory.

    Attributes:
        decided: decisions of the last step.
    """

    xp = tensors()
    device = torch.device("cpu")
    decided = None

    def step(self, chosen, decisions, measured=True):
        self.decided = decisions
        return super().step(chosen, decisions, measured)

    def begin(self, chosen, size, given):
        sizes = np.full(self.num_swarms, size)
        weight, parameters = self.settings.mean_weight, self.parameters.numpy()
        tables = self.worlds.tables
        self.optimizer.initialise(self._shared(), tables, chosen.numpy(), sizes, weight, given, parameters)

    def advance(self, chosen, decisions):
        decided = (part.numpy() for part in decisions[:3])
        weight = self.settings.mean_weight
        self.optimizer.step(self._shared(), self.worlds.tables, chosen.numpy(), *decided, weight)

    def re_evaluate(self, changed):
        weight = self.settings.mean_weight
        self.optimizer.re_evaluate(self._shared(), self.worlds.tables, changed.numpy(), weight)

    def _shared(self):
        shared = Swarms._make(tensor.numpy() for tensor in self.swarms)
        return shared._replace(stream=shared.stream.view(np.uint64))


class Follower(Simulation):
    """A simulation on NumPy arrays that takes the decisions of a leader, after comparing them with its own.

    Sizes must be equal, and other decisions equal up to the last bits of powers and logarithms.
    """

    leader = None

    def step(self, chosen, decisions, measured=True):
        rows = np.flatnonzero(chosen)
        theirs = Decisions._make(as_numpy(part) for part in self.leader.decided)
        for mine, other in zip(decisions, theirs, strict=True):
            assert mine.dtype == other.dtype
            np.testing.assert_allclose(other[rows], mine[rows], rtol=1e-12)
        return super().step(chosen, theirs, measured)


class Questions(TorchDispatchMode):
    """Counts what would make a program wait for a GPU: values of tensors that it asks for.

    These are single numbers, and indices by flags, whose number of rows is unknown before they are read.

    Attributes:
        asked: names of the operations, in order.
    """

    def __init__(self):
        super().__init__()
        self.asked = []

    def __torch_dispatch__(self, function, types, args=(), kwargs=None):
        name = function.name()
        by_flags = name.startswith("aten::index") and any(
            isinstance(one, torch.Tensor) and one.dtype == torch.bool for one in _flat(args[1])
        )
        if by_flags or name in ("aten::_local_scalar_dense", "aten::nonzero"):
            self.asked.append(name)
        return function(*args, **(kwargs or {}))


def _flat(indices):
    return indices if isinstance(indices, list | tuple) else [indices]
