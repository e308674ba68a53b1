"""Exact lengths and plans on random scenes, held against the oracle of `oracles.shapely_paths`."""

import math
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from helpers.trouble_scenes import make_scene
from oracles.entered_depth import entered_depth
from oracles.shapely_paths import shortest_length
from swarm_gym.errors import NoPathError, SwarmGymError
from swarm_gym.planning import plan
from swarm_gym.planning.request import PLANNERS
from swarm_gym.planning.tasks import read_task

LARGEST_ERROR = 1e-6  # of an exact length, as a share
DEEPEST = 1e-9  # of paths, as a share of the extent
LEAST_GAP = -1e-6
EPISODE = 1  # evaluations after which no second episode begins


@dataclass
class Outcome:
    """The result of one scene.

    Attributes:
        seed: seed of the scene.
        what: kind of obstacles, and what makes the scene special.
        length: length of the shortest path by the oracle, in map units; infinite without one.
        error: exact length of the package against the oracle, as a share; NaN if it was not compared.
        depth: deepest entry of a path, as a share of the extent.
        gap: gap of the plan; NaN without a plan.
        unfound: whether the planner found no path though there is one.
        refused: the error that the package raised instead of an answer.
    """

    seed: int
    what: str
    length: float = math.nan
    error: float = math.nan
    depth: float = 0.0
    gap: float = math.nan
    unfound: bool = False
    refused: str = ""

    @property
    def faults(self):
        """Everything that is wrong, as texts."""
        found = [self.refused] if self.refused else []
        if self.error > LARGEST_ERROR:
            found.append(f"length: off by {self.error:.3g}")
        if self.depth > DEEPEST:
            found.append(f"depth: {self.depth:.3g} of the extent inside")
        if self.gap < LEAST_GAP:
            found.append(f"gap: {self.gap:.3g}")
        return found

    def __str__(self):
        return f"scene {self.seed} ({self.what}): {'; '.join(self.faults) or 'right'}"


def hold(scene, planned=False):
    """Return how the package fares on a scene: its exact length, and a plan of one episode if asked for."""
    outcome = Outcome(scene.seed, _description(scene))
    ends = (scene.start.real, scene.start.imag), (scene.goal.real, scene.goal.imag)
    least = outcome.length = shortest_length(scene.grown_lattice(), *ends) * scene.scale
    with tempfile.TemporaryDirectory() as folder:
        where = _where(scene, Path(folder))
        try:
            length, path = _exact(where, scene)
            outcome.error = _error(length, least)
            if scene.radius == 0.0 and not len(scene.discs) and len(path):
                outcome.depth = _depth(scene, path)
            if planned:
                _plan(outcome, where, scene, least)
        except SwarmGymError as error:
            outcome.refused = f"{type(error).__name__}: {error}"[:300]
    return outcome


def hold_seed(seed, planned=False):
    """Return how the package fares on the scene of a seed."""
    return hold(make_scene(seed), planned)


def summarise(outcomes: Iterable[Outcome]):
    """Return a summary of outcomes as text."""
    outcomes = list(outcomes)
    wrong = [one for one in outcomes if one.faults]
    errors = [one.error for one in outcomes if not math.isnan(one.error)]
    gaps = [one.gap for one in outcomes if not math.isnan(one.gap)]
    closed = sum(math.isinf(one.length) for one in outcomes)
    lines = [
        f"scenes                 {len(outcomes)}, {closed} without a path",
        f"deepest entry          {max([one.depth for one in outcomes], default=0.0):.3g} of the extent",
        f"largest error          {max(errors, default=0.0):.3g} of the exact length",
        f"plans                  {len(gaps)}, {sum(one.unfound for one in outcomes)} not found",
        f"least gap              {min(gaps, default=math.inf):.3g}",
        f"wrong                  {len(wrong)}, {sum(bool(one.refused) for one in wrong)} of them refused",
    ]
    kinds = sorted({one.what.split(",")[0] for one in wrong})
    for kind in kinds:
        seeds = [one.seed for one in wrong if one.what.split(",")[0] == kind]
        lines.append(f"  {kind:<12} {len(seeds)}, for example seeds {seeds[:4]}")
    return "\n".join(lines)


def _description(scene):
    more = {
        "exact": scene.exact,
        "rounded": not scene.exact,
        "discs": len(scene.discs),
        "radius": scene.radius > 0.0,
        "moved": scene.offset != 0,
    }
    return ", ".join([scene.kind, *(word for word, holds in more.items() if holds)])


def _where(scene, folder):
    """Return what is given to planners: the scenario, or a file for half of the scenes that have both."""
    if scene.geojson is None or (scene.scenario is not None and scene.seed % 2):
        return scene.scenario
    file = folder / "trouble.geojson"
    file.write_text(scene.geojson, encoding="utf-8")
    return file


def _exact(where, scene):
    """Return the package's exact length and path; infinite and empty if it says that there is none."""
    try:
        task = read_task(where, *scene.ends, scene.radius, coordinates="plane")
        length, path = task.shortest
        return length / task.frame.factor, task.frame.to_map(path)
    except NoPathError:
        return math.inf, np.empty((0, 2))


def _error(length, expected):
    if math.isinf(length) or math.isinf(expected):
        return 0.0 if length == expected else math.inf
    return abs(length / expected - 1.0)


def _depth(scene, path):
    return entered_depth(scene.blocked, scene.local(path)) / scene.blocked.extent


def _plan(outcome, where, scene, least):
    options = {"planner": PLANNERS[scene.seed // 2 % len(PLANNERS)], "coordinates": "plane"}
    try:
        found = plan(
            where,
            *scene.ends,
            robot_radius=scene.radius,
            max_evaluations=EPISODE,
            seed=scene.seed,
            **options,
        )
    except NoPathError:
        outcome.unfound = math.isfinite(least)
        return
    outcome.depth = max(outcome.depth, _depth(scene, found.path))
    outcome.gap = min(found.gap, found.length / least - 1.0)
