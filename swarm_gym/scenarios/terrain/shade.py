"""Hill shade: how bright the ground of a height map is in slanting light, for pictures."""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.scenarios.terrain.scenario import TerrainScenario

# Light from the north-west, 45 degrees above the horizon, as cartographers have it.
LIGHT = (-0.5, 0.5, math.sqrt(0.5))


def hill_shade(scenario: TerrainScenario, most: int = 512) -> NDArray[np.float64]:
    """Return brightness in [0, 1] of the ground, with y along rows and x along columns.

    Args:
        scenario: the map.
        most: largest number of rows and columns; larger maps are thinned out.
    """
    stride = math.ceil(max(scenario.heights.shape) / most)
    heights = scenario.heights[::stride, ::stride]
    along_y, along_x = np.zeros_like(heights), np.zeros_like(heights)
    if heights.shape[0] > 1:
        along_y = np.gradient(heights, scenario.cell * stride, axis=0)
    if heights.shape[1] > 1:
        along_x = np.gradient(heights, scenario.cell * stride, axis=1)
    facing = LIGHT[2] - along_x * LIGHT[0] - along_y * LIGHT[1]
    return np.clip(facing / np.sqrt(1.0 + along_x**2 + along_y**2), 0.0, 1.0)
