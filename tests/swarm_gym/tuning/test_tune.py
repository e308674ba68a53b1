"""Tuning: what is minimised on which episodes, exact resuming, results that are controllers, refusals."""

import dataclasses
import json
import re

import numpy as np
import pytest

from agents import make_controller
from agents.tune import main, read_command_line
from helpers.slow import slow_but
from swarm_gym.controllers.fixed import Fixed
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.open_loop import OpenLoop
from swarm_gym.controllers.parameters import format_parameters
from swarm_gym.controllers.schedules import SelfAdaptiveSchedule
from swarm_gym.env import SwarmEnv
from swarm_gym.observation import make_observation
from swarm_gym.reward import NEED_A_BUDGET
from swarm_gym.runs.folder import RunFolderError
from swarm_gym.runs.seeds import TRAINING_START, training_seed
from swarm_gym.tuning.config import TuneConfig
from swarm_gym.tuning.knots import START, START_ITERATIONS, KnotSpace
from swarm_gym.tuning.parameter_spaces import SCHEDULE
from swarm_gym.tuning.run import TuningRun
from swarm_gym.tuning.side_by_side import LOSSES, SideBySide
from swarm_gym.tuning.tuners import TUNERS, kind_defaults

TINY = {"episodes": 4, "scenarios": ("case3", "case1"), "max_population_size": 12}
BY_EVOLUTION = ("open-loop", "reacting-loop", "constant")
ROUND = {what: (4 if what in BY_EVOLUTION else 1) * 4 * 100 for what in TUNERS}
SMALL_KIND = {"candidates": 4, "initial_population_size": 6}


@pytest.fixture(autouse=True)
def short_estimate(monkeypatch):
    monkeypatch.setattr("swarm_gym.tuning.run.ESTIMATE_EPISODES", 2)


def tune(folder, what="open-loop", rounds=3, **options):
    small = SMALL_KIND if "candidates" in TUNERS[what].options else {}
    options = {**TINY, **small, "total_steps": rounds * ROUND[what], **options}
    changes = {"runs": folder, "name": "it", **options}
    return TuningRun(dataclasses.replace(kind_defaults(what), **changes))


def stored(path):
    content = json.loads(path.read_text())
    del content["manifest"]
    return content


def play(controller, scenario, seed, **options):
    """Best fitness above the bound, reward and evaluations of an episode in the single environment."""
    env = SwarmEnv(scenario=scenario, **options, **controller.env_options())
    controller.reset(1, seed)
    observation, _ = env.reset(seed=seed)
    ended, earned = False, 0.0
    while not ended:
        observation, reward, ended, _, info = env.step(controller.act(observation[None])[0])
        earned += reward
    return env.simulation, earned, info


def test_candidates_meet_the_same_episodes_as_in_the_single_environment_whatever_their_first_size():
    config = TuneConfig(**TINY, price=0.7)
    controllers = [
        Fixed(5),
        SelfAdaptiveSchedule(True, initial_population_size=7, limits=config.limits),
        Fixed(5),
    ]
    outcomes = SideBySide(config, 3, "paper", "natural").run(controllers, seed=TRAINING_START)
    np.testing.assert_array_equal(outcomes.losses[0], outcomes.losses[2])
    assert all(sorted(row) == ["case1", "case1", "case3", "case3"] for row in outcomes.scenarios)
    assert (outcomes.scenarios[0] == outcomes.scenarios[1]).all()
    for row, controller in enumerate(controllers[:2]):
        for episode, scenario in enumerate(outcomes.scenarios[row]):
            inside, _, info = play(controller, scenario, TRAINING_START + episode, max_population_size=12)
            gap = inside.swarms.best_fitness[0] / inside.worlds.lower_bounds[0] - 1.0
            expected = np.log(gap) + 0.7 * info["evaluations"] / 100_000
            assert outcomes.losses[row, episode] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("reward", "scenario"),
    # `final` does not charge a controller for an event, and its loss does.
    [
        *((name, "case3") for name in LOSSES if name != "detour"),
        *((name, "dynamic:case3-gate@50") for name in LOSSES if name not in ("final", "detour")),
        ("detour", "dynamic:case3-gate@50-drive@40,every=5,distance=120"),
    ],
)
def test_the_loss_is_the_return_with_the_sign_turned_up_to_a_constant_of_the_episode(reward, scenario):
    # Rewards that need a budget do not charge for evaluations.
    price, budget = (0.0, 90) if reward in NEED_A_BUDGET else (0.5, 0)
    given = {**TINY, "scenarios": (scenario,), "max_evaluations": budget}
    config = TuneConfig(**given, price=price, reward=reward)
    controllers = [OpenLoop(Knots(6, [0], [float(size)], [0.5])) for size in (3, 11)]
    outcomes = SideBySide(config, 2, "paper", "natural").run(controllers, seed=TRAINING_START)
    for episode in range(4):
        options = {"price": price, "reward": reward, "max_evaluations": budget or None}
        earned = [play(c, scenario, TRAINING_START + episode, **options)[1] for c in controllers]
        difference = outcomes.losses[0, episode] - outcomes.losses[1, episode]
        assert earned[1] - earned[0] == pytest.approx(difference, rel=1e-9)


@pytest.mark.parametrize("action", START)
def test_the_search_begins_at_the_start_and_its_points_cover_the_ranges(action):
    space = KnotSpace(TuneConfig(action=action))
    begin = space.decode(space.start)
    np.testing.assert_allclose(begin.sizes, START[action]["population size"], rtol=1e-9)
    np.testing.assert_allclose(begin.repair_degrees, START[action]["repair degree"], atol=0.0005)
    others = begin.knobs | begin.sources
    assert list(others) == list(START[action])[2:]
    for name, values in others.items():
        np.testing.assert_allclose(values, START[action][name], rtol=0.15)  # kept off the bounds
    low, high = (space.decode(np.full(len(space.start), corner)) for corner in (0.0, 1.0))
    assert (set(low.sizes), set(high.sizes)) == ({2.0}, {200.0})
    assert (set(low.repair_degrees), set(high.repair_degrees)) == ({0.0}, {1.0})
    for name, bounds in (("noise", (0.02, 100.0)), ("attractiveness", (0.01, 1.0))):
        assert name not in low.knobs or (low.knobs[name][0], high.knobs[name][0]) == bounds


def test_episodes_that_end_early_count_once():
    """Robots that follow glowworms arrive at different times."""
    given = {**TINY, "scenarios": ("block:20", "open:20")}
    config = TuneConfig(**given, optimizer="glowworm", reward="optimality", price=0.5)
    quick = {"step": [0.02], "decision_range": [2.0]}
    controllers = [
        OpenLoop(Knots(size, [0], [float(size)], [0.0], quick, optimizer="glowworm")) for size in (5, 12)
    ]
    outcomes = SideBySide(config, 2, "paper", "extended").run(controllers, seed=TRAINING_START)
    lengths = set()
    for row, controller in enumerate(controllers):
        for episode, scenario in enumerate(outcomes.scenarios[row]):
            env = SwarmEnv("glowworm", scenario=scenario, max_population_size=12, **controller.env_options())
            observation, info = env.reset(seed=TRAINING_START + episode)
            ended = False
            while not ended:
                observation, _, ended, _, info = env.step(controller.act(observation[None])[0])
            loss = 100.0 * info["optimality_gap"] + 0.5 * info["evaluations"] / 100_000
            assert outcomes.losses[row, episode] == pytest.approx(loss, rel=1e-9)
            lengths.add(int(env.simulation.iteration[0]))
    assert len(lengths) > 1


def test_a_point_decides_at_its_knots_what_the_controller_does():
    space = KnotSpace(TuneConfig(action="extended", initial_population_size=33))
    point = np.random.default_rng(0).random(24)
    decided, controller = space.decode(point), space.controller(point)
    assert controller.initial_population_size == 33
    actions = controller.act(np.array([[0.0, 0.0, 0.0, t] for t in START_ITERATIONS]))
    columns = [decided.sizes, decided.repair_degrees, *decided.knobs.values()]
    np.testing.assert_allclose(actions, np.stack(columns, axis=1), rtol=1e-12)


def test_a_constant_is_one_decision():
    space = KnotSpace(kind_defaults("constant"))
    actions = space.controller(space.start).act(np.array([[0.0, 0.0, 0.0, t] for t in (0, 50, 99)]))
    assert (actions == actions[0]).all()
    assert 10 < actions[0, 0] < 165


# Open loops, loops that react, and one of the families that a study of Optuna tunes.
@pytest.mark.parametrize("what", slow_but([*BY_EVOLUTION, "schedule"], TUNERS))
def test_a_result_is_a_controller_with_what_it_was_made_with(tmp_path, what):
    run = tune(tmp_path, what, rounds=2, output=tmp_path / "elsewhere" / "mine.json")
    path = run.run()
    assert path == tmp_path / "elsewhere" / "mine.json"
    assert path.read_bytes() == (tmp_path / "it" / f"{what}.json").read_bytes()
    controller = make_controller(f"{run.tuner.family}:{path}")
    observations = np.zeros((1, len(make_observation(controller.observation).features)))
    controller.reset(1)
    expected = run.tuner.result()
    expected.reset(1)
    np.testing.assert_array_equal(controller.act(observations), expected.act(observations))
    assert controller.initial_population_size == expected.initial_population_size
    manifest = json.loads(path.read_text())["manifest"]
    assert manifest["steps"] == run.num_steps == 2 * ROUND[what]
    assert manifest["config"]["scenarios"] == ["case3", "case1"]
    assert {"commit", "cmaes", "optuna", "swarm_gym"} <= set(manifest["provenance"])
    assert set(manifest["estimate"]) == {"case1", "case3"}
    assert min(manifest["round_seeds"] + manifest["estimate_seeds"]) >= TRAINING_START


@pytest.mark.slow
@pytest.mark.parametrize("what", TUNERS)
def test_a_resumed_run_equals_one_that_was_not_stopped(tmp_path, what):
    whole = tune(tmp_path, what, name="whole").run()
    tune(tmp_path, what, rounds=1, name="stopped").run()
    resumed = tune(tmp_path, what, name="stopped", resume=True)
    assert resumed.tuner.rounds == 1
    assert resumed.run().read_text() == whole.read_text()
    other = tune(tmp_path, what, name="other", seed=1).run()
    losses = [json.loads(path.read_text())["manifest"]["estimate"] for path in (whole, other)]
    assert losses[0] != losses[1]


def test_the_budget_is_kept(tmp_path):
    run = tune(tmp_path, total_steps=2 * ROUND["open-loop"] + 1599)
    run.run()
    assert run.num_steps == 2 * ROUND["open-loop"]
    with pytest.raises(RunFolderError, match="total_steps 1599: one round takes 1600"):
        tune(tmp_path, name="short", total_steps=1599)


@pytest.mark.parametrize("what", ["schedule", "open-loop"])
def test_first_populations_fit_a_budget(tmp_path, what):
    own = {"action": "sourced", "initial_population_size": 30} if what == "open-loop" else {}
    run = tune(tmp_path, what, max_evaluations=30, max_population_size=200, **own)
    run.run()
    tuner = run.tuner
    if what == "schedule":
        assert tuner._spans["initial_population_size"].high == 30
    else:
        space = KnotSpace(tuner._config)
        assert space.decode(np.ones(len(space.start))).initial_population_size == 30


def test_extended_decisions_are_tuned_by_their_names(tmp_path):
    path = tune(tmp_path, rounds=1, action="extended").run()
    assert list(stored(path)["knobs"]) == ["noise", "attractiveness"]
    assert make_controller(f"open-loop:{path}").action == "extended"


def test_a_run_is_not_overwritten_nor_another_one_resumed(tmp_path):
    with pytest.raises(RunFolderError, match="no run"):
        tune(tmp_path, resume=True)
    path = tune(tmp_path, rounds=1).run()
    with pytest.raises(RunFolderError, match="--resume"):
        tune(tmp_path)
    with pytest.raises(RunFolderError, match=r"price was 0\.5, is 0\.6"):
        tune(tmp_path, resume=True, price=0.6)
    with pytest.raises(RunFolderError, match="exists already"):
        tune(tmp_path, name="new", output=path)
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("what", "name", "damage"),
    [
        ("open-loop", "checkpoint.npz", lambda content: content[:200]),
        ("schedule", "study.db", lambda content: b"no database" * 100),
    ],
)
def test_a_damaged_checkpoint_or_study_is_refused(tmp_path, what, name, damage):
    tune(tmp_path, what, rounds=1).run()
    path = tmp_path / "it" / name
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(RunFolderError, match=re.escape(name)):
        tune(tmp_path, what, resume=True)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scenarios": ("case9",)}, "case9.*case1"),
        ({"optimizer": "bees"}, "bees.*firefly"),
        ({"action": "paced"}, "paced"),
        ({"knots": (3, 8)}, "begin with 0"),
        ({"knots": (0, 8, 8)}, "increase"),
        ({"knots": (0, 100)}, "knots.*100"),
        ({"what": "constant", "knots": (0, 9)}, "knots: not an option of what 'constant'"),
        ({"what": "schedule", "action": "extended"}, "action: not an option of what 'schedule'"),
        ({"what": "schedule", "sigma": 0.3}, "sigma: not an option of what 'schedule'"),
        ({"what": "schedule", "candidates": 8}, "candidates: not an option of what 'schedule'"),
        ({"candidates": 3}, "candidates.*3"),
        ({"sigma": 0.0}, "sigma.*0"),
        ({"episodes": 0}, "episodes.*0"),
        ({"price": -1.0}, "price.*-1"),
        ({"reward": "gold"}, "gold.*optimality"),
        ({"seed": -1}, "seed.*-1"),
        ({"initial_population_size": 300}, "initial_population_size.*300"),
        ({"min_population_size": 12, "initial_population_size": 12}, "nothing to tune"),
    ],
)
def test_options_that_cannot_be_are_refused_before_anything_is_written(tmp_path, options, message):
    with pytest.raises(ValueError, match=message):
        tune(tmp_path, **{"what": "open-loop", **options})
    assert list(tmp_path.iterdir()) == []


def test_where_to_tune_is_refused_as_it_is_for_trainings(tmp_path):
    with pytest.raises(SystemExit, match="error: --address auto: --backend local has no address"):
        main(["--address", "auto", "--runs", str(tmp_path)])
    assert list(tmp_path.iterdir()) == []


def test_the_command_line_takes_defaults_from_kind_and_preset(tmp_path):
    preset = tmp_path / "own.toml"
    preset.write_text('scenarios = ["case2"]\ntotal_steps = 1234\n')
    config = read_command_line(["--what", "constant", "--preset", str(preset), "--price", "0.1"]).config
    assert (config.scenarios, config.total_steps, config.knots) == (("case2",), 1234, (0,))
    assert (config.preset, config.price) == (str(preset), 0.1)
    expected = dataclasses.replace(TuneConfig(), sigma=0.3)
    assert read_command_line(["--sigma", "0.3"]).config == expected


def test_trials_meet_the_same_episodes_the_first_one_with_the_parameters_to_begin_with(tmp_path):
    run = tune(tmp_path, "schedule", rounds=2, max_population_size=90)
    path = run.run()
    content = json.loads(path.read_text())
    first = run.tuner._study.get_trials()[0]
    assert first.params == SCHEDULE.first
    seed, paper = training_seed(0, 0), make_controller("spsfa-tip", run.config.limits)
    outcomes = SideBySide(run.config, 1, "paper", "natural").run([paper], seed)
    assert first.value == outcomes.losses.mean() == content["manifest"]["first_trial_loss"]
    best = make_controller(content["controller"], run.config.limits)
    outcomes = SideBySide(run.config, 1, "paper", "natural").run([best], seed)
    assert outcomes.losses.mean() == content["manifest"]["best_trial_loss"]


@pytest.mark.slow
def test_a_trial_that_was_killed_is_repeated(tmp_path, monkeypatch):
    whole = tune(tmp_path, "schedule", rounds=14, name="whole").run()
    killed = tune(tmp_path, "schedule", rounds=14, name="killed")
    for _ in range(12):
        killed.tuner.advance()
    monkeypatch.setattr(killed.tuner, "_loss", lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        killed.tuner.advance()
    del killed  # and with it, as with a process, its lock
    resumed = tune(tmp_path, "schedule", rounds=14, name="killed", resume=True)
    assert resumed.tuner.rounds == 12
    assert stored(resumed.run()) == stored(whole)
    trials = [
        [trial.params for trial in run._study.get_trials() if trial.value is not None]
        for run in (resumed.tuner, tune(tmp_path, "schedule", rounds=14, name="whole", resume=True).tuner)
    ]
    assert trials[0] == trials[1]


@pytest.mark.parametrize("space", [what for what in TUNERS if what not in BY_EVOLUTION])
def test_every_parameter_of_a_family_can_be_tuned_over_its_span(space):
    space = TUNERS[space].make.keywords["space"]
    assert list(space.first) == list(space.spans)
    for end in ("low", "high"):
        values = {name: getattr(span, end) for name, span in space.spans.items()}
        controller = make_controller(f"{space.family}:{format_parameters(values)}")
        for name, value in values.items():
            assert getattr(controller, name) == value
