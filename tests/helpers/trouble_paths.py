"""Paths of swarms on random scenes: a path is feasible exactly if shapely's union says so."""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from helpers.trouble_scenes import Scene, make_scene, shared_edges
from helpers.trouble_shapes import SIZE
from oracles.entered_depth import NO_DISCS, entered_depth
from oracles.shapely_paths import shortest_route
from swarm_gym.env import SwarmEnv
from swarm_gym.problem import AnalyticProblem

FEASIBLE = 1e-9  # degree of collision up to which a path counts as feasible, in map units
ROUNDED = 4e-12  # the same, as a share of the extent, for large maps, on which roundings are larger
ROUNDING = 1e-12  # depth that rounded coordinates give to a path that only touches, as a share of the extent
UNCLEAR = 1e-7  # depth from which a path surely enters, as a share of the extent
WAYPOINTS = (3, 7, 15, 31)
ITERATIONS, MEMBERS = 25, 20
MOST_REPAIRS = 6


@dataclass
class Count:
    """Paths that were compared on some scenes.

    Attributes:
        free: paths that do not enter the union.
        entering: paths that enter it.
        unclear: paths that enter by so little that they are not compared.
        wrong: for each path where the package and shapely differ, a text.
    """

    free: int = 0
    entering: int = 0
    unclear: int = 0
    wrong: tuple[str, ...] = ()

    def __add__(self, other):
        return Count(*(getattr(self, name) + getattr(other, name) for name in vars(self)))

    def __str__(self):
        differ = "".join(f"\n  {text}" for text in self.wrong[:10])
        return (
            f"paths                  {self.free} free, {self.entering} entering, {self.unclear} unclear\n"
            f"feasible, but not so   {len(self.wrong)}{differ}"
        )


def map_scene(seed):
    """Return a scene of convex obstacles at the origin, some hundreds of map units wide, for a point robot.

    Half of the scenes keep a few neighbours only, so that many paths are free.
    """
    scene = make_scene(seed, convex=True, radius=False, placed=False)
    rng = np.random.default_rng([seed, 3])
    if rng.random() < 0.5:
        return scene
    first, number = rng.integers(len(scene.polygons)), rng.integers(1, 4)
    return replace(scene, polygons=scene.polygons[first : first + number], discs=scene.discs[:1])


def slope_scene(seed):
    """Return a scene of two houses that share a wall across the way, a decision vector along it, and a gap.

    The wall begins and ends where waypoints lie, and no edge but the wall is in the way of the path. The gap
    between the houses is 0 or positive; the path is free if it is positive.
    """
    rng = np.random.default_rng([seed, 4])
    waypoints, spacing = int(rng.choice(WAYPOINTS[1:])), 4
    first, last = np.sort(rng.choice(np.arange(1, waypoints + 1), 2, replace=False))
    heights = rng.integers(-SIZE // 4, SIZE // 4, 2)
    gap = float(rng.choice([0, 0, 1]))
    (x0, x1), (y0, y1) = (spacing * first, spacing * last), heights
    up, down = rng.integers(2, SIZE // 2, 2), rng.integers(2, SIZE // 2, 2) + gap
    upper = shapely.Polygon([(x0, y0), (x1, y1), (x1, y1 + up[1]), (x0, y0 + up[0])])
    lower = shapely.Polygon([(x1, y1 - gap), (x0, y0 - gap), (x0, y0 - down[0]), (x1, y1 - down[1])])
    turn = complex(*rng.integers(1, 6, 2)) * 2.0 ** int(rng.integers(0, 3))
    goal = complex(spacing * (waypoints + 1))
    scene = Scene(seed, "slope", True, [upper, lower], NO_DISCS, 0j, goal, 0.0, turn, 0j)
    stations = spacing * np.arange(1, waypoints + 1)
    offsets = np.interp(stations, [0, x0, x1, goal.real], [0, y0, y1, 0])
    return scene, offsets * scene.scale, gap


def hold_random_paths(seed, number=50):
    """Compare random paths on the scene of a seed: rough and smooth ones, and those along edges."""
    scene = map_scene(seed)
    rng = np.random.default_rng([seed, 2])
    problem = AnalyticProblem(scene.scenario, int(rng.choice(WAYPOINTS)))
    along = [problem.along(line[None])[0] for line in lines_along_edges(scene, rng)]
    vectors = [np.zeros(problem.dimension), *along]
    while len(vectors) < number:
        vectors.append(_random_vector(rng, problem))
        for _ in range(rng.integers(0, MOST_REPAIRS)):
            vectors[-1] = problem.repaired(vectors[-1], 1.0)
    return _held(seed, "random", scene, problem, np.array(vectors[:number]))


def hold_slope(seed):
    """Compare the path along the wall that two houses share, on the scene of a seed."""
    scene, vector, gap = slope_scene(seed)
    problem = AnalyticProblem(scene.scenario, len(vector))
    assert is_entering(scene, problem.points(vector)) == (gap == 0.0)
    return _held(seed, "slope", scene, problem, vector[None])


def hold_optimised_paths(seed):
    """Compare members of a swarm on the scene of a seed, the same after repair, and the best path."""
    scene = map_scene(seed)
    env = SwarmEnv("firefly", scenario=scene.scenario, iterations=ITERATIONS)
    env.reset(seed=seed)
    problem = env.simulation.problems[0]
    action = np.array([MEMBERS, 1.0])
    ended = False
    while not ended:
        _, _, ended, _, _ = env.step(action)
    members = env.simulation.positions(0)
    repaired = [problem.repaired(problem.repaired(vector, 1.0), 1.0) for vector in members]
    best = env.simulation.swarms.feasible_position[:, : problem.dimension]
    known = best[np.isfinite(best).all(axis=1)]
    return _held(seed, "optimised", scene, problem, np.concatenate([members, repaired, known]))


def lines_along_edges(scene, rng):
    """Return polylines, (k, 2) in map units, that run exactly along edges that are shared or of the union."""
    edges = shared_edges(scene)
    rng.shuffle(edges)
    outer = [(a, b) for a, b in zip(*scene.lattice.edges, strict=True)]
    rng.shuffle(outer)
    lines = []
    for a, b in [*edges[:8], *outer[:6]]:
        lines.append([scene.start, *sorted((a, b), key=lambda z: abs(z - scene.start)), scene.goal])
    length, route = shortest_route(scene.lattice, *((z.real, z.imag) for z in (scene.start, scene.goal)))
    found = [scene.place(np.array([(z.real, z.imag) for z in map(complex, line)])) for line in lines]
    return [*found, scene.place(route)] if np.isfinite(length) else found


def is_entering(scene, path):
    """Return whether a path, (k, 2) in map units, enters the union; None if the depth is too small to say."""
    depth = entered_depth(scene.blocked, scene.local(path)) / scene.blocked.extent
    if ROUNDING < depth < UNCLEAR:
        return None
    return bool(depth >= UNCLEAR)


def _held(seed, what, scene, problem, vectors):
    count = Count()
    limit = max(FEASIBLE, ROUNDED * scene.blocked.extent)
    for number, (vector, path) in enumerate(zip(vectors, problem.points(vectors), strict=True)):
        entering = is_entering(scene, path)
        if entering is None:
            count += Count(unclear=1)
            continue
        collision = problem.evaluate(vector)[1]
        count += Count(entering=1) if entering else Count(free=1)
        if (collision <= limit) == entering:
            where = "inside" if entering else "outside"
            text = f"scene {seed} ({scene.kind}), {what} path {number}: {where}, collision {collision:.3g}"
            count += Count(wrong=(text,))
    return count


def _random_vector(rng, problem):
    """Return offsets near the line or anywhere around the obstacles; half of them bend smoothly."""
    low, high = problem.initial_bounds
    size = rng.choice([0.1, 0.4, 1.0, 1.5])
    if rng.random() < 0.5:
        return np.clip(size * rng.uniform(low, high), *problem.bounds)
    knots = rng.uniform(low.min(), high.max(), rng.integers(1, 4))
    at = np.linspace(0.0, 1.0, problem.dimension + 2)[1:-1]
    bent = size * np.interp(at, np.linspace(0.0, 1.0, len(knots) + 2), [0.0, *knots, 0.0])
    return np.clip(bent, *problem.bounds)
