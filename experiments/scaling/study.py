"""The work of the whole study, every run of its suites and ten trainings of every preset, and its time."""

import contextlib
import io
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from experiments.catalogue import get_suite
from experiments.runs.episode import Episode
from experiments.runs.experiment import Experiment
from experiments.runs.run import RunKey
from experiments.runs.runner import make_units
from experiments.scaling.model import Work
from experiments.speed.measurement import seconds_of
from swarm_gym.training.presets import load_preset, preset_names
from swarm_gym.training.run import TrainingRun

EVALUATED = ("headline", "generalisation", "out-of-distribution", "parameters")
TRAINING_SEEDS = 10
# The preset that is timed for each kind of learner; recurrent PPO counts as PPO.
TIMED_PRESETS = {"evolution": "three-cases-linear", "ppo": "three-cases"}


def time_runs(experiment: Experiment, keys: list[RunKey], sample: int) -> list[float]:
    """Return the processor times, in seconds, of a random sample of runs with their overheads."""
    rng = np.random.default_rng(0)
    found = []
    for number in rng.choice(len(keys), min(sample, len(keys)), replace=False):
        Episode(keys[number], experiment).run({})  # loads files and kernels
        begin = time.process_time()
        Episode(keys[number], experiment).run({})
        found.append(time.process_time() - begin)
    return found


def time_training(preset: str, steps: int) -> float:
    """Return the wall time of an environment step in training, validations and checkpoints included."""
    with TemporaryDirectory() as folder:
        run = TrainingRun(replace(load_preset(preset), runs=Path(folder), total_steps=steps))
        with contextlib.redirect_stderr(io.StringIO()):  # hides its progress bars
            seconds = seconds_of(run.run)
        return seconds / run.learner.num_steps


def evaluations(seconds: Mapping[str, Sequence[float]], cores: int) -> Work:
    """Return the work of the runs of all suites, in units for a number of cores.

    Args:
        seconds: times of some runs of each suite, by its name.
        cores: number of cores.
    """
    total, units, rows, longest = 0.0, 0, 0, 0.0
    for name, sample in seconds.items():
        runs = get_suite(name).all_runs()
        made = make_units(runs, cores)
        total += len(runs) * float(np.mean(sample))
        longest = max(longest, max(sample) * max(len(unit.seeds) for unit in made))
        units, rows = units + len(made), rows + len(runs)
    return Work(units, total / units, longest, rows)


def trainings(seconds_per_step: Mapping[str, float]) -> Work:
    """Return the work of all trainings; each is one unit.

    Args:
        seconds_per_step: time of an environment step by kind of learner, "evolution" or "ppo".
    """
    lengths = []
    for name in preset_names():
        preset = load_preset(name)
        kind = "evolution" if preset.algorithm == "evolution" else "ppo"
        lengths.append(preset.total_steps * seconds_per_step[kind])
    return Work(TRAINING_SEEDS * len(lengths), float(np.mean(lengths)), max(lengths))
