"""Assertions about plans, by shapely."""

import numpy as np
import pytest
import shapely

from helpers.shapes import shape
from swarm_gym.scenarios import GridScenario


def obstacles_of(scenario):
    """Return everything that is blocked as one shape."""
    if not isinstance(scenario, GridScenario):
        return shapely.union_all([shape(obstacle, 512) for obstacle in scenario.obstacles])
    grid, rows, columns = scenario.map, *np.nonzero(scenario.map.blocked)
    corners = [grid.to_map(np.stack([columns + a, rows + b], axis=-1)) for a, b in ((-0.5, -0.5), (0.5, 0.5))]
    low, high = np.minimum(*corners), np.maximum(*corners)
    return shapely.union_all(shapely.box(*low.T, *high.T))


def assert_free(found, radius=0.0):
    """The path joins start and goal, is as long and as far from obstacles as it says, and enters none."""
    scenario, line = found.map, shapely.LineString(found.path)
    np.testing.assert_array_equal(found.path[[0, -1]], [scenario.start, scenario.target])
    assert found.length == pytest.approx(line.length)
    blocked = obstacles_of(scenario)
    assert line.intersection(blocked.buffer(-1e-5)).length == 0.0
    assert line.distance(blocked) >= radius - 1e-4
    assert found.clearance == pytest.approx(line.distance(blocked), abs=1e-3)
    assert found.gap >= -1e-6
