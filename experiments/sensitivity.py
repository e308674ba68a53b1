"""What a controller makes of its inputs: `python -m experiments.sensitivity --help`.

An input is taken away by showing its mean course instead: at every iteration, what it is on average there
over all episodes. First in the states that the controller visits: how much do its decisions change? Then
whole episodes that way: what does it cost, on the same scenarios and seeds? Without all inputs but the
iteration, the controller is a fixed schedule of its own; what it loses then is what seeing the population is
worth to it. Seeds are of those for validation, and none that a model was selected by.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from numpy.typing import NDArray

from agents import make_controller
from agents.evaluation.masking import Masked, clock_columns, input_names, mean_courses
from agents.evaluation.observers import Watched, decision_names, watch
from agents.training.config import TrainConfig, stored_config
from experiments.analysis.episodes import Outcome, analysis_seeds, outcome
from experiments.runs.database import ResultsError
from swarm_gym.command import command
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.distilled import LINEAR

Floats = NDArray[np.float64]

ALL_BUT_ITERATION = "all inputs but the iteration"
ITERATION = "the iteration (mean of all iterations)"


@dataclass(frozen=True)
class SensitivityConfig:
    """Options of an analysis."""

    policy: str = "learned:three-cases/0@1"
    """Controller to look into."""
    seeds: int = 50
    """Episodes per scenario."""
    scenarios: tuple[str, ...] = ()
    """Scenarios; those of the policy's validation by default."""
    output: Path = Path("results/sensitivity")
    """Folder for tables and figures."""
    threads: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """Threads that the swarms are spread over. Results do not depend on it."""


@dataclass(frozen=True)
class Sensitivity:
    """What was found.

    Attributes:
        policy: name of the controller.
        scenarios: their names.
        decisions: their names; changes of phi are absolute, those of others in octaves (log2).
        changes: by what was taken away, (d,) mean absolute change of each decision in the states visited.
        seeing: outcome of the controller as it is.
        masked: outcome by what was taken away.
    """

    policy: str
    scenarios: tuple[str, ...]
    decisions: tuple[str, ...]
    changes: dict[str, Floats]
    seeing: Outcome
    masked: dict[str, Outcome]


def analyse(
    name: str,
    controller: Controller,
    training: TrainConfig,
    scenarios: Sequence[str],
    seeds: range,
    threads: int = 1,
) -> Sensitivity:
    """Take away every input by itself, then all but the iteration, then the iteration.

    Args:
        name: of the controller.
        controller: what is looked into.
        training: whose optimizer, sizes, reward and price the episodes have.
        scenarios: names; a range counts as one, of which each seed draws.
        seeds: one episode each, on every scenario.
        threads: that swarms are spread over.
    """

    def episodes(driver: Controller, watchers: Sequence[Controller]) -> list[Watched]:
        return [
            watch(
                driver, watchers, [scenario], seeds, controller.observation, training.optimizer, threads,
                **training.env_options(),
            )
            for scenario in scenarios
        ]  # fmt: skip

    seeing = episodes(controller, [])
    taken_away = _take_away(controller, seeing)
    # In a pass of its own, since the mean courses have to be known.
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
    """The controller without one or several of its inputs, by what it is without."""
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
    """(d,) mean absolute difference of a watcher's decisions from those of the first one."""
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
    """Arrays (T, B, ...) as one, with episodes of all; shorter ones are filled up by zeros."""
    longest = max(map(len, parts))
    padded = [np.concatenate([p, np.zeros((longest - len(p), *p.shape[1:]), p.dtype)]) for p in parts]
    return np.concatenate(padded, axis=1)


def main() -> None:
    """Analyse as the command line says."""
    config = tyro.cli(SensitivityConfig, description=__doc__)
    from experiments.analysis.sensitivity_report import write_report

    with command(ResultsError):
        seeds = analysis_seeds(config.seeds)
        controller = make_controller(config.policy)
        training = stored_config(getattr(controller, "manifest", {}))
        scenarios = config.scenarios or training.validation_scenarios or training.scenarios
        found = analyse(config.policy, controller, training, scenarios, seeds, config.threads)
        print(f"results: {write_report(found, config.output)}")


if __name__ == "__main__":
    main()
