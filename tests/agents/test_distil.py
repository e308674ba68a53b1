"""Distilled rules: fits, the file, the limit of ten numbers, and what is distilled from known policies."""

import dataclasses
import json
import math

import numpy as np
import pytest

from agents import SizeLimits, make_controller
from agents.distil import DistilConfig, Score, assess, describe, distil, run_distillation
from agents.rule_fit import Fit, fit_within, select_forward, share_out
from helpers.slow import slow_but
from helpers.trainings import make_correction
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.distilled import (
    DISTILLED,
    INPUTS,
    MOST_NUMBERS,
    DistilledFileError,
    DistilledRule,
    Formula,
    load_rule,
    packaged_rules,
    save_rule,
)
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.runs.seeds import ANALYSIS, VALIDATION
from swarm_gym.sources import Source
from swarm_gym.training.config import TrainConfig, stored_config

TRAINING = TrainConfig(scenarios=("case3",), initial_population_size=40)
LOG_TIME = "log(1+t)/log(1+T)"
SIZE, PHI = "population size", "repair degree"


class LogLinear(Controller):
    """Exactly exp(4 - 2 log-time) members, and phi = 0.3 t/T + 0.2 feasible share, in a scaled layout."""

    observation = "rich"
    action = "normalised"
    initial_population_size = 40

    def reset(self, num_swarms, seed=0):
        pass

    def identity(self):
        return "log-linear"

    def act(self, observations):
        features = [feature.name for feature in OBSERVATIONS["rich"].features]
        log_time = observations[:, features.index("log(1 + iteration), relative to that of the last")]
        feasible = observations[:, features.index("feasible share")]
        size = 2.0 * (4.0 - 2.0 * log_time - math.log(2)) / math.log(100) - 1.0
        phi = 0.3 * observations[:, 3] + 0.2 * feasible
        return np.stack([size, 2.0 * phi - 1.0], axis=1).astype(np.float32)


class Everything(Controller):
    """Four decisions that use more than ten numbers can say."""

    observation = "rich"
    action = "extended-normalised"
    initial_population_size = 40

    def reset(self, num_swarms, seed=0):
        self.weights = np.random.default_rng(0).normal(size=(13, 4))

    def identity(self):
        return "everything"

    def act(self, observations):
        return np.tanh(observations @ self.weights).astype(np.float32)


def config_of(**changes):
    few = {"rounds": 1, "episodes": 12, "validation_seeds": 3, **changes}
    return DistilConfig(policy="synthetic", output=None, **few)


def rule_of(**changes):
    formulas = (
        Formula(SIZE, 4.0, {LOG_TIME: -2.0}),
        Formula(PHI, 0.1, {"t/T": 0.5, "feasible share": -0.25}),
    )
    return DistilledRule(40, changes.pop("formulas", formulas), **changes)


@pytest.fixture
def stored(tmp_path):
    path = tmp_path / "rule.json"
    save_rule(path, rule_of(), SizeLimits(), {"made": "here"})
    return path


def test_a_policy_that_is_log_linear_is_recovered():
    found = distil(LogLinear(), TRAINING, config_of())
    assert found.rule.num_numbers >= 5
    rule = next(c.rule for c in found.candidates if c.rule.num_numbers == 6)
    size, phi = rule.formulas
    assert size.constant == pytest.approx(4.0, abs=0.01)
    assert size.weights == pytest.approx({LOG_TIME: -2.0}, abs=0.01)
    assert phi.weights == pytest.approx({"t/T": 0.3, "feasible share": 0.2}, abs=0.01)
    assert phi.constant == pytest.approx(0.0, abs=0.01)
    assert max(c.rule.num_numbers for c in found.candidates) == 6


@pytest.mark.parametrize("numbers", slow_but([5], [5, 8, 10]))
def test_a_rule_never_has_more_numbers_than_allowed(numbers):
    found = distil(Everything(), TRAINING, config_of(numbers=numbers, episodes=6))
    assert 5 <= max(c.rule.num_numbers for c in found.candidates) <= numbers
    assert found.rule.action == "extended"
    assert len(found.rule.formulas) == len(found.chosen.errors) == 4


@pytest.mark.slow
def test_the_rule_that_earns_most_on_validation_seeds_is_taken():
    found = distil(Everything(), TRAINING, config_of(rounds=2, validation_seeds=8))
    assert {candidate.round for candidate in found.candidates} == {0, 1}
    finalists = sorted(found.candidates, key=lambda c: c.score.mean_return, reverse=True)[:4]
    returns = [assess(c.rule, TRAINING, VALIDATION[:8]).mean_return for c in finalists]
    assert found.chosen.score.mean_return == max(returns)
    assert found.rule is finalists[int(np.argmax(returns))].rule


def test_an_episode_that_runs_away_is_broken_off():
    large = make_controller("fixed:60")
    stopped = assess(large, TRAINING, VALIDATION[:2], most_evaluations=3000)
    assert 3000 <= stopped.mean_evaluations < 6000
    assert assess(large, TRAINING, VALIDATION[:2]).mean_evaluations > 100_000


def test_an_unknown_gap_is_stored_as_null_and_not_printed():
    score = Score(1.5, math.nan, 2000.0)
    assert json.dumps(score.stored(), allow_nan=False) == (
        '{"mean_return": 1.5, "mean_gap": null, "mean_evaluations": 2000.0}'
    )
    assert describe(score) == "return 1.500 at 2,000 evaluations"
    assert describe(score._replace(mean_gap=0.25)) == "return 1.500, gap 25.00 % at 2,000 evaluations"


def test_a_policy_that_corrects_a_schedule_can_be_distilled(tmp_path):
    path = make_correction(tmp_path / "residual.safetensors", np.random.default_rng(1), "spsfa-tip")
    found = distil(make_controller(f"learned:{path}"), TRAINING, config_of())
    assert [formula.decision for formula in found.rule.formulas] == [SIZE, PHI]


def test_more_than_ten_numbers_are_refused():
    weights = dict.fromkeys(list(INPUTS)[: MOST_NUMBERS - 3], 1.0)
    assert rule_of(formulas=(Formula(SIZE, 1.0, weights), Formula(PHI, 0.0, {}))).num_numbers == MOST_NUMBERS
    with pytest.raises(ValueError, match="at most 10 numbers, this one has 11"):
        rule_of(formulas=(Formula(SIZE, 1.0, weights), Formula(PHI, 0.0, {"t/T": 1.0})))
    with pytest.raises(ValueError, match="--numbers"):
        distil(LogLinear(), TRAINING, config_of(numbers=11))


def test_numbers_are_what_is_printed():
    rule = rule_of(formulas=(Formula(SIZE, 4.12345, {LOG_TIME: -2.98765}), Formula(PHI, 0.0, {"t/T": 0.5})))
    assert rule.formulas[0] == Formula(SIZE, 4.12, {LOG_TIME: -2.99})
    assert rule.lines() == [
        "first population size = 40",
        f"{SIZE} = exp(4.12 - 2.99 * {LOG_TIME}), within [2, 200]",
        f"{PHI} = 0 + 0.5 * t/T, within [0, 1]",
    ]


def test_a_rule_decides_what_its_text_says():
    observations = np.random.default_rng(0).random((20, 13)).astype(np.float32)
    time, log_time, feasible = (observations[:, k].astype(float) for k in (3, 9, 5))
    size, phi = rule_of().act(observations).T
    np.testing.assert_allclose(size, np.clip(np.exp(4.0 - 2.0 * log_time), 2, 200))
    np.testing.assert_allclose(phi, np.clip(0.1 + 0.5 * time - 0.25 * feasible, 0, 1))


def test_inputs_say_what_the_simulation_is_like():
    from agents.evaluation.observers import watch

    watched = watch(LogLinear(), [LogLinear()], ["case1"], range(5, 8), iterations=20)
    seen = watched.seen[7]
    assert INPUTS["t/T"](seen) == pytest.approx(7 / 20)
    assert INPUTS[LOG_TIME](seen) == pytest.approx(math.log(8) / math.log(21))
    size = np.floor(watched.decided[0][6, :, 0] + 0.5)
    assert INPUTS["log(1+size)/log(1+largest size)"](seen) == pytest.approx(np.log1p(size) / math.log(201))


def test_a_stored_rule_is_read_back(stored):
    rule = load_rule(str(stored))
    assert rule.formulas == rule_of().formulas
    assert rule.initial_population_size == 40
    assert make_controller(f"distilled:{stored}").lines() == rule.lines()
    assert load_rule(str(stored), SizeLimits(2, 30)).initial_population_size == 30


def test_a_stored_rule_needs_the_sizes_that_it_was_made_with(tmp_path):
    limits = SizeLimits(4, 60)
    save_rule(tmp_path / "small.json", rule_of(limits=limits), limits, {"made": "here"})
    options = make_controller(f"distilled:{tmp_path / 'small.json'}").env_options()
    assert (options["min_population_size"], options["max_population_size"]) == (4, 60)


def test_a_stored_rule_begins_with_the_members_of_its_policy(tmp_path):
    rule = rule_of(first_source=Source(1.0, 0.1))
    path = tmp_path / "smooth.json"
    save_rule(path, rule, SizeLimits(), {"made": "here"})
    found = load_rule(str(path))
    assert found.first_source == Source(1.0, 0.1)
    assert found.identity() == rule.identity() != rule_of().identity()
    assert found.env_options()["source"] == "smooth"
    content = json.loads(path.read_text())
    path.write_text(json.dumps({**content, "first_source": {"amplitude": 0.1}}))
    with pytest.raises(DistilledFileError, match="first_source must have smooth_share and amplitude"):
        load_rule(str(path))


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (lambda content: content.pop("formulas"), "formulas"),
        (lambda content: content.update(format="another"), "another"),
        (lambda content: content["formulas"][0].update(constant=5.0), "text"),
        (lambda content: content["formulas"][0].update(constant="4"), "finite"),
        (lambda content: content["formulas"][0].update(constant=float("nan")), "finite"),
        (lambda content: content["formulas"][0].update(decision="speed"), "speed"),
        (lambda content: content["formulas"][0]["weights"].update(weather=1.0), "weather"),
        (lambda content: content["formulas"][0].update(weights=dict.fromkeys(INPUTS, 1.0)), "at most 10"),
        (lambda content: content["formulas"].pop(), "decide"),
        (lambda content: content.update(formulas=[1]), "subscriptable"),
        (lambda content: content.update(initial_population_size=None), "supported"),
    ],
)
def test_a_damaged_file_is_refused_by_name_and_with_the_reason(stored, damage, reason):
    content = json.loads(stored.read_text())
    damage(content)
    stored.write_text(json.dumps(content))
    with pytest.raises(DistilledFileError, match=reason) as refused:
        load_rule(str(stored))
    assert str(stored) in str(refused.value)


def test_a_file_that_is_cut_off_or_missing_is_refused(stored):
    stored.write_text(stored.read_text()[:100])
    for name, message in ((str(stored), str(stored)), ("no-such-rule", r"no-such-rule.*neither")):
        with pytest.raises(DistilledFileError, match=message):
            load_rule(name)


@pytest.mark.parametrize("name", packaged_rules())
def test_packaged_rules_say_where_they_come_from(name):
    content = json.loads(DISTILLED.find(name).read_text())
    assert content["manifest"]["policy"].startswith("learned:")
    assert content["num_numbers"] == load_rule(name).num_numbers <= MOST_NUMBERS


def test_cut_off_values_do_not_bend_a_fit():
    x = np.linspace(-1, 1, 200)[:, None]
    wanted = np.clip(0.2 + 1.5 * x[:, 0], 0.0, 1.0)
    np.testing.assert_allclose(fit_within(x, wanted, 0.0, 1.0), [0.2, 1.5], atol=1e-9)


def test_inputs_are_chosen_by_what_they_explain_and_useless_ones_are_not():
    rng = np.random.default_rng(0)
    inputs = rng.normal(size=(400, 6))
    wanted = np.clip(0.5 + 0.2 * inputs[:, 4] - 0.05 * inputs[:, 1], 0.0, 1.0)
    fits = select_forward(inputs, wanted, 0.0, 1.0, np.arange(400) // 10, 5)
    assert [fit.inputs for fit in fits] == [(), (4,), (4, 1)]
    assert np.all(np.diff([fit.error for fit in fits]) < 0)


def test_numbers_are_shared_out_where_they_help_and_pairs_are_seen():
    def path(*errors):
        return [Fit(tuple(range(k)), np.zeros(k + 1), error) for k, error in enumerate(errors)]

    shared = share_out([path(1.0, 1.0, 0.0), path(0.5, 0.1)], 4)
    assert [[len(fit.inputs) for fit in fits] for fits in shared] == [[0, 0], [2, 0]]
    shared = share_out([path(1.0, 0.9), path(1.0, 0.1)], 4)
    assert [[len(fit.inputs) for fit in fits] for fits in shared] == [[0, 0], [0, 1], [1, 1]]
    with pytest.raises(ValueError, match="at least"):
        share_out([path(1.0), path(1.0)], 1)


@pytest.mark.parametrize(
    ("policy", "message"),
    [
        ("open-loop:three-cases", "its training is unknown.*expected learned:<policy>"),
        ("learned:terrain-sourced/0", "decides smooth share, .*expected a policy of population size"),
    ],
)
def test_policies_that_no_rule_can_follow_are_refused(tmp_path, policy, message):
    with pytest.raises(ValueError, match=message):
        run_distillation(DistilConfig(policy, tmp_path / "rule.json"))
    assert not any(tmp_path.iterdir())


def test_the_configuration_of_a_policy_is_read_from_its_manifest():
    manifest = {"config": {"price": [0.3], "scenarios": ["case2"], "seed": 4}}
    expected = dataclasses.replace(TrainConfig(), price=(0.3,), scenarios=("case2",), seed=4)
    assert stored_config(manifest) == expected
    assert stored_config({}) == stored_config({"config": {}}) == TrainConfig()
    with pytest.raises(ValueError, match=r"unknown options.*long_gone"):
        stored_config({"config": {"long_gone": 1}})


def test_seeds_of_analyses_select_no_model():
    assert ANALYSIS.start >= VALIDATION.start + 10_000
    assert ANALYSIS.stop <= VALIDATION.stop
