"""Masked controllers: some of their inputs are replaced by the mean of these inputs at the same iteration.

A blinded policy has all inputs but the clock replaced by their mean courses, so that it decides by the
iteration alone. What a policy gains over itself blinded is what it makes of what it sees; what it gains over
other controllers may be a better course of decisions.
"""

import copy
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.evaluation.observers import watch
from swarm_gym.controllers.controller import Controller, Floats, SizeLimits, Wrapper
from swarm_gym.controllers.registry import load_learned
from swarm_gym.observation import make_observation
from swarm_gym.runs.seeds import ANALYSIS
from swarm_gym.training.config import stored_config

# Inputs that are functions of the iteration: masking them changes nothing.
CLOCKS = (
    "iteration",
    "share of the iterations done",
    "log(1 + iteration), relative to that of the last",
)

NUM_EPISODES = 192  # of the courses of a blinded policy


class Masked(Wrapper):
    """A controller with some of its inputs replaced by their means at the same iteration.

    If the controller corrects another one, the columns of the observation are the inputs of the other one and
    then its own.

    Args:
        controller: controller to mask; a copy of it decides, since it may have a memory.
        courses: (T, k) mean observations by iteration, or a function that returns them at the first decision;
            later iterations use the last row.
        columns: columns of the observation that are replaced.
    """

    def __init__(
        self, controller: Controller, courses: Floats | Callable[[], Floats], columns: Sequence[int]
    ):
        super().__init__(copy.deepcopy(controller))
        self._given = courses
        self._columns = list(columns)

    @cached_property
    def _courses(self) -> Floats:
        return self._given() if callable(self._given) else self._given

    def identity(self) -> object:
        """Return the identity of the controller, and which inputs are masked.

        The courses that replace them are computed from its decisions.
        """
        return "masked", [int(column) for column in self._columns], self._controller.identity()

    def act(self, observations: NDArray) -> NDArray:
        """Return the decisions of the controller on masked observations."""
        seen = observations.copy()
        courses = self._courses[np.minimum(self._count(observations), len(self._courses) - 1)]
        seen[:, self._columns] = courses[:, self._columns]
        return self._controller.act(seen)


def mean_courses(seen: NDArray, running: NDArray[np.bool_]) -> Floats:
    """Return the (T, k) means of observations (T, B, k) at each iteration, over running episodes (T, B)."""
    counts = np.maximum(running.sum(axis=1), 1)[:, None]
    return np.where(running[..., None], seen, 0.0).sum(axis=1, dtype=np.float64) / counts


def input_names(controller: Controller) -> list[str]:
    """Return unique names of a controller's inputs.

    Inputs of its base are marked "(base)"; names that occur in several joined layouts are numbered.

    Raises:
        UnknownNameError: if its observation layout does not exist.
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
    """Return the columns of a controller's observation that are functions of the iteration."""
    return [column for column, name in enumerate(_features(controller)) if name in CLOCKS]


def _features(controller: Controller) -> list[str]:
    return [feature.name for feature in make_observation(controller.observation).features]


def load_blinded(policy: str, limits: SizeLimits | None = None, longer: float = 1.0) -> Masked:
    """Return a learned policy, blinded by its mean courses over all scenarios that it was trained on.

    The episodes of the courses have seeds that neither trainings nor tests have. They run before the first
    decision, so that whoever only asks for the identity does not wait for them.

    Args:
        policy: name or path of the policy, as after `learned:`.
        limits: population sizes that the environment allows.
        longer: iterations and evaluations of its episodes, relative to those of the training. The courses are
            those of such episodes.

    Raises:
        PolicyFileError: if the file is missing, damaged or made for something else.
    """
    controller = load_learned(policy, limits).stretched(longer)
    training = stored_config(controller.manifest)
    clocks = clock_columns(controller)
    options: dict[str, Any] = dict(training.env_options())
    options["iterations"] = round(longer * options["iterations"])
    if options["max_evaluations"] is not None:
        options["max_evaluations"] = round(longer * options["max_evaluations"])

    def courses() -> Floats:
        watched = watch(
            controller,
            [],
            training.scenarios,
            ANALYSIS[:NUM_EPISODES],
            controller.observation,
            training.optimizer,
            **options,
        )
        return mean_courses(watched.seen, watched.running)

    return Masked(controller, courses, [k for k in range(len(_features(controller))) if k not in clocks])
