"""Routes in the form of the IAFSA paper's, for robots of a radius: the scenarios `routes:<map>-<from>-<to>`.

Source: Zhang, Guan, Pu, "The robot path planning based on improved artificial fish swarm algorithm", Math.
Probl. Eng. 2016, tables 4 and 5. The paper drives between points A to E of two maps that it shows as
figures only. These stand in for them: two public maps with robots that are driven on them, and points of ours
with the paper's pairs, for ways of about its lengths. Coordinates are metres (x, y), of centres of cells, see
`ros_map`.
"""

import math
import re
from typing import NamedTuple

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.family import Family
from swarm_gym.scenarios.formats.data_files import find_data_file
from swarm_gym.scenarios.formats.ros_map import read_ros_map
from swarm_gym.scenarios.grid_map import GridMap
from swarm_gym.scenarios.grid_scenario import GridScenario
from swarm_gym.scenarios.scenario import Point

NAME = "routes"


class Site(NamedTuple):
    """A map, a robot on it, and its routes.

    Attributes:
        map: name of the YAML file.
        digest: `GridMap.digest` of that map, not inflated.
        robot: which one has the radius.
        radius: of a circle around the robot, in metres.
        points: by letter.
        pairs: letters of start and target.
    """

    map: str
    digest: str
    robot: str
    radius: float
    points: dict[str, Point]
    pairs: tuple[str, ...]


SITES = {
    "turtlebot3": Site(
        "turtlebot3_world",
        "cb2e5ea0bccd280407123248cfe24d146cec31ca4924d5fe9f7044e67541cf7d",
        "TurtleBot3 Burger",
        0.105,
        {
            "A": (-2.425, 0.075),
            "B": (2.275, -0.575),
            "C": (-1.075, 1.675),
            "D": (0.575, -0.775),
            "E": (-1.675, -1.025),
        },
        ("A-B", "B-C", "C-D", "D-E"),
    ),
    "playground": Site(
        "playground",
        "fb9fb5285f557c5ac142dfbb1deca8ecdecdd78b180f446f7e367822464ebedf",
        "TurtleBot 2",
        0.18,
        {
            "A": (-4.625, -1.625),
            "B": (-5.025, 2.975),
            "C": (4.275, 0.575),
            "D": (2.475, -4.625),
            "E": (1.475, -1.875),
        },
        ("A-B", "A-C", "E-D", "D-B"),
    ),
}
USAGE = f"{NAME}:<{'|'.join(SITES)}>[-<from>-<to>]"


def inflation(radius: float, resolution: float) -> float:
    """The radius to inflate a map by, so that a path in free cells keeps the robot clear of blocked ones.

    `GridMap.inflated` looks at the centres of cells, from which a path may be half a diagonal away. Rounded
    up to whole centimetres, which leaves some millimetres for what samples of a curve do not see.
    """
    return math.ceil(100.0 * (radius + resolution * math.sqrt(0.5))) / 100.0


def read_site_map(name: str) -> GridMap:
    """The map of a site as it is, without the robot.

    Raises:
        ScenarioError: if the map is missing, malformed or another one.
        MissingExtraError: if PyYAML or Pillow is missing.
    """
    return _read(name, 0.0)


def expand(name: str) -> tuple[str, ...]:
    """The names of single routes that a name stands for: `routes:turtlebot3` for all routes on its map.

    Raises:
        ScenarioError: if the name has another form.
    """
    match = re.fullmatch(rf"{NAME}:(\w+?)(?:-(\w-\w))?", name)
    site = SITES.get(match[1]) if match else None
    if match and site and (match[2] is None or match[2] in site.pairs):
        pairs = site.pairs if match[2] is None else (match[2],)
        return tuple(f"{NAME}:{match[1]}-{pair}" for pair in pairs)
    known = "; ".join(f"{key}: {', '.join(site.pairs)}" for key, site in SITES.items())
    raise ScenarioError(f"scenario {shown(name)}: expected {USAGE}, with one of the routes {known}")


def make(name: str) -> GridScenario:
    """The single route of that name, on the map inflated for the robot and cut to what it can reach.

    Control points of curves may lie anywhere on a map, and moves of optimizers are shares of its sides: what
    is unknown around an arena would make them coarser.

    Raises:
        ScenarioError: if the map is missing, malformed or another one.
        MissingExtraError: if PyYAML or Pillow is missing.
    """
    key, start, target = name.removeprefix(f"{NAME}:").split("-")
    site = SITES[key]
    grid = _read(key, inflation(site.radius, read_site_map(key).resolution))
    whole = GridScenario(name, grid, site.points[start], site.points[target])
    return GridScenario(name, grid.cut(*whole.window), whole.start, whole.target)


FAMILY = Family(USAGE, (), expand, make)


def _read(name: str, radius: float) -> GridMap:
    site = SITES[name]
    path = find_data_file(f"{site.map}.yaml")
    if read_ros_map(path).digest != site.digest:
        raise ScenarioError(f"site {shown(name)}: {path} is not the public map that these routes are on")
    return read_ros_map(path, radius)
