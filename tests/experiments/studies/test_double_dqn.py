"""Double DQN with published settings on OneMax: its memory, its updates and what it learns."""

import json

import numpy as np
import pytest
import torch

from experiments.studies.onemax import double_dqn, q_policies
from experiments.studies.onemax.double_dqn import (
    Learners,
    ReplayMemory,
    StackedNetworks,
    train,
)
from experiments.studies.onemax.runtimes import best_constant, expected, optimum
from swarm_gym.comparing.onemax import expected_runtime
from swarm_gym.controllers import make_controller

SIZE, SEEDS = 20, (3, 5)
STATES = SIZE - SIZE // 2


def filled_memory(memory, number):
    """Add random transitions to a memory, and return them as (number, S) arrays."""
    generator = np.random.default_rng(0)
    shape = number, len(SEEDS)
    states = generator.integers(STATES, size=shape)
    choices = generator.integers(len(q_policies.CHOICES), size=shape)
    after = generator.integers(STATES + 1, size=shape)
    rewards = generator.normal(size=shape)
    for row in zip(states, choices, after, rewards, strict=True):
        memory.add(*row)
    return states, choices, after, rewards


def test_a_minibatch_has_the_counts_and_sums_of_the_transitions_that_were_drawn(monkeypatch):
    monkeypatch.setattr(double_dqn, "BATCH", 64)
    memory = ReplayMemory(SEEDS, STATES, 100)
    states, choices, after, rewards = filled_memory(memory, 30)
    values = np.random.default_rng(1).normal(size=(len(SEEDS), STATES + 1))
    counts, sums = memory.draw(values)
    expected_counts, expected_sums = np.zeros_like(counts), np.zeros_like(sums)
    for row, seed in enumerate(SEEDS):
        for k in np.random.default_rng([STATES, seed]).integers(30, size=64):
            cell = row, states[k, row], choices[k, row]
            expected_counts[cell] += 1.0
            expected_sums[cell] += rewards[k, row] + double_dqn.DISCOUNT * values[row, after[k, row]]
    np.testing.assert_array_equal(counts, expected_counts)
    np.testing.assert_allclose(sums, expected_sums, rtol=1e-12)
    np.testing.assert_array_equal(memory.median_rewards(), np.median(rewards, axis=0))


def test_stacked_networks_are_those_of_each_seed():
    inputs = torch.randn(len(SEEDS), 4, 2)
    stacked = StackedNetworks(SEEDS)(inputs).detach().numpy()
    for row, seed in enumerate(SEEDS):
        torch.manual_seed(seed)
        first, second, last = (torch.nn.Linear(*pair) for pair in ((2, 50), (50, 50), (50, 7)))
        alone = torch.nn.Sequential(first, torch.nn.ReLU(), second, torch.nn.ReLU(), last)
        np.testing.assert_allclose(stacked[row], alone(inputs[row]).detach().numpy(), atol=1e-6)


def test_an_update_is_that_of_double_dqn_on_the_transitions_one_by_one(monkeypatch):
    monkeypatch.setattr(double_dqn, "BATCH", 16)
    learners = Learners(SIZE, SEEDS)
    states, choices, after, rewards = filled_memory(learners.memory, 30)
    inputs = torch.tensor([[SIZE, SIZE // 2 + k] for k in range(STATES + 1)], dtype=torch.float32)
    drawn = [np.random.default_rng([STATES, seed]).integers(30, size=16) for seed in SEEDS]

    networks, target = StackedNetworks(SEEDS), StackedNetworks(SEEDS)
    adam = torch.optim.Adam(networks.parameters(), lr=double_dqn.STEP_SIZE)
    loss = torch.zeros(())
    stacked_inputs = inputs.expand(len(SEEDS), -1, -1)
    estimates, of_target = networks(stacked_inputs), target(stacked_inputs).detach()
    for row, numbers in enumerate(drawn):
        for k in numbers:
            place = after[k, row]
            value = of_target[row, place, estimates[row, place].argmax()] if place < STATES else 0.0
            aim = rewards[k, row] + double_dqn.DISCOUNT * value
            loss = loss + (estimates[row, states[k, row], choices[k, row]] - aim) ** 2 / 16
    loss.backward()
    adam.step()

    learners.learn()
    for found, known in zip(learners._networks.parameters(), networks.parameters(), strict=True):
        np.testing.assert_allclose(found.detach().numpy(), known.detach().numpy(), atol=2e-5)


@pytest.fixture
def short(monkeypatch):
    """Make trainings short: fewer random steps and smaller minibatches."""
    monkeypatch.setattr(double_dqn, "BATCH", 256)
    monkeypatch.setattr(double_dqn, "RANDOM_STEPS", 1_000)
    monkeypatch.setattr(double_dqn, "EVALUATED_EVERY", 100)


@pytest.mark.usefixtures("short")
def test_a_training_repeats_and_keeps_its_best_policy():
    first = train(SIZE, SEEDS, 1_300)
    assert train(SIZE, SEEDS, 1_300) == first
    for policy, seed in zip(first, SEEDS, strict=True):
        assert policy["seed"] == seed
        assert policy["step"] in (1_100, 1_200, 1_300)
        assert q_policies.expected_of(policy["best"], SIZE) <= q_policies.expected_of(policy["last"], SIZE)


@pytest.mark.usefixtures("short")
def test_a_training_finds_a_policy_ahead_of_every_constant_lambda():
    [policy] = train(60, (3,), 4_000)
    assert q_policies.expected_of(policy["best"], 60) < 0.95 * best_constant(60)[1]


def test_a_policy_of_one_lambda_is_worth_what_this_constant_is():
    ones = expected_runtime(make_controller("static:mutants=4,children=4,strength=1,bias=1"), 40)
    assert q_policies.expected_of([2] * 20, 40) == pytest.approx(ones, rel=1e-12)


def test_lengths_are_trained_one_after_another_and_those_of_a_file_stay(tmp_path, monkeypatch):
    file = tmp_path / "policies.json"
    monkeypatch.setattr(double_dqn, "train", lambda size, seeds: [{"seed": s, "best": [size]} for s in seeds])
    file.write_text(json.dumps({"40": {"policies": [], "provenance": {}}}), encoding="utf-8")
    assert double_dqn.ship((12, 14), (0,), file) == file
    found = q_policies.stored(file)
    assert [*found] == ["40", "12", "14"]
    assert found["12"]["policies"] == [{"seed": 0, "best": [12]}]
    assert "commit" in found["12"]["provenance"]


@pytest.mark.parametrize("size", [100, 200, 500])
def test_the_policies_that_ship_are_between_the_optimum_and_theory(size):
    evaluations = q_policies.expected_of_trained(size)
    assert len(evaluations) == 10
    assert (evaluations >= optimum("onemax-portfolio", size) * (1.0 - 1e-9)).all()
    assert (evaluations < expected("theory", size)).all()


def test_a_length_without_policies_has_no_expectations():
    assert q_policies.expected_of_trained(1000).shape == (0,)
