"""Routes like the ones of the IAFSA paper, for robots with a radius: scenarios `routes:<map>-<from>-<to>`.

Source: Y. Zhang, G. Guan, X. Pu, "The robot path planning based on improved artificial fish swarm algorithm",
Mathematical Problems in Engineering, 2016, tables 4 and 5. In the paper a robot drives between points A to E
of two maps, which are shown in figures only. Two public maps replace them, with robots that are in use on
these maps. The points are chosen here: they form the paper's pairs, and paths between them have about the
paper's lengths. Coordinates are metres (x, y) and lie at the centres of cells, see
`swarm_gym.scenarios.formats.ros_map`.
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
from swarm_gym.scenarios.obstacles import Point

NAME = "routes"


class Site(NamedTuple):
    """A map, a robot on it, and its routes.

    Attributes:
        map: name of the YAML file, without suffix.
        digest: `GridMap.digest` of that map before it is inflated.
        robot: name of the robot.
        radius: radius of a circle around the robot, in metres.
        points: coordinates (x, y) in metres, by letter.
        pairs: letters of start and target of each route, such as "A-B".
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
    """Return the radius by which to inflate a map so that paths through free cells keep a robot clear.

    `GridMap.inflated` looks at the centres of cells, and a path can be half a diagonal away from a centre.
    The sum is rounded up to whole centimetres; this leaves some millimetres for obstacles between two samples
    of a curve.

    Args:
        radius: radius of the robot, in metres.
        resolution: side of a cell, in metres.
    """
    return math.ceil(100.0 * (radius + resolution * math.sqrt(0.5))) / 100.0


def read_site_map(name: str) -> GridMap:
    """Return the map of a site as it is in its file, not inflated.

    Raises:
        ScenarioError: if the map is missing or malformed, or is another map.
        MissingExtraError: if PyYAML or Pillow is missing.
    """
    return _read(name, 0.0)


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single routes that a name stands for; `routes:turtlebot3` is all on its map.

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
    """Return the single route of that name, on the map inflated for the robot and cut to what it can reach.

    The map is cut because control points of curves may lie anywhere on a map, and moves of optimizers are
    fractions of its sides. Unknown cells around an arena would make these moves coarser.

    Raises:
        ScenarioError: if the map is missing or malformed, or is another map.
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
        raise ScenarioError(
            f"site {shown(name)}: {path} is not the public map of these routes; replace it, "
            f"`python -m swarm_gym.scenarios.download --force {site.map}` does so"
        )
    return read_ros_map(path, radius)
