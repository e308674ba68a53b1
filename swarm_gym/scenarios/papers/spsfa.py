"""The three cases of the SPSFA paper (section IV): the scenarios `case1`, `case2` and `case3`.

Source: J. Li, H. Fan, Y. Hou, "A firefly algorithm with self-adaptive population size for global path
planning of mobile robot", IEEE Access 8 (2020), doi 10.1109/ACCESS.2020.3023999.

The paper does not print the range of the first waypoints. With y in [120, 480] its results are reproduced;
see docs/readings.md.
"""

from swarm_gym.scenarios.obstacles import Circle, Obstacle, Polygon
from swarm_gym.scenarios.scenario import Scenario

START = (20.0, 300.0)
TARGET = (980.0, 300.0)
WORKSPACE = (0.0, 0.0, 1000.0, 600.0)
INITIAL_RANGE = (120.0 - START[1], 480.0 - START[1])

# (x, y, radius)
CASE1_CIRCLES = [
    (100, 250, 40), (200, 320, 50), (200, 450, 60), (220, 200, 40), (360, 400, 60),
    (440, 180, 40), (340, 260, 50), (500, 320, 80), (580, 200, 40), (640, 400, 60),
    (680, 280, 50), (780, 200, 50), (780, 360, 50), (860, 280, 40),
]  # fmt: skip

# (x_min, y_min, x_max, y_max)
CASE2_RECTANGLES = [
    (100, 260, 130, 380), (190, 220, 220, 300), (180, 320, 200, 400), (270, 150, 300, 260),
    (270, 280, 300, 320), (270, 340, 300, 460), (380, 220, 420, 380), (490, 120, 520, 260),
    (500, 290, 520, 420), (590, 340, 620, 480), (600, 170, 640, 300), (710, 230, 740, 420),
    (820, 180, 840, 290), (800, 340, 840, 460), (900, 280, 930, 380),
]  # fmt: skip

CASE3_CIRCLES = [(100, 280, 40), (360, 400, 60), (530, 240, 50), (620, 450, 50), (820, 320, 40)]
CASE3_RECTANGLES = [
    (200, 150, 230, 270), (170, 300, 200, 420), (320, 200, 360, 320), (500, 340, 520, 480),
    (450, 280, 470, 370), (600, 270, 640, 380), (710, 230, 740, 420), (780, 140, 820, 250),
    (800, 380, 840, 460), (900, 300, 930, 400),
]  # fmt: skip


def case1() -> Scenario:
    """Return case 1: fourteen circles."""
    return _case("case1", CASE1_CIRCLES, [])


def case2() -> Scenario:
    """Return case 2: fifteen rectangles."""
    return _case("case2", [], CASE2_RECTANGLES)


def case3() -> Scenario:
    """Return case 3: five circles and ten rectangles."""
    return _case("case3", CASE3_CIRCLES, CASE3_RECTANGLES)


def _case(
    name: str, circles: list[tuple[int, int, int]], rectangles: list[tuple[int, int, int, int]]
) -> Scenario:
    obstacles: tuple[Obstacle, ...] = (
        *(Circle(*c) for c in circles),
        *(Polygon.rectangle(*r) for r in rectangles),
    )
    return Scenario(name, START, TARGET, obstacles, WORKSPACE, INITIAL_RANGE)
