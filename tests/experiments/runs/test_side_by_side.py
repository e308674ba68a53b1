"""Runs side by side are single runs, bit for bit."""

import dataclasses

import numpy as np
import pytest

from experiments.runs.episode import Episode
from experiments.runs.experiment import Experiment
from experiments.runs.runner import Unit, run_unit
from experiments.runs.side_by_side import can_be_side_by_side, run_side_by_side
from helpers.slow import slow_but

SEEDS = (7, 8, 9)
ROWS = {
    "spsfa-tip": ("case2", {}),
    "random": ("case1", {}),
    "learned:three-cases/0@1": ("case3", {}),
    "blinded:three-cases/0@1": ("case3", {}),
    "learned:three-cases-sourced-ppo/0": ("case1", {"source": "smooth"}),
    "reacting-loop:dynamic-reacting-long@1": ("dynamic:case1-block@9", {"reward": "offline-error"}),
    "multivariate+fixed:30": ("rooms:0", {"max_evaluations": 400}),
    "ant-colony+fixed:12": ("case3", {}),
    "particle-swarm(12)+fixed:9": ("dynamic:case3-drive@3,every=2,distance=4", {}),
    "fish-swarm+fixed:9": ("rooms:1", {"max_evaluations": 150, "encoding": "bezier"}),
}
# A rule, a policy with a source, a loop that reacts on a map that changes, and a budget on cells.
FAST_ROWS = [*ROWS][:1] + [*ROWS][4:7]


def experiment_of(name):
    scenario, options = ROWS[name]
    return Experiment("small", (name,), (scenario,), 3, options={"iterations": 20, **options}, first_seed=7)


@pytest.mark.parametrize("name", slow_but(FAST_ROWS, ROWS))
def test_runs_side_by_side_are_single_runs(name):
    experiment = experiment_of(name)
    (scenario,) = experiment.scenarios
    assert can_be_side_by_side(name, scenario, SEEDS, experiment)
    together = run_side_by_side(name, scenario, SEEDS, experiment, {"commit": "a"})
    for seed, found in zip(SEEDS, together, strict=True):
        alone = Episode((name, scenario, seed), experiment).run({"commit": "a"})
        for field in dataclasses.fields(found):
            if field.name != "seconds":
                np.testing.assert_equal(getattr(found, field.name), getattr(alone, field.name), field.name)
        assert found.seconds > 0.0
    assert len({found.final_fitness for found in together}) > 1


def test_what_cannot_be_side_by_side_runs_alone():
    experiment = experiment_of("spsfa-tip")
    for seeds in ((7,), (7, 9), (8, 7)):
        assert not can_be_side_by_side("spsfa-tip", "case2", seeds, experiment)
    kept = dataclasses.replace(experiment, snapshots=(("spsfa-tip", "case2", 8, (3,)),))
    assert not can_be_side_by_side("spsfa-tip", "case2", SEEDS, kept)
    assert not can_be_side_by_side("helpers.libraries:RandomSteps+fixed:9", "case2", SEEDS, experiment)
    assert not can_be_side_by_side("helpers.rules:Rule", "case2", SEEDS, experiment)
    runs = run_unit(Unit("spsfa-tip", "case2", SEEDS), kept, {}, {})
    assert [len(run.snapshots) for run in runs] == [0, 1, 0]
