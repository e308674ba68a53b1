"""Measures of runs on maps that change: errors over time, and when a path is feasible again after an event.

The row of an iteration in a run's trace shows the swarm after the events that follow this iteration.
"""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.runs.run import Floats, Run
from swarm_gym.errors import ScenarioError
from swarm_gym.reference import gap_to_optimum, known_optimum
from swarm_gym.settings import Settings
from swarm_gym.worlds import problems_for, worlds_for


class Changes(NamedTuple):
    """The changes of a map during an episode.

    Attributes:
        begins: (worlds,) iteration after which each map is in force; 0 for the first.
        optima: (worlds,) least fitness on each map, nan where it is unknown.
    """

    begins: NDArray[np.int64]
    optima: Floats

    @classmethod
    @cache
    def of(cls, scenario: str) -> "Changes":
        """Return the changes of the scenario of a name, in the default encoding."""
        settings = Settings(scenario=scenario)
        begins = np.array([world.iteration for world in worlds_for(settings)])
        return cls(begins, np.array([known_optimum(problem) for problem in problems_for(settings)]))

    @property
    def events(self) -> NDArray[np.int64]:
        """Iterations that events follow, (worlds - 1,)."""
        return self.begins[1:]

    def gaps(self, runs: Sequence[Run]) -> Floats:
        """Return the optimality gap of runs after every iteration, on the map in force, (runs, rows)."""
        best = np.array([run.course("best_fitness") for run in runs])
        rows = np.arange(best.shape[1])
        in_force = np.searchsorted(self.begins, rows, side="right") - 1
        return gap_to_optimum(best, self.optima[in_force])


def offline_errors(runs: Sequence[Run], scenario: str) -> Floats:
    """Return the mean gap of each run from the first event on, (runs,), as the reward `offline-error` has it.

    Without events the mean is over all iterations.

    Raises:
        ScenarioError: if the optimum of one of the maps is unknown.
    """
    changes = Changes.of(scenario)
    if np.isnan(changes.optima).any():
        raise ScenarioError(f"the offline error of {scenario!r} needs the optimum after each of its events")
    first = int(changes.events[0]) if changes.events.size else 1
    return changes.gaps(runs)[:, first:].mean(axis=1)


def iterations_to_feasible(runs: Sequence[Run], event: int) -> Floats:
    """Return the iterations from an event to the first feasible path after it, (runs,); infinite without one.

    Args:
        runs: runs of one length.
        event: iteration that the event follows; 0 iterations later is right after the event.
    """
    found = np.isfinite([run.course("feasible_fitness")[event:] for run in runs])
    return np.where(found.any(axis=1), found.argmax(axis=1), np.inf)
