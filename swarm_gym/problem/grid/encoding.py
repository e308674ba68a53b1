"""How a decision vector becomes a path on a grid map: control points, and samples of the curve they define.

Every coordinate of a control point depends on at most one component of the decision vector, and every sample
is a weighted mean of neighbouring control points. So both encodings are a few arrays, and the kernels know
no difference between them.

Sources: Bezier curves, MOA paper, eq. 4 (Li et al., "A path planner based on multivariate optimization
algorithm", Acta Electronica Sinica 44(9), 2016); waypoints, SPSFA paper, eq. 1. What the papers leave open is
in docs/readings.md.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.problem.analytic.table import offset_bounds, spacing_of
from swarm_gym.problem.geometry.rotation import Frame
from swarm_gym.scenarios import GridScenario

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Samples of a Bezier curve, from t = 0 to t = 1.
BEZIER_SAMPLES = 1000
# Samples of a path of waypoints: of each segment, from its left end on, at least so many in all.
WAYPOINT_SAMPLES = 1000


@dataclass(frozen=True)
class Encoding:
    """P control points of decision vectors of length D, and M samples; in map coordinates.

    Attributes:
        base: (P, 2) control points of the zero vector; the first is the start, the last the target.
        gain: (P, 2) by how much a coordinate changes with its component; 0 where it is fixed.
        source: (P, 2) that component.
        lower: (D,) bounds of decision vectors.
        upper: (D,)
        first: (M,) first of the control points that a sample depends on.
        weights: (M, width) weights of that control point and those after it.
    """

    base: Floats
    gain: Floats
    source: Integers
    lower: Floats
    upper: Floats
    first: Integers
    weights: Floats

    def control_points(self, vectors: ArrayLike) -> Floats:
        """Control points (..., P, 2) of decision vectors (..., D)."""
        return self.base + self.gain * np.asarray(vectors, dtype=np.float64)[..., self.source]

    def points(self, vectors: ArrayLike) -> Floats:
        """The paths of decision vectors (..., D) as polylines, (..., K, 2): through the control points."""
        return self.control_points(vectors)

    def samples(self, vectors: ArrayLike) -> Floats:
        """All samples, (..., M, 2), of decision vectors (..., D)."""
        window = self.first[:, None] + np.arange(self.weights.shape[1])
        return (self.weights[..., None] * self.control_points(vectors)[..., window, :]).sum(axis=-2)


class Curve(Encoding):
    """An encoding in which every sample depends on all control points."""

    def points(self, vectors: ArrayLike) -> Floats:
        """The paths of decision vectors (..., D) as polylines, (..., M, 2): through the samples."""
        coordinates = self.control_points(vectors).swapaxes(-1, -2)
        # Not a product of matrices, whose last bits depend on how many there are and on the library.
        return (coordinates[..., None] * self.weights.T).sum(axis=-2).swapaxes(-1, -2)


def bezier(scenario: GridScenario, num_control_points: int) -> Encoding:
    """A Bezier curve with free control points: a decision vector is all their x, then all their y.

    The control points may be anywhere among the centres of the map's cells.
    """
    free = num_control_points
    base, gain = _fixed_ends(scenario, free)
    source = np.zeros((free + 2, 2), dtype=np.int64)
    gain[1:-1] = 1.0
    source[1:-1] = np.stack([np.arange(free), free + np.arange(free)], axis=1)
    x_min, y_min, x_max, y_max = _centres(scenario)
    return Curve(
        base,
        gain,
        source,
        np.repeat([x_min, y_min], free),
        np.repeat([x_max, y_max], free),
        np.zeros(BEZIER_SAMPLES, dtype=np.int64),
        np.asfortranarray(_bernstein(free + 1, BEZIER_SAMPLES)),  # as `Curve.points` goes through them
    )


def waypoints(scenario: GridScenario, num_waypoints: int) -> Encoding:
    """Evenly spaced waypoints: a decision vector is their offsets to the left of the start-target line.

    They, too, keep to the centres of the outermost cells: on the edge of the map, rounding would decide
    whether a sample is on it.
    """
    frame = Frame.of(scenario)
    x = spacing_of(scenario, num_waypoints) * np.arange(num_waypoints + 2.0)
    base, gain = _fixed_ends(scenario, num_waypoints)
    base[1:-1] = frame.to_map(x, np.zeros_like(x))[1:-1]
    gain[1:-1] = frame.across
    source = np.zeros((num_waypoints + 2, 2), dtype=np.int64)
    source[1:-1] = np.arange(num_waypoints)[:, None]
    lower, upper = offset_bounds(scenario, x[1:-1], _centres(scenario))
    # Whole blocks of lanes for each segment; the target is the last sample.
    per_segment = 8 * math.ceil(WAYPOINT_SAMPLES / (8 * (num_waypoints + 1)))
    share = np.tile(np.arange(per_segment) / per_segment, num_waypoints + 1)
    return Encoding(
        base,
        gain,
        source,
        lower,
        upper,
        np.append(np.repeat(np.arange(num_waypoints + 1), per_segment), num_waypoints),
        np.append(np.stack([1.0 - share, share], axis=1), [[0.0, 1.0]], axis=0),
    )


def _centres(scenario: GridScenario) -> tuple[float, float, float, float]:
    """(x_min, y_min, x_max, y_max) of the centres of the map's cells."""
    corners = scenario.map.to_map([(0, 0), (scenario.map.width - 1, scenario.map.height - 1)])
    (x_min, y_min), (x_max, y_max) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return x_min, y_min, x_max, y_max


def _fixed_ends(scenario: GridScenario, free: int) -> tuple[Floats, Floats]:
    """Base and gain of `free` control points between the start and the target."""
    base = np.zeros((free + 2, 2))
    base[0], base[-1] = scenario.start, scenario.target
    return base, np.zeros((free + 2, 2))


def _bernstein(degree: int, count: int) -> Floats:
    """Bernstein polynomials of that degree at `count` values of t from 0 to 1, (count, degree + 1)."""
    t = np.linspace(0.0, 1.0, count)[:, None]
    k = np.arange(degree + 1)
    choose = np.array([math.comb(degree, i) for i in k], dtype=np.float64)
    return choose * t**k * (1.0 - t) ** (degree - k)
