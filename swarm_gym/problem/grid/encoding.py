"""Encodings of paths on a grid map: control points, and samples of the curve that they define.

Every coordinate of a control point depends on at most one component of the decision vector. Every sample is a
weighted mean of neighbouring control points. So both encodings are a few arrays, and kernels treat them
alike.

Sources: Bezier curves, MOA paper, eq. 4 (Li et al., "A path planner based on multivariate optimization
algorithm", Acta Electronica Sinica 44(9), 2016); waypoints, SPSFA paper, eq. 1. What the papers leave open is
in docs/readings.md.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from swarm_gym.problem.geometry.curves import bernstein
from swarm_gym.problem.geometry.rotated_axes import RotatedAxes, offset_bounds, spacing_of
from swarm_gym.scenarios import GridScenario

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Samples of a Bezier curve, from t = 0 to t = 1.
BEZIER_SAMPLES = 1000
# Least number of samples of a path of waypoints; each segment is sampled from its left end on.
WAYPOINT_SAMPLES = 1000


@dataclass(frozen=True)
class Encoding:
    """An encoding with P control points and M samples, in map coordinates, of decision vectors of length D.

    Attributes:
        base: (P, 2) control points of the zero vector; the first is the start, the last the target.
        gain: (P, 2) change of a coordinate per unit of its component; 0 where it is fixed.
        source: (P, 2) number of that component in the decision vector.
        lower: (D,) bounds of decision vectors.
        upper: (D,) bounds of decision vectors.
        width: largest extent of the map across the start-target line, at a free control point.
        middle: (D,) decision vector of the straight line with evenly spaced control points.
        across: (D,) change of the components when their control points move across the line by one unit.
        owner: (D,) number of the free control point that a component belongs to, from 0.
        first: (M,) number of the first control point that a sample depends on.
        weights: (M, width) weights of that control point and those after it.
    """

    base: Floats
    gain: Floats
    source: Integers
    lower: Floats
    upper: Floats
    width: float
    middle: Floats
    across: Floats
    owner: Integers
    first: Integers
    weights: Floats

    def control_points(self, vectors: ArrayLike) -> Floats:
        """Return the control points (..., P, 2) of decision vectors (..., D)."""
        return self.base + self.gain * np.asarray(vectors, dtype=np.float64)[..., self.source]

    def points(self, vectors: ArrayLike) -> Floats:
        """Return the paths of decision vectors (..., D) as polylines through control points, (..., P, 2)."""
        return self.control_points(vectors)

    def samples(self, vectors: ArrayLike) -> Floats:
        """Return all samples, (..., M, 2), of decision vectors (..., D)."""
        window = self.first[:, None] + np.arange(self.weights.shape[1])
        return (self.weights[..., None] * self.control_points(vectors)[..., window, :]).sum(axis=-2)


class BezierCurve(Encoding):
    """An encoding in which every sample depends on all control points."""

    def points(self, vectors: ArrayLike) -> Floats:
        """Return the paths of decision vectors (..., D) as polylines through the samples, (..., M, 2)."""
        coordinates = self.control_points(vectors).swapaxes(-1, -2)
        # This is not a product of matrices, whose last bits depend on their number and on the library.
        return (coordinates[..., None] * self.weights.T).sum(axis=-2).swapaxes(-1, -2)


def bezier(scenario: GridScenario, num_control_points: int) -> Encoding:
    """Return the encoding of Bezier curves: a decision vector is x of all free control points, then their y.

    The control points may be anywhere among the centres of the map's cells.
    """
    free = num_control_points
    base, gain = _fixed_ends(scenario, free)
    source = np.zeros((free + 2, 2), dtype=np.int64)
    gain[1:-1] = 1.0
    source[1:-1] = np.stack([np.arange(free), free + np.arange(free)], axis=1)
    x_min, y_min, x_max, y_max = _centres(scenario)
    axes = RotatedAxes.of(scenario)
    x = spacing_of(scenario, free) * np.arange(1.0, free + 1)
    least, largest = offset_bounds(axes, x, _centres(scenario))
    return BezierCurve(
        base,
        gain,
        source,
        np.repeat([x_min, y_min], free),
        np.repeat([x_max, y_max], free),
        float((largest - least).max()),
        axes.to_map(x, np.zeros(free)).T.ravel(),
        np.repeat(axes.across, free),
        np.tile(np.arange(free), 2),
        np.zeros(BEZIER_SAMPLES, dtype=np.int64),
        np.asfortranarray(bernstein(free + 1, BEZIER_SAMPLES)),  # as `BezierCurve.points` goes through them
    )


def waypoints(scenario: GridScenario, num_waypoints: int) -> Encoding:
    """Return the encoding of evenly spaced waypoints by their offsets to the left of the start-target line.

    Waypoints keep to the centres of the outermost cells, as control points do: on the edge of the map,
    rounding would decide whether a sample is on it.
    """
    axes = RotatedAxes.of(scenario)
    x = spacing_of(scenario, num_waypoints) * np.arange(num_waypoints + 2.0)
    base, gain = _fixed_ends(scenario, num_waypoints)
    base[1:-1] = axes.to_map(x, np.zeros_like(x))[1:-1]
    gain[1:-1] = axes.across
    source = np.zeros((num_waypoints + 2, 2), dtype=np.int64)
    source[1:-1] = np.arange(num_waypoints)[:, None]
    lower, upper = offset_bounds(axes, x[1:-1], _centres(scenario))
    # Each segment has whole blocks of eight samples; the target is the last sample.
    per_segment = 8 * math.ceil(WAYPOINT_SAMPLES / (8 * (num_waypoints + 1)))
    share = np.tile(np.arange(per_segment) / per_segment, num_waypoints + 1)
    return Encoding(
        base,
        gain,
        source,
        lower,
        upper,
        float((upper - lower).max()),
        np.zeros(num_waypoints),
        np.ones(num_waypoints),
        np.arange(num_waypoints),
        np.append(np.repeat(np.arange(num_waypoints + 1), per_segment), num_waypoints),
        np.append(np.stack([1.0 - share, share], axis=1), [[0.0, 1.0]], axis=0),
    )


def _centres(scenario: GridScenario) -> tuple[float, float, float, float]:
    """Return (x_min, y_min, x_max, y_max) of the centres of the map's cells."""
    corners = scenario.map.to_map([(0, 0), (scenario.map.width - 1, scenario.map.height - 1)])
    (x_min, y_min), (x_max, y_max) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return x_min, y_min, x_max, y_max


def _fixed_ends(scenario: GridScenario, free: int) -> tuple[Floats, Floats]:
    """Return base and gain for `free` control points between the start and the target."""
    base = np.zeros((free + 2, 2))
    base[0], base[-1] = scenario.start, scenario.target
    return base, np.zeros((free + 2, 2))
