"""Policies with a memory: the file decides as the torch policy does, and forgets between episodes."""

import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode
from sb3_contrib.ppo_recurrent import MlpLstmPolicy

from agents import make_controller
from helpers.layouts import OF_SWARMS
from helpers.trainings import (
    STEPS,
    add_memory,
    assert_decides_alike_at_any_width,
    change_policy,
    make_policy,
    random_observations,
    tiny_config,
    train,
)
from swarm_gym.controllers.learned.networks import NETWORKS, FeedforwardController, RecurrentController
from swarm_gym.controllers.learned.policy_file import PolicyFileError, load_policy
from swarm_gym.controllers.registry import load_learned
from swarm_gym.observation import ITERATION
from swarm_gym.training.imitation import _cut, demonstrate, imitate
from swarm_gym.training.learners import make_learner
from swarm_gym.training.learners.recurrent import SequencePolicy
from swarm_gym.vector_env import SwarmVectorEnv

pytestmark = pytest.mark.usefixtures("little_imitation", "plain_pictures")

RECURRENT = {"algorithm": "recurrent-ppo", "warm_start": "none", "observation": "paper"}
SIZE = 6


@pytest.fixture
def policy(tmp_path):
    """A file with random weights."""
    rng = np.random.default_rng(0)
    path = add_memory(make_policy(tmp_path / "some.safetensors", rng), rng, SIZE)
    change_policy(path, {"1.weight": 0.1 * load_policy(path)[0]["1.weight"]})
    return path


@pytest.mark.parametrize("base", ["none", "spsfa-tip"])
def test_the_file_decides_as_the_torch_policy_over_several_episodes(tmp_path, base):
    run = train(tmp_path, **RECURRENT, base=base, total_steps=STEPS)
    run.run()
    controller = make_controller(f"learned:{tmp_path / 'ppo' / 'latest.safetensors'}", run.config.limits)
    assert isinstance(controller, RecurrentController)
    env = SwarmVectorEnv(
        4, **{**controller.env_options(), "observation": controller.observation}, iterations=7,
        autoreset_mode=AutoresetMode.SAME_STEP,
    )  # fmt: skip
    observations, _ = env.reset(seed=0)
    controller.reset(4)
    twin = make_controller("spsfa-tip", run.config.limits)
    twin.reset(4)
    state, starts = None, np.ones(4, dtype=bool)
    for _ in range(20):
        proposed, seen = 0.0, observations
        if base != "none":
            learners_base = run.learner.env.base
            proposed = learners_base.layout.encode(twin.act(observations[:, :4]))
            seen = np.concatenate([observations[:, 4:], proposed], axis=1).astype(np.float32)
        actions, state = run.learner.model.predict(seen, state, starts, deterministic=True)
        decided = controller.act(observations)
        np.testing.assert_allclose(decided, np.clip(proposed + actions, -1, 1), atol=2e-5)
        observations, _, starts, _, _ = env.step(decided)


def test_decisions_do_not_depend_on_how_many_swarms_are_decided_for(policy):
    assert_decides_alike_at_any_width(lambda: load_learned(policy), np.random.default_rng(2), seed=0)


def test_a_recurrent_policy_remembers_within_an_episode_and_forgets_between_two(policy):
    controller = load_learned(policy)
    first, second = random_observations("extended", np.random.default_rng(3), 2)[:, None]
    first[0, ITERATION], second[0, ITERATION] = 0.0, 0.5
    controller.reset(1)
    decided = [controller.act(o) for o in (first, second, second)]
    assert not np.array_equal(decided[1], decided[2])
    again = [controller.act(o) for o in (first, second)]  # iteration 0 begins an episode
    np.testing.assert_array_equal(again, decided[:2])
    controller.reset(1)  # and so does reset
    fresh = controller.act(second)
    controller.reset(1)
    np.testing.assert_array_equal(controller.act(second), fresh)


@pytest.mark.parametrize("layout", OF_SWARMS)
def test_every_layout_tells_the_beginning_of_an_episode(layout):
    env = SwarmVectorEnv(2, observation=layout, initial_population_size=4, iterations=3)
    observations, _ = env.reset(seed=0)
    assert (observations[:, ITERATION] == 0).all()
    for _ in range(3):
        observations, *_ = env.step(np.tile([4.0, 0.0], (2, 1)))
        assert (observations[:, ITERATION] > 0).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"network": "transformer"}, "network must be one of choices, feedforward, lstm.*transformer"),
        ({"network": ["lstm"]}, "network must be one of"),
        ({"lstm_size": 7}, "tensor 'lstm.weight'"),
        ({"network": "feedforward"}, "tensor '0.weight'"),
        ({"weights": {"lstm.bias": np.zeros(3, np.float32)}}, "tensor 'lstm.bias'"),
        ({"weights": {"0.weight": np.zeros((8, 9), np.float32)}}, "tensor '0.weight'"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(policy, changes, message):
    change_policy(policy, **changes)
    with pytest.raises(PolicyFileError, match=message):
        load_learned(policy)


def test_the_file_tells_which_class_it_is_of_and_is_read_once(policy, tmp_path, monkeypatch):
    read = []
    monkeypatch.setattr(
        "swarm_gym.controllers.registry.load_policy", lambda path: read.append(path) or load_policy(path)
    )
    other = make_policy(tmp_path / "other.safetensors", np.random.default_rng(0))
    assert type(load_learned(policy)) is NETWORKS["lstm"] is RecurrentController
    assert type(load_learned(other)) is NETWORKS["feedforward"] is FeedforwardController
    assert read == [policy, other]


def test_a_memory_imitates_a_schedule_from_what_the_paper_observes(tmp_path, monkeypatch):
    monkeypatch.setattr("swarm_gym.training.imitation.GRADIENT_STEPS", 150)
    learner = make_learner(tiny_config(tmp_path, **{**RECURRENT, "observation": "scaled"}))
    shown = demonstrate(make_controller("spsfa", learner.config.limits), learner.env, 0.1, 1.0, 5)
    assert shown.there.all()
    assert shown.observations.shape == (4 * 4, 100, 4)

    def error():
        with torch.no_grad():
            decided, _ = learner._predict(torch.as_tensor(shown.observations))
        return float(((decided.numpy() - shown.actions.reshape(-1, 2)) ** 2).mean())

    before = error()
    imitate(learner.model.policy, shown, learner._predict, 0)
    assert error() < 0.3 * before


@pytest.mark.parametrize("inside", [False, True])
def test_sequences_at_a_time_equal_the_librarys_steps(inside):
    torch.manual_seed(0)
    lstm = torch.nn.LSTM(4, SIZE)
    features, states = torch.randn(3 * 7, 4), (torch.randn(1, 3, SIZE), torch.randn(1, 3, SIZE))
    starts = torch.zeros(3, 7)
    starts[1, 0], starts[2, 4] = 1.0, float(inside)
    with torch.no_grad():
        ours = SequencePolicy._process_sequence(features, states, starts.flatten(), lstm)
        theirs = MlpLstmPolicy._process_sequence(features, states, starts.flatten(), lstm)
    for one, other in zip((ours[0], *ours[1]), (theirs[0], *theirs[1]), strict=True):
        torch.testing.assert_close(one, other)


def test_demonstrations_are_cut_into_whole_episodes():
    ends = np.zeros((6, 2), dtype=bool)
    ends[[1, 4], 0] = ends[3, 1] = True
    steps, ran = np.arange(12.0).reshape(6, 2), np.ones((6, 2))
    ran[3, 1] = 0.0
    shown = _cut((steps[..., None], steps[..., None], steps, ran), ends, 4)
    assert shown.returns.tolist() == [[0, 2, 0, 0], [4, 6, 8, 0], [1, 3, 5, 7]]
    assert shown.there.sum(axis=1).tolist() == [2, 3, 3]
    assert shown.one_by_one().returns.flatten().tolist() == [0, 2, 4, 6, 8, 1, 3, 5]
