"""Blinded policies decide by the iteration alone, and suites run them by name."""

import numpy as np
import pytest

from agents.evaluation import masking
from agents.evaluation.masking import clock_columns, load_blinded
from experiments.runs.configuration import identity
from experiments.runs.episode import Episode, _controller
from experiments.runs.labels import label
from experiments.studies.learned.suites import HEADLINE
from helpers.stored_runs import part_of
from swarm_gym.controllers.learned.policy_file import PolicyFileError
from swarm_gym.controllers.registry import load_learned

POLICY = "three-cases/0@1"
NAME = f"blinded:{POLICY}"


@pytest.fixture(autouse=True)
def few_episodes(monkeypatch):
    monkeypatch.setattr(masking, "NUM_EPISODES", 6)
    _controller.cache_clear()
    yield
    _controller.cache_clear()


def test_a_blinded_policy_decides_by_the_iteration_alone():
    controller, seeing = load_blinded(POLICY), load_learned(POLICY)
    width = len(controller._courses[0])
    clocks = clock_columns(seeing)
    rng = np.random.default_rng(0)
    for iteration in (0, 1, 2):
        observations = rng.uniform(0.0, 1.0, (5, width)).astype(np.float32)
        observations[:, clocks] = controller._courses[iteration][clocks]
        decided = controller.act(observations)
        assert (decided == decided[0]).all()
    assert controller.price == seeing.price == 1.0
    assert controller.initial_population_size == seeing.initial_population_size


def test_a_policy_blinded_for_longer_episodes_has_the_mean_inputs_of_these():
    usual, longer = load_blinded(POLICY), load_blinded(POLICY, longer=2.0)
    assert len(longer._courses) == 2 * len(usual._courses)
    share = clock_columns(load_learned(POLICY))[0]
    last = longer._courses[-1, share] / usual._courses[-1, share]
    assert last == pytest.approx(2.0, rel=0.02)  # the iteration, counted from 0
    assert load_blinded("terrain-shifted/0", longer=8.0).max_evaluations == 20_000


def test_a_suite_runs_a_blinded_policy_as_another_controller():
    suite = part_of(HEADLINE, (NAME, f"learned:{POLICY}"), ("case1",), 1, baseline=f"learned:{POLICY}")
    ends = []
    for name in suite.controllers:
        *_, last = Episode((name, "case1", 0), suite)
        ends.append(last.history[0, -1, :3].tolist())
    assert ends[0] != ends[1]
    assert label(NAME) == "blinded (three-cases/0@1)"
    assert label("blinded:three-cases/*@1") == "blinded three-cases@1"


def test_a_blinded_policy_is_known_by_the_weights_of_the_policy(monkeypatch):
    monkeypatch.setattr(
        masking, "watch", lambda *_, **__: pytest.fail("episodes run, though nothing decides")
    )
    seeing = identity(f"learned:{POLICY}", load_learned(POLICY))
    kind, masked, known = identity(NAME, load_blinded(POLICY))
    assert (kind, known) == ("masked", seeing)
    assert len(masked) > 1


def test_only_learned_policies_are_blinded():
    with pytest.raises(PolicyFileError, match="nobody"):
        load_blinded("nobody/0")
