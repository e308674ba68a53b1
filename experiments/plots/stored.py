"""Stored runs of a suite as figures need them, each part loaded once it is needed."""

from collections.abc import Callable
from functools import cached_property

from matplotlib.figure import Figure

from experiments.plots.courses import CaseRuns
from experiments.plots.style import styles
from experiments.runs.database import Results
from experiments.runs.outcomes import Outcomes
from experiments.runs.run import RunKey, Snapshot
from experiments.runs.suite import Suite
from swarm_gym.reference import known_optimum
from swarm_gym.worlds import make_problem


class Stored:
    """The stored runs of a suite.

    Attributes:
        suite: suite that was run.
        results: database of the suite.
    """

    def __init__(self, suite: Suite, results: Results):
        self.suite = suite
        self.results = results

    @cached_property
    def cases(self) -> list[CaseRuns]:
        """The scenarios with all that is stored of their runs."""
        return load_cases(self.suite, self.results)

    @cached_property
    def outcomes(self) -> Outcomes:
        """The numbers of all runs, none of which may be missing."""
        return self.results.outcomes(
            self.suite.controllers, self.suite.seeds, self.suite.options, self.suite.alone
        )

    @cached_property
    def snapshots(self) -> dict[RunKey, list[Snapshot]]:
        """The stored populations by run."""
        return load_snapshots(self.suite, self.results)


Drawings = dict[str, Callable[[], Figure]]  # functions that draw, by name of the figure
FigureMaker = Callable[[Stored], Drawings]


def load_cases(suite: Suite, results: Results) -> list[CaseRuns]:
    """Return the scenarios of a suite that have runs, with these runs."""
    cases = []
    for name in suite.scenarios:
        runs = {
            controller: found
            for controller in suite.controllers
            if (found := results.runs(controller, name, suite.num_seeds, suite.seeds[name].start))
        }
        if runs:
            problem = make_problem(name, **suite.options)
            cases.append(CaseRuns(problem.scenario, known_optimum(problem), runs, styles(suite.controllers)))
    return cases


def load_snapshots(suite: Suite, results: Results) -> dict[RunKey, list[Snapshot]]:
    """Return the populations that a suite asks for and that are stored, by run."""
    found = {}
    for controller, scenario, seed, iterations in suite.snapshots:
        if controller in suite.controllers and scenario in suite.scenarios:
            stored = results.snapshots(controller, scenario, seed)
            kept = [snapshot for snapshot in stored if snapshot.iteration in iterations]
            if kept:
                found[controller, scenario, seed] = kept
    return found
