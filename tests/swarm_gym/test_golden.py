"""Results do not change from version to version unless a golden file says why.

`tests/golden` has a file per optimizer with the courses of short runs. Where a change of results is meant,
run these tests with UPDATE_GOLDEN set to the reason. The files of changed results then state it; use `-m ''`,
so that no test is left out, and one process. Name the change in CHANGELOG.md, too.
"""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from helpers.builders import is_walker
from swarm_gym.env import SwarmEnv
from swarm_gym.history import HISTORY
from swarm_gym.optimizers import ALL_OPTIMIZERS, OPTIMIZERS, SPECIAL_OPTIMIZERS

GOLDEN = Path(__file__).parents[1] / "golden"
SCENARIOS = ("case1", "rooms:0", "function:rastrigin-10")
ON_BITS = "onemax:1000"
ITERATIONS = 8
# Of machines whose exp, pow and the like differ in the last bit, which grows from iteration to iteration.
TOLERANCE = 1e-9


def plan():
    """Return optimizers and scenarios; those with test functions, which need more compiling, are slow."""
    return [
        pytest.param(
            optimizer,
            scenario,
            marks=[pytest.mark.slow] if "function" in scenario and optimizer != "firefly" else [],
        )
        for optimizer in OPTIMIZERS
        for scenario in SCENARIOS
        if not (is_walker(optimizer) and "function" in scenario)
    ] + [pytest.param(optimizer, ON_BITS) for optimizer in SPECIAL_OPTIMIZERS]


def course(optimizer, scenario):
    """Return the record, (iterations + 1, columns), of a run with growth, shrinking and, on maps, repair."""
    most = 0.25 if scenario != ON_BITS else 0.0
    env = SwarmEnv(optimizer, scenario=scenario, iterations=ITERATIONS, initial_population_size=20)
    env.reset(seed=7)
    for iteration in range(ITERATIONS):
        env.step(np.array([20.0 + 8.0 * (-1) ** iteration, most * (iteration % 3)]))
    return env.simulation.history[0, :, : len(HISTORY)]


def golden(optimizer):
    return json.loads((GOLDEN / f"{optimizer}.json").read_text())


def is_stored(optimizer, scenario, found):
    """Return whether the file of an optimizer has this course, so that there is nothing to update."""
    if not (GOLDEN / f"{optimizer}.json").exists():
        return False
    stored = np.array(golden(optimizer)["courses"].get(scenario, ()))
    return stored.shape == found.shape and np.allclose(found, stored, rtol=TOLERANCE, atol=TOLERANCE)


def update(optimizer, scenario, found, reason):
    """Replace the stored courses; only one process may do this at a time."""
    path = GOLDEN / f"{optimizer}.json"
    courses = golden(optimizer)["courses"] if path.exists() else {}
    content = {"because": reason, "columns": HISTORY, "courses": {**courses, scenario: found.tolist()}}
    path.write_text(json.dumps(content, indent=1) + "\n")


@pytest.mark.parametrize(("optimizer", "scenario"), plan())
def test_results_are_those_of_the_version_before(optimizer, scenario):
    found = course(optimizer, scenario)
    reason = os.environ.get("UPDATE_GOLDEN")
    if reason and not is_stored(optimizer, scenario, found):
        update(optimizer, scenario, found, reason)
    stored = golden(optimizer)
    assert tuple(stored["columns"]) == HISTORY
    np.testing.assert_allclose(
        found,
        stored["courses"][scenario],
        rtol=TOLERANCE,
        atol=TOLERANCE,
        err_msg=f"{optimizer} on {scenario} has other results than before; if that is meant, run this test "
        "with UPDATE_GOLDEN set to the reason, and name the change in CHANGELOG.md",
    )


@pytest.mark.parametrize("optimizer", ALL_OPTIMIZERS)
def test_every_golden_file_states_the_reason_of_its_last_change(optimizer):
    assert len(golden(optimizer)["because"].split()) > 3


def test_there_is_a_file_for_every_optimizer_and_no_other():
    assert {path.stem for path in GOLDEN.glob("*.json")} == set(ALL_OPTIMIZERS)
