"""Kernels compile for a GPU, even where there is none; it takes the compiler of the extra `gpu`."""

import types

import numba
import numpy as np
import pytest

from swarm_gym.optimizers import get_optimizer
from swarm_gym.population import Swarms
from swarm_gym.problem.tables import stack
from swarm_gym.worlds import make_problem

pytestmark = pytest.mark.slow
HOPPER = (9, 0)  # compute capability


@pytest.fixture
def compile_for_hopper(monkeypatch):
    """A function that compiles an entry for arguments of these types, and returns its PTX."""
    if numba.config.ENABLE_CUDASIM:
        pytest.skip("NUMBA_ENABLE_CUDASIM=1 turns on the simulator, which compiles nothing")
    from numba import cuda
    from numba.cuda import dispatcher

    device = types.SimpleNamespace(compute_capability=HOPPER)
    monkeypatch.setattr(dispatcher, "get_current_device", lambda: device)

    def compiled(entry, arguments):
        try:
            return cuda.compile_ptx(entry.py_func, tuple(map(numba.typeof, arguments)), cc=HOPPER)[0]
        except Exception as error:
            if "libnvrtc" in str(error) or "libnvvm" in str(error):
                pytest.skip("NVIDIA's compiler is not installed: pip install '.[gpu]' brings it")
            raise

    return compiled


@pytest.mark.parametrize("number", [np.float64, np.float32])
@pytest.mark.parametrize("scenario", ["case1", "function:rastrigin-10"])
@pytest.mark.parametrize("optimizer", ["firefly", "particle-swarm"])
def test_every_entry_compiles(compile_for_hopper, optimizer, scenario, number):
    from swarm_gym.gpu.loop import entries_for
    from swarm_gym.gpu.state import allocate, tables_with_lanes, with_numbers

    tables = stack([make_problem(scenario).table])
    empty = allocate(2, 4, get_optimizer(optimizer).memory_columns(31), 5)
    swarms = Swarms._make(with_numbers(array, number) for array in empty)
    chosen, sizes = np.ones(2, dtype=np.bool_), np.ones(2, dtype=np.int64)
    arguments = (swarms, tables_with_lanes(tables, number), chosen, sizes, np.ones((2, 6), number), 0.9)
    entries = entries_for(optimizer, type(tables))
    for entry, last in (
        (entries.begin, False),
        (entries.step, np.ones(2, number)),
        (entries.re_evaluate, False),
    ):
        code = compile_for_hopper(entry, (*arguments, last))
        assert ".target sm_90" in code
        assert "shfl.sync" in code
