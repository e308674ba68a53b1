"""Every controller by name: contract, independence of the width, refusals, policy files."""

import json
import re
from functools import partial

import numpy as np
import pytest

from agents import CONTROLLERS, Controller, SizeLimits, make_controller
from helpers.shipped import policies_on_maps
from helpers.slow import slow_but
from helpers.trainings import assert_decides_alike_at_any_width, make_policy, random_observations
from swarm_gym.action import make_action
from swarm_gym.controllers.distilled import packaged_rules
from swarm_gym.controllers.learned import policy_file
from swarm_gym.controllers.learned.policy_file import (
    PolicyFileError,
    load_policy,
    packaged_policies,
)
from swarm_gym.controllers.onemax_rules import RULES
from swarm_gym.controllers.open_loop import OpenLoopFileError, packaged_open_loops
from swarm_gym.controllers.packaged import Packaged
from swarm_gym.controllers.registry import load_learned
from swarm_gym.controllers.tuned import FORMAT, TunedFileError, load_tuned, packaged_tuned, save_tuned
from swarm_gym.errors import UnknownNameError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.rollout import run_episodes
from swarm_gym.settings import Settings

ARGUMENTS = {
    "fixed": ["60", "2", "200"],
    "distilled": packaged_rules(),
    "open-loop": packaged_open_loops(),
    "diversity-ladder": ["", "rung=9,band=0.3,repair_degree=0.2"],
    "linear-reduction": ["", "start=120,smallest=20"],
    "lpsr": ["", "start=120,smallest=20"],
    "nlpsr": ["", "start=120,smallest=20"],
    "bipop": ["", "start=6,factor=3"],
    "ipop": ["", "start=6,factor=1.5,repair_degree=0.2"],
    "psa": ["", "start=6,threshold=2,repair_degree=0.2"],
    "early-restarts": ["", "start=6,later=4,wait=9,step=0.2"],
    "status-monitor": ["", "patience=1,step=0.5,improvement=0.05"],
    "learned": policies_on_maps(),
    "reacting-loop": ["three-cases", "three-cases-sourced/0@1"],
    "spsfa": ["", "growth=500,smallest=20"],
    "together": ["three-cases@1", "three-cases/0,three-cases/1"],
    "tuned": packaged_tuned(),
    "spsfa-tip": ["", "decay=0.5,low_deviation=100,repair_factor=9"],
}
# Rules of bit strings observe no iteration, and their sizes begin at 1: test_onemax_rules.py has what holds.
NAMES = [
    f"{family}:{argument}" if argument else family
    for family in CONTROLLERS
    if family not in {*RULES, "share"}
    for argument in ARGUMENTS.get(family, [""])
]
# Names of one recipe, by its name, so that a test of all controllers is a few dozen tests, not hundreds.
RECIPES: dict[str, list[str]] = {}
for name in NAMES:
    RECIPES.setdefault(name.partition("/")[0], []).append(name)
ON_MAPS = [one for one in RECIPES if one.partition(":")[0] not in ("ipop", "bipop")]
# One recipe of each family, and what rows of files differ by: optimizers, decisions and sources of members.
ONE_OF_EACH = [
    *{one.partition(":")[0]: one for one in reversed(ON_MAPS) if "ant-colony" not in one}.values(),
    "open-loop:three-cases-sourced-13-knots",
    "open-loop:optimizers-multivariate-base",
    "learned:ablation-dqn",
    "learned:optimizers-all-named",
    "learned:three-cases-extended",
    "learned:three-cases-sourced",
    "learned:dynamic-told",
    "tuned:optimizers-particle-swarm-schedule",
]
# Those, and a fifth of all others, for tests of what all recipes have alike.
SOME = [one for k, one in enumerate(RECIPES) if one in ONE_OF_EACH or k % 5 == 0]


@pytest.fixture
def policy(tmp_path):
    return make_policy(tmp_path / "some.safetensors", np.random.default_rng(0))


def test_a_path_without_a_family_says_how_to_write_it(tmp_path):
    path = tmp_path / "mine.safetensors"
    path.touch()
    with pytest.raises(ValueError, match=rf"is a file; write learned:{re.escape(str(path))} for a policy"):
        make_controller(str(path))


@pytest.mark.parametrize("recipe", slow_but(SOME, RECIPES))
def test_every_controller_keeps_the_protocol_and_the_limits(recipe):
    for name in RECIPES[recipe]:
        controller = make_controller(name)
        assert isinstance(controller, Controller)
        assert 2 <= controller.initial_population_size <= 200
        rng = np.random.default_rng(1)
        controller.reset(7, seed=3)
        for step in range(5):
            observations = random_observations(controller.observation, rng, 7)
            observations[:, 3] = 0 if step == 0 else observations[:, 3]
            actions = controller.act(observations)
            options = {"action": controller.action, "max_evaluations": controller.max_evaluations}
            layout = make_action(Settings(**options), get_optimizer(controller.made_for or "firefly"))
            assert actions.shape == (7, *layout.space.shape)
            assert ((actions >= layout.space.low) & (actions <= layout.space.high)).all()


@pytest.mark.parametrize("recipe", slow_but(["ipop", "bipop", *ONE_OF_EACH], RECIPES))
def test_decisions_do_not_depend_on_how_many_swarms_are_decided_for(recipe):
    for name in RECIPES[recipe]:
        assert_decides_alike_at_any_width(partial(make_controller, name), np.random.default_rng(2), seed=10)


def test_random_covers_the_action_space_and_is_seeded():
    controller = make_controller("random", SizeLimits(10, 20))
    draws = []
    for _ in range(2):
        controller.reset(400, seed=5)
        draws.append(controller.act(np.zeros((400, 4))))
    np.testing.assert_array_equal(*draws)
    assert draws[0][:, 0].min() < 10.5
    assert draws[0][:, 0].max() > 19.5
    assert 0 <= draws[0][:, 1].min() < 0.05
    assert 0.95 < draws[0][:, 1].max() <= 1


@pytest.mark.parametrize(
    ("name", "error", "message"),
    [
        ("spfsa", UnknownNameError, "spfsa.*valid: spsfa, psa, spsfa-tip.*in all"),
        ("", UnknownNameError, "''"),
        ("fixed", ValueError, "population size, e.g. fixed:60"),
        ("fixed:sixty", ValueError, "fixed:sixty"),
        ("fixed:0", ValueError, "0"),
        ("fixed:10001", ValueError, "10001"),
        ("fixed:-5", ValueError, "-5"),
        ("spsfa:3", ValueError, "3"),
        ("learned:nowhere", PolicyFileError, "nowhere.*neither a packaged one"),
        ("learned", PolicyFileError, "neither"),
        ("open-loop:nowhere", OpenLoopFileError, "nowhere.*neither a packaged one"),
        ("tuned:nowhere", TunedFileError, "nowhere.*neither a packaged one"),
    ],
)
def test_unknown_controllers_are_refused(name, error, message):
    with pytest.raises(error, match=message):
        make_controller(name)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("{", "not a readable"),
        ("[]", "not a readable"),
        ({"format": "something"}, "expected format"),
        ({"format": FORMAT}, "controller"),
        ({"format": FORMAT, "controller": 3}, "got 3"),
        ({"format": FORMAT, "controller": "tuned:itself"}, "tuned:itself"),
        (
            {"format": FORMAT, "controller": "spsfa", "manifest": {"config": {"max_population_size": 1}}},
            "1 <= smallest <= largest, got 2 and 1",
        ),
    ],
)
def test_a_file_that_names_no_tuned_controller_is_refused(tmp_path, content, message):
    path = tmp_path / "some.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    with pytest.raises(TunedFileError, match=message):
        make_controller(f"tuned:{path}")


@pytest.mark.parametrize(("config", "limits"), [({}, (2, 200)), ({"max_population_size": 90}, (2, 90))])
def test_a_tuned_controller_has_the_sizes_it_was_tuned_with(tmp_path, config, limits):
    path = tmp_path / "some.json"
    save_tuned(path, "spsfa-tip:growth=99", {"config": config})
    assert make_controller(f"tuned:{path}").limits == SizeLimits(*limits)
    assert make_controller(f"tuned:{path}", SizeLimits(3, 40)).limits == SizeLimits(3, 40)


def test_policy_equals_the_network_it_was_saved_from(policy):
    torch = pytest.importorskip("torch")
    weights, _ = load_policy(policy)
    controller = load_learned(policy)
    observations = random_observations("extended", np.random.default_rng(3), 50)
    with torch.no_grad():
        x = torch.as_tensor(observations)
        x = torch.tanh(
            torch.as_tensor(weights["0.weight"]) @ x.T + torch.as_tensor(weights["0.bias"])[:, None]
        )
        x = torch.as_tensor(weights["1.weight"]) @ x + torch.as_tensor(weights["1.bias"])[:, None]
        means = np.clip(x.T.numpy(), -1.0, 1.0)
    np.testing.assert_allclose(controller.act(observations), means, atol=1e-6)


def test_policies_of_a_recipe_ship_in_a_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(policy_file, "POLICIES", Packaged(tmp_path, ".safetensors"))
    rng = np.random.default_rng(0)
    for name in ("alone", "recipe/0", "recipe/1"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        make_policy(tmp_path / f"{name}.safetensors", rng)
    assert packaged_policies() == ["alone", "recipe/0", "recipe/1"]
    digests = {make_controller(f"learned:{name}").manifest["weights_sha256"] for name in packaged_policies()}
    assert len(digests) == 3
    for name in ("recipe", "recipe/2"):
        with pytest.raises(PolicyFileError, match=r"packaged one \(alone, recipe/\*\)"):
            make_controller(f"learned:{name}")


# Without rules that observe restarts, which fireflies do not count: test_restart_rules.py has what holds.
@pytest.mark.parametrize("recipe", slow_but(ONE_OF_EACH, ON_MAPS))
def test_every_controller_runs_episodes(recipe):
    for name in RECIPES[recipe]:
        controller = make_controller(name)
        optimizer = controller.made_for or "firefly"
        episodes = run_episodes(controller, "case3", range(50, 53), optimizer, iterations=3)
        assert episodes.sizes.shape == episodes.repair_degrees.shape == (3, 3)
        assert (episodes.final_fitness > (300 if optimizer == "firefly" else 0)).all()
        assert (episodes.evaluations > 0).all()


@pytest.mark.parametrize("recipe", slow_but(SOME, RECIPES))
def test_an_identity_is_json_and_does_not_change_while_the_controller_decides(recipe):
    for name in RECIPES[recipe]:
        controller = make_controller(name)
        identity = json.dumps(controller.identity(), sort_keys=True)
        assert identity == json.dumps(make_controller(name).identity(), sort_keys=True)
        controller.reset(3, seed=0)
        rng = np.random.default_rng(0)
        for _ in range(2):
            controller.act(random_observations(controller.observation, rng, 3))
        assert json.dumps(controller.identity(), sort_keys=True) == identity


def test_controllers_that_decide_differently_have_different_identities():
    names = [
        "fixed:60", "fixed:61", "fixed:60,smooth_share=1", "random", "spsfa", "spsfa-tip",
        "spsfa-tip:decay=0.5",
        "linear-reduction", "linear-reduction:start=90", "linear-reduction:repair_degree=0.2",
        "lpsr", "nlpsr", "diversity-ladder", "status-monitor",
        "ipop", "ipop:factor=3", "bipop", "psa", "psa:threshold=2",
        "early-restarts", "early-restarts:later=9", "early-restarts:wait=9",
        "restart", "restart:patience=3", "periodic", "reaction",
        "open-loop:three-cases", "reacting-loop:three-cases", "distilled:three-cases",
        "learned:three-cases/0@1", "learned:three-cases/0@2", "learned:three-cases/1@1", "learned:case1/0@1",
    ]  # fmt: skip
    found = [json.dumps(make_controller(name).identity()) for name in names]
    assert len(set(found)) == len(names)
    limits = [make_controller("spsfa", SizeLimits(2, largest)).identity() for largest in (100, 200)]
    assert limits[0] != limits[1]


def test_a_tuned_file_is_the_controller_that_it_names():
    name = packaged_tuned()[0]
    named, limits = load_tuned(name)
    assert make_controller(f"tuned:{name}").identity() == make_controller(named, limits).identity()


def test_a_controller_without_an_identity_is_refused():
    class Silent(Controller):
        initial_population_size = 9

        def reset(self, num_swarms, seed=0):
            pass

        def act(self, observations):
            return observations

    with pytest.raises(TypeError, match="identity"):
        Silent()
