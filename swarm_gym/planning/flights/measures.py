"""Measures of a flight: its length, heights above ground, angles, and distances from threats."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.planning.flights.ground_track import ground_track
from swarm_gym.planning.flights.result import Passed
from swarm_gym.scenarios import TerrainScenario
from swarm_gym.scenarios.terrain.scenario import RADIUS, X, Y
from swarm_gym.scenarios.terrain.survey import Survey

Floats = NDArray[np.float64]


class Measures(NamedTuple):
    """Measures of a flight, see `Flight`."""

    above_ground: Floats
    least_height: float
    greatest_height: float
    steepest_climb: float
    sharpest_turn: float
    passed: tuple[Passed, ...]


def length_of(waypoints: Floats) -> float:
    """Return the length of a flight, (k, 3), in metres."""
    return float(np.sqrt((np.diff(waypoints, axis=0) ** 2).sum(axis=1)).sum())


def measured(task: Survey, waypoints: Floats) -> Measures:
    """Return the measures of a flight, (k, 3), above the ground of the file."""
    track = ground_track(task, waypoints[:, :2])
    z = np.interp(track.along, track.along[track.vertices], waypoints[:, 2])
    apart = z - track.ground
    # Along a piece the height above ground is quadratic; its extreme values lie at nodes or at the vertex.
    lows, highs = _extremes(apart[:-1], apart[1:], track.bulge - track.sink)
    steps = np.diff(waypoints, axis=0)
    level = np.hypot(steps[:, 0], steps[:, 1])
    climbs = np.degrees(np.arctan2(np.abs(steps[:, 2]), level))
    return Measures(
        waypoints[:, 2] - task.ground(waypoints[:, :2]),
        float(lows.min()),
        float(highs.max()),
        float(climbs.max()),
        _sharpest_turn(steps[level > 0.0]),
        _passed(task.scenario, waypoints[:, :2]),
    )


def _extremes(begin: Floats, end: Floats, bulge: Floats) -> tuple[Floats, Floats]:
    """Return the extreme values of begin + (end - begin) s - 4 bulge (s - s^2) for s in [0, 1]."""
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex = np.where(bulge != 0.0, 0.5 - (end - begin) / (8.0 * bulge), 0.0)
    vertex = np.clip(np.nan_to_num(vertex), 0.0, 1.0)
    middle = begin + (end - begin) * vertex - 4.0 * bulge * (vertex - vertex**2)
    return np.minimum(np.minimum(begin, end), middle), np.maximum(np.maximum(begin, end), middle)


def _sharpest_turn(steps: Floats) -> float:
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    turns = np.abs((np.diff(headings) + np.pi) % (2.0 * np.pi) - np.pi)
    return float(np.degrees(turns).max(initial=0.0))


def _passed(scenario: TerrainScenario, route: Floats) -> tuple[Passed, ...]:
    found = []
    for number, threat in enumerate(scenario.threats):
        least = min(_distance(threat[[X, Y]], begin, end) for begin, end in pairwise(route))
        found.append(Passed(number, least - float(threat[RADIUS])))
    return tuple(sorted(found, key=lambda one: one.distance))


def _distance(point: Floats, begin: Floats, end: Floats) -> float:
    step = end - begin
    squared = float(step @ step)
    share = min(max(float((point - begin) @ step) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    return float(np.hypot(*(begin + share * step - point)))
