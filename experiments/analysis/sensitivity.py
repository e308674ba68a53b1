"""Analysis of what a controller makes of its inputs: each is replaced by its mean course in turn."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from agents.evaluation.masking import Masked, clock_columns, input_names, mean_courses
from agents.evaluation.observers import Watched, decision_names, watch
from experiments.analysis.episodes import EpisodeOutcome, outcome
from experiments.runs.run import Floats
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.distilled import LINEAR
from swarm_gym.training.config import TrainConfig

ALL_BUT_ITERATION = "all inputs but the iteration"
ITERATION = "the iteration (mean of all iterations)"


@dataclass(frozen=True)
class Sensitivity:
    """Changes of decisions and outcomes of a controller without its inputs.

    Attributes:
        policy: name of the controller.
        scenarios: names of the scenarios.
        decisions: names of the decisions; changes of phi are absolute, those of others in octaves (log2).
        changes: (d,) mean absolute change of each decision in the visited states, by the input taken away.
        seeing: outcome of the controller with all inputs.
        masked: outcomes by the input taken away.
    """

    policy: str
    scenarios: tuple[str, ...]
    decisions: tuple[str, ...]
    changes: dict[str, Floats]
    seeing: EpisodeOutcome
    masked: dict[str, EpisodeOutcome]


def analyse(
    name: str,
    controller: Controller,
    training: TrainConfig,
    scenarios: Sequence[str],
    seeds: range,
    threads: int = 1,
) -> Sensitivity:
    """Take away every input by itself, then all inputs but the iteration, then the iteration.

    Args:
        name: name of the controller.
        controller: the controller to analyse.
        training: configuration whose optimizer, sizes, reward and price the episodes have.
        scenarios: names of the scenarios; a range is one scenario, from which each seed draws a map.
        seeds: one episode each, on every scenario.
        threads: number of threads that share the swarms.
    """

    def episodes(deciding: Controller, watchers: Sequence[Controller]) -> list[Watched]:
        return [
            watch(
                deciding, watchers, [scenario], seeds, controller.observation, training.optimizer, threads,
                **training.env_options(),
            )
            for scenario in scenarios
        ]  # fmt: skip

    seeing = episodes(controller, [])
    taken_away = _take_away(controller, seeing)
    # A second pass, since the mean courses must be known first.
    visited = episodes(controller, [Masked(controller, np.zeros((1, 0)), []), *taken_away.values()])
    decisions = decision_names(controller, training.optimizer)
    changes = [_changes(decisions, visited, 1 + place) for place in range(len(taken_away))]
    return Sensitivity(
        name,
        tuple(scenarios),
        decisions,
        dict(zip(taken_away, changes, strict=True)),
        outcome(seeing),
        {text: outcome(episodes(masked, [])) for text, masked in taken_away.items()},
    )


def _take_away(controller: Controller, seeing: list[Watched]) -> dict[str, Masked]:
    """Return the controller without one or several of its inputs, by the name of what is taken away."""
    names, clocks = input_names(controller), clock_columns(controller)
    seen, running = _side_by_side([w.seen for w in seeing]), _side_by_side([w.running for w in seeing])
    courses = mean_courses(seen, running)
    others = [column for column in range(len(names)) if column not in clocks]
    found = {names[column]: Masked(controller, courses, [column]) for column in others}
    found[ALL_BUT_ITERATION] = Masked(controller, courses, others)
    if clocks:
        constant = seen[running].mean(axis=0, dtype=np.float64, keepdims=True)
        found[ITERATION] = Masked(controller, constant, clocks)
    return found


def _changes(decisions: Sequence[str], visited: list[Watched], watcher: int) -> Floats:
    """Return the mean absolute difference, (d,), of a watcher's decisions from those of the first watcher."""
    rows = np.concatenate([w.running.ravel() for w in visited])
    before, after = (
        np.concatenate([w.decided[k].reshape(-1, len(decisions)) for w in visited])[rows]
        for k in (0, watcher)
    )
    columns = [
        abs(b - a) if name == LINEAR else abs(np.log2(b / a))
        for name, a, b in zip(decisions, before.T, after.T, strict=True)
    ]
    return np.array([column.mean() for column in columns])


def _side_by_side(parts: list[NDArray]) -> NDArray:
    """Return arrays (T, B, ...) joined along their episodes; shorter ones are padded by zeros."""
    longest = max(map(len, parts))
    padded = [np.concatenate([p, np.zeros((longest - len(p), *p.shape[1:]), p.dtype)]) for p in parts]
    return np.concatenate(padded, axis=1)
