"""When a decision matters, and what can be foreseen: `python -m experiments.branching --help`.

Runs with the same seeds are alike up to an iteration; then one decision is changed for a window of
iterations, after which the controller goes on as ever. How far runs end from where they would have ended says
when the outcome is settled. Beside it: how well each observation at the end of a window foretells the final
gap, as a rank correlation. A controller can gain by seeing only where runs differ in what can still be
changed. Seeds are of those for validation, and none that a model was selected by.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import tyro
from numpy.typing import NDArray
from scipy import stats

from agents import make_controller
from agents.evaluation.observers import Watched, decision_names, watch
from experiments.analysis.episodes import analysis_seeds, outcome
from experiments.runs.database import ResultsError
from experiments.runs.labels import label
from experiments.statistics import paired
from experiments.tables.table import Table, percent, percent_interval
from swarm_gym.action import make_action
from swarm_gym.command import command
from swarm_gym.controllers.controller import Controller, Floats, Wrapper
from swarm_gym.files import write_atomically
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings

WINDOWS = ((0, 6), (6, 15), (15, 30), (30, 60), (60, 100))
OPTIMIZER = "firefly"
SEEN = "rich"
MOVED = 0.01  # a change of the gap that the same corridor does not explain


@dataclass(frozen=True)
class BranchingConfig:
    """Options of an analysis."""

    controller: str = "open-loop:three-cases-extended@0.1"
    """Controller to look into; its decisions must be in natural units."""
    seeds: int = 100
    """Episodes per scenario."""
    scenarios: tuple[str, ...] = ("case1", "case2", "case3")
    """Scenarios, whose optimum must be known."""
    output: Path = Path("results/branching")
    """Folder for tables."""
    threads: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """Threads that the swarms are spread over. Results do not depend on it."""


class Change(NamedTuple):
    """A change of one decision: to `factor` times what it was, plus `offset`."""

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
    """A controller, one of whose decisions is changed in a window of iterations, within its range."""

    def __init__(self, controller: Controller, change: Change, window: tuple[int, int]):
        super().__init__(controller)
        self._change, self._window = change, window
        layout = make_action(Settings(action=controller.action), get_optimizer(OPTIMIZER))
        self._low, self._high = (float(end[change.column]) for end in (layout.space.low, layout.space.high))

    def act(self, observations: NDArray) -> NDArray:
        """What the controller decides, changed."""
        actions = np.array(self._controller.act(observations), dtype=np.float64)
        first, end = self._window
        if first <= self._iteration < end:
            column, factor, offset = self._change[1:]
            actions[:, column] = np.clip(factor * actions[:, column] + offset, self._low, self._high)
        self._iteration += 1
        return actions


@dataclass(frozen=True)
class Branching:
    """What was found.

    Attributes:
        controller: its name.
        scenarios: their names.
        straight: (scenarios,) runs as they are.
        branches: (scenarios,) runs with a change, by window and name of the change.
    """

    controller: str
    scenarios: tuple[str, ...]
    straight: list[Watched]
    branches: dict[tuple[tuple[int, int], str], list[Watched]]


def analyse(
    name: str, controller: Controller, scenarios: Sequence[str], seeds: range, threads: int = 1
) -> Branching:
    """Change every decision in every window, on the same seeds.

    Raises:
        ResultsError: for a controller whose decisions are not in natural units, or an unknown optimum.
    """
    if controller.action not in ("natural", "extended"):
        raise ResultsError(
            f"controller {name!r}: its action layout is {controller.action!r}, expected natural or extended"
        )

    def runs(driver: Controller) -> list[Watched]:
        return [watch(driver, [], [one], seeds, SEEN, num_threads=threads) for one in scenarios]

    straight = runs(controller)
    outcome(straight)  # an unknown optimum is refused before all the branches
    num_decisions = len(decision_names(controller, OPTIMIZER))
    branches = {
        (window, change.name): runs(Changed(controller, change, window))
        for window in WINDOWS
        for change in CHANGES
        if change.column < num_decisions
    }
    return Branching(name, tuple(scenarios), straight, branches)


def branching_tables(found: Branching) -> list[Table]:
    """Differences of the outcome by window and change, and rank correlations with the final gap."""
    where = f"{len(found.straight[0].gap)} seeds on each of {', '.join(found.scenarios)}"
    straight = outcome(found.straight)
    rows = []
    for ((first, end), change), branch in found.branches.items():
        changed = outcome(branch)
        differences = changed.gap - straight.gap
        difference, ends = paired(differences)
        rows.append(
            (
                f"{first} to {end - 1}",
                change,
                f"{percent(difference, '+.2f')} {percent_interval(ends, '+.2f')}",
                percent((np.abs(differences) > MOVED).mean(), ".0f"),
                f"{changed.evaluations.mean() / straight.evaluations.mean():.2f}",
            )
        )
    branches = Table(
        "branching",
        f"{label(found.controller)} with one decision changed in a window of iterations: mean difference of "
        "the final gap on the same seeds [95 % bootstrap interval], runs whose gap moved by more than "
        f"{percent(MOVED, '.0f')}, ratio of the mean evaluations; {where}",
        ("iterations", "change", "difference", "moved", "evaluations ratio"),
        rows,
    )
    return [branches, _foresight(found, where)]


def _foresight(found: Branching, where: str) -> Table:
    """Rank correlations of what is seen at the beginning of a window with the final gap."""
    moments = [first for first, _ in WINDOWS[1:]]
    rows = []
    for column, feature in enumerate(make_observation(SEEN).features):
        cells = [
            _rank_correlation(w.seen[moment, :, column], w.gap) for w in found.straight for moment in moments
        ]
        if any(cells):
            rows.append((feature.name, *(cell or "–" for cell in cells)))
    heads = [f"iteration {moment}, {scenario}" for scenario in found.scenarios for moment in moments]
    return Table(
        "foresight",
        f"Rank correlation of what is seen before an iteration with the final gap, runs of "
        f"{label(found.controller)}, {where}",
        ("seen", *heads),
        rows,
    )


def _rank_correlation(seen: Floats, gap: Floats) -> str:
    """Spearman's; nothing where what is seen is the same in all runs."""
    return f"{stats.spearmanr(seen, gap).statistic:+.2f}" if np.ptp(seen) > 0.0 else ""


def write_report(found: Branching, folder: Path) -> Path:
    """Write tables as Markdown, CSV and LaTeX, and a page that shows them; returns the page."""
    tables = branching_tables(found)
    for table in tables:
        table.write(folder)
    parts = [f"# When decisions of {label(found.controller)} matter\n", *(t.markdown() for t in tables)]
    return write_atomically(folder / "README.md", "\n".join(parts))


def main() -> None:
    """Analyse as the command line says."""
    config = tyro.cli(BranchingConfig, description=__doc__)
    with command(ResultsError):
        seeds = analysis_seeds(config.seeds)
        controller = make_controller(config.controller)
        found = analyse(config.controller, controller, config.scenarios, seeds, config.threads)
        print(f"results: {write_report(found, config.output)}")


if __name__ == "__main__":
    main()
