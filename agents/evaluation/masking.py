"""Controllers that do not see some of their inputs: these follow their mean course over the iterations."""

import copy
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller, Floats
from swarm_gym.controllers.wrapper import Wrapper
from swarm_gym.observation import make_observation

# Inputs that are the iteration in other words: at a given iteration there is nothing in them to be blind for.
CLOCKS = (
    "iteration",
    "share of the iterations done",
    "log(1 + iteration), relative to that of the last",
)


class Blinded(Wrapper):
    """A controller, with some of its inputs replaced by what they are on average at the same iteration.

    Where a controller corrects another one, inputs of both are among the observation's columns, those of the
    other one first.

    Args:
        controller: what decides; a copy of it, since it may have a memory.
        courses: (T, k) of its observation, by iteration; later iterations see the last row.
        columns: of the observation that are replaced.
    """

    def __init__(self, controller: Controller, courses: Floats, columns: Sequence[int]):
        super().__init__(copy.deepcopy(controller))
        self._courses = courses
        self._columns = list(columns)

    def act(self, observations: NDArray) -> NDArray:
        """What is decided without these inputs."""
        seen = observations.copy()
        course = self._courses[min(self._iteration, len(self._courses) - 1)]
        seen[:, self._columns] = course[self._columns]
        self._iteration += 1
        return self._controller.act(seen)


def mean_courses(seen: NDArray, running: NDArray[np.bool_]) -> Floats:
    """(T, k) mean of observations (T, B, k) at each iteration, over the episodes that were running then."""
    counts = np.maximum(running.sum(axis=1), 1)[:, None]
    return np.where(running[..., None], seen, 0.0).sum(axis=1, dtype=np.float64) / counts


def input_names(controller: Controller) -> list[str]:
    """Names of what a controller sees, no two alike.

    What its base sees is marked so; a name that joined layouts repeat is numbered.

    Raises:
        UnknownNameError: if it sees a layout that there is not.
    """
    of_base = len(_features(controller.corrects)) if controller.corrects else 0
    names = [
        f"{name} (base)" if column < of_base else name for column, name in enumerate(_features(controller))
    ]
    return [
        f"{name} ({names[:column].count(name) + 1})" if name in names[:column] else name
        for column, name in enumerate(names)
    ]


def clock_columns(controller: Controller) -> list[int]:
    """Which of these are the iteration."""
    return [column for column, name in enumerate(_features(controller)) if name in CLOCKS]


def _features(controller: Controller) -> list[str]:
    return [feature.name for feature in make_observation(controller.observation).features]
