"""Analysis of when a decision matters: one decision is changed in one window of iterations."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from agents.evaluation.observers import Watched, decision_names, watch
from experiments.analysis.episodes import outcome
from experiments.runs.database import ResultsError
from experiments.runs.labels import label
from experiments.statistics import paired
from experiments.tables.cell import MISSING, Entry, number, percent, share, share_in
from experiments.tables.table import Row, Table, write_tables_page
from swarm_gym.action import make_action
from swarm_gym.controllers.controller import Controller, Floats, Wrapper
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings

WINDOWS = ((0, 6), (6, 15), (15, 30), (30, 60), (60, 100))
OPTIMIZER = "firefly"
OBSERVED = "rich"  # observation layout whose features are correlated with the final gap
MOVED = 0.01  # least change of the gap that means another corridor


class Change(NamedTuple):
    """A change of one decision, a column of the action: its value times `factor`, plus `offset`."""

    name: str
    column: int
    factor: float
    offset: float = 0.0


CHANGES = (
    Change("size x 2", 0, 2.0),
    Change("size / 2", 0, 0.5),
    Change("φ = 0", 1, 0.0),
    Change("φ = 1", 1, 0.0, 1.0),
    Change("α x 4", 2, 4.0),
    Change("α / 4", 2, 0.25),
    Change("β₀ x 3", 3, 3.0),
    Change("β₀ / 3", 3, 1 / 3),
)


class Changed(Wrapper):
    """A controller with one decision changed in a window of iterations.

    Args:
        controller: decides in natural units; its decision is clipped to the range of the action.
        change: change of the decision.
        window: first iteration of the window, and the one after its last.
    """

    def __init__(self, controller: Controller, change: Change, window: tuple[int, int]):
        super().__init__(controller)
        self._change, self._window = change, window
        space = make_action(Settings(action=controller.action), get_optimizer(OPTIMIZER)).space
        self._low, self._high = (float(end[change.column]) for end in (space.low, space.high))

    def identity(self) -> object:
        """Return the change, the window and the identity of the controller."""
        return "changed", tuple(self._change), self._window, self._controller.identity()

    def act(self, observations: NDArray) -> NDArray:
        """Return the actions of the controller, changed where the iteration is in the window."""
        actions = np.array(self._controller.act(observations), dtype=np.float64)
        first, end = self._window
        iterations = self._count(observations)
        inside = (first <= iterations) & (iterations < end)
        column, factor, offset = self._change[1:]
        actions[inside, column] = np.clip(factor * actions[inside, column] + offset, self._low, self._high)
        return actions


@dataclass(frozen=True)
class Branching:
    """Runs of a controller, unchanged and with every change in every window.

    Attributes:
        controller: name of the controller.
        scenarios: names of the scenarios.
        straight: (scenarios,) runs without a change.
        branches: (scenarios,) runs with a change, by window and name of the change.
    """

    controller: str
    scenarios: tuple[str, ...]
    straight: list[Watched]
    branches: dict[tuple[tuple[int, int], str], list[Watched]]


def analyse(
    name: str, controller: Controller, scenarios: Sequence[str], seeds: range, threads: int = 1
) -> Branching:
    """Run a controller on the same seeds without a change and with every change in every window.

    Args:
        name: name of the controller.
        controller: the controller; its action layout must be natural or extended.
        scenarios: names of the scenarios.
        seeds: one episode each, on every scenario.
        threads: number of threads that share the swarms.

    Raises:
        ResultsError: if decisions are not in natural units, or if the optimum of a scenario is unknown.
    """
    if controller.action not in ("natural", "extended"):
        raise ResultsError(
            f"controller {name!r}: its action layout is {controller.action!r}, expected natural or extended"
        )

    def runs(deciding: Controller) -> list[Watched]:
        return [watch(deciding, [], [one], seeds, OBSERVED, num_threads=threads) for one in scenarios]

    straight = runs(controller)
    outcome(straight)  # raises for an unknown optimum, before the many branches are run
    num_decisions = len(decision_names(controller, OPTIMIZER))
    branches = {
        (window, change.name): runs(Changed(controller, change, window))
        for window in WINDOWS
        for change in CHANGES
        if change.column < num_decisions
    }
    return Branching(name, tuple(scenarios), straight, branches)


def branching_tables(found: Branching) -> list[Table]:
    """Return the table of differences by window and change, and that of rank correlations."""
    where = f"{len(found.straight[0].gap)} seeds on each of {', '.join(found.scenarios)}"
    straight = outcome(found.straight)
    rows: list[Row] = []
    for ((first, end), change), branch in found.branches.items():
        changed = outcome(branch)
        differences = changed.gap - straight.gap
        rows.append(
            {
                "iterations": f"{first} to {end - 1}",
                "change": change,
                "difference": share_in(*paired(differences), "+.2f"),
                "moved": share((np.abs(differences) > MOVED).mean(), ".0f"),
                "evaluations ratio": number(changed.evaluations.mean() / straight.evaluations.mean(), ".2f"),
            }
        )
    caption = (
        f"{label(found.controller)} with one decision changed in a window of iterations: mean difference of "
        "the final gap on the same seeds [95 % bootstrap interval], runs whose gap moved by more than "
        f"{percent(MOVED, '.0f')}, ratio of the mean evaluations; {where}"
    )
    return [Table.of("branching", caption, rows), _foresight(found, where)]


def _foresight(found: Branching, where: str) -> Table:
    """Return rank correlations of observations before the beginning of each window with the final gap."""
    moments = [first for first, _ in WINDOWS[1:]]
    rows: list[Row] = []
    for column, feature in enumerate(make_observation(OBSERVED).features):
        cells = {
            f"iteration {moment}, {scenario}": _rank_correlation(w.seen[moment, :, column], w.gap)
            for scenario, w in zip(found.scenarios, found.straight, strict=True)
            for moment in moments
        }
        if any(cell != MISSING for cell in cells.values()):
            rows.append({"seen": feature.name, **cells})
    caption = (
        f"Rank correlation of what is seen before an iteration with the final gap, runs of "
        f"{label(found.controller)}, {where}"
    )
    return Table.of("foresight", caption, rows)


def _rank_correlation(seen: Floats, gap: Floats) -> Entry:
    """Return Spearman's rank correlation; the sign for a missing number if all observations are equal."""
    return number(stats.spearmanr(seen, gap).statistic if np.ptp(seen) > 0.0 else None, "+.2f")


def write_report(found: Branching, folder: Path) -> Path:
    """Write the tables as files, and a page that shows them; return the path of the page."""
    title = f"When decisions of {label(found.controller)} matter"
    return write_tables_page(folder, title, branching_tables(found))
