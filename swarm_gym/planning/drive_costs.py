"""Sums of wishes of drivable curves, and the weights that count where a caller names none.

The sum of a curve is the integral of 1 + ground c(x) + distance e(x) + curvature (r k)^2 along it, in map
units. Here k is the curvature and r the turning radius. On a map of cells c and e are as in
`swarm_gym.planning.wishes`. Among circles and polygons e = exp(-(d - margin) / decay) has the distance d of
the point itself. The decay is the margin or the turning radius, whichever is larger. Each change between
driving forwards and backwards adds one turning radius.
"""

import math
from collections.abc import Mapping

import numpy as np

from swarm_gym.planning.curve import Curve
from swarm_gym.planning.drive_map import DriveMap
from swarm_gym.planning.tasks import Task
from swarm_gym.planning.wishes import FIELDS, MOST_CELLS, WISHES, require_ground, require_wishes
from swarm_gym.scenarios import GridScenario

USUAL = {"ground": 1.0, "distance": 1.0, "curvature": 0.2}  # weights where no wishes are named
CHANGE = 1.0  # cost of a change of direction, in turning radii
FINE = 0.1  # steps of integrals, in steps of the lattice
MOST_STEPS = 50_000


def drive_weights(task: Task, wishes: Mapping[str, float] | None) -> dict[str, float]:
    """Return the weights of the wishes for curves on a task.

    Args:
        task: the task.
        wishes: weights by name; None for the usual ones, as far as the map has them.

    Raises:
        SettingError: for weights that are invalid, or that the map cannot have.
        UnknownNameError: for a wish of another name.
    """
    if wishes is not None:
        weights = require_wishes(wishes)
        require_ground(task, weights)
        return weights
    is_too_large = isinstance(task.given, GridScenario) and task.given.map.blocked.size > MOST_CELLS
    absent = {"ground"} if task.costs is None else set()
    absent |= {"distance"} if is_too_large else set()
    return {name: 0.0 if name in absent else USUAL[name] for name in WISHES}


def costs_of(drive_map: DriveMap, curve: Curve, weights: Mapping[str, float]) -> dict[str, float]:
    """Return length, integral of each wish without its weight, changes of direction, and sum of a curve."""
    step = max(FINE * drive_map.unit, curve.length / MOST_STEPS)
    poses = curve.sampled(step)
    middles = 0.5 * (poses[1:, :2] + poses[:-1, :2])
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    values = {"ground": drive_map.ground_at, "distance": drive_map.nearness_at}
    found = {"length": curve.length}
    for name in FIELDS:
        found[name] = float((values[name](middles) * steps).sum()) if weights[name] > 0.0 else 0.0
    found["curvature"] = curve.bending()
    found["sum"] = found["length"] + math.fsum(weights[name] * found[name] for name in WISHES)
    if curve.changes:
        found["changes"] = float(curve.changes)
        found["sum"] += CHANGE * curve.turning_radius * curve.changes
    return found
