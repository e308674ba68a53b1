"""Where a path is planned: maps with start and target, made by name.

To add a map: write a function that returns a `Scenario` and enter it in `SCENARIOS`.
"""

from collections.abc import Callable

from swarm_gym.checks import look_up
from swarm_gym.scenarios import paper_cases
from swarm_gym.scenarios.scenario import Circle, Obstacle, Point, Polygon, Scenario

__all__ = ["SCENARIOS", "Circle", "Obstacle", "Point", "Polygon", "Scenario", "make_scenario"]

SCENARIOS: dict[str, Callable[[], Scenario]] = {
    "case1": paper_cases.case1,
    "case2": paper_cases.case2,
    "case3": paper_cases.case3,
}


def make_scenario(scenario: str | Scenario) -> Scenario:
    """The scenario of that name; a `Scenario` is returned as it is.

    Raises:
        UnknownNameError: if there is none of that name.
    """
    if isinstance(scenario, Scenario):
        return scenario
    return look_up("scenario", scenario, SCENARIOS)()
