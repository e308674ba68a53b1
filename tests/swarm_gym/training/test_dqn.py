"""DQN: it learns, begins next to its base, and its file chooses as the library's model does."""

import numpy as np
import pytest

from helpers.trainings import DQN, STEPS, assert_decides_alike_at_any_width, tiny_config, train
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.learned.networks import NETWORKS, ChoiceController
from swarm_gym.controllers.learned.policy_file import load_policy
from swarm_gym.controllers.registry import load_learned
from swarm_gym.training.learners import make_learner
from swarm_gym.training.learners.dqn import LEAST_EXPLORATION, make_choices
from swarm_gym.vector_env import SwarmVectorEnv

pytestmark = pytest.mark.usefixtures("plain_pictures")


@pytest.mark.slow
def test_dqn_learns_to_save_evaluations_that_cost_much(tmp_path):
    options = {"price": (500.0,), "rollouts_per_chunk": 4, "learning_rate": 3e-3, "gradient_steps": 4}
    options |= {"size_choices": (-1.0, 0.0, 1.0), "degree_choices": (0.0,), "exploration_steps": 4 * STEPS}
    run = train(tmp_path, **{**DQN, **options}, total_steps=12 * STEPS)
    best = run.run()
    validation = load_policy(best)[1]["validation"]["case3"]
    # The middle of the range from 2 to 12 members has about five members.
    assert validation["evaluations"] < 0.7 * 5 * 100


def test_the_file_chooses_as_the_librarys_model_does(tmp_path):
    run = train(tmp_path, **DQN, total_steps=3 * STEPS)
    run.run()
    controller = load_learned(tmp_path / "ppo" / "latest.safetensors", run.config.limits)
    assert isinstance(controller, ChoiceController)
    assert NETWORKS["choices"] is ChoiceController
    env = SwarmVectorEnv(64, **controller.env_options(), scenario="case3", iterations=5)
    seen, _ = env.reset(seed=0)
    chosen, _ = run.learner.model.predict(seen, deterministic=True)
    np.testing.assert_array_equal(controller.act(seen), run.learner.choices[chosen])


def test_a_policy_begins_with_the_choice_next_to_zero(tmp_path):
    run = train(tmp_path, **{**DQN, "size_choices": (0.4, 0.1, -0.2)}, base="spsfa-tip")
    run.learner.begin()
    run._save_policy(tmp_path / "first.safetensors", {})
    policy = load_learned(tmp_path / "first.safetensors", run.config.limits)
    base = make_controller("spsfa-tip", run.config.limits)
    env = SwarmVectorEnv(8, **{**policy.env_options(), "observation": policy.observation}, iterations=5)
    seen, _ = env.reset(seed=0)
    policy.reset(8)
    base.reset(8)
    proposed = run.learner.env.venv.base.layout.encode(base.act(seen[:, :4]))
    # 0.1 is the correction next to zero.
    np.testing.assert_allclose(policy.act(seen), np.clip(proposed + np.array([0.1, 0.0]), -1, 1), atol=1e-6)


def test_decisions_do_not_depend_on_how_many_swarms_are_decided_for(tmp_path):
    run = train(tmp_path, **DQN)
    run._save_policy(tmp_path / "first.safetensors", {})
    assert_decides_alike_at_any_width(
        lambda: load_learned(tmp_path / "first.safetensors"), np.random.default_rng(2), seed=0
    )


def test_random_choices_become_rare(tmp_path):
    learner = make_learner(tiny_config(tmp_path, **DQN))
    shares = []
    for steps in (0, STEPS, 2 * STEPS, 3 * STEPS):
        learner.model.num_timesteps = steps
        shares.append(learner._exploration(0.0))
    np.testing.assert_allclose(shares, [1.0, (1.0 + LEAST_EXPLORATION) / 2, LEAST_EXPLORATION, 0.05])


def test_every_swarm_explores_by_itself(tmp_path):
    learner = make_learner(tiny_config(tmp_path, **DQN))
    model, seen = learner.model, np.zeros((4000, len(learner.features)), np.float32)
    model.set_random_seed(0)
    model.exploration_rate = 0.3
    best = model.predict(seen, deterministic=True)[0]
    assert (best == best[0]).all()
    changed = model.predict(seen)[0] != best
    # A random choice is the best one in one of nine cases.
    assert changed.mean() == pytest.approx(0.3 * 8 / 9, abs=0.025)


def test_choices_are_all_pairs():
    pairs = make_choices((-0.5, 0.5), (0.0, 0.25, 1.0))
    expected = [[-0.5, 0.0], [-0.5, 0.25], [-0.5, 1.0], [0.5, 0.0], [0.5, 0.25], [0.5, 1.0]]
    np.testing.assert_array_equal(pairs, expected)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size_choices": ()}, r"size_choices .* at least one, got \(\)"),
        ({"size_choices": (0.5, 0.5)}, r"size_choices must be different .*\(0.5, 0.5\)"),
        ({"degree_choices": (0.0, 1.5)}, r"degree_choices must lie in \[-1, 1\], got 1.5"),
        ({"replay_size": STEPS - 1}, rf"replay_size must lie in \[{STEPS}, .*got {STEPS - 1}"),
        ({"return_steps": 101}, r"return_steps must lie in \[1, 100\], got 101"),
        ({"batch_size": 0}, "batch_size must lie in .*got 0"),
        ({"gradient_steps": 0}, "gradient_steps must lie in .*got 0"),
        ({"target_steps": 0}, "target_steps must lie in .*got 0"),
        ({"exploration_steps": -1}, "exploration_steps must lie in .*got -1"),
        ({"warm_start": "spsfa-tip"}, "imitates no controller.*'spsfa-tip'"),
        ({"max_evaluations": 900}, "max_evaluations must be 0, got 900"),
        ({"action": "extended-normalised"}, "'dqn' decides size and repair degree only.*has 4"),
        ({"group_size": 2}, "group_size 2 is for algorithm 'ppo' or 'device-ppo' only, got 'dqn'"),
        ({"algorithm": "ppo"}, r"is for algorithm 'dqn' only, got 'ppo'"),
    ],
)
def test_options_that_it_cannot_use_are_refused_before_anything_is_written(tmp_path, options, message):
    with pytest.raises(ValueError, match=message):
        train(tmp_path, **{**DQN, **options})
    assert list(tmp_path.iterdir()) == []
