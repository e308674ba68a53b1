"""One policy for several optimizers: their swarms side by side, and what cannot be trained together."""

import numpy as np
import pytest
import torch
from gymnasium.spaces import Box

from helpers.trainings import STEPS, run_whole_and_stopped, tiny_config, train
from swarm_gym.action import make_action
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.learned.policy_file import PolicyFileError, load_policy, resolve, save_policy
from swarm_gym.features import TOLD_APART
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.rollout import run_episodes
from swarm_gym.training.joined_vec_env import JoinedVecEnv
from swarm_gym.training.learners import make_learner
from swarm_gym.training.learners.group_advantages import GroupBuffer
from swarm_gym.vector_env import SwarmVectorEnv

pytestmark = pytest.mark.usefixtures("little_imitation", "plain_pictures")

SEVERAL = {
    "optimizer": "firefly", "also_on": ("particle-swarm",), "warm_start": "none", "base": "fixed:4",
    "group_size": 2, "reward": "optimality", "noise_steps": 0, "critic": False, "gae_lambda": 1.0,
    "observation": "extended+named",
}  # fmt: skip

EVOLVED = {
    "optimizer": "firefly", "also_on": ("particle-swarm",), "warm_start": "none", "base": "fixed:4",
    "algorithm": "evolution", "candidates": 4, "num_swarms": 16, "reward": "optimality", "hidden_layers": (),
    "observation": "extended+named",
}  # fmt: skip


def test_each_optimizer_has_its_share_of_the_swarms_and_its_own_episodes(tmp_path):
    learner = make_learner(tiny_config(tmp_path, **SEVERAL))
    env = learner.env
    assert isinstance(env, JoinedVecEnv)
    names = [part.env.unwrapped.simulation.optimizer.name for part in env.parts]
    assert names == ["firefly", "particle-swarm"]
    env.seed(5)
    first = env.reset()
    env.seed(5)
    np.testing.assert_array_equal(env.reset(), first)
    np.testing.assert_array_equal(first[0], first[1])
    assert (first[1] != first[2]).any()
    columns = [learner.features.index(f"whether the optimizer is {name}") for name in names]
    np.testing.assert_array_equal(first[:, columns], [[1, 0], [1, 0], [0, 1], [0, 1]])


def test_swarms_side_by_side_move_as_each_optimizer_does_alone(tmp_path):
    env = make_learner(tiny_config(tmp_path, **SEVERAL)).env
    own = {**SEVERAL, "also_on": (), "num_swarms": 2}
    alone = [
        make_learner(tiny_config(tmp_path, **{**own, "optimizer": optimizer})).env
        for optimizer in ("firefly", "particle-swarm")
    ]
    env.seed(7)
    for number, part in enumerate(alone):
        part.seed(7 + number)
    np.testing.assert_array_equal(env.reset(), np.concatenate([part.reset() for part in alone]))
    rng = np.random.default_rng(0)
    for _ in range(12):
        actions = rng.uniform(-0.2, 0.2, (4, 2))
        seen, rewards, dones, _ = env.step(actions)
        apart = [part.step(own) for part, own in zip(alone, np.split(actions, 2), strict=True)]
        np.testing.assert_array_equal(seen, np.concatenate([one[0] for one in apart]))
        np.testing.assert_array_equal(rewards, np.concatenate([one[1] for one in apart]))
        assert not dones.any()


def test_advantages_of_each_optimizer_have_a_deviation_of_one():
    buffer = GroupBuffer(
        3, Box(-1, 1, (2,)), Box(-1, 1, (2,)), device="cpu", gae_lambda=1.0, gamma=1.0, n_envs=8,
        group_size=2, critic=False, noise_steps=0, num_optimizers=2,
    )  # fmt: skip
    buffer.reset()
    rng = np.random.default_rng(1)
    buffer.rewards[:] = rng.normal(size=(3, 8)) * np.repeat([1.0, 1000.0], 4)
    buffer.episode_starts[0] = 1.0
    buffer.compute_returns_and_advantage(torch.zeros(8), np.ones(8, dtype=bool))
    returns = buffer.rewards.sum(axis=0).reshape(4, 2)
    beyond = (returns - returns.mean(axis=1, keepdims=True)).reshape(2, 4)
    np.testing.assert_allclose(
        buffer.advantages[0].reshape(2, 4), beyond / beyond.std(axis=1, keepdims=True), rtol=1e-5
    )


def test_a_policy_of_several_optimizers_is_validated_on_each_and_drives_any(tmp_path):
    best = train(tmp_path, **SEVERAL, total_steps=STEPS).run()
    manifest = load_policy(best)[1]
    assert manifest["also_on"] == ["particle-swarm"]
    assert list(manifest["validation"]) == ["firefly/case3", "particle-swarm/case3"]
    controller = make_controller(f"learned:{best}")
    assert controller.made_for is None
    for optimizer in ("elite-genetic", "firefly"):
        episodes = run_episodes(controller, "case3", range(3, 4), optimizer, **controller.env_options())
        assert episodes.evaluations[0] > 0


def test_evolution_earns_the_mean_over_the_optimizers(tmp_path):
    both = make_learner(tiny_config(tmp_path, **EVOLVED))
    own = {**EVOLVED, "also_on": (), "num_swarms": 8}
    alone = [
        make_learner(tiny_config(tmp_path, **{**own, "optimizer": optimizer}))
        for optimizer in ("firefly", "particle-swarm")
    ]
    candidates = np.random.default_rng(0).normal(0.0, 0.3, (4, len(both.features) * 2 + 2))
    earned = [learner._earn(candidates, 3) for learner in alone]
    np.testing.assert_array_equal(both._earn(candidates, 3), np.mean(earned, axis=0))
    assert (earned[0] != earned[1]).all()
    assert both.num_steps == sum(learner.num_steps for learner in alone)


def test_a_policy_that_evolution_trains_on_several_optimizers_drives_any(tmp_path):
    best = train(tmp_path, **EVOLVED, total_steps=STEPS).run()
    manifest = load_policy(best)[1]
    assert manifest["also_on"] == ["particle-swarm"]
    assert list(manifest["validation"]) == ["firefly/case3", "particle-swarm/case3"]
    assert make_controller(f"learned:{best}").made_for is None


@pytest.mark.slow
def test_a_resumed_training_on_several_optimizers_equals_one_that_was_not_stopped(tmp_path):
    one, other = run_whole_and_stopped(tmp_path, 1, 2 * STEPS, **SEVERAL)
    ours, theirs = (run.learner.model.policy.state_dict() for run in (one, other))
    assert all(torch.equal(ours[name], theirs[name]) for name in ours)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"group_size": 1}, "also_on needs groups"),
        ({"critic": True}, "also_on needs groups"),
        ({"branches": (3,)}, "also_on and branches exclude each other"),
        ({"group_size": 4}, "multiple of group_size 4 times 2 optimizers, got 4"),
        (
            {"action": "extended-normalised"},
            "made for firefly, .*of particle-swarm are",
        ),
        ({"also_on": ("bees",)}, "unknown optimizer 'bees'"),
        ({"algorithm": "dqn"}, "also_on .*'ppo' or 'evolution' only"),
    ],
)
def test_optimizers_that_cannot_be_trained_together_leave_nothing_behind(tmp_path, options, message):
    with pytest.raises(ValueError, match=message):
        train(tmp_path, **{**SEVERAL, **options})
    assert list(tmp_path.iterdir()) == []


def test_candidates_share_the_swarms_of_each_optimizer(tmp_path):
    with pytest.raises(ValueError, match="multiple of candidates times 2 optimizers, got 16 and 16"):
        train(tmp_path, **{**EVOLVED, "candidates": 16})
    assert list(tmp_path.iterdir()) == []


def test_a_manifest_with_an_unknown_optimizer_is_refused(tmp_path):
    best = train(tmp_path, **SEVERAL, total_steps=STEPS).run()
    weights, manifest = load_policy(best)
    save_policy(tmp_path / "bees.safetensors", weights, {**manifest, "also_on": ["bees"]})
    with pytest.raises(PolicyFileError, match=r"also_on must be a list of names.*\['bees'\]"):
        make_controller(f"learned:{tmp_path / 'bees.safetensors'}")


@pytest.mark.parametrize("optimizer", ["firefly", "fish-swarm"])
def test_the_layout_named_tells_the_optimizer_apart(optimizer):
    env = SwarmVectorEnv(2, optimizer, scenario="case1", observation="named")
    seen, _ = env.reset(seed=1)
    names = [feature.name for feature in make_observation("named").features[4:]]
    assert names == [f"whether the optimizer is {name}" for name in TOLD_APART]
    np.testing.assert_array_equal(seen[:, 4:], [[name.endswith(f" {optimizer}") for name in names]] * 2)
    assert make_action(env.simulation.settings, env.simulation.optimizer).labels[:1] == ("population size",)


def test_an_optimizer_that_is_added_leaves_the_layout_named_as_stored_policies_have_it(monkeypatch):
    names = [feature.name for feature in make_observation("named").features[4:]]
    manifest = load_policy(resolve("optimizers-all-named/0"))[1]
    assert [name for name in manifest["features"] if name.startswith("whether")] == names
    monkeypatch.setattr(get_optimizer("firefly"), "name", "added")
    seen, _ = SwarmVectorEnv(2, "firefly", scenario="case1", observation="named").reset(seed=1)
    assert (seen[:, 4:] == 0.0).all()
