"""Small terrains for tests."""

import numpy as np

from swarm_gym.scenarios import TerrainScenario


def rolling_terrain(seed=0, side=30, cell=30.0, threats=6, **parts):
    """Return rolling hills of a drawn shape with cylinders that block every altitude."""
    rng = np.random.default_rng(seed)
    along = np.linspace(0.0, 1.0, side)
    heights = np.zeros((side, side))
    for columns, rows in ((1, 2), (2, 1), (3, 2), (1, -3), (4, 1)):
        waves = columns * along + rows * along[:, None] + rng.random()
        heights += 60.0 * rng.normal() * np.sin(2.0 * np.pi * waves)
    places = 200.0 + 500.0 * rng.random((threats, 2))
    cylinders = np.column_stack([places, np.full(threats, np.inf), 50.0 + 40.0 * rng.random(threats)])
    given = {"start": (30.0, 40.0, 150.0), "goal": (850.0, 820.0, 150.0), "cell": cell, "threats": cylinders}
    return TerrainScenario(f"rolling-{seed}", heights, **{**given, **parts})


def published_terrain():
    """Return the ridges on which MetaBox's code made the costs in `tests/data/metabox-flights.npz`.

    Heights are multiples of 1/2, so that they are the same everywhere.
    """
    column, row = np.meshgrid(np.arange(140.0), np.arange(130.0))
    heights = 3.0 * abs((3.0 * column + row) % 100.0 - 50.0)
    heights += 2.5 * abs((2.0 * column + 5.0 * row) % 140.0 - 70.0)
    cylinders = [[50, 60, np.inf, 12], [80, 50, np.inf, 9], [70, 95, np.inf, 10], [110, 90, np.inf, 8]]
    ends = {"start": (9.0, 14.0, 150.0), "goal": (128.0, 117.0, 150.0)}
    return TerrainScenario("ridges", heights, origin=(1.0, 1.0), threats=cylinders, **ends)


def drawn_flights(problem, seed, count):
    """Return spherical flights (count, D): near the middle of the bounds, of the longest steps, and any.

    Those of long steps reach corners of the map, where waypoints fall together.

    The legacy generator never changes, so a seed stands for the flights.
    """
    low, high = problem.bounds
    flights = low + (high - low) * np.random.RandomState(seed).rand(count, len(low))
    middle = 0.5 * (low + high)
    flights[::3] = middle + 0.3 * (flights[::3] - middle)
    flights[1::3] = middle + 0.5 * (flights[1::3] - middle)
    flights[1::3, ::3] = high[::3]
    return flights
