"""Requests: what is asked of the planner for one path, apart from the map; checked when they are made."""

from collections.abc import Mapping
from dataclasses import dataclass

from numpy.typing import ArrayLike

from swarm_gym.checks import require_integer, require_number
from swarm_gym.errors import SettingError
from swarm_gym.planning.alternatives import MOST
from swarm_gym.planning.steady import SWITCH_MARGIN
from swarm_gym.planning.tasks import Task
from swarm_gym.planning.wishes import WishedTask, require_wishes

PLANNERS = ("auto", "swarm")


@dataclass(frozen=True, eq=False)
class Request:
    """A request for one path; the attributes are arguments of `swarm_gym.plan`.

    Raises:
        SettingError: for a value that is invalid.
        UnknownNameError: for a wish of another name.
    """

    planner: str = "auto"
    optimizer: str | None = None
    controller: str | None = None
    max_evaluations: int | None = None
    max_seconds: float | None = None
    seed: int = 0
    previous: ArrayLike | None = None
    switch_margin: float = SWITCH_MARGIN
    alternatives: int = 1
    wishes: Mapping[str, float] | None = None

    def __post_init__(self) -> None:
        require_integer("seed", self.seed, 0, 2**31)
        if self.planner not in PLANNERS:
            raise SettingError(f"planner: expected {' or '.join(PLANNERS)}, got {self.planner!r:.80}")
        if self.max_seconds is not None:
            require_number("max_seconds", self.max_seconds, 1e-3, 1e9)
        if self.max_evaluations is not None:
            require_integer("max_evaluations", self.max_evaluations, 1)
        require_number("switch_margin", self.switch_margin, 0.0, 1.0)
        require_integer("alternatives", self.alternatives, 1, MOST)
        if self.wishes is not None:
            require_wishes(self.wishes)
        if self.wishes and self.names_swarm:
            raise SettingError(
                "wishes: a swarm weighs the length alone; leave wishes out, or planner, optimizer and "
                "controller"
            )

    @property
    def names_swarm(self) -> bool:
        """True if a swarm is asked for."""
        return self.planner == "swarm" or self.optimizer is not None or self.controller is not None

    def wished(self, task: Task) -> WishedTask | None:
        """Return the task with its wishes; None if the length alone counts.

        Costs of ground count with a weight of 1 where there are some, and no wishes and no swarm are named.

        Raises:
            SettingError: for wishes that the map cannot have.
        """
        has_costs = task.costs is not None and bool(task.costs.any())
        usual = {"ground": 1.0} if has_costs and not self.names_swarm else {}
        weights = require_wishes(usual if self.wishes is None else self.wishes)
        return WishedTask(task, weights) if any(weights.values()) else None
