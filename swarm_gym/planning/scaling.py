"""Maps of circles and polygons in the size of the SPSFA paper's cases, for which optimizers are tuned."""

from dataclasses import dataclass

from swarm_gym.scenarios import Circle, Obstacle, Point, Polygon, Scenario

DISTANCE = 960.0  # from start to target in the paper's cases, in map units


@dataclass(frozen=True)
class Scaled:
    """A scaled scenario.

    Attributes:
        scenario: the scenario, scaled around the origin.
        factor: lengths of the scaled scenario over those of the original.
    """

    scenario: Scenario
    factor: float


def scaled_to_cases(scenario: Scenario) -> Scaled:
    """Return the scenario, scaled so that start and target are as far apart as in the paper's cases."""
    factor = DISTANCE / scenario.straight_line
    x_min, y_min, x_max, y_max = (factor * x for x in scenario.workspace)
    low_high = scenario.initial_range
    return Scaled(
        Scenario(
            scenario.name,
            _times(factor, scenario.start),
            _times(factor, scenario.target),
            tuple(_scaled(obstacle, factor) for obstacle in scenario.obstacles),
            (x_min, y_min, x_max, y_max),
            None if low_high is None else _times(factor, low_high),
        ),
        factor,
    )


def _times(factor: float, pair: Point) -> Point:
    return factor * pair[0], factor * pair[1]


def _scaled(obstacle: Obstacle, factor: float) -> Obstacle:
    if isinstance(obstacle, Circle):
        return Circle(factor * obstacle.x, factor * obstacle.y, factor * obstacle.radius)
    return Polygon(tuple(_times(factor, vertex) for vertex in obstacle.vertices))
