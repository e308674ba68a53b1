"""Rewards relative to a reference controller, for any learner."""

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

pytest.importorskip("stable_baselines3", reason="needs the extra `train`")

from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.rollout import run_episodes
from swarm_gym.sb3 import NativeVecEnv
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.wrappers import PairedReward

SHORT = {"iterations": 7, "max_population_size": 12, "initial_population_size": 9, "reward": "final-gap"}


def swarms(num=3, **options):
    return SwarmVectorEnv(num, **{**SHORT, "autoreset_mode": AutoresetMode.SAME_STEP, **options})


def test_the_last_reward_is_less_by_the_return_of_the_reference():
    plain, paired = swarms(price=2.0), PairedReward(swarms(price=2.0), "fixed:9")
    plain.reset(seed=20)
    paired.reset(seed=20)
    actions = np.tile([11.0, 0.2], (3, 1))
    differences = []
    for _ in range(14):
        rewards, ended = plain.step(actions)[1:3]
        found, also, _, infos = paired.step(actions)[1:]
        assert (ended == also).all()
        differences.append(rewards - found)
    assert not np.any(differences[:6])
    alone = run_episodes(make_controller("fixed:9"), "case1", range(20, 23), price=0.0, **SHORT)
    assert np.allclose(differences[6], alone.returns, rtol=0, atol=1e-12)
    assert np.all(differences[13] != differences[6])  # the next episodes
    assert infos["_final_info"].all()


def test_the_reference_that_is_imitated_earns_nothing():
    options = {"price": 0.0, "max_population_size": 200, "initial_population_size": 80, "iterations": 20}
    paired = PairedReward(swarms(base="spsfa-tip", **options), "spsfa-tip")
    paired.reset(seed=3)
    zeros = np.zeros(paired.action_space.shape, dtype=np.float32)
    earned = sum(paired.step(zeros)[1] for _ in range(20))
    assert np.allclose(earned, 0.0, atol=1e-12)


def test_a_reference_begins_as_a_base_does():
    base = "fixed:9,smooth_share=0.5,amplitude=0.1"
    options = {"scenario": "case1", "iterations": 7, "reward": "final-gap", "price": 0.0}
    made = SwarmVectorEnv(2, base=base, autoreset_mode=AutoresetMode.SAME_STEP, **options)
    twin = made.twin()
    assert (twin.settings.initial_population_size, twin.settings.new_members.smooth_share) == (9, 0.5)
    assert twin.settings.action == "natural"
    paired = PairedReward(made, "fixed:9")
    paired.reset(seed=3)
    zeros = np.zeros(paired.action_space.shape, dtype=np.float32)
    earned = sum(paired.step(zeros)[1] for _ in range(7))
    assert np.allclose(earned, 0.0, atol=1e-12)


def test_stable_baselines3_takes_it():
    made = NativeVecEnv(PairedReward(swarms(), "fixed:9"))
    made.seed(6)
    made.reset()
    for _ in range(7):
        _, _, dones, infos = made.step(np.tile([9.0, 0.0], (3, 1)))
    assert dones.all()
    assert [info["episode"]["l"] for info in infos] == [7] * 3


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: PairedReward(SyncVectorEnv([lambda: SwarmEnv(**SHORT)]), "fixed:9"),
            "which SyncVectorEnv cannot",
        ),
        (
            lambda: PairedReward(swarms(autoreset_mode=AutoresetMode.NEXT_STEP), "fixed:9"),
            "PairedReward needs autoreset mode 'SameStep', got 'NextStep'",
        ),
        (
            lambda: PairedReward(swarms(), "spsfa-tip"),
            "'spsfa-tip' begins with 12 members .*, but the swarms with 9 .*change initial_population_size",
        ),
        (lambda: PairedReward(swarms(), "fixed:9").reset(), "PairedReward needs a seed"),
        (
            lambda: PairedReward(swarms(), "fixed:9").reset(seed=1, options={"scenario": "case1"}),
            "must be None for paired rewards",
        ),
    ],
)
def test_what_cannot_be_paired_is_refused(make, message):
    with pytest.raises(SettingError, match=message):
        make()
    with pytest.raises(UnknownNameError, match="controller"):
        PairedReward(swarms(), "nobody")
