"""The study of the BBOB functions: budgets of its entrants, and tables that say what made-up runs say."""

import numpy as np
import pytest

from experiments.runs.measures import MEASURES, log_precision
from experiments.runs.outcomes import Outcomes
from experiments.studies.bbob.suites import BBOB, BUDGET, CONTROLLERS, OPTIMIZERS, name_of
from experiments.studies.bbob.tables import GROUPS, group_tables, rule_tables
from helpers.stored_runs import cells_of, part_of
from swarm_gym.comparing.entrants import entrant
from swarm_gym.controllers import make_controller
from swarm_gym.env import SwarmEnv
from swarm_gym.population import POPULATION_COLLISION

SCENARIOS = ("function:bbob-1-5-1", "function:bbob-1-5-2", "function:bbob-21-5-1", "function:bbob-21-5-2")
FIXED, FALLING = name_of("swarm_gym", "60 members"), name_of("swarm_gym", "falling from 100 to 10")
GAPS = {
    FIXED: ([1e-2, 1e-2], [1e-4, 1e-4], [10.0, 10.0], [10.0, 10.0]),
    FALLING: ([1e-3, 1e-3], [1e-5, 0.0], [10.0, 10.0], [10.0, 10.0]),
}


@pytest.fixture(scope="module")
def outcomes():
    fitness = 0.999 * np.array(list(GAPS.values()))  # the optimum of a function is 0
    same = np.ones_like(fitness)
    return Outcomes(tuple(GAPS), SCENARIOS, fitness, 0.0 * same, 2500.0 * same, 0.1 * same)


@pytest.fixture(scope="module")
def suite():
    return part_of(BBOB, GAPS, SCENARIOS, 2)


def sizes_of(controller):
    """Return the evaluations and the sizes of a run of one of this project's optimizers."""
    chosen = entrant(name_of("swarm_gym", controller), BBOB.optimizer)
    made = make_controller(chosen.controller)
    options = {**BBOB.options, **chosen.options, **made.env_options()}
    assert chosen.optimizer == OPTIMIZERS["swarm_gym"]
    env = SwarmEnv(chosen.optimizer, scenario="function:bbob-8-5-1", **options)
    made.reset(1, 0)
    observation, info = env.reset(seed=0)
    sizes, ended = [int(info["population_size"])], False
    while not ended:
        observation, _, ended, _, info = env.step(made.act(observation[None])[0])
        sizes.append(int(info["population_size"]))
    return int(info["evaluations"]), sizes


@pytest.mark.parametrize("controller", [name for name in CONTROLLERS if name != "grows on stagnation"])
def test_entrants_spend_the_budget_in_their_last_iterations(controller):
    spent, sizes = sizes_of(controller)
    assert 0.95 * BUDGET <= spent <= BUDGET
    assert len(sizes) >= CONTROLLERS[controller][0]


def test_every_optimizer_meets_every_controller_on_every_function():
    assert len(BBOB.controllers) == len(OPTIMIZERS) * len(CONTROLLERS)
    assert len(BBOB.scenarios) == 24 * 5
    assert sorted(number for name, found in GROUPS.items() if name != "all" for number in found) == list(
        range(1, 25)
    )


@pytest.mark.parametrize("rule", ["spsfa", "spsfa-tip"])
def test_the_schedule_of_the_spsfa_paper_keeps_its_size_on_a_function(rule):
    made = make_controller(rule)
    env = SwarmEnv("particle-swarm", scenario="function:bbob-8-5-1", iterations=20, **made.env_options())
    made.reset(1, 0)
    observation, info = env.reset(seed=0)
    sizes, ended = [], False
    while not ended:
        sizes.append(int(info["population_size"]))
        assert env.simulation.swarms.summary[0, POPULATION_COLLISION] == 0.0
        observation, _, ended, _, info = env.step(made.act(observation[None])[0])
    assert set(sizes) == {made.initial_population_size}


def test_means_are_of_logarithms_in_groups_of_functions(suite, outcomes):
    rows = cells_of(group_tables(suite, outcomes), "bbob-groups")
    assert [row["size"] for row in rows] == ["60 members", "falling from 100 to 10"]
    fixed, falling = rows
    assert fixed["separable"].startswith("-3.00 [")
    assert falling["separable"].startswith("-4.75 [")  # 0 counts as 1e-8
    assert fixed["weak structure"] == falling["weak structure"] == "1.00 [1.00, 1.00]"
    assert fixed["multimodal"] == "–"
    assert falling["all"].startswith("-1.88 [")


def test_rules_are_compared_with_60_members_of_the_same_optimizer(suite, outcomes):
    fixed, falling = cells_of(rule_tables(suite, outcomes), "bbob-rules")
    assert fixed["minus 60 members"] == fixed["closer"] == fixed["p"] == "–"
    assert falling["minus 60 members"].startswith("-0.87 [")
    assert falling["closer"] == "0.75"  # closer on half of the pairs, alike on the others
    # Five targets for a power of ten: a run at 10 reaches 6 of 51, at 1e-2 21, at 1e-3 26, and so on.
    assert fixed["targets reached"].startswith(f"{100 * np.mean([21, 31, 6, 6]) / 51:.1f} % [")
    assert falling["targets reached"].startswith(f"{100 * np.mean([26, (36 + 51) / 2, 6, 6]) / 51:.1f} % [")


def test_a_logarithm_is_never_below_that_of_the_least_precision():
    np.testing.assert_allclose(log_precision(np.array([0.0, 1e-12, 1e-8, 0.1])), [-8.0, -8.0, -8.0, -1.0])


def test_claims_can_be_about_the_logarithm(outcomes):
    values = MEASURES["log precision"].of(outcomes.sample(FALLING, "function:bbob-1-5"), 1.0)
    np.testing.assert_allclose(values, [[[-3.0, -3.0], [-5.0, -8.0]]], atol=1e-3)
