"""Maps of replays as JSON values: shapes of analytic maps, pictures of grid maps."""

import base64
import math
from io import BytesIO
from typing import Any

import numpy as np
from matplotlib import image

from swarm_gym.errors import ScenarioError
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import (
    Circle,
    FunctionScenario,
    GridScenario,
    Obstacle,
    Scenario,
    StaticScenario,
    TerrainScenario,
)

Extent = tuple[float, float, float, float]

MOST_CELLS = 512  # greatest width and height of the picture of a grid map, in pixels
DECIMALS = 3


def extent_of(scenario: StaticScenario) -> Extent:
    """Return (x_min, y_min, x_max, y_max) of what is shown; of test functions, their first two components."""
    if isinstance(scenario, FunctionScenario):
        low, high = scenario.domain
        return low, low, high, high
    return scenario.view


def describe_map(scenario: StaticScenario) -> dict[str, Any]:
    """Return what is shown below a population: map, start, target, and the shortest path if it is known."""
    found: dict[str, Any] = {"extent": list(extent_of(scenario)), "yUp": True}
    if isinstance(scenario, FunctionScenario):
        optimum = [*scenario.optimum[:2], 0.0][:2]
        return {**found, "target": _rounded(optimum)}
    found |= {
        "start": list(scenario.start[:2]),
        "target": list(scenario.target),
        "yUp": scenario.y_up,
    }
    if isinstance(scenario, Scenario):
        found |= _shapes(scenario.obstacles)
    elif isinstance(scenario, TerrainScenario):
        found |= _shapes(tuple(Circle(x, y, radius) for x, y, _, radius in scenario.threats.tolist()))
    else:
        found["picture"] = _picture(scenario)
    try:
        length, points = shortest_path(scenario)
    except ScenarioError:  # obstacles separate start and target, or there is no planner
        return found
    return {**found, "shortest": [_rounded(point) for point in points], "shortestLength": round(length, 2)}


def _shapes(obstacles: tuple[Obstacle, ...]) -> dict[str, Any]:
    """Return circles and polygons as lists of numbers."""
    circles = [o for o in obstacles if isinstance(o, Circle)]
    polygons = [o for o in obstacles if not isinstance(o, Circle)]
    return {
        "circles": [_rounded((circle.x, circle.y, circle.radius)) for circle in circles],
        "polygons": [[_rounded(vertex) for vertex in polygon.vertices] for polygon in polygons],
    }


def _picture(scenario: GridScenario) -> str:
    """Return the blocked cells of the window as the URI of a PNG, in which free cells are transparent."""
    blocked = scenario.map.blocked[scenario.window]
    stride = max(1, math.ceil(max(blocked.shape) / MOST_CELLS))
    cells = np.zeros((*blocked[::stride, ::stride].shape, 4), dtype=np.uint8)
    for row in range(stride):  # a pixel is blocked if any of its cells is
        for column in range(stride):
            part = blocked[row::stride, column::stride]
            cells[: part.shape[0], : part.shape[1], 3] |= np.where(part, 255, 0).astype(np.uint8)
    cells[..., :3] = 140
    file = BytesIO()
    image.imsave(file, cells, format="png")
    return f"data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}"


def _rounded(point: Any) -> list[float]:
    return [round(float(value), DECIMALS) for value in point]
