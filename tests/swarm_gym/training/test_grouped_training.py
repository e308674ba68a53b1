"""Groups: swarms that begin alike, advantages beyond their mean, and what groups refuse."""

import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode

from helpers.trainings import EVOLUTION, STEPS, filled_buffer, run_whole_and_stopped, tiny_config, train
from swarm_gym.action import make_action
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.learned.residual import Base
from swarm_gym.training.grouped_vec_env import GroupedVecEnv
from swarm_gym.training.imitation import demonstrate
from swarm_gym.vector_env import SwarmVectorEnv

pytestmark = pytest.mark.usefixtures("little_imitation", "plain_pictures")

ITERATIONS = 9
OPTIONS = {
    "scenario": ["case1", "case2", "case3"], "initial_population_size": 6, "max_population_size": 12,
    "iterations": ITERATIONS, "reward": "optimality", "price": (0.5, 2.0), "action": "normalised",
}  # fmt: skip
BUDGET = {"max_evaluations": 500, "critic": False, "gae_lambda": 1.0}
GROUPED = {"warm_start": "none", "base": "spsfa", "group_size": 2, "reward": "optimality", "noise_steps": 0}


def grouped_env(num=6, group_size=3, firsts=(0,), decide=None, at_events=False, **options):
    """Swarms in groups that correct the schedule; the policy sees the price."""
    env = SwarmVectorEnv(
        num, autoreset_mode=AutoresetMode.DISABLED, observation="paper+priced", **{**OPTIONS, **options}
    )
    layout = make_action(env.simulation.settings, env.simulation.optimizer)
    base = Base(make_controller("spsfa", SizeLimits(2, 12)), layout)
    return GroupedVecEnv(env, base, group_size, firsts, decide, at_events)


def test_swarms_of_a_group_begin_alike_in_every_episode_and_groups_differ():
    env = grouped_env()
    env.seed(3)
    seen, starts, prices = env.reset(), [], []
    for _ in range(2 * ITERATIONS):
        if env._lengths[0] == 0:
            starts.append(seen)
            prices.append(env.env.simulation.prices.of_reference.copy())
        seen, _, dones, _ = env.step(np.random.default_rng(0).uniform(-1, 1, (6, 2)))
        assert dones.all() == dones.any()
    for start, price in zip(starts, prices, strict=True):
        np.testing.assert_array_equal(start[:3], start[[0, 0, 0]])
        np.testing.assert_array_equal(start[3:], start[[3, 3, 3]])
        assert price[0] == price[2] != price[3]
        assert (start[0] != start[3]).any()
    assert (starts[0] != starts[1]).any()


def test_a_seed_repeats_the_episodes_of_groups():
    env = grouped_env()
    runs = []
    for _ in range(2):
        env.seed(3)
        runs.append([env.reset(), *(env.step(np.full((6, 2), 0.1))[0] for _ in range(ITERATIONS + 2))])
    np.testing.assert_array_equal(*np.array(runs))


def test_equal_actions_earn_equal_returns_in_a_group_and_other_actions_do_not():
    env = grouped_env()
    env.seed(5)
    env.reset()
    actions = np.zeros((6, 2))
    actions[2] = 0.9
    for _ in range(ITERATIONS):
        _, rewards, _, infos = env.step(actions)
    earned = [info["episode"]["r"] for info in infos]
    assert earned[0] == earned[1] != earned[2]
    assert infos[0]["evaluations"] == infos[1]["evaluations"] != infos[2]["evaluations"]
    assert rewards[0] < 0


@pytest.mark.parametrize("decide", [None, lambda seen: np.full((len(seen), 2), 0.3)])
def test_common_iterations_are_computed_once_and_are_those_of_a_single_swarm(decide):
    """A group that begins to differ late ends as one that has always taken the common actions."""
    late, early = grouped_env(firsts=(4,), decide=decide), grouped_env(firsts=(0,))
    common = np.zeros((6, 2)) if decide is None else np.full((6, 2), 0.3)
    results = []
    for env in (late, early):
        env.seed(8)
        env.reset()
        assert env.first == (4 if env is late else 0)
        for iteration in range(env.first, ITERATIONS):
            _, _, dones, infos = env.step(common if iteration < 4 else np.full((6, 2), -0.5))
        assert dones.all()
        results.append([(info["episode"]["r"], info["episode"]["l"], info["best_fitness"]) for info in infos])
    np.testing.assert_allclose(*np.array(results), rtol=1e-12)
    assert results[0][0][1] == ITERATIONS
    assert late.uncounted_steps == 2 * 2 * 4  # in two episodes, the next one included, of each group


def test_after_an_event_groups_go_on_from_one_state_in_half_of_the_rollouts():
    changing = ["dynamic:case1-block@4", "dynamic:case2-block@6"]
    env = grouped_env(at_events=True, scenario=changing, reward="final")
    env.seed(2)
    env.reset()
    simulation = env.env.simulation
    rng = np.random.default_rng(0)
    joined, elsewhere = [], []
    for _ in range(12):
        event = simulation.worlds.next_event[simulation.swarms.problem]
        assert (event[:3] == event[0]).all()
        for iteration in range(1, ITERATIONS):
            env.step(rng.uniform(-1, 1, (6, 2)))
            for first in (0, 3):
                positions = simulation.swarms.positions[first : first + 3]
                alike = bool((positions == positions[0]).all())
                (joined if iteration == event[first] else elsewhere).append(alike)
        _, _, dones, infos = env.step(rng.uniform(-1, 1, (6, 2)))
        assert dones.all()
        assert len({info["episode"]["r"] for info in infos}) == 6
    assert joined[::2] == joined[1::2]  # all groups of a rollout
    assert 0.2 < np.mean(joined) < 0.8
    assert np.mean(elsewhere) < 0.05  # where all actions were clipped to the same


@pytest.mark.parametrize(("noise_steps", "drawn"), [(1, [0, 1, 2, 3, 4]), (2, [0, 0, 2, 2, 4]), (0, [0] * 5)])
def test_advantages_are_returns_since_the_noise_was_drawn_beyond_the_mean_of_the_group(noise_steps, drawn):
    steps, swarms, size = 5, 6, 3
    rng = np.random.default_rng(1)
    rewards = rng.normal(size=(steps, swarms)).astype(np.float32)
    values = rng.normal(size=(steps, swarms)).astype(np.float32)
    for critic in (True, False):
        buffer = filled_buffer(
            rewards, values, gae_lambda=1.0, gamma=1.0, group_size=size, critic=critic,
            noise_steps=noise_steps,
        )  # fmt: skip
        for step in range(steps):
            for swarm in range(swarms):
                group = range(swarm // size * size, swarm // size * size + size)
                beyond = {s: rewards[drawn[step] :, s].sum() - critic * values[drawn[step], s] for s in group}
                wanted = beyond[swarm] - sum(beyond.values()) / size
                assert buffer.advantages[step, swarm] == pytest.approx(wanted, abs=1e-5)
                assert buffer.returns[step, swarm] == pytest.approx(rewards[step:, swarm].sum(), abs=1e-5)


def test_a_swarm_whose_episode_ends_early_rests_until_all_begin_anew():
    env = grouped_env(max_evaluations=200)
    env.seed(1)
    env.reset()
    actions = np.array([[1.0, 0.0]] + 5 * [[-1.0, 0.0]])  # the first swarm spends its budget
    results = [env.step(actions) for _ in range(ITERATIONS)]
    rewards = np.array([result[1] for result in results])
    early = np.flatnonzero(rewards[:, 0])[-1]
    assert early < ITERATIONS - 1
    assert (rewards[early + 1 :, 0] == 0.0).all()
    assert (rewards[-1, 1:] != 0.0).all()
    assert [bool(result[2].any()) for result in results] == [False] * (ITERATIONS - 1) + [True]
    assert results[-1][2].all()
    infos = results[-1][3]
    assert infos[0]["evaluations"] == 200
    assert infos[0]["episode"]["r"] == pytest.approx(rewards[:, 0].sum())


def test_with_a_budget_only_steps_of_swarms_under_way_are_counted_and_learned_from(tmp_path):
    learner = train(tmp_path, **GROUPED, **BUDGET).learner
    before = learner.num_steps
    learner.learn(1)
    buffer = learner.model.rollout_buffer
    lengths = buffer.there.sum(axis=0)
    assert (lengths < 100).all()
    assert len(set(lengths.tolist())) > 1
    assert not (buffer.there[1:] & ~buffer.there[:-1]).any()  # a swarm that rests does not go on
    assert learner.num_steps - before == lengths.sum()
    seen = [len(batch.observations) for batch in buffer.get(10)]
    assert sum(seen) == lengths.sum()
    assert max(seen) == 10


def test_with_a_budget_a_demonstration_has_no_steps_of_resting_swarms():
    env = grouped_env(max_evaluations=300)
    shown = demonstrate(make_controller("fixed:12"), env, 0.0, 1.0, seed=1)
    steps = shown.there.sum(axis=1)
    assert (steps > 1).all()
    assert (steps < ITERATIONS).all()
    assert len(shown.one_by_one().observations) == steps.sum()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"group_size": 3}, "num_swarms must be a multiple of group_size, got 4 and 3"),
        ({"group_size": 8}, "group_size.*8"),
        ({"group_size": 1, "branch_at_events": True}, "branch_at_events needs groups of several swarms"),
        ({"reward": "paired"}, "'paired' and group_size 2 exclude"),
        (
            {"max_evaluations": 500, "noise_steps": 1},
            "max_evaluations 500: .* group_size 2, noise_steps 1 and branches",
        ),
        ({"max_evaluations": 500, "group_size": 1}, "got group_size 1, noise_steps 0 and branches"),
        ({"max_evaluations": 500, "branches": (3,)}, r"noise_steps 0 and branches \[3\]"),
        ({"critic": False}, "without a critic, gae_lambda must be 1, got 0.98"),
        ({"branches": (100,)}, "branches.*100"),
        ({"branches": (3,), "corrected_from": 5}, "branches.*3"),
        ({"noise_steps": 101}, "noise_steps.*101"),
        ({"averaging": 1.0}, "averaging.*1"),
        (
            {"decay_steps": STEPS},
            f"decay_steps must be 0 or at least total_steps, got {STEPS} and {3 * STEPS}",
        ),
        ({"algorithm": "recurrent-ppo"}, "group_size 2 .*recurrent-ppo"),
        ({**EVOLUTION}, "group_size 2 .*evolution"),
        ({"reward": "optimality", "scenarios": ("rooms:0-99",)}, "optimality"),
    ],
)
def test_groups_that_cannot_be_trained_leave_nothing_behind(tmp_path, options, message):
    with pytest.raises(ValueError, match=message):
        train(tmp_path, **{**GROUPED, **options})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "options",
    [
        {
            "critic": False,
            "gae_lambda": 1.0,
            "averaging": 0.5,
            "branches": (40, 90),
            "corrected_from": 30,
            "decay_steps": 4 * STEPS,
        },
        BUDGET,
        pytest.param({"corrected_from": 60, "noise_steps": 7}, marks=pytest.mark.slow),
    ],
)
def test_a_resumed_training_with_groups_equals_one_that_was_not_stopped(tmp_path, options):
    options = {**GROUPED, **options}
    one, other = run_whole_and_stopped(tmp_path, 1, 3 * STEPS, **options)
    ours, theirs = (run.learner.model.policy.state_dict() for run in (one, other))
    assert all(torch.equal(ours[name], theirs[name]) for name in ours)


def test_the_policy_is_the_running_mean_of_the_weights(tmp_path):
    learner = train(tmp_path, **GROUPED, critic=False, gae_lambda=1.0, averaging=0.5).learner
    learner.learn(1)
    first = learner._last_weights()
    learner.learn(2)
    second = learner._last_weights()
    for name, array in learner.weights().items():
        np.testing.assert_allclose(array, 0.5 * first[name] + 0.5 * second[name], rtol=1e-6)
    assert any((first[name] != second[name]).any() for name in first)


def test_the_learning_rate_falls_linearly_to_zero(tmp_path):
    learner = train(tmp_path, **GROUPED, learning_rate=0.01, decay_steps=4 * STEPS).learner
    rates = []
    for chunk in range(5):
        learner.learn(chunk)
        rates.append((learner.num_steps, learner.model.policy.optimizer.param_groups[0]["lr"]))
    for steps, rate in rates:
        assert rate == pytest.approx(0.01 * max(1.0 - steps / (4 * STEPS), 0.0))
    assert rates[0][1] > rates[-1][1] == 0.0


def test_steps_count_common_iterations_once_for_a_group(tmp_path):
    learner = train(tmp_path, **GROUPED, corrected_from=60).learner
    before = learner.num_steps
    learner.learn(1)
    episodes = 2  # that of the rollout, and the one that would follow
    assert learner.num_steps - before == 4 * 40 + episodes * 2 * 60
    assert tiny_config(tmp_path).num_swarms == 4
