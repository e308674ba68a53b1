"""Arrays of objects in infos go through Gymnasium's wrappers for other array libraries."""

import pickle

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import DictInfoToList

from swarm_gym.object_arrays import ObjectArray
from swarm_gym.vector_env import SwarmVectorEnv

OPTIONS = {
    "scenario": ["case1", "case2"],
    "iterations": 2,
    "initial_population_size": 6,
    "max_population_size": 12,
}


@pytest.fixture
def torch():
    pytest.importorskip("array_api_compat")
    return pytest.importorskip("torch", reason="needs the extra `study`")


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_torch_takes_all_infos_and_names_stay_names(torch, mode):
    from gymnasium.wrappers.vector import NumpyToTorch

    envs = NumpyToTorch(
        gymnasium.make_vec(
            "swarm_gym/Firefly-v0",
            num_envs=3,
            vectorization_mode="vector_entry_point",
            autoreset_mode=mode,
            made_for="particle-swarm",
            **OPTIONS,
        )
    )
    native = SwarmVectorEnv(3, autoreset_mode=mode, made_for="particle-swarm", **OPTIONS)
    found, expected = envs.reset(seed=4)[1], native.reset(seed=4)[1]
    assert found["scenario"].tolist() == expected["scenario"].tolist()
    assert set(found["scenario"]) == {"case1", "case2"}
    assert found["made_for"].tolist() == ["particle-swarm"] * 3
    action = np.tile([6.0, 0.5], (3, 1))
    for _ in range(2):
        found, expected = envs.step(torch.as_tensor(action))[4], native.step(action)[4]
    assert isinstance(found["best_path"], torch.Tensor)
    np.testing.assert_array_equal(found["best_path"].numpy(), expected["best_path"])
    if mode == AutoresetMode.SAME_STEP:
        assert all(isinstance(last, torch.Tensor) for last in found["final_obs"])
        np.testing.assert_array_equal(np.stack(found["final_obs"]), np.stack(expected["final_obs"]))
        assert found["final_info"]["scenario"].tolist() == expected["final_info"]["scenario"].tolist()


def test_infos_as_a_list_have_the_names():
    envs = DictInfoToList(SwarmVectorEnv(3, **OPTIONS))
    _, infos = envs.reset(seed=4)
    assert {info["scenario"] for info in infos} == {"case1", "case2"}


def test_arrays_of_objects_are_arrays_like_others():
    names = np.array(["case1", "case2", "case1"], dtype=object).view(ObjectArray)
    assert type(names == "case1") is np.ndarray
    assert (names == "case1").tolist() == [True, False, True]
    assert names[[1, 0]].tolist() == ["case2", "case1"]
    assert pickle.loads(pickle.dumps(names)).tolist() == names.tolist()
