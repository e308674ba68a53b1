"""The option `device` where there is no GPU, and a first look at the kernels in the simulator."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from swarm_gym.errors import MissingExtraError, SettingError
from swarm_gym.vector_env import SwarmVectorEnv

A_FEW_STEPS = """
from helpers.devices import Pair

pair = Pair(scenario="function:rastrigin-10", num_swarms=2)
pair.reset(seed=0)
for size in (5, 3):
    pair.step(size)
    pair.assert_alike()
print(pair.gpu.swarms.evaluations.tolist())
"""


not_on_macos = pytest.mark.skipif(
    sys.platform == "darwin", reason="needs Linux or Windows: CUDA has no version for macOS"
)


@not_on_macos
def test_swarms_in_the_simulator_are_those_of_the_cpu():
    pytest.importorskip("numba_cuda", reason="needs numba-cuda, of the extra `dev`")
    pytest.importorskip("array_api_compat", reason="needs the extra `gpu`")
    path = os.pathsep.join([str(Path(__file__).parents[1]), str(Path(__file__).parents[2])])
    done = subprocess.run(
        [sys.executable, "-c", A_FEW_STEPS],
        env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert all(evaluations > 4 + 5 for evaluations in eval(done.stdout))


@not_on_macos
@pytest.mark.skipif(bool(numba.config.ENABLE_CUDASIM), reason="NUMBA_ENABLE_CUDASIM=1 turns on the simulator")
def test_without_a_gpu_the_error_names_the_option_and_the_extra(monkeypatch):
    torch = pytest.importorskip("torch")
    pytest.importorskip("numba_cuda", reason="needs numba-cuda, of the extra `dev`")
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(SettingError, match=r"device 'cuda': torch finds no GPU here.*the extra 'gpu'"):
        SwarmVectorEnv(2, device="cuda")


def test_without_numba_cuda_the_error_names_the_extra(monkeypatch):
    for name in [name for name in sys.modules if name.startswith("swarm_gym.gpu")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "numba_cuda", None)
    with pytest.raises(MissingExtraError, match=r"device 'cuda' needs numba-cuda.*swarm_gym\[gpu\]"):
        SwarmVectorEnv(2, device="cuda")
