"""The published generator of terrains for flights: a height map, cylinders as threats, a start and a goal.

Source: the function `createmodel` of the program MetaBox of Z. Ma et al., NeurIPS 2025, repository
MetaEvo/MetaBox, commit 5565a28. It follows M. A. Shehadeh and J. Kudela, "Benchmarking global optimization
techniques for unmanned aerial vehicle path planning", arXiv 2501.14503 (2025). Only facts are taken from
there: what is drawn, in which order, and how it is combined. The same random stream gives the same terrain,
bit for bit, if NumPy, SciPy and the processor are the same. Elsewhere heights may differ in their last
digits.

The terrain begins with one to four random points. Eight times every point gets three new points around it,
whose heights and roughnesses are interpolated and disturbed. The height map interpolates all points linearly.

The published program has these faults, which are kept or reported, but never repaired in silence:

* Only the start is kept away from threats. The goal may lie in one, see `Terrain.goal_distance`.
* The search for a start never ends where threats cover all of its area. Here it ends with an error.
* A threat that lies on the last row of the map ends the program with an error. Here, too.
* The heights of threats are drawn around the height of the ground, but no cost of that program reads them.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError

Floats = NDArray[np.float64]

SIDE = 900  # cells of a side of the map, each one metre wide
FIRST_CELL = 1.0  # coordinates x and y of the first cell
ABOVE_GROUND = 150.0  # height of start and goal above ground, in metres
BAND = (100.0, 200.0)  # least and greatest height above ground, in metres
DRONE, DANGER = 1.0, 10.0  # size of the drone, and the distance that counts as dangerous, in metres

LEVELS = 8
CHILDREN = 3  # new points of every point in a level
MEAN_HEIGHT = 130.0
CORNER = 100.0  # four points of height 0 at (+-CORNER, +-CORNER) surround the others
MOST_TRIES = 10_000  # at a start


class Terrain(NamedTuple):
    """A terrain of the generator, in metres; x is 1 in the first column, y is 1 in the first row.

    Attributes:
        heights: (SIDE, SIDE) heights of the ground, rows by y.
        threats: (k, 4) x, y, height of the top and radius of each cylinder.
        start: x, y and height above ground.
        goal: x, y and height above ground.
    """

    heights: Floats
    threats: Floats
    start: tuple[float, float, float]
    goal: tuple[float, float, float]

    @property
    def goal_distance(self) -> float:
        """Distance of the goal from the nearest threat; negative inside of one."""
        return _distance(self.threats, self.goal[0], self.goal[1])


class Level(NamedTuple):
    """Random numbers of the points of a level: angle and distance from the parent, two disturbances."""

    angle: Floats
    distance: Floats
    roughness: Floats
    height: Floats


class TerrainDraws(NamedTuple):
    """All random numbers of a terrain.

    Attributes:
        roughness: roughness of the terrain.
        variation: standard deviation of the roughness between places.
        first: (4, n) x, y, height and roughness of the first points.
        levels: numbers of the new points, level by level.
        threats: (k, 4) x, y, height of the top above ground, and radius of each cylinder.
        start: x and y.
        goal: x and y.
    """

    roughness: float
    variation: float
    first: Floats
    levels: tuple[Level, ...]
    threats: Floats
    start: tuple[float, float]
    goal: tuple[float, float]

    @property
    def is_possible(self) -> bool:
        """True if all threats lie on the map, and the drone at the goal touches none."""
        on_map = bool((self.threats[:, :2] < SIDE).all())
        return on_map and _distance(self.threats, *self.goal) > DRONE


def draw(generator: np.random.RandomState, threats: int) -> TerrainDraws:
    """Return the random numbers of the next terrain of a stream, without its height map: in milliseconds.

    Args:
        generator: stream, which is advanced by as many numbers as the published program draws.
        threats: number of threats.

    Raises:
        ScenarioError: if threats leave no room for a start.
    """
    roughness = generator.rand() * 600 - 200
    variation = generator.rand() * 800 + 100
    count = generator.randint(low=1, high=5)
    x, y = generator.randn(count), generator.randn(count)
    height = roughness * generator.randn(count) + MEAN_HEIGHT
    rough = variation * generator.randn(count) + roughness
    levels = []
    for level in range(1, LEVELS + 1):
        new = CHILDREN * count
        angle = 2 * np.pi * generator.rand(new)
        distance = 0.75**level * (generator.rand(new) + 1)
        levels.append(Level(angle, distance, generator.randn(new), generator.randn(new)))
        count += new
    cylinders = generator.rand(threats, 4)
    cylinders[:, 3] = np.round(SIDE / 15 + cylinders[:, 3] * SIDE / 30)
    edge = np.minimum(cylinders[:, 3], 0.1 * SIDE)
    cylinders[:, 0] = np.round(edge + cylinders[:, 0] * 0.7 * SIDE)
    cylinders[:, 1] = np.round(edge + cylinders[:, 1] * 0.9 * SIDE)
    cylinders[:, 2] *= 40
    for _ in range(MOST_TRIES):
        # Nearer and farther end, alternately, as the published program draws them.
        x_near, x_far = _end(generator.rand(), far=False), _end(generator.rand(), far=True)
        y_near, y_far = _end(generator.rand(), far=False), _end(generator.rand(), far=True)
        if _distance(cylinders, x_near, y_near) > DRONE + DANGER:
            first = np.stack([x, y, height, rough])
            return TerrainDraws(
                roughness, variation, first, tuple(levels), cylinders, (x_near, y_near), (x_far, y_far)
            )
    raise ScenarioError(f"terrain with {threats} threats: they leave no room for a start; expected fewer")


def make_terrain(draws: TerrainDraws) -> Terrain:
    """Return the terrain of random numbers; its height map takes seconds.

    Raises:
        ScenarioError: if a threat lies on the last row of the map, where the published program ends, too.
    """
    return terrain_with(draws, heights_of(draws))


def terrain_with(draws: TerrainDraws, heights: Floats) -> Terrain:
    """Return the terrain of random numbers whose height map is known.

    Raises:
        ScenarioError: if a threat lies on the last row of the map, where the published program ends, too.
    """
    threats = draws.threats.copy()
    columns, rows = threats[:, 0].astype(np.int64), threats[:, 1].astype(np.int64)
    for number in np.flatnonzero(rows >= SIDE).tolist():
        raise ScenarioError(
            f"terrain: threat {number} lies at y = {rows[number]}, expected below {SIDE}; draw "
            "another terrain"
        )
    threats[:, 2] = np.round(heights[rows, columns] - 10 + threats[:, 2])
    heights.flags.writeable = threats.flags.writeable = False
    return Terrain(heights, threats, (*draws.start, ABOVE_GROUND), (*draws.goal, ABOVE_GROUND))


def heights_of(draws: TerrainDraws) -> Floats:
    """Return the height map: all points of all levels, interpolated at the cells.

    For each triangle SciPy solves two equations with LAPACK, whose threads wait for each other. On a
    processor that has other work, one terrain took minutes with all threads, and seconds with one.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        return _grown(draws)


def _grown(draws: TerrainDraws) -> Floats:
    x, y, height, rough = draws.first
    for number, level in enumerate(draws.levels, 1):
        spread, step = 0.5**number, 0.75**number
        parents = np.repeat(np.arange(len(x)), CHILDREN)
        new_x = x[parents] + level.distance * np.cos(level.angle)
        new_y = y[parents] + level.distance * np.sin(level.angle)
        # One triangulation for both: each column is interpolated as it would be alone.
        nominal = _interpolated(x, y, np.stack([rough, height], axis=-1), new_x, new_y)
        new_rough = nominal[:, 0] + (spread * draws.variation) * level.roughness
        new_height = nominal[:, 1] + (spread / step) * level.distance * new_rough * level.height
        x, y = np.concatenate([x, new_x]), np.concatenate([y, new_y])
        height, rough = np.concatenate([height, new_height]), np.concatenate([rough, new_rough])
    x = (x - np.median(x)) / np.std(x)
    y = (y - np.median(y)) / np.std(y)
    columns, rows = np.meshgrid(np.linspace(-1, 1, SIDE), np.linspace(-1, 1, SIDE))
    return _interpolated(x, y, height[:, None], columns.ravel(), rows.ravel()).reshape(SIDE, SIDE)


def _interpolated(x: Floats, y: Floats, values: Floats, at_x: Floats, at_y: Floats) -> Floats:
    """Return values (n, k) of points, interpolated linearly at (m,) places, as (m, k)."""
    from scipy.interpolate import LinearNDInterpolator

    corners = CORNER * np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]])
    points = np.concatenate([corners, np.stack([x, y], axis=-1)])
    known = np.concatenate([np.zeros((4, values.shape[1])), values])
    interpolated: Floats = LinearNDInterpolator(points, known)(at_x, at_y)
    return interpolated


def _end(share: float, far: bool) -> float:
    """Return a coordinate of the start or the far goal."""
    return float(np.round((1 - 0.02 - share * 0.17) * SIDE if far else (0.02 + share * 0.17) * SIDE))


def _distance(threats: Floats, x: float, y: float) -> float:
    """Return the distance of a point from the nearest cylinder; negative inside of one."""
    if not len(threats):
        return math.inf
    apart = np.sqrt((threats[:, 0] - x) ** 2 + (threats[:, 1] - y) ** 2)
    return float((apart - threats[:, 3]).min())
