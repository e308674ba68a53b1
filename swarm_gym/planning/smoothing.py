"""Curves of continuous curvature: the curvature of arcs and straight lines is smoothed, and the ends are met.

The curvature over the length driven is averaged over a window, whose length is the range of curvatures over
the greatest rate. So the average changes no faster than the rate, and is within the same bounds. It changes
evenly between breaks, so its pieces are clothoids. The ends of the smoothed curve are a little off
then. Adding an even change of curvature between a few knots, found by Newton's method, leads it to the goal.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.curve import Curve
from swarm_gym.planning.curves.field import SLACK, room_at
from swarm_gym.planning.drive_map import DriveMap

Floats = NDArray[np.float64]

FOR_WINDOW = 0.9  # share of the greatest rate that the average has; the rest is for meeting the goal
KNOTS = 9  # between which curvature is added
MOST_STEPS = 12  # of Newton's method
TINY = 1e-6  # of curvature times radius, for differences
MET = 1e-10  # how far a curve may end from the goal, in turning radii and radians
LEAST = 1e-9  # length of a piece that counts, in turning radii
STEP, FINER = 0.04, 16  # of the test of obstacles, in steps of the lattice, and its parts close to obstacles
ROUNDING = 1e-9  # share by which limits may be exceeded


def smoothed(
    curve: Curve, goal: Floats, turning_radius: float, rate: float, starts_free: bool, ends_free: bool
) -> Curve | None:
    """Return a curve of continuous curvature near another one, with the same ends; None without one.

    Args:
        curve: a curve of arcs and straight lines.
        goal: x, y and heading in radians of its end, (3,).
        turning_radius: least radius, in map units.
        rate: greatest change of curvature over length, in 1 / map unit squared.
        starts_free: whether the heading at the start may change.
        ends_free: whether the heading at the goal may change.
    """
    curvatures, lengths = curve.pieces.T
    cuts = np.append(0.0, np.cumsum(np.abs(lengths)))
    window = float(np.ptp(curvatures)) / (FOR_WINDOW * rate)
    knots = np.linspace(0.0, cuts[-1], KNOTS)
    breaks = np.concatenate([cuts, cuts - 0.5 * window, cuts + 0.5 * window, knots])
    breaks = np.unique(np.clip(breaks, 0.0, cuts[-1]))
    breaks = breaks[np.append(True, np.diff(breaks) > LEAST * turning_radius)]
    breaks[-1] = cuts[-1]
    means = _means(curvatures, cuts, breaks, window)
    middles = 0.5 * (breaks[1:] + breaks[:-1])
    signs = np.sign(lengths)[np.searchsorted(cuts, middles) - 1]
    steps = signs * np.diff(breaks)

    def changed(added: Floats) -> Curve:
        """Return the curve with curvatures times radius added at the knots, and a turn at the start."""
        values = means + np.interp(breaks, knots, added[:-1]) / turning_radius
        start = curve.start + np.array([0.0, 0.0, np.degrees(added[-1])])
        pieces = np.column_stack([values[:-1], steps])
        return Curve(start, pieces, turning_radius, np.diff(values) / steps)

    def missed(added: Floats) -> Floats:
        """Return how far the curve ends from the goal."""
        off = changed(added).end - goal
        off[2] = np.arctan2(np.sin(off[2]), np.cos(off[2]))
        return np.append(off[:2] / turning_radius, off[2:])[: 2 if ends_free else 3]

    added = np.zeros(KNOTS + 1)
    number = KNOTS + 1 if starts_free else KNOTS
    for _ in range(MOST_STEPS):
        off = missed(added)
        if np.abs(off).max() <= MET:
            break
        slopes = np.stack([(missed(added + TINY * one) - off) / TINY for one in np.eye(KNOTS + 1)[:number]])
        added[:number] -= np.linalg.lstsq(slopes.T, off, rcond=None)[0]
        if np.abs(added).max() > 1.0:
            return None
    else:
        return None
    found = changed(added)
    assert found.rates is not None
    is_wide = found.least_radius >= turning_radius * (1.0 - ROUNDING)
    return found if is_wide and np.abs(found.rates).max() <= rate * (1.0 + ROUNDING) else None


def _means(curvatures: Floats, cuts: Floats, places: Floats, window: float) -> Floats:
    """Return the means of curvatures over a window around places; beyond the ends, the curvature goes on."""
    if window <= 0.0:
        return np.full(len(places), curvatures[0])
    whole, sums = cuts[-1], np.append(0.0, np.cumsum(curvatures * np.diff(cuts)))

    def until(along: Floats) -> Floats:
        inner = np.interp(along, cuts, sums)
        return (
            inner + curvatures[0] * np.minimum(along, 0.0) + curvatures[-1] * np.maximum(along - whole, 0.0)
        )

    means: Floats = (until(places + 0.5 * window) - until(places - 0.5 * window)) / window
    return means


def is_free(drive_map: DriveMap, curve: Curve) -> bool:
    """Return whether a curve keeps the margin and the slack, by the test of pieces in `curves.field`."""
    number = max(math.ceil(curve.length / (STEP * drive_map.unit)), 1)
    along = np.linspace(0.0, curve.length, number + 1)

    def rooms(places: Floats) -> list[float]:
        points = drive_map.to_nodes(curve.at(places)[:, :2])
        return [room_at(drive_map.field, x, y) for x, y in points.tolist()]

    k, points = 0, drive_map.to_nodes(curve.at(along)[:, :2])
    while True:
        x, y = points[k].tolist()
        room = room_at(drive_map.field, x, y)
        if room < 0.0:
            return False
        if k == number:
            return True
        steps = int((room + SLACK) / STEP)
        # Close to obstacles, each point keeps the margin for the slack around it.
        if steps == 0 and min(rooms(np.linspace(along[k], along[k + 1], FINER + 1))) < 0.0:
            return False
        k = min(k + max(steps, 1), number)
