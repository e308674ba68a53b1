"""Episodes in groups for any learner: equal starts, shared first iterations, and refusals."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers.vector import TransformReward

from swarm_gym.controllers.fixed import Fixed
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.runs.seeds import TRAINING_START, TRAINING_STOP
from swarm_gym.training.grouped_vec_env import GroupedVecEnv
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.wrappers import GroupedEpisodes, relative_to_group

SHORT = {"iterations": 8, "initial_population_size": 6, "max_population_size": 12, "action": "normalised"}
CASES = {"scenario": ["case1", "case2", "case3"], **SHORT}


def swarms(num=6, **options):
    return SwarmVectorEnv(num, **{**CASES, "autoreset_mode": AutoresetMode.DISABLED, **options})


def test_swarms_of_a_group_begin_alike_and_then_differ():
    envs = GroupedEpisodes(swarms(reward="optimality"), 3)
    rng = np.random.default_rng(0)
    seen, infos = envs.reset(seed=5)
    starts = []
    for _ in range(3):
        assert (seen[[0, 3]] == seen[[1, 4]]).all()
        assert (seen[[0, 3]] == seen[[2, 5]]).all()
        assert not (seen[0] == seen[3]).all()
        names = infos["scenario"]
        assert list(names) == [names[0]] * 3 + [names[3]] * 3
        starts.append(seen[[0, 3]])
        for iteration in range(8):
            seen, rewards, ended, cut, infos = envs.step(rng.uniform(-1, 1, (6, 2)).astype(np.float32))
            assert not cut.any()
            assert ended.all() == ended.any() == (iteration == 7)
        assert infos["_final_info"].all()
        assert np.allclose(rewards, -100.0 * infos["final_info"]["optimality_gap"], rtol=0.05, atol=0.5)
        assert len({tuple(row) for row in infos["final_obs"][:3]}) == 3
    assert len({start.tobytes() for start in starts}) == 3
    again, _ = envs.reset(seed=5)
    assert (again[[0, 3]] == starts[0]).all()
    assert (envs.reset(seed=[5, 9, 9, 9, 9, 9])[0] == again).all()
    assert envs.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP


def test_the_episodes_are_those_of_trainings():
    mine, theirs = GroupedEpisodes(swarms(), 2), GroupedVecEnv(swarms(), None, 2)
    theirs.seed(11)
    seen, expected = mine.reset(seed=11)[0], theirs.reset()
    rng = np.random.default_rng(3)
    for _ in range(20):
        assert (seen == expected).all()
        actions = rng.uniform(-1, 1, (6, 2)).astype(np.float32)
        seen, rewards, ended, _, _ = mine.step(actions)
        expected, paid, dones, _ = theirs.step(actions)
        assert (rewards == paid).all()
        assert (ended == dones).all()


def test_groups_begin_inside_of_episodes_where_the_base_has_decided_before():
    envs = GroupedEpisodes(swarms(4, base=Fixed(9)), 2, firsts=(5,))
    seen, infos = envs.reset(seed=1)
    assert envs.first == 5
    assert envs.num_common_steps == 2 * 5  # once for each group
    assert (infos["population_size"] == 9).all()
    assert (seen[[0, 2]] == seen[[1, 3]]).all()
    differ = np.zeros((4, 2), dtype=np.float32)
    differ[[1, 3], 0] = -0.5
    ends = [envs.step(differ)[2].all() for _ in range(3)]
    assert ends == [False, False, True]
    record = envs.unwrapped.simulation.history
    assert record.shape[1] == 9


def test_common_iterations_are_decided_by_a_function_or_by_zeros():
    asked = []

    def decide(observations):
        asked.append(observations.shape)
        return np.full((4, 2), -1.0, dtype=np.float32)

    envs = GroupedEpisodes(swarms(4), 2, (3,), decide)
    _, infos = envs.reset(seed=0)
    assert asked == [(4, 4)] * 3
    assert (infos["population_size"] == 2).all()
    with pytest.raises(SettingError, match="nothing decides in the common iterations; give decide"):
        GroupedEpisodes(swarms(4), 2, (3,))


def test_seeds_of_episodes_are_those_of_trainings(monkeypatch):
    envs, found = swarms(4), []
    begin = envs.reset
    monkeypatch.setattr(envs, "reset", lambda **given: (found.extend(given["seed"]), begin(**given))[1])
    GroupedEpisodes(envs, 2).reset(seed=2)
    assert found[0] == found[1] == found[2] - 1 == found[3] - 1
    assert TRAINING_START <= found[0] < TRAINING_STOP


def test_advantages_are_relative_to_the_group():
    found = relative_to_group(np.array([[1.0, 3.0, 10.0, 20.0], [0.0, 0.0, 5.0, 7.0]]), 2)
    assert found.tolist() == [[-1.0, 1.0, -5.0, 5.0], [0.0, 0.0, -1.0, 1.0]]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: GroupedEpisodes(SyncVectorEnv([lambda: SwarmEnv(**SHORT)] * 2), 2),
            "can copy the states of its swarms, which SyncVectorEnv cannot",
        ),
        (
            lambda: GroupedEpisodes(TransformReward(swarms(), lambda reward: reward), 2),
            "which TransformReward cannot; wrap the SwarmVectorEnv",
        ),
        (
            lambda: GroupedEpisodes(swarms(autoreset_mode=AutoresetMode.SAME_STEP), 2),
            "needs autoreset mode 'Disabled', got 'SameStep'",
        ),
        (lambda: GroupedEpisodes(swarms(), 4), "num_envs must be a multiple of group_size, got 6 and 4"),
        (lambda: GroupedEpisodes(swarms(), 7), r"group_size must lie in \[1, 6\], got 7"),
        (lambda: GroupedEpisodes(swarms(), 2, ()), "firsts must have at least one iteration"),
        (lambda: GroupedEpisodes(swarms(base="fixed:6"), 2, (8,)), r"firsts must lie in \[0, 7\], got 8"),
        (
            lambda: GroupedEpisodes(swarms(), 2).reset(options={"scenario": "case1"}),
            "must be None for groups",
        ),
        (
            lambda: GroupedEpisodes(
                swarms(scenario="dynamic:case1-drive@4,every=5,distance=60", reward="optimality"), 2
            ),
            "reward 'optimality' needs optima",
        ),
    ],
)
def test_what_has_no_groups_is_refused(make, message):
    with pytest.raises(SettingError, match=message):
        make()


def test_seeds_are_natural_numbers():
    with pytest.raises(gymnasium.error.Error, match="-1"):
        GroupedEpisodes(swarms(), 2).reset(seed=-1)


def test_gymnasium_makes_the_vector_that_is_wrapped():
    made = gymnasium.make_vec("swarm_gym/Firefly-v0", num_envs=4, autoreset_mode="Disabled", **SHORT)
    seen, _ = GroupedEpisodes(made, 2).reset(seed=0)
    assert seen.shape == (4, 4)
