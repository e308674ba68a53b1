"""Tasks of planning: a map with start and goal as it is given, and as the planner works on it."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.errors import NoPathError, ScenarioError, shown
from swarm_gym.planning.frame import Frame
from swarm_gym.planning.maps import AnyMap, read_any_map
from swarm_gym.planning.workspace import read_workspace
from swarm_gym.problem.geometry.clearance import clearance_of
from swarm_gym.reference import known_robot_path, shortest_path
from swarm_gym.reference.disc_planner import never
from swarm_gym.scenarios import GridScenario, MapScenario, Point, Scenario, grown
from swarm_gym.scenarios.formats.geographic import Projection, require_coordinates
from swarm_gym.scenarios.graded_map import Grading
from swarm_gym.scenarios.growing_grids import require_room

Floats = NDArray[np.float64]

# What the exact planner takes a second for, at most: cells of a grid map, and obstacles of others.
MOST_CELLS, MOST_OBSTACLES = 2**21, 4000


@dataclass(frozen=True)
class Task:
    """A task of planning.

    Attributes:
        given: the map as it is, with start and goal, in map units.
        margin: distance in map units that the path keeps from obstacles: radius of the robot and clearance.
        frame: the coordinates that the planner works in.
        bare: the map as it is, in the frame.
        start: start in the user's coordinates.
        goal: goal in the user's coordinates.
        projection: projection from the user's longitudes and latitudes to map units, which are metres then;
            None if the user's coordinates are map units.
        is_stopped: whether planning shall end; the exact planner of a disc asks for it, again and again.
        reference: member "crs" of a GeoJSON file, which names its coordinates; None without one.
    """

    given: MapScenario
    margin: float
    frame: Frame
    bare: MapScenario
    start: Point
    goal: Point
    projection: Projection | None
    is_stopped: Callable[[], bool] = field(default=never, repr=False, compare=False)
    reference: object = None

    @property
    def costs(self) -> Floats | None:
        """Cost of ground of each cell of the map as it is, (height, width); None if it has none."""
        ground = self.given.ground if isinstance(self.given, GridScenario) else None
        return None if ground is None else ground.costs

    @cached_property
    def grown(self) -> MapScenario:
        """The map with obstacles that have grown by the margin, in the frame: a point is the whole robot.

        On grid maps, cells at the ends, or along an exact path, may be open though parts of them are too
        close.

        Raises:
            NoPathError: if grown obstacles separate the ends.
        """
        bare = self.bare
        if self.margin == 0.0:
            return bare
        if isinstance(bare, Scenario) and isinstance(self.given, Scenario):
            # Obstacles that share an edge overlap when they have grown, so seams need not grow.
            bare = replace(bare, obstacles=bare.obstacles[: len(self.given.obstacles)])
        try:
            return grown(bare, self.frame.factor * self.margin)
        except NoPathError as error:
            if self.shortest is None:
                raise NoPathError(
                    f"{error}; rounding to small cells closes passages that are hardly wider than the robot, "
                    f"whose diameter is {2.0 * self.margin:g} with the clearance: try a map of finer cells, "
                    "or only the part around start and goal"
                ) from error
        return grown(bare, self.margin, self.shortest[1])

    @cached_property
    def shortest(self) -> tuple[float, Floats] | None:
        """Length and points, (k, 2), of the exact shortest path of the robot, in the frame.

        On a grid map it is the path of the robot on the map as given, which no rounding to cells has changed.
        None where it is not quickly known, by the size of the map and the work that it takes.

        Raises:
            NoPathError: if there is none.
            StoppedError: if planning shall end before it is known.
        """
        if isinstance(self.given, GridScenario):
            if self.given.map.blocked.size > MOST_CELLS:
                return None
            return known_robot_path(self.given, self.margin, self.is_stopped)
        assert isinstance(self.grown, Scenario)
        return None if len(self.grown.solids) > MOST_OBSTACLES else shortest_path(self.grown)

    def for_user(self, path: Floats) -> Floats:
        """Return a path from start to goal, (k, 2) in map units, in the user's coordinates."""
        if self.projection is None:
            return path
        points = self.projection.to_degrees(path)
        points[0], points[-1] = self.start, self.goal
        return points

    def on_map(self, path: Floats) -> Floats:
        """Return a path in the user's coordinates, (k, 2), in map units."""
        return path if self.projection is None else self.projection.to_metres(path)


def read_task(
    where: AnyMap,
    start: Point | None,
    goal: Point | None,
    margin: float,
    workspace: str | Path | ArrayLike | None = None,
    coordinates: str | None = None,
    grading: Grading | None = None,
    is_stopped: Callable[[], bool] = never,
) -> Task:
    """Return the task on a map.

    Args:
        where: a file, here or in the data folder: `.yaml` or `.yml` of ROS's map_server, `.map` of Moving
            AI, or GeoJSON; a scenario or its name; or a map of cells. A file that exists wins.
        start: (x, y), in the user's coordinates; a scenario has its own.
        goal: (x, y), in the user's coordinates; a scenario has its own.
        margin: distance to keep from obstacles, in map units.
        workspace: box, polygon or file of what the robot stays in, see `read_workspace`; None for no limit.
        coordinates: kind of the user's coordinates, see `COORDINATES`; None takes what the file names.
        grading: meaning of the grades of a file; None for free and blocked cells only.
        is_stopped: whether planning shall end; the task asks for it again and again.

    Raises:
        ScenarioError: for a file that is missing or malformed, or an end that is outside the map or the
            workspace, inside an obstacle, or closer to one than the margin.
        SettingError: for a workspace or kind of coordinates that is invalid, or that the map cannot have.
        NoPathError: if obstacles separate start and goal, also after they have grown.
    """
    require_coordinates(coordinates)
    area = None if workspace is None else read_workspace(workspace)
    read = read_any_map(where, start, goal, margin, area, coordinates, grading or Grading())
    given, projection = read.scenario, read.projection
    ends = given.start, given.target
    if projection is not None:
        assert start is not None  # as files need it
        assert goal is not None
        ends = start, goal
    if isinstance(given, GridScenario):
        require_room(given, margin)
        bare = replace(given, ground=None)  # whose costs nothing that works on it weighs
        return Task(given, margin, Frame(), bare, *ends, projection, is_stopped)
    frame = Frame.of(given)
    try:
        moved = frame.moved(given)
        task = Task(given, margin, frame, moved, *ends, projection, is_stopped, read.reference)
        _ = task.grown  # making it checks the ends
    except ScenarioError as error:
        raise ScenarioError(_refusal(given, margin) or str(error)) from error
    return task


def _refusal(given: Scenario, margin: float) -> str | None:
    """Return which end is too close to an obstacle, in the user's units; None if none is."""
    where = f"map {shown(given.name)}"
    for name, end in (("start", given.start), ("goal", given.target)):
        if any(solid.depth(end) > 0.0 for solid in given.solids):
            return f"{where}: {name} {end} lies inside an obstacle"
        apart = clearance_of(given, np.array([end, end]))
        if apart < margin:
            return (
                f"{where}: {name} {end} is {apart:.6g} from an obstacle; obstacles have grown by {margin:g}, "
                "for the robot's radius and the clearance"
            )
    return None
