"""Policies that correct a controller: correcting nothing is deciding as it does."""

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from agents import Controller, SizeLimits, make_controller
from helpers.trainings import make_rule, untrained_manifest
from swarm_gym.action import make_action
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.learned.policy_file import PolicyFileError, save_policy
from swarm_gym.controllers.learned.residual import Base
from swarm_gym.controllers.open_loop import OpenLoop, save_open_loop
from swarm_gym.controllers.registry import load_learned
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.rollout import run_episodes
from swarm_gym.settings import Settings
from swarm_gym.training.sb3_vec_env import SB3VecEnv
from swarm_gym.vector_env import SwarmVectorEnv

LIMITS = SizeLimits(2, 20)
SIZES = {"initial_population_size": 6, "max_population_size": 20, "iterations": 12}
NUM_DECISIONS = {"normalised": 2, "extended-normalised": 4}


class Encoded(Controller):
    """A controller that answers in a scaled layout, with nothing in between."""

    initial_population_size = 6

    def __init__(self, controller, layout):
        self.controller, self.layout = controller, layout
        self.observation, self.action = controller.observation, layout.name

    def reset(self, num_swarms, seed=0):
        self.controller.reset(num_swarms, seed)

    def identity(self):
        return self.layout.name, self.controller.identity()

    def act(self, observations):
        return self.layout.encode(self.controller.act(observations))


def make_layout(action):
    return make_action(Settings(action=action, initial_population_size=6, max_population_size=20), Firefly)


def make_base(name, action="normalised", budget=None):
    return Base(make_controller(name, LIMITS), make_layout(action), max_evaluations=budget)


def silent_policy(path, base, base_name, action, last=0.0, corrected_from=0, budget=None):
    """A policy with random hidden layers and a last one that always says the same."""
    rng = np.random.default_rng(0)
    features = base.features("extended")
    decisions = len(base.layout.labels)
    weights = {
        "0.weight": rng.normal(size=(8, len(features))).astype(np.float32),
        "0.bias": rng.normal(size=8).astype(np.float32),
        "1.weight": np.zeros((decisions, 8), np.float32),
        "1.bias": np.full(decisions, last, np.float32),
    }
    manifest = untrained_manifest(
        "extended", action=action, base=base_name, corrected_from=corrected_from, features=features,
        initial_population_size=6, max_population_size=20, max_evaluations=budget, num_decisions=decisions,
    )  # fmt: skip
    save_policy(path, weights, manifest)
    return load_learned(path, LIMITS)


@pytest.fixture(params=["spsfa-tip", "open-loop", "open-loop with knobs"])
def based(request, tmp_path):
    """Name of a controller, and the scaled layout of its decisions."""
    if request.param == "spsfa-tip":
        return "spsfa-tip", "normalised"
    path = tmp_path / "some.json"
    knobs = {"noise": [0.3, 1.0], "attractiveness": [0.1, 0.4]} if "knobs" in request.param else {}
    save_open_loop(path, Knots(6, [0, 9], [6.0, 17.3], [0.1, 0.7], knobs), {})
    return f"open-loop:{path}", "extended-normalised" if knobs else "normalised"


def test_a_policy_that_corrects_nothing_decides_as_its_base_bit_for_bit(tmp_path, based):
    name, action = based
    alone = Encoded(make_controller(name, LIMITS), make_layout(action))
    policy = silent_policy(tmp_path / "p.safetensors", make_base(name, action), name, action)
    for controller in (alone, policy):
        controller.reset(5)
    ours, theirs = (run_episodes(c, "case3", range(40, 45), **SIZES) for c in (policy, alone))
    for field in ("final_fitness", "evaluations", "returns", "sizes", "repair_degrees"):
        np.testing.assert_array_equal(getattr(ours, field), getattr(theirs, field))
    assert len(np.unique(ours.sizes)) > 3


def test_a_stretched_policy_corrects_its_stretched_base(tmp_path):
    path = tmp_path / "some.json"
    save_open_loop(path, Knots(6, [0, 9], [6.0, 17.3], [0.1, 0.7]), {})
    name = f"open-loop:{path}"
    policy = silent_policy(tmp_path / "p.safetensors", make_base(name), name, "normalised")
    longer, base = policy.stretched(4), make_controller(name, LIMITS).stretched(4)
    assert longer.corrects.identity() == base.identity() != policy.corrects.identity()
    assert longer.identity() != policy.identity()
    results = [
        run_episodes(controller, "case1", range(3), **{**SIZES, "iterations": 48})
        for controller in (longer, Encoded(base, make_layout("normalised")), policy)
    ]
    assert np.array_equal(results[0].sizes, results[1].sizes)
    assert not np.array_equal(results[0].sizes, results[2].sizes)
    rule = silent_policy(tmp_path / "r.safetensors", make_base("spsfa-tip"), "spsfa-tip", "normalised")
    assert rule.stretched(4).identity() == rule.identity()


def test_the_training_environment_adds_to_the_base_what_the_controller_adds(tmp_path, based):
    name, action = based
    for last in (0.0, 0.07):
        policy = silent_policy(tmp_path / "p.safetensors", make_base(name, action), name, action, last)
        episodes = run_episodes(policy, "case3", range(40, 43), **SIZES)
        base = make_base(name, action)
        env = SwarmVectorEnv(
            3, scenario="case3", observation=f"{base.controller.observation}+extended", action=action,
            autoreset_mode=AutoresetMode.SAME_STEP, **SIZES,
        )  # fmt: skip
        adapter = SB3VecEnv(env, base)
        adapter.seed(40)
        assert adapter.observation_space.contains(adapter.reset()[0])
        corrections = np.full((3, NUM_DECISIONS[action]), last, np.float32)
        for _ in range(SIZES["iterations"]):
            observations, _, dones, infos = adapter.step(corrections)
            assert all(adapter.observation_space.contains(row) for row in observations)
        assert dones.all()
        np.testing.assert_array_equal([i["best_fitness"] for i in infos], episodes.final_fitness)
        np.testing.assert_array_equal([i["evaluations"] for i in infos], episodes.evaluations)
        assert all(adapter.observation_space.contains(i["terminal_observation"]) for i in infos)


def test_corrections_change_the_sizes_in_their_direction(tmp_path):
    more, none = (
        silent_policy(tmp_path / "p.safetensors", make_base("fixed:9"), "fixed:9", "normalised", last)
        for last in (0.3, 0.0)
    )
    sizes = [run_episodes(c, "case3", range(2), **SIZES).sizes for c in (more, none)]
    assert (sizes[0] > sizes[1]).all()
    assert (sizes[1] == 9).all()


def test_a_policy_sees_its_own_layout_and_what_is_proposed():
    base = make_base("spsfa-tip")
    assert base.features("scaled")[:4] == [f.name for f in OBSERVATIONS["scaled"].features]
    assert base.features("scaled")[4:] == ["proposed population size", "proposed repair degree"]
    base.controller.reset(2)
    whole = np.concatenate([np.zeros((2, 4)), np.full((2, 4), 0.25)], axis=1)
    proposal = base.propose(whole)
    np.testing.assert_array_equal(proposal.seen, np.concatenate([whole[:, 4:], proposal.actions], axis=1))
    np.testing.assert_array_equal(base.last(whole[0]), [0.25] * 4 + [0.0] * 2)


@pytest.mark.parametrize("name", ["fixed:9", "open-loop"])
def test_until_a_given_iteration_the_base_decides_alone(tmp_path, name):
    if name == "open-loop":
        name = f"open-loop:{tmp_path / 'some.json'}"
        save_open_loop(tmp_path / "some.json", Knots(6, [0, 9], [6.0, 17.3], [0.1, 0.7]), {})
    base = make_base(name)
    policies = [
        silent_policy(tmp_path / f"{begin}.safetensors", base, name, "normalised", 0.3, begin)
        for begin in (0, 4, 100)
    ]
    now, later, never = (run_episodes(c, "case3", range(3), **SIZES).sizes for c in policies)
    alone = run_episodes(make_controller(name, LIMITS), "case3", range(3), **SIZES).sizes
    np.testing.assert_array_equal(never, alone)
    np.testing.assert_array_equal(later[:, :4], alone[:, :4])
    np.testing.assert_array_equal(later[:, 4:], now[:, 4:])
    assert (later[:, 4:] > alone[:, 4:]).all()


@pytest.mark.parametrize(("observation", "unit"), [("paper", 1), ("scaled", 100)])
def test_a_base_is_corrected_from_the_same_iteration_whatever_it_sees(observation, unit):
    controller = make_controller("fixed:9", LIMITS)
    controller.observation = observation
    base = Base(controller, make_layout("normalised"), 7)
    whole = np.zeros((101, 8), np.float32)
    whole[:, 3] = np.arange(101, dtype=np.float32) / unit
    np.testing.assert_array_equal(base.propose(whole).correctable, np.arange(101) >= 7)


@pytest.mark.parametrize("action", ["natural", "extended"])
def test_layouts_that_are_not_scaled_cannot_be_corrected(action):
    with pytest.raises(ValueError, match=f"cannot be corrected in the layout '{action}'"):
        make_base("spsfa", action)
    paced = make_action(Settings(action="paced", max_evaluations=1000), Firefly)
    with pytest.raises(ValueError, match="'paced'"):
        Base(make_controller("spsfa"), paced)


def test_controllers_whose_decisions_the_layout_does_not_take_are_refused():
    loop = OpenLoop(Knots(9, [0], [9.0], [0.5], {"noise": [1.0], "attractiveness": [0.5]}))
    scaled = Encoded(make_controller("fixed:9"), make_layout("normalised"))
    for controller, action in ((loop, "extended"), (scaled, "normalised")):
        with pytest.raises(ValueError, match=f"'{action}' cannot be corrected in the layout 'normalised'"):
            Base(controller, make_layout("normalised"))


def test_a_base_that_needs_a_budget_decides_in_episodes_of_that_budget_only(tmp_path):
    name, path = make_rule(tmp_path / "rule.json", 900), tmp_path / "p.safetensors"
    base = make_base(name, budget=900)
    policy = silent_policy(path, base, name, "normalised", budget=900)
    assert policy.env_options()["max_evaluations"] == 900
    ours, theirs = (run_episodes(c, "case3", range(3), **SIZES) for c in (policy, base.controller))
    np.testing.assert_array_equal(ours.sizes, theirs.sizes)
    for other in (None, 800):
        with pytest.raises(PolicyFileError, match=f"{path}: base '{name}': .*max_evaluations 900"):
            silent_policy(path, base, name, "normalised", budget=other)


def test_any_base_may_decide_under_the_budget_of_the_policy(tmp_path):
    base = make_base("spsfa")
    policy = silent_policy(tmp_path / "p.safetensors", base, "spsfa", "normalised", budget=900)
    assert policy.env_options()["max_evaluations"] == 900


def test_a_base_that_is_told_a_price_is_refused():
    priced = make_controller("fixed:9", LIMITS)
    priced.price = 0.3
    with pytest.raises(ValueError, match=r"price, 0\.3"):
        Base(priced, make_layout("normalised"))
