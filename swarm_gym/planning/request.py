"""Requests: what is asked of the planner for one path, apart from the map; checked when they are made."""

from collections.abc import Mapping
from dataclasses import dataclass

from numpy.typing import ArrayLike

from swarm_gym.checks import require_integer, require_number
from swarm_gym.errors import SettingError, shown
from swarm_gym.planning.alternatives import MOST
from swarm_gym.planning.previous import Floats, require_previous
from swarm_gym.planning.steady import SWITCH_MARGIN
from swarm_gym.planning.tasks import Task
from swarm_gym.planning.wishes import WishedTask, require_wishes

PLANNERS = ("auto", "swarm")


@dataclass(frozen=True, eq=False)
class Request:
    """A request for one path; the attributes are arguments of `swarm_gym.plan`, but for the last.

    Attributes:
        underway: whether the robot has left the start of the previous path, whose rest counts.

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
    turning_radius: float | None = None
    start_heading: float | None = None
    goal_heading: float | None = None
    reverse: bool = False
    curvature_rate: float | None = None
    underway: bool = False

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
        self._require_drivable()
        if self.wishes and self.names_swarm:
            raise SettingError(
                "wishes: a swarm weighs the length alone; leave wishes out, or planner, optimizer and "
                "controller"
            )

    @property
    def names_swarm(self) -> bool:
        """True if a swarm is asked for."""
        return self.planner == "swarm" or self.optimizer is not None or self.controller is not None

    def before(self, task: Task) -> Floats | None:
        """Return the previous path, or its rest, in the frame of a task, (k, 2); None without one.

        Raises:
            SettingError: for a previous path that does not fit the task.
        """
        if self.previous is None:
            return None
        return task.frame.to_frame(require_previous(self.previous, task, underway=self.underway))

    def _require_drivable(self) -> None:
        """Raise an error for a turning radius, headings or `reverse` that are invalid."""
        for name, heading in (("start_heading", self.start_heading), ("goal_heading", self.goal_heading)):
            if heading is not None:
                require_number(f"{name} in degrees", heading, -360.0, 360.0)
                self._require_radius(name, heading)
        if not isinstance(self.reverse, bool):
            raise SettingError(f"reverse must be True or False, got {shown(self.reverse)}")
        if self.reverse:
            self._require_radius("reverse", self.reverse)
        if self.curvature_rate is not None:
            require_number("curvature_rate", self.curvature_rate, 1e-12, 1e12)
            self._require_radius("curvature_rate", self.curvature_rate)
        if self.wishes and self.wishes.get("curvature"):
            self._require_radius("wishes: weight of curvature", self.wishes["curvature"])
        if self.turning_radius is None:
            return
        require_number("turning_radius", self.turning_radius, 1e-6, 1e9)
        if self.names_swarm:
            raise SettingError(
                "turning_radius: swarms find polylines; leave it out, or planner, optimizer and controller"
            )

    def _require_radius(self, name: str, value: object) -> None:
        if self.turning_radius is None:
            raise SettingError(
                f"{name} {shown(value)}: expected a turning_radius, too; paths without one turn on the spot"
            )

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
