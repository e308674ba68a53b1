"""The rule `early-restarts` on made observations and in environments."""

import math

import numpy as np

from helpers.refusals import refused
from swarm_gym.controllers import SizeLimits, make_controller
from swarm_gym.errors import SettingError
from swarm_gym.features import RESTARTS_COUNTED
from swarm_gym.observation import make_observation
from swarm_gym.rollout import run_episodes

LIMITS = SizeLimits(4, 200)
RULE = "early-restarts:start=40,later=12,short=0.3,wait=20,step=0.01"


def seen(iteration, waits, steps, spent, restarts):
    """Return observations of swarms: generations without an improvement, step sizes, budget and restarts."""
    names = [feature.name for feature in make_observation("search+restarts").features]
    observations = np.zeros((len(waits), len(names)), dtype=np.float64)
    for part, values in {
        "share of the iterations done": [iteration / 100] * len(waits),
        "generations since the best improved": [math.log(1 + one) / math.log(64) for one in waits],
        "log10(step size / first step size)": [math.log10(one) / 6 for one in steps],
        "budget spent": spent,
        "restarts": restarts,
    }.items():
        column = next(k for k, name in enumerate(names) if part in name)
        observations[:, column] = np.float32(values)
    return observations


def begun(swarms):
    """Return the rule, after it has decided for this many swarms whose episodes begin."""
    controller = make_controller(RULE, LIMITS)
    controller.reset(swarms)
    first = controller.act(seen(0, [0] * swarms, [1.0] * swarms, [0.0] * swarms, [0] * swarms))
    assert first.tolist() == [[40.0, 0.0, 1.0, 0.01]] * swarms
    return controller


def test_a_run_ends_where_it_waits_and_its_step_is_small():
    controller = begun(4)
    decided = controller.act(seen(9, [19, 20, 20, 63], [1e-5, 0.02, 0.0099, 1e-6], [0.2] * 4, [1, 1, 1, 0]))
    assert decided[:, 3].tolist() == [0.01, 0.01, 1.0, 1.0]
    assert (decided[:, 1:3] == [0.0, 1.0]).all()


def test_later_runs_are_small_where_the_first_was_short():
    """The first swarm restarts soon, the second late, the third not at all."""
    controller = begun(3)
    wait, step = [0, 0, 0], [0.1, 0.1, 0.1]
    assert controller.act(seen(5, wait, step, [0.1, 0.1, 0.1], [0, 0, 0]))[:, 0].tolist() == [40, 40, 40]
    assert controller.act(seen(9, wait, step, [0.29, 0.29, 0.29], [1, 0, 0]))[:, 0].tolist() == [12, 40, 40]
    assert controller.act(seen(20, wait, step, [0.5, 0.5, 0.5], [2, 1, 0]))[:, 0].tolist() == [12, 40, 40]
    assert controller.act(seen(25, wait, step, [0.6, 0.2, 0.6], [3, 2, 0]))[:, 0].tolist() == [12, 40, 40]
    again = seen(0, wait, step, [0.0, 0.0, 0.0], [0, 0, 0])
    assert controller.act(again)[:, 0].tolist() == [40, 40, 40]


def test_a_first_run_that_the_rule_ends_is_short_as_well():
    controller = begun(2)
    decided = controller.act(seen(9, [63, 63], [1e-4, 1e-4], [0.2, 0.4], [0, 0]))
    assert decided[:, 0].tolist() == [12.0, 40.0]
    assert decided[:, 3].tolist() == [1.0, 1.0]


def run(name, scenario, runs):
    """Return log10 of the gap and the number of restarts of runs."""
    counts = np.zeros(runs)

    def look(simulation):
        counts[:] = simulation.optimizer.counts(simulation.swarms)[RESTARTS_COUNTED]

    episodes = run_episodes(
        make_controller(name, LIMITS), scenario, range(runs), "cma-es", look,
        iterations=2000, max_evaluations=10_000,
    )  # fmt: skip
    return np.log10(np.maximum(episodes.final_fitness, 1e-8)), counts


def test_runs_on_many_optima_end_earlier_and_come_closer():
    """Function 21 has 101 peaks; the rule has the size of the constant beside it."""
    gap, restarts = run("early-restarts:start=12,later=12,step=0.05", "metabox-bbob:21-10-seed:41", 24)
    constant, fewer = run("fixed:12", "metabox-bbob:21-10-seed:41", 24)
    assert restarts.mean() > 1.2 * fewer.mean()
    assert gap.mean() < constant.mean() - 0.5


def test_a_gap_on_a_function_with_one_optimum_is_as_small():
    gap, restarts = run("early-restarts:start=12,later=12,step=0.05", "metabox-bbob:10-10", 6)
    assert (gap == -8.0).all()
    assert (restarts > 0).any()  # once all precision is reached


def test_what_the_rule_cannot_have_is_refused():
    refused(lambda: make_controller("early-restarts:step=0"), "step must lie", error=SettingError)
    refused(lambda: make_controller("early-restarts:short=2"), "short must lie", error=SettingError)
    refused(lambda: make_controller("early-restarts:wait=64"), "wait must lie", error=SettingError)
    refused(
        lambda: run_episodes(make_controller("early-restarts"), "case1", range(1), "firefly", iterations=2),
        "cma-es", error=SettingError,
    )  # fmt: skip
