"""The work of the whole study: every run of its suites, and ten trainings of every preset."""

from collections.abc import Mapping, Sequence

import numpy as np

from agents.training.presets import load_preset, preset_names
from experiments.catalogue import get_suite
from experiments.runs.runner import all_runs, make_units
from experiments.scaling.model import Work

EVALUATED = ("headline", "generalisation", "out-of-distribution", "ablation", "parameters")
TRAINING_SEEDS = 10
# Of each kind of learner the preset that is timed; recurrent PPO counts as PPO.
TIMED_PRESETS = {"evolution": "three-cases", "ppo": "three-cases-ppo"}


def evaluations(seconds: Mapping[str, Sequence[float]], cores: int) -> Work:
    """The runs of all suites, as units that so many cores are given.

    Args:
        seconds: by suite, of some of its runs.
        cores: how many.
    """
    total, units, rows, longest = 0.0, 0, 0, 0.0
    for name, sample in seconds.items():
        runs = all_runs(get_suite(name))
        made = make_units(runs, cores)
        total += len(runs) * float(np.mean(sample))
        longest = max(longest, max(sample) * max(len(unit.seeds) for unit in made))
        units, rows = units + len(made), rows + len(runs)
    return Work(units, total / units, longest, rows)


def trainings(seconds_per_step: Mapping[str, float]) -> Work:
    """All trainings, each of which is a unit.

    Args:
        seconds_per_step: of each kind of learner.
    """
    lengths = []
    for name in preset_names():
        preset = load_preset(name)
        kind = "evolution" if preset.algorithm == "evolution" else "ppo"
        lengths.append(preset.total_steps * seconds_per_step[kind])
    return Work(TRAINING_SEEDS * len(lengths), float(np.mean(lengths)), max(lengths))
