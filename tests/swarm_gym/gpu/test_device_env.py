"""Vector environments on a GPU: the same observations, rewards and endings; what they refuse, and how."""

import re

import gymnasium
import numpy as np
import pytest

from helpers.devices import ROUNDING
from swarm_gym.arrays import as_numpy
from swarm_gym.errors import DeviceError, SettingError, UnknownNameError

torch = pytest.importorskip("torch")
RASTRIGIN = "function:rastrigin-10"


def make(device, optimizer="Firefly", num_envs=2, **options):
    options = {
        "scenario": RASTRIGIN, "iterations": 3, "initial_population_size": 4, "max_population_size": 8,
        **options,
    }  # fmt: skip
    return gymnasium.make_vec(f"swarm_gym/{optimizer}-v0", num_envs=num_envs, device=device, **options)


def assert_close(ours, theirs):
    np.testing.assert_allclose(as_numpy(theirs), ours, rtol=max(ROUNDING["rtol"], 1e-12), atol=1e-12)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_an_episode_is_that_of_the_cpu(mode):
    modes = {
        "autoreset_mode": gymnasium.vector.AutoresetMode(mode),
        "action": "extended",
        "observation": "paper",
    }
    ours, theirs = make("cpu", **modes), make("cuda", **modes)
    assert (ours.observation_space, ours.action_space) == (theirs.observation_space, theirs.action_space)
    assert_close(ours.reset(seed=5)[0], theirs.reset(seed=5)[0])
    rng = np.random.default_rng(0)
    for _ in range(5):
        low, high = ours.action_space.low, ours.action_space.high
        action = rng.uniform(low, np.minimum(high, 6.0))
        mine, its = ours.step(action), theirs.step(torch.as_tensor(action))
        assert all(isinstance(one, torch.Tensor) for one in its[:4])
        for one, other in zip(mine[:4], its[:4], strict=True):
            assert_close(one, other)
        for name in ("best_fitness", "evaluations", "population_size"):
            assert_close(mine[4][name], its[4][name])
        assert ("final_info" in mine[4]) == ("final_info" in its[4])
        if "final_info" in mine[4]:
            assert_close(mine[4]["final_info"]["best_path"], its[4]["final_info"]["best_path"])
            assert_close(np.stack(mine[4]["final_obs"]), its[4]["final_obs"])


def test_observations_and_rewards_lie_where_torch_reads_them():
    env = make("cuda", observation="scaled", action="normalised")
    observations, _ = env.reset(seed=0)
    device = env.simulation.device
    assert observations.device == torch.device(device)
    assert torch.from_dlpack(observations).data_ptr() == observations.data_ptr()
    policy = torch.nn.Linear(4, 2).to(device)
    with torch.no_grad():
        _, rewards, *_ = env.step(torch.tanh(policy(observations)))
    assert rewards.device == torch.device(device)
    assert rewards.dtype == torch.float64


def test_stable_baselines3_gets_arrays_of_the_host():
    from swarm_gym.sb3 import make_vec

    ours, theirs = (
        make_vec(
            "firefly",
            2,
            seed=3,
            device=device,
            scenario=RASTRIGIN,
            iterations=2,
            initial_population_size=4,
            max_population_size=6,
        )
        for device in ("cpu", "cuda")
    )
    mine, its = ours.reset(), theirs.reset()
    for _ in range(3):
        assert isinstance(its, np.ndarray)
        assert_close(mine, its)
        actions = np.full((2, 2), -0.5, dtype=np.float32)
        (mine, reward, done, info), (its, their_reward, their_done, their_info) = (
            ours.step(actions),
            theirs.step(actions),
        )
        assert_close(reward, their_reward)
        assert_close(done, their_done)
        assert [one.keys() for one in info] == [one.keys() for one in their_info]


def test_copied_swarms_go_on_alike():
    env = make("cuda")
    env.reset(seed=0)
    env.step(np.full((2, 2), [4.0, 0.0]))
    observations = env.copy_swarms(np.array([1, 1]))
    assert torch.equal(observations[0], observations[1])
    after = env.step(np.full((2, 2), [5.0, 0.0]))[0]
    assert torch.equal(after[0], after[1])


@pytest.mark.parametrize("mask", [np.array, torch.tensor])
def test_a_mask_of_numpy_or_torch_chooses_the_swarms_that_advance(mask):
    env = make("cuda")
    env.reset(seed=0)
    chosen = mask([False, True])
    chosen = chosen.to(env.simulation.device) if isinstance(chosen, torch.Tensor) else chosen
    _, rewards, ended = env.step_running(np.full((2, 2), [4.0, 0.0]), chosen)
    assert env.simulation.iteration.tolist() == [0, 1]
    assert rewards[0] == 0.0
    assert chosen.tolist() == [False, True]
    assert not ended.any()


def test_a_mask_chooses_the_swarms_that_begin_anew():
    env = make("cuda")
    env.reset(seed=0)
    env.step(np.full((2, 2), [4.0, 0.0]))
    env.reset(seed=[None, 9], options={"reset_mask": np.array([False, True])})
    assert env.simulation.iteration.tolist() == [1, 0]


@pytest.mark.parametrize(
    ("optimizer", "options", "message"),
    [
        ("AntColony", {"scenario": "block:30"}, "optimizer 'ant-colony' runs on the CPU only"),
        (
            "Firefly",
            {"scenario": "rooms:1", "encoding": "bezier"},
            "scenario 'rooms:1' with encoding 'bezier'",
        ),
        ("Firefly", {"scenario": "case1", "num_waypoints": 32}, "decision vectors of length 32"),
        ("Firefly", {"scenario": "case1", "observation": "corridors"}, "observation 'corridors'"),
        ("Firefly", {"num_envs": 10**9}, "1000000000 swarms need .* GiB, but only .* GiB"),
    ],
)
def test_what_has_no_kernels_is_refused_by_name(optimizer, options, message):
    with pytest.raises(SettingError, match=message):
        make("cuda", optimizer, **options)


def test_in_float32_an_episode_differs_from_that_of_the_cpu_by_rounding():
    ours, theirs = make("cpu"), make("cuda", precision="float32")
    mine, its = ours.reset(seed=5)[0], theirs.reset(seed=5)[0]
    for _ in range(3):
        np.testing.assert_allclose(as_numpy(its), mine, rtol=1e-3, atol=1e-3)
        mine, its = ours.step(np.full((2, 2), [4.0, 0.0]))[0], theirs.step(np.full((2, 2), [4.0, 0.0]))[0]


def test_a_precision_that_a_device_does_not_have_is_refused():
    with pytest.raises(SettingError, match="precision must be 'float64' on the device 'cpu', got 'float32'"):
        make("cpu", precision="float32")
    with pytest.raises(UnknownNameError, match="unknown precision 'float16'; valid: float32, float64"):
        make("cuda", precision="float16")


def test_a_device_that_does_not_exist_is_refused():
    with pytest.raises(UnknownNameError, match=re.escape("unknown device 'tpu'; valid: cpu, cuda")):
        make("tpu")


def test_invalid_actions_are_refused_as_on_the_cpu():
    messages = []
    for device in ("cpu", "cuda"):
        env = make(device)
        env.reset(seed=0)
        with pytest.raises(ValueError, match="population size must lie in") as caught:
            env.step(np.array([[4.0, 0.0], [99.0, 0.0]]))
        messages.append(str(caught.value))
    assert messages[0] == messages[1]


def test_a_kernel_that_fails_names_the_swarm_and_the_iteration():
    env = make("cuda", num_envs=3)
    env.reset(seed=0)
    env.step(np.full((3, 2), [4.0, 0.0]))
    env.simulation.swarms.positions[1, :, 0] = torch.nan  # the best member does not move
    with pytest.raises(DeviceError, match=r"on swarm 1 in iteration 2: positions or costs .* are NaN"):
        env.step(np.full((3, 2), [4.0, 0.0]))
