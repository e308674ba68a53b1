"""Training: it runs, it stores, it resumes bit for bit, it refuses."""

import json
import re

import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv

from agents import SizeLimits, make_controller
from helpers.trainings import DQN, EVOLUTION, STEPS, make_rule, run_whole_and_stopped, tiny_config, train
from swarm_gym.controllers.learned.policy_file import load_policy
from swarm_gym.controllers.registry import load_learned
from swarm_gym.controllers.tuned import save_tuned
from swarm_gym.env import SwarmEnv
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.runs.seeds import TEST, VALIDATION, training_seed
from swarm_gym.settings import Settings
from swarm_gym.training.algorithms import PPO, option_names
from swarm_gym.training.config import SHARED
from swarm_gym.training.learners import make_learner
from swarm_gym.training.sb3_vec_env import SB3VecEnv
from swarm_gym.vector_env import SwarmVectorEnv

OTHER_LENGTH = {"warm_start": "none", "iterations": 20}
START_OF_4 = "spsfa-tip:initial_population_size=4"  # a reference that begins as the tiny trainings do

pytestmark = pytest.mark.usefixtures("little_imitation", "plain_pictures")


@pytest.fixture(scope="module")
def ended(tmp_path_factory, little_imitation, plain_pictures):
    """The folder of a run that has ended, which is not to be changed."""
    folder = tmp_path_factory.mktemp("ended")
    train(folder, total_steps=STEPS).run()
    return folder


def test_training_leaves_its_whole_configuration_policies_and_scalars(tmp_path):
    best = train(tmp_path).run()
    weights, manifest = load_policy(best)
    assert manifest["config"]["scenarios"] == ["case3"]
    stored = json.loads((tmp_path / "ppo" / "config.json").read_text())
    assert set(stored) == {"algorithm", *SHARED, *option_names(PPO)}
    assert manifest["validation"]["case3"]["evaluations"] > 0
    assert {"swarm_gym", "torch", "stable-baselines3"} <= set(manifest["provenance"])
    assert weights["0.weight"].shape == (8, 9)
    assert list((tmp_path / "ppo").glob("events*"))
    events = b"".join(path.read_bytes() for path in (tmp_path / "ppo").glob("events*"))
    for scalar in (b"rollout/ep_rew_mean", b"validation/case3/final_fitness", b"sizes/iteration 011"):
        assert scalar in events


EARLY = {"scenarios": ("dynamic:case1-gate@3-4-drive@1,every=1,distance=120",), "reward": "detour"}


@pytest.mark.parametrize(
    ("stop", "total", "options"),
    [
        (1, 3, {}),
        # `test_device_ppo.py` resumes one, too.
        pytest.param(1, 3, {"algorithm": "device-ppo", "warm_start": "none"}, marks=pytest.mark.slow),
        pytest.param(1, 3, {"algorithm": "recurrent-ppo", "warm_start": "none"}, marks=pytest.mark.slow),
        pytest.param(
            1,
            3,
            {"base": "spsfa-tip", "warm_start": "none", "reward": "paired", "reference": START_OF_4},
            marks=pytest.mark.slow,
        ),
        # The last rollouts replace the first ones in the memory of DQN.
        pytest.param(2, 4, DQN, marks=pytest.mark.slow),
        # With a whole covariance, and with its diagonal.
        pytest.param(4, 8, {**EVOLUTION, "num_swarms": 8, "hidden_layers": ()}, marks=pytest.mark.slow),
        pytest.param(4, 8, {**EVOLUTION, "num_swarms": 8, "hidden_layers": (20,)}, marks=pytest.mark.slow),
    ],
)
def test_a_resumed_run_equals_one_that_was_not_stopped(tmp_path, stop, total, options):
    runs = run_whole_and_stopped(tmp_path, stop * STEPS, total * STEPS, **options)
    if "algorithm" in options and options["algorithm"] == "evolution":
        one, other = ({"mean": torch.from_numpy(run.learner._strategy.mean)} for run in runs)
    else:
        one, other = (getattr(run.learner, "model", run.learner).policy.state_dict() for run in runs)
    assert all(torch.equal(one[name], other[name]) for name in one)


def test_the_saved_policy_decides_as_the_model_does(tmp_path):
    run = train(tmp_path, total_steps=STEPS)
    run.run()
    env = SwarmVectorEnv(4, observation="extended", action="normalised", max_population_size=12,
                         initial_population_size=4)  # fmt: skip
    observations, _ = env.reset(seed=0)
    actions, _ = run.learner.model.predict(observations, deterministic=True)
    controller = load_learned(tmp_path / "ppo" / "latest.safetensors", run.config.limits)
    decided = controller.act(observations)
    np.testing.assert_allclose(decided, np.clip(actions, -1, 1), atol=1e-5)


def test_the_critic_is_taught_rewards_to_come_under_the_discount_of_the_training(tmp_path, monkeypatch):
    lessons = []
    monkeypatch.setattr(
        "swarm_gym.training.learners.ppo.imitate", lambda _, shown, *__: lessons.append(shown)
    )
    for discount in (1.0, 0.9):
        make_learner(tiny_config(tmp_path, algorithm="recurrent-ppo", discount=discount)).begin()
    whole, discounted = (np.pad(shown.returns, ((0, 0), (0, 1))) for shown in lessons)
    rewards = whole[:, :-1] - whole[:, 1:]
    np.testing.assert_allclose(discounted[:, :-1], rewards + 0.9 * discounted[:, 1:], atol=1e-5)
    assert abs(whole - discounted).max() > 0.01


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "--resume"),
        ({"resume": True, "name": "another"}, "no run"),
        ({"resume": True, "price": (0.7,)}, "price was"),
        ({"resume": True, "seed": 3}, "seed was"),
        ({"resume": True, "scenarios": ("case1",)}, "scenarios was"),
    ],
)
def test_a_run_is_neither_overwritten_nor_resumed_as_another_one(ended, options, message):
    before = (ended / "ppo" / "checkpoint.pt").read_bytes()
    with pytest.raises(RunFolderError, match=message):
        train(ended, **options)
    assert (ended / "ppo" / "checkpoint.pt").read_bytes() == before


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda text: "{", r"config\.json"),
        (
            lambda text: text.replace('"reference"', '"temperature"'),
            "with temperature was 'spsfa-tip', is 'no option'",
        ),
        (
            lambda text: re.sub(r'"reference": "[^"]*",?', "", text),
            "with reference was 'no option', is 'spsfa-tip'",
        ),
    ],
)
def test_a_stored_configuration_that_is_unreadable_or_another_is_not_resumed(tmp_path, spoil, message):
    train(tmp_path)
    path = tmp_path / "ppo" / "config.json"
    path.write_text(spoil(path.read_text()))
    with pytest.raises(RunFolderError, match=message):
        train(tmp_path, resume=True)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({**EVOLUTION, "candidates": 3}, "multiple of candidates, got 4 and 3"),
        ({**EVOLUTION, "warm_start": "spsfa-tip"}, "imitates no controller"),
        ({**EVOLUTION, "reward": "paired"}, "changes nothing.*'final-gap'"),
        ({**EVOLUTION, "base": "spsfa", "action": "natural"}, "scaled to"),
        ({"scenarios": ("case9",)}, "case9.*case1"),
        ({"warm_start": "spsf"}, "spsf.*spsfa"),
        ({"optimizer": "bees"}, "bees.*firefly"),
        ({"observation": "all"}, "all.*extended"),
        ({"reward": "gold"}, "gold.*progress"),
        ({"initial_population_size": 13}, "initial_population_size.*13"),
        ({"min_population_size": 14}, "smallest <= largest"),
        ({"price": (-1.0,)}, "price.*-1"),
        ({"algorithm": "sac"}, "sac.*recurrent-ppo"),
        ({"base": "spsfa"}, "'spsfa' and warm_start 'spsfa-tip' exclude"),
        ({"base": "spfsa", "warm_start": "none"}, "spfsa.*spsfa"),
        (
            {"base": "learned:three-cases/0@1", "warm_start": "none", "max_population_size": 200},
            "base 'learned:three-cases/0@1': .*'normalised' cannot be corrected",
        ),
        ({"corrected_from": 3}, "corrected_from 3: without a base"),
        ({"base": "spsfa", "warm_start": "none", "corrected_from": 100}, "corrected_from.*100"),
        ({**OTHER_LENGTH, "base": "spsfa", "corrected_from": 20}, r"corrected_from must lie in \[0, 19\]"),
        ({**OTHER_LENGTH, "base": "distilled:three-cases", "corrected_from": 3}, "share of 100.*got 20"),
        ({"reward": "paired", "reference": "none"}, "none.*in all"),
        ({"reward": "paired"}, "'spsfa-tip' begins with 12 members, but the policy with 4: .*equal starts"),
        (
            {"reward": "paired", "reference": "fixed:4,smooth_share=1"},
            "policy with 4 from the source None, theirs from .*smooth_share=1.0",
        ),
        (
            {"algorithm": "recurrent-ppo", "observation": "theory-scaled"},
            "'theory-scaled' has no iteration, by which recurrent-ppo begins its memory",
        ),
        ({"rollouts_per_chunk": 0}, r"rollouts_per_chunk must lie in \[1, \d+\], got 0"),
        ({"num_swarms": 0}, "num_swarms must lie in"),
        ({"iterations": 0}, "iterations must lie in"),
        ({"total_steps": -1}, "total_steps must lie in"),
        ({"validation_seeds": 0}, "validation_seeds must lie in"),
        ({"validation_seeds": 10**7}, "validation_seeds must lie in"),
        ({"validation_scenarios": ("case9",)}, "case9.*case1"),
        ({"hidden_layers": (4, 0)}, "hidden_layers must lie in"),
        ({"seed": 1.5}, "seed must be an integer"),
        ({"hidden_layers": (5000,)}, r"hidden_layers must lie in \[1, 4096\]"),
        ({"hidden_layers": (4,) * 17}, "number of hidden_layers must lie in"),
        ({"hidden_layers": (4096, 4096)}, "a policy has at least 67108864 bytes"),
        ({"algorithm": "recurrent-ppo", "lstm_size": -3}, "lstm_size must lie in"),
        ({"batch_size": 0}, "batch_size must lie in"),
        ({"batch_size": 1}, r"batch_size must lie in \[2, "),
        ({"num_swarms": 1, "iterations": 1}, "a rollout has one step"),
        ({"epochs": 0}, "epochs must lie in"),
        ({"clip_range": float("nan")}, "clip_range must lie in"),
        ({"target_kl": -1.0}, "target_kl must lie in"),
        ({"discount": 2.0}, "discount must lie in"),
        ({"gae_lambda": 2.0}, "gae_lambda must lie in"),
        ({"entropy_weight": float("nan")}, "entropy_weight must lie in"),
        ({"log_std": 100.0}, "log_std must lie in"),
        ({**EVOLUTION, "candidates": 0}, "candidates must lie in"),
        ({**EVOLUTION, "candidates": 1}, "candidates must lie in"),
        ({**EVOLUTION, "sigma": float("nan")}, "sigma must lie in"),
        ({"noise_steps": 0, "warm_start": "none", **EARLY}, "noise_steps 0: .* these may end early"),
        (
            {
                "warm_start": "open-loop:optimizers-elite-genetic-base",
                "action": "extended-normalised",
                "max_population_size": 200,
            },
            "warm_start .* was made for elite-genetic, whose decisions are",
        ),
        ({"learning_rate": -1.0}, "learning_rate must lie in"),
        ({"action": "natural"}, "'natural'.*scaled"),
        (
            {"warm_start": "open-loop:three-cases-extended", "max_population_size": 200},
            "'extended'.*imitated",
        ),
        ({"warm_start": "learned:three-cases-ppo/0", "max_population_size": 200}, "'normalised'.*imitated"),
    ],
)
def test_a_configuration_that_cannot_be_run_leaves_nothing_behind(tmp_path, options, message):
    with pytest.raises(ValueError, match=message):
        train(tmp_path, **options)
    assert list(tmp_path.iterdir()) == []


def test_a_policy_begins_in_use_as_in_its_training(tmp_path):
    run = train(tmp_path, **EVOLUTION, source="smooth", total_steps=STEPS)
    run.run()
    policy = load_learned(run.best, run.config.limits)
    assert policy.first_source == Settings(source="smooth").new_members
    seeds = range(100, 104)
    in_training, in_use = (
        run_episodes(policy, "case3", seeds, **options) for options in (run.config.env_options(), {})
    )
    assert in_use.final_fitness.tolist() == in_training.final_fitness.tolist()


@pytest.mark.parametrize("source", ["smooth", "mixed"])
def test_a_policy_is_the_reference_of_a_training_with_the_same_first_members(tmp_path, source):
    first = train(tmp_path, **EVOLUTION, source=source, name="first", total_steps=STEPS).run()
    paired = {"reward": "paired", "reference": f"learned:{first}", "warm_start": "none", "source": source}
    train(tmp_path, **paired, name="second", total_steps=STEPS).run()
    with pytest.raises(ValueError, match="equal starts"):
        train(tmp_path, **{**paired, "source": "uniform"}, name="third")


@pytest.mark.parametrize("role", ["base", "warm_start"])
def test_a_controller_that_needs_a_budget_is_refused_where_episodes_have_another(tmp_path, role):
    name, runs = make_rule(tmp_path / "rule.json", 900), tmp_path / "runs"
    options = {"warm_start": "none", role: name}
    for budget in (0, 800):
        with pytest.raises(ValueError, match=f"{role} '{name}': .*max_evaluations 900"):
            train(runs, **options, max_evaluations=budget)
    assert not runs.exists()
    train(runs, **options, max_evaluations=900)


# With so few evaluations all episodes end early.
@pytest.mark.parametrize(
    "options", [{"observation": "paper+rich"}, {"action": "paced", "max_evaluations": 30}]
)
def test_joined_layouts_and_budgets_that_end_all_episodes_early_can_be_trained_with(tmp_path, options):
    best = train(tmp_path / "a@b", **EVOLUTION, total_steps=4, **options).run()
    controller = make_controller(f"learned:{best}", SizeLimits(2, 12))
    assert controller.action == options.get("action", "normalised")


@pytest.mark.parametrize("role", ["base", "reference"])
def test_a_run_goes_on_beside_the_same_controllers_only(tmp_path, role):
    save_tuned(file := tmp_path / "mine.json", "fixed:4", {})
    given = {role: f"tuned:{file}", **({"reward": "paired"} if role == "reference" else {})}
    options = {**EVOLUTION, **given} if role == "base" else {"warm_start": "none", **given}
    train(tmp_path / "runs", total_steps=STEPS, **options).run()
    train(tmp_path / "runs", total_steps=STEPS, resume=True, **options)
    save_tuned(file, "spsfa-tip:initial_population_size=4", {})
    with pytest.raises(RunFolderError, match=f"{role} 'tuned:.*has changed since .*another --name"):
        train(tmp_path / "runs", total_steps=2 * STEPS, resume=True, **options)


def test_a_run_that_was_stopped_before_its_first_checkpoint_begins_anew(tmp_path):
    train(tmp_path)  # only prepared
    resumed = train(tmp_path, resume=True, total_steps=STEPS)
    resumed.run()
    assert resumed.learner.num_steps == STEPS


def test_seeds_of_test_validation_and_training_are_disjoint():
    drawn = [training_seed(seed, chunk) for seed in range(30) for chunk in range(30)]
    assert len(set(drawn)) == len(drawn)
    assert min(drawn) > VALIDATION.stop > VALIDATION.start >= TEST.stop
    assert max(drawn) + 10_000 < 2**31 + 10_000


OPTIONS = {"initial_population_size": 4, "max_population_size": 9, "iterations": 3}


def test_adapter_steps_as_the_single_environments_do():
    vector = SwarmVectorEnv(3, autoreset_mode=AutoresetMode.SAME_STEP, **OPTIONS)
    adapter = SB3VecEnv(vector)
    assert isinstance(adapter, VecEnv)
    adapter.seed(5)
    observations = adapter.reset()
    singles = [SwarmEnv(**OPTIONS) for _ in range(3)]
    for row, env in enumerate(singles):
        np.testing.assert_array_equal(env.reset(seed=5 + row)[0], observations[row])
    returns = np.zeros(3)
    for step in range(3):
        actions = np.tile([5 + step, 0.2], (3, 1))
        observations, rewards, dones, infos = adapter.step(actions)
        for row, env in enumerate(singles):
            observation, reward, *_ = env.step(actions[row])
            returns[row] += reward
            assert rewards[row] == reward
            if step < 2:
                np.testing.assert_array_equal(observation, observations[row])
                assert infos[row] == {}
            else:
                np.testing.assert_array_equal(observation, infos[row]["terminal_observation"])
                np.testing.assert_array_equal(env.reset()[0], observations[row])
                assert infos[row]["episode"]["r"] == pytest.approx(returns[row])
                assert infos[row]["TimeLimit.truncated"] is False
        assert dones.tolist() == [step == 2] * 3


def test_adapter_refuses_another_autoreset_mode():
    with pytest.raises(ValueError, match="SAME_STEP"):
        SB3VecEnv(SwarmVectorEnv(2, **OPTIONS))


def test_a_training_that_gained_nothing_says_so(tmp_path):
    """A learning rate of 0 leaves the policy as it was, so that no later validation is above the first."""
    run = train(tmp_path, learning_rate=0.0, total_steps=2 * STEPS)
    run.run()
    assert (
        run.verdict == f"best validation return {run.best_return:.4f}, did not improve on what it began with"
    )
    other = train(tmp_path, name="other", total_steps=STEPS)
    other.run()
    other._save_policy(other.best, {})
    assert other.verdict == f"best validation return {other.best_return:.4f}"
