"""Ways of robots, and of what is found for them: length, turning, arrival."""

import numpy as np

from experiments.runs.run import Floats, Run
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.scenarios.scenario import Point


def way_of(run: Run) -> Floats:
    """(k, 2) where the robot has gone; the best path of a run that only plans."""
    return run.way if len(run.way) else run.best_path


def arrives(run: Run, target: Point) -> bool:
    """Whether a robot has come to the target; of a run that only plans, whether its best path is feasible."""
    if len(run.way):
        return bool((run.way[-1] == target).all())
    return run.final_collision <= FEASIBILITY_TOLERANCE


def length_of(path: Floats) -> float:
    """Length of a polyline, (k, 2)."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def turning_of(path: Floats) -> float:
    """By how much a polyline, (k, 2), turns in all, to either side, in degrees."""
    steps = np.diff(path, axis=0)
    steps = steps[(steps != 0.0).any(axis=1)]
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    turns = (np.diff(headings) + np.pi) % (2.0 * np.pi) - np.pi
    return float(np.degrees(np.abs(turns).sum()))
