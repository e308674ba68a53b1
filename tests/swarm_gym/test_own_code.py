"""Names of own code: what they give, what is refused before anything runs, and that files import nothing."""

import importlib
import importlib.metadata
import json
import re
import sys
import types
import warnings

import gymnasium
import numba
import numpy as np
import pytest

from experiments.runs.episode import controller_of
from helpers.own_files import let_own_files_be_imported
from helpers.slow import slow_but
from helpers.trainings import make_policy
from swarm_gym import own_code
from swarm_gym.comparing.comparison import compare
from swarm_gym.comparing.entrants import entrant
from swarm_gym.controllers import CONTROLLERS, make_controller
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.learned.policy_file import PolicyFileError
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.open_loop import OpenLoopFileError, save_open_loop
from swarm_gym.controllers.tuned import FORMAT
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import UnknownNameError
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.own_code import OwnCodeError
from swarm_gym.registration import environment_id
from swarm_gym.reward import make_reward
from swarm_gym.scenarios import make_scenario
from swarm_gym.testing import ContractError, ControllerHint, check_controller, check_optimizer, check_scenario
from swarm_gym.training.config import stored_config
from swarm_gym.training.presets import load_preset
from swarm_gym.vector_env import SwarmVectorEnv

BROKEN = """
import numpy as np
from swarm_gym.controllers import Controller
from swarm_gym.observation import Observation, OBSERVATIONS
from swarm_gym.action import Layout
from swarm_gym.scenarios import Scenario

number = 3
layout = Layout("natural", False)
seen = Observation("seen", OBSERVATIONS["paper"].features, np.float64)

class Base(Controller):
    initial_population_size = 9
    def reset(self, num_swarms, seed=0):
        self.calls = 0
    def identity(self):
        return type(self).__name__
    def act(self, observations):
        return np.tile([9.0, 0.5], (len(observations), 1))

class WrongShape(Base):
    def act(self, observations):
        return np.array([9.0, 0.5])

class Raises(Base):
    def act(self, observations):
        raise KeyError("lost")

class NotANumber(Base):
    def act(self, observations):
        return np.full((len(observations), 2), np.nan)

class NoSize(Base):
    initial_population_size = None

class UnknownLayout(Base):
    action = "sideways"

class LooksAtOthers(Base):
    def act(self, observations):
        return np.tile([4.0 + len(observations), 0.5], (len(observations), 1))

class RepairsEarly(Base):
    initial_population_size = 60
    def act(self, observations):
        return np.tile([60.0, 0.5], (len(observations), 1))

class KeepsTwo(Base):
    def act(self, observations):
        return np.tile([2.0, 0.0], (len(observations), 1))

class Forgets(Base):
    count = [0]
    def act(self, observations):
        self.count[0] += 1
        return np.tile([3.0 + self.count[0] % 7, 0.5], (len(observations), 1))

def another():
    another.made = getattr(another, "made", 0) + 1
    return Scenario("shifting", (0.0, 0.0), (100.0 + another.made, 0.0), (), (0.0, -50.0, 200.0, 50.0))

def text():
    return "a text"
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """A folder with the files of the page and a module with broken things; nothing is known of it before."""
    let_own_files_be_imported(tmp_path, monkeypatch)
    (tmp_path / "broken.py").write_text(BROKEN)
    (tmp_path / "unimportable.py").write_text("raise OSError('no such device')\n")
    for name in {"mine", "broken"} & sys.modules.keys():
        monkeypatch.delitem(sys.modules, name)
    return tmp_path


def test_names_of_own_code_go_wherever_names_go():
    options = {
        "scenario": "my_swarms.hall:HALL",
        "reward": "my_swarms.pay:logarithm_of_the_gap",
        "iterations": 4,
    }
    options |= {"observation": "broken:seen", "action": "broken:layout"}
    env = gymnasium.make(environment_id("firefly"), **options)
    _, info = env.reset(seed=0)
    assert info["scenario"] == "hall"
    earned = [env.step(np.array([9.0, 0.5]))[1] for _ in range(4)]
    assert earned[-1] < -1.0 < earned[0] < 0.0  # at the end the logarithm of the gap, before it a price
    assert make_controller("my_swarms.rule:ByThirds").act(np.array([[0, 0, 0, 40.0]])).tolist() == [[30, 0.3]]
    assert make_scenario("my_swarms.hall:HALL").name == "hall"
    assert entrant("my_swarms.swarm:HillClimber(7)+fixed:5", "firefly") == (
        "my_swarms.swarm:HillClimber",
        "fixed:5",
        7,
    )


@pytest.mark.parametrize(
    ("make", "name", "expected"),
    [
        (make_controller, "nowhere:Rule", "'nowhere' cannot be imported .*ModuleNotFoundError"),
        (make_controller, "unimportable:Rule", "cannot be imported .*no such device"),
        (make_controller, "broken:Missing", "module 'broken' has no attribute 'Missing'"),
        (make_controller, "broken:number", "expected a class or function that gives a Controller, got 3"),
        (make_controller, "broken:text", "expected a Controller .*got 'a text'"),
        (make_controller, "broken:WrongShape", r"act must return numbers of shape \(3, 2\).*shape \(2,\)"),
        (make_controller, "broken:Raises", r"act raised KeyError\('lost'\)"),
        (make_controller, "broken:NotANumber", "act must return finite numbers, got .*nan"),
        (make_controller, "broken:NoSize", "initial_population_size must be a positive integer, got None"),
        (make_controller, "broken:UnknownLayout", "unknown action layout 'sideways'"),
        (make_scenario, "broken:number", "expected a scenario, or a function .*got 3"),
        (make_scenario, "broken:text", "it returned 'a text'"),
        (get_optimizer, "broken:Base", "expected a subclass of Optimizer, got"),
        (get_optimizer, "my_swarms.hall:HALL", "expected a subclass of Optimizer, got"),
        (load_preset, "broken:number", "expected a TrainConfig, got 3"),
    ],
)
def test_what_is_of_another_kind_is_refused_by_name(make, name, expected):
    with pytest.raises(OwnCodeError, match=expected) as error:
        make(name)
    assert name in str(error.value)
    assert len(str(error.value)) < 900


@pytest.mark.parametrize("make", [make_controller, make_scenario, get_optimizer])
def test_what_has_no_form_of_own_code_is_an_unknown_name(make):
    for name in (
        "my_swarms.hall",
        "mine hall:HALL",
        "my_swarms.hall:",
        ":HALL",
        "my_swarms.hall:HALL()",
        "../mine:HALL",
    ):
        with pytest.raises(UnknownNameError, match="valid: "):
            make(name)


def test_a_file_never_imports_code(folder):
    policy = make_policy(
        folder / "policy.safetensors", np.random.default_rng(0), base="my_swarms.rule:ByThirds"
    )
    tuned = folder / "tuned.json"
    tuned.write_text(json.dumps({"format": FORMAT, "controller": "my_swarms.rule:ByThirds", "manifest": {}}))
    loop = folder / "loop.json"
    save_open_loop(loop, Knots(6, [0], [6.0], [0.1]), {})
    another = {"knobs": {"step": [0.1]}, "optimizer": "my_swarms.swarm:HillClimber"}
    loop.write_text(json.dumps({**json.loads(loop.read_text()), **another}))
    preset = folder / "preset.toml"
    preset.write_text('like = "three-cases"\nscenarios = ["case1", "my_swarms.hall:HALL"]\n')
    readings = [
        (lambda: make_controller(f"learned:{policy}"), PolicyFileError),
        (lambda: make_controller(f"tuned:{tuned}"), OwnCodeError),
        (lambda: make_controller(f"open-loop:{loop}"), OpenLoopFileError),
        (lambda: load_preset(str(preset)), OwnCodeError),
        (lambda: stored_config({"config": {"reward": "my_swarms.pay:logarithm_of_the_gap"}}), OwnCodeError),
        (lambda: stored_config({"config": {"observation": "extended+broken:seen"}}), OwnCodeError),
    ]
    for read, error in readings:
        with pytest.raises(error, match="stands for code, which a name in a file never imports"):
            read()
    assert not {"my_swarms.rule", "my_swarms.hall", "my_swarms.pay", "broken"} & sys.modules.keys()
    own_code.allow("my_swarms.rule:ByThirds", "my_swarms.swarm:HillClimber", "my_swarms.hall:HALL")
    assert make_controller(f"tuned:{tuned}").initial_population_size == 60
    with pytest.raises(PolicyFileError, match=r"'my_swarms.rule:ByThirds' has .*proposed population size"):
        make_controller(f"learned:{policy}")  # the policy lacks the inputs that a base adds
    assert make_controller(f"open-loop:{loop}").made_for == "my_swarms.swarm:HillClimber"
    assert load_preset(str(preset)).scenarios == ("case1", "my_swarms.hall:HALL")


def test_a_digest_of_the_source_belongs_to_the_name(folder):
    before = own_code.origin_of("controller", "my_swarms.rule:ByThirds")
    file = folder / "my_swarms" / "rule.py"
    file.write_text(file.read_text().replace("[60, 0.0]", "[61, 0.0]"))
    assert own_code.origin_of("controller", "my_swarms.rule:ByThirds") != before
    assert own_code.source_files() == {"my_swarms.rule:ByThirds": file.resolve()}


class TestEntryPoints:
    """Installed packages may give their code a short name, but none of ours."""

    @pytest.fixture(autouse=True)
    def installed(self, monkeypatch):
        points = {
            "swarm_gym.controllers": {
                "by-thirds": "my_swarms.rule:ByThirds",
                "fixed": "my_swarms.rule:ByThirds",
            },
            "swarm_gym.optimizers": {"hill-climber": "my_swarms.swarm:HillClimber"},
            "swarm_gym.scenarios": {"hall": "my_swarms.hall:HALL"},
        }

        def found(group):
            return {
                name: importlib.metadata.EntryPoint(name, value, group)
                for name, value in points.get(group, {}).items()
            }

        monkeypatch.setattr(own_code, "_installed", found)

    def test_short_names_are_names(self):
        assert make_controller("by-thirds").initial_population_size == 60
        assert get_optimizer("hill-climber").name == "hill-climber"
        assert SwarmEnv(scenario="hall", iterations=2).reset(seed=0)[1]["scenario"] == "hall"

    def test_an_environment_of_a_short_name_has_it_in_its_id(self):
        assert environment_id("hill-climber") == "my_swarms-swarm/hill-climber-v0"
        assert gymnasium.make(environment_id("hill-climber"), scenario="case1").reset(seed=0)[1][
            "evaluations"
        ]

    def test_one_that_shadows_a_name_of_ours_is_refused(self):
        with pytest.raises(OwnCodeError, match=r"'fixed': .* has an entry point of this name"):
            make_controller("fixed:60")

    def test_a_file_does_not_import_them_either(self, folder):
        policy = make_policy(folder / "policy.safetensors", np.random.default_rng(0), base="by-thirds")
        with pytest.raises(PolicyFileError, match="stands for code"):
            make_controller(f"learned:{policy}")


@pytest.mark.parametrize("size", [1, 2])
def test_a_controller_of_bit_strings_runs_by_its_name(folder, size):
    (folder / "bits.py").write_text(
        "import numpy as np\n"
        "from swarm_gym.controllers import Controller\n"
        "class Theory(Controller):\n"
        "    observation, action, made_for = 'theory', 'natural', 'one-plus-lambda-lambda'\n"
        f"    initial_population_size = {size}\n"
        "    def reset(self, num_swarms, seed=0): pass\n"
        "    def act(self, observations):\n"
        "        length, ones = observations[:, 0], observations[:, 1]\n"
        "        return np.stack([np.sqrt(length / np.maximum(length - ones, 1.0)), 0.0 * ones], axis=1)\n"
        "    def identity(self): return 'theory'\n"
    )
    found = compare(["bits:Theory", "theory"], ["onemax:30"], range(2), "one-plus-lambda-lambda")
    assert (found.fitness == 0.0).all()
    check_controller("bits:Theory", "onemax:50")


def test_optimizers_whose_classes_share_a_name_have_environments_of_their_own(folder):
    (folder / "made.py").write_text(
        "from typing import NamedTuple, get_type_hints\n"
        "from my_swarms.swarm import HillClimber\n"
        "def make(iterations):\n"
        "    fields = get_type_hints(HillClimber.parameter_class, include_extras=True)\n"
        "    class Variant(HillClimber):\n"
        "        parameter_class = NamedTuple('Parameters', [*fields.items()])\n"
        "        default_options = {'iterations': iterations}\n"
        "    return Variant\n"
        "Short, Long = make(2), make(5)\n"
    )
    made = [gymnasium.make(environment_id(f"made:{name}"), scenario="case1") for name in ("Short", "Long")]
    assert [env.unwrapped.settings.iterations for env in made] == [2, 5]
    found = compare(["made:Short+fixed:9", "made:Long+fixed:9"], ["case1"], range(2))
    assert (found.evaluations[0] < found.evaluations[1]).all()


def test_checks_pass_for_the_examples_of_the_page():
    check_controller("my_swarms.rule:ByThirds", "my_swarms.hall:HALL")
    check_scenario("my_swarms.hall:HALL")


def test_checks_pass_on_maps_that_change_and_for_optimizers_of_four_members():
    check_scenario("dynamic:case1-block@70")
    check_controller("fixed:60", "dynamic:case1-block@20")
    check_scenario("onemax:40", "one-plus-lambda-lambda")
    check_controller("one-fifth", "onemax:50")
    check_optimizer("one-plus-lambda-lambda", "onemax:20")
    check_scenario("case3", "differential-evolution")
    check_optimizer("differential-evolution")


@pytest.mark.slow
def test_the_check_of_optimizers_passes_for_the_example_and_for_ours():
    check_optimizer("my_swarms.swarm:HillClimber", "my_swarms.hall:HALL")
    for name in OPTIMIZERS:
        check_optimizer(name, "block:20" if name in ("glowworm", "ant-colony") else "case3")


@pytest.mark.parametrize(
    "name",
    slow_but(
        ["fixed:60", "learned:three-cases/0@1"],
        ["fixed:60", "spsfa-tip", "learned:three-cases/0@1", "open-loop:three-cases"],
    ),
)
def test_the_check_of_controllers_passes_for_ours(name):
    assert ControllerName.parse(name).family in CONTROLLERS
    with warnings.catch_warnings():
        warnings.simplefilter("error", ControllerHint)
        check_controller(name)


@pytest.mark.parametrize(
    ("check", "name", "expected"),
    [
        (
            check_controller,
            "broken:LooksAtOthers",
            r"swarm 0 alone gets \[5.0, 0.5\].*but \[9.0, 0.5\] beside 4",
        ),
        (check_controller, "broken:Forgets", "swarm 0 alone gets|two episodes of the same seed differ"),
        (check_scenario, "broken:another", "two calls give different scenarios"),
    ],
)
def test_checks_name_the_contract_that_is_not_kept(check, name, expected):
    with pytest.raises(ContractError, match=expected):
        check(name)


@pytest.mark.parametrize(
    ("name", "reasons"),
    [
        (
            "broken:RepairsEarly",
            r"\(it repairs early: phi is 0.50 on average in the first 20 iterations, .*\)$",
        ),
        ("broken:KeepsTwo", r"\(it keeps 2 members in most iterations, too few .*\)$"),
    ],
)
def test_a_controller_that_ends_worse_than_a_constant_population_gets_a_hint(name, reasons):
    with pytest.warns(ControllerHint, match=reasons) as found:
        check_controller(name)
    text = str(found[0].message)
    mine, theirs = map(int, re.search(r"fitness of (\d+); 60 constant members end at (\d+)", text).groups())
    assert text.startswith(f"controller {name}: on scenario 'case3' and 5 seeds")
    assert mine > 1.1 * theirs


class TestEdits:
    """A name stands for the present code: after a reload and after an edited cell of a notebook."""

    @pytest.fixture
    def edit(self, folder):
        """Return a function that edits a file and executes its module again."""

        def edit(module, old, new):
            file = folder / f"{module.replace('.', '/')}.py"
            text = file.read_text()
            assert old in text
            file.write_text(text.replace(old, new) + "\n")  # another size, so that the bytecode is stale
            importlib.reload(sys.modules[module])

        return edit

    def test_an_edited_controller_is_the_one_that_is_made_and_checked(self, edit):
        assert make_controller("my_swarms.rule:ByThirds").initial_population_size == 60
        edit("my_swarms.rule", "initial_population_size = 60", "initial_population_size = 61")
        assert make_controller("my_swarms.rule:ByThirds").initial_population_size == 61
        assert controller_of("my_swarms.rule:ByThirds").initial_population_size == 61
        check_controller("my_swarms.rule:ByThirds")
        edit("my_swarms.rule", "return np.array(", "return np.nan * np.array(")
        with pytest.raises(OwnCodeError, match="act must return finite numbers"):
            check_controller("my_swarms.rule:ByThirds")

    def test_the_controllers_of_experiments_are_made_once_for_each_code(self, edit):
        first = controller_of("my_swarms.rule:ByThirds")
        assert controller_of("my_swarms.rule:ByThirds") is first
        edit("my_swarms.rule", "initial_population_size = 60", "initial_population_size = 59")
        assert controller_of("my_swarms.rule:ByThirds").initial_population_size == 59
        assert controller_of("fixed:60") is controller_of("fixed:60")

    def test_edited_scenarios_rewards_and_layouts_are_the_ones_that_are_made(self, edit):
        assert make_scenario("my_swarms.hall:HALL").target == (500.0, 0.0)
        edit("my_swarms.hall", "target=(500.0, 0.0)", "target=(450.0, 0.0)")
        assert make_scenario("my_swarms.hall:HALL").target == (450.0, 0.0)
        reward, seen = make_reward("my_swarms.pay:logarithm_of_the_gap"), make_observation("broken:seen")
        edit("my_swarms.pay", "0.0", "-5.0")
        edit("broken", "number = 3", "number = 4")
        assert make_reward("my_swarms.pay:logarithm_of_the_gap") is not reward
        assert make_observation("broken:seen") is not seen

    def test_a_cell_of_a_notebook_that_ran_again_gives_another_controller(self, monkeypatch):
        main = types.ModuleType("__main__")  # has no file
        monkeypatch.setitem(sys.modules, "__main__", main)
        digests = []
        for size in (5, 8):
            exec(BROKEN + f"class Mine(Base):\n    initial_population_size = {size}\n", main.__dict__)
            assert make_controller("__main__:Mine").initial_population_size == size
            main.Mine.act = eval(f"lambda self, seen: {size} + 0 * seen[:, :2]")
            digests.append(own_code.origin_of("controller", "__main__:Mine"))
        assert digests[0] != digests[1]
        assert own_code.source_files() == {}

    @pytest.mark.slow
    @pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs the compiler")
    def test_an_edited_optimizer_runs_its_new_kernels(self, edit, folder):
        name, options = "my_swarms.again:HillClimber", {"scenario": "case3", "initial_population_size": 9}
        (folder / "my_swarms/again.py").write_text((folder / "my_swarms/swarm.py").read_text())

        def episode():
            env = gymnasium.make(environment_id(name), iterations=9, **options)
            env.reset(seed=1)
            return [env.step(np.array([9.0, 0.0]))[4]["best_fitness"] for _ in range(9)]

        before = episode()
        assert episode() == before
        edit("my_swarms.again", "Parameter(0.2,", "Parameter(0.9,")
        larger_steps = episode()
        edit("my_swarms.again", "2.0 * work.noise[k] - 1.0", "0.0 * work.noise[k]")
        no_steps = episode()
        assert before[-1] != larger_steps[-1]
        assert len(set(no_steps)) == 1 < len(set(before))
        check_optimizer(name)


PAY = """
import numpy as np

calls = [0]

def one_for_all(transition):
    return np.array([1.0])

def a_number(transition):
    return 1.0

def lost_later(transition):
    calls[0] += 1
    reward = np.ones(len(transition.cost))
    reward[-1] = np.nan if calls[0] > 2 else 1.0
    return reward

def infinite(transition):
    return np.full(len(transition.cost), -np.inf)

def words(transition):
    return np.full(len(transition.cost), "much", dtype=object)

def texts(transition):
    return np.full(len(transition.cost), "much")

def nothing_for_those_who_rest(transition):
    return np.where(transition.cost > 0.0, 1.0, np.nan)
"""
REWARDED = {"iterations": 5, "initial_population_size": 6, "max_population_size": 12}


class TestRewards:
    """Rewards are checked in every step, and messages name them."""

    @pytest.fixture(autouse=True)
    def pay(self, folder, monkeypatch):
        (folder / "paid.py").write_text(PAY)
        monkeypatch.delitem(sys.modules, "paid", raising=False)

    @pytest.mark.parametrize(
        ("name", "expected"),
        [
            ("one_for_all", r"'paid:one_for_all' must return an array of shape \(3,\).* shape \(1,\)"),
            ("a_number", r"'paid:a_number' must return an array of shape \(3,\).*got 1.0"),
            ("lost_later", "'paid:lost_later' of swarm 2 in iteration 3 is nan, expected a finite number"),
            ("infinite", "'paid:infinite' of swarm 0 in iteration 1 is -inf"),
            ("words", "'paid:words' must return numbers, got the type object"),
            ("texts", "'paid:texts' must return numbers, got the type <U4"),
        ],
    )
    def test_what_is_no_number_for_each_swarm_is_refused(self, name, expected):
        envs = SwarmVectorEnv(3, reward=f"paid:{name}", **REWARDED)
        envs.reset(seed=0)
        steps = 2 if name == "lost_later" else 0
        for _ in range(steps):
            envs.step(np.tile([6.0, 0.5], (3, 1)))
        with pytest.raises(OwnCodeError, match=expected):
            envs.step(np.tile([6.0, 0.5], (3, 1)))

    def test_the_reward_of_a_swarm_that_rests_may_be_anything(self):
        envs = SwarmVectorEnv(2, reward="paid:nothing_for_those_who_rest", **REWARDED)
        envs.reset(seed=0)
        envs.reset(options={"reset_mask": np.array([True, False])})
        _, rewards, ended = envs.step_running(np.tile([6.0, 0.5], (2, 1)), np.array([True, False]))
        assert rewards.tolist() == [1.0, 0.0]
        assert not ended.any()
