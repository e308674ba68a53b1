"""Commands that end within seconds, and checks of their results, which must not depend on interruptions."""

import io
import json
import sqlite3
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import optuna
import torch

from helpers.event_files import shown
from helpers.trainings import STEPS, TINY
from swarm_gym.controllers.learned.policy_file import load_policy
from swarm_gym.runs.checkpoints import Checkpoints

# A preset with the defaults of all options.
IMITATION = Path(__file__).parent / "imitation.toml"


class Command(NamedTuple):
    """A module, its arguments, and values by dotted names that are set before it runs."""

    module: str
    arguments: Sequence[str]
    patches: dict[str, object]


TRAININGS = {
    "ppo": {"total_steps": 3 * STEPS},
    "recurrent": {
        "algorithm": "recurrent-ppo",
        "warm_start": "none",
        "observation": "paper",
        "total_steps": 3 * STEPS,
    },
    "evolution": {"algorithm": "evolution", "warm_start": "none", "candidates": 4, "total_steps": 3 * STEPS},
}
CONTROLLERS = ("fixed:3", "spsfa-tip", "spsfa")
ROUND = {"open-loop": 4 * 4 * 100, "reacting-loop": 4 * 4 * 100, "constant": 4 * 4 * 100, "schedule": 4 * 100}
ROUNDS = {
    "open-loop": 4,
    "reacting-loop": 4,
    "constant": 4,
    "schedule": 14,
}  # Optuna's sampler begins after ten


def as_arguments(options):
    found = []
    for name, value in options.items():
        values = value if isinstance(value, tuple) else (value,)
        found += [f"--{name.replace('_', '-')}", *map(str, values)]
    return found


def resumed(folder):
    return ["--resume"] if (folder / "it" / "config.json").exists() else []


def training(algorithm, folder):
    options = {"preset": IMITATION, **TINY, **TRAININGS[algorithm], "runs": folder, "name": "it"}
    patches = {"swarm_gym.training.imitation.GRADIENT_STEPS": 20}
    return Command("agents.train", [*as_arguments(options), *resumed(folder)], patches)


def tuning(what, folder):
    options = {"episodes": 4, "scenarios": ("case3", "case1"), "max_population_size": 12, "what": what}
    options |= {
        "total_steps": ROUNDS[what] * ROUND[what],
        "runs": folder,
        "name": "it",
        "output": folder / "result.json",
    }
    if what != "schedule":
        options |= {"candidates": 4, "initial_population_size": 6}
    patches = {"swarm_gym.tuning.run.ESTIMATE_EPISODES": 2}
    return Command("agents.tune", [*as_arguments(options), *resumed(folder)], patches)


def evaluation(folder, **options):
    options = {
        "suite": "paper",
        "seeds": 3,
        "controllers": CONTROLLERS,
        "jobs": 1,
        "output": folder,
    } | options
    return Command("experiments.evaluate", [*as_arguments(options), "--no-figures"], {})


def state_of(folder):
    """Return the content of the last checkpoint without names and sizes of event files."""
    state = Checkpoints(folder, ".pt").load(lambda content: content)
    stored = torch.load(io.BytesIO(state), weights_only=True)
    del stored["events"]
    # Memory that the strategy never wrote to, where fitness would be if it were asked whether to stop.
    stored["learner"].get("strategy", {}).pop("strategy._funhist_values", None)
    return stored


def assert_same_bits(one, other):
    assert type(one) is type(other)
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        for key in one:
            assert_same_bits(one[key], other[key])
    elif isinstance(one, list | tuple):
        assert len(one) == len(other)
        for mine, theirs in zip(one, other, strict=True):
            assert_same_bits(mine, theirs)
    elif isinstance(one, torch.Tensor | np.ndarray):
        one, other = np.asarray(one), np.asarray(other)
        assert (one.dtype, one.shape) == (other.dtype, other.shape)
        assert one.tobytes() == other.tobytes()
    else:
        assert one == other


def assert_same_training(whole, folder):
    """Assert that policies, checkpoints and events of two runs are equal, and that no other file is left."""
    assert_same_learning(whole, folder)
    names = {p.name for p in folder.iterdir() if not p.name.startswith("events")}
    assert names == {p.name for p in whole.iterdir() if not p.name.startswith("events")}


def assert_same_learning(whole, folder):
    """Assert that policies, checkpoints and events of two runs are equal."""
    for name in ("best", "latest"):
        ours, theirs = (load_policy(place / f"{name}.safetensors") for place in (whole, folder))
        assert_same_bits(ours[0], theirs[0])
        manifests = ({**manifest, "provenance": ""} for _, manifest in (ours, theirs))  # its commit may move
        assert next(manifests) == next(manifests)
    assert_same_bits(state_of(whole), state_of(folder))
    expected = shown(whole)
    assert {len(values) for values in expected["scalars"].values()} >= {1, 3, 4}
    assert shown(folder) == expected
    assert shown(folder, purge=False) == expected  # nothing is there twice and only hidden


def assert_same_result(what, whole, folder):
    ours, theirs = (result(place / "result.json") for place in (whole, folder))
    assert ours == theirs == result(folder / "it" / f"{what}.json")
    ours, theirs = rounds(what, whole / "it"), rounds(what, folder / "it")
    assert len(ours) == ROUNDS[what]
    assert_same_bits(ours, theirs)


def result(path):
    """Return a tuning result without its provenance, since the commit may change during the tests."""
    content = json.loads(path.read_text(encoding="utf-8"))
    del content["manifest"]["provenance"]
    return content


def rounds(what, folder):
    """Return points and losses of every round."""
    if what != "schedule":
        with np.load(io.BytesIO(Checkpoints(folder, ".npz").load(lambda c: c))) as stored:
            return list(zip(stored["points"], stored["losses"], strict=True))
    study = optuna.load_study(study_name="tune", storage=f"sqlite:///{folder / 'study.db'}")
    return [(t.params, t.value) for t in study.trials if t.state.name == "COMPLETE"]


def rows(folder):
    """Return all runs of a database without their durations and provenance."""
    path = folder / "paper.sqlite"
    if not path.exists():
        return []
    with sqlite3.connect(path) as database:
        tables = {name for (name,) in database.execute("SELECT name FROM sqlite_master")}
        if "runs" not in tables:
            return []
        return database.execute(
            "SELECT controller, scenario, seed, final_fitness, final_collision, evaluations, best_path, "
            "trace, columns, way FROM runs ORDER BY controller, scenario, seed"
        ).fetchall()
