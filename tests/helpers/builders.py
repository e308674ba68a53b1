"""Scenarios and swarms that several tests build."""

import math

import numpy as np
import pytest
import shapely

from helpers.compiled import compiled
from oracles import naive, naive_optimizers, naive_swarm
from swarm_gym.compiler.random_stream import seed_stream
from swarm_gym.optimizers import get_optimizer
from swarm_gym.population import Swarms, make_workspace
from swarm_gym.problem import AnalyticProblem, GridProblem, WalkProblem, problem_of_function
from swarm_gym.problem.geometry.bends import BENDS
from swarm_gym.problem.padding import columns
from swarm_gym.problem.tables import select, stack
from swarm_gym.scenarios import Circle, GridMap, GridScenario, Polygon, Scenario, make_scenario, rasterised

CASES = ("case1", "case2", "case3")
MEAN_WEIGHT = 0.1
UNLIMITED = 10**9
METRES = {"resolution": 0.05, "origin": (-1.0, 2.0), "y_up": True}  # geometry of a grid map
COARSE = 20.0  # cells of the analytic cases for walks: fifty columns


def random_polygon(rng, centre, size):
    """The convex hull of a few random points."""
    points = rng.uniform(-size, size, (rng.integers(3, 9), 2)) + centre
    return Polygon(tuple(shapely.MultiPoint(points).convex_hull.exterior.coords[:-1]))


def random_circle(rng, centre, size):
    return Circle(*centre, rng.uniform(0.1, 1.0) * size)


def random_scenario(rng, num_obstacles=12):
    """Circles and convex polygons around a start-target line at any angle; they overlap."""
    start, target = rng.uniform(100.0, 900.0, 2), rng.uniform(100.0, 900.0, 2)
    obstacles = []
    while len(obstacles) < num_obstacles:
        make = random_circle if rng.random() < 0.5 else random_polygon
        centre = start + rng.random() * (target - start) + rng.normal(0.0, 60.0, 2)
        obstacle = make(rng, centre, rng.uniform(10.0, 80.0))
        if not obstacle.contains(start) and not obstacle.contains(target):
            obstacles.append(obstacle)
    ends = tuple(start.tolist()), tuple(target.tolist())
    return Scenario("random", *ends, tuple(obstacles), (0.0, 0.0, 1000.0, 1000.0), (-90.0, 90.0))


def random_grid_scenario(seed, shape=(19, 26), rock=0.15, **geometry):
    """Blocked rectangles on a small map; start and target are anywhere in free cells that are connected."""
    rng = np.random.default_rng(seed)
    height, width = shape
    blocked = np.zeros(shape, dtype=np.bool_)
    while blocked.mean() < rock:
        row, column = rng.integers(height), rng.integers(width)
        blocked[row : row + rng.integers(1, 6), column : column + rng.integers(1, 6)] = True
    grid = GridMap("small", blocked, **geometry)
    largest = np.bincount(grid.components.ravel())[1:].argmax() + 1
    rows, columns_of = np.nonzero(grid.components == largest)
    first, last = columns_of.argmin(), columns_of.argmax()
    ends = [
        grid.to_map(np.array([columns_of[k], rows[k]]) + rng.uniform(-0.4, 0.4, 2)) for k in (first, last)
    ]
    return GridScenario(f"small:{seed}", grid, *(tuple(end.tolist()) for end in ends))


def small_grid_problem(encoding="bezier", num_points=3, seed=0, **geometry):
    return GridProblem(random_grid_scenario(seed, **geometry), encoding, num_points)


def function_problem(name):
    return problem_of_function(make_scenario(name))


def walk_problem(source, seed=3, **geometry):
    """A case of the paper, made of coarse cells, or a small random grid."""
    if source == "random":
        return WalkProblem(random_grid_scenario(seed, **geometry))
    return WalkProblem(rasterised(make_scenario(source), COARSE))


def is_walker(optimizer):
    """Return whether members of an optimizer are points of a walk, and not whole paths."""
    return "walk" in get_optimizer(optimizer).encodings


def problem_for(optimizer, source, num_waypoints, seed=3):
    """A case of the paper by name, or a random one, as that optimizer can have it."""
    return walk_problem(source, seed) if is_walker(optimizer) else problem_of(source, num_waypoints, seed)


def options_for(optimizer, **options):
    """Options of an environment, but for an encoding that the optimizer cannot have."""
    known = get_optimizer(optimizer).encodings
    return {name: value for name, value in options.items() if name != "encoding" or value in known}


def walked(swarms, b=0):
    """Length of the best walk so far, up to the best position; 0 where members are no points of walks."""
    dimension = swarms.walk.shape[2]
    walk = [*swarms.walk[b, : swarms.best_walk[b]], swarms.best_position[b, :dimension]]
    return float(np.linalg.norm(np.diff(walk, axis=0), axis=1).sum())


def turned(scenario, angle, shift=(0.0, 0.0)):
    """The scenario turned about the origin and shifted, in a workspace that bounds nothing."""

    def turn(point):
        x, y = point
        cosine, sine = math.cos(angle), math.sin(angle)
        return x * cosine - y * sine + shift[0], x * sine + y * cosine + shift[1]

    obstacles = [
        Circle(*turn((obstacle.x, obstacle.y)), obstacle.radius)
        if isinstance(obstacle, Circle)
        else Polygon(tuple(turn(vertex) for vertex in obstacle.vertices))
        for obstacle in scenario.obstacles
    ]
    ends, workspace = map(turn, (scenario.start, scenario.target)), (-1e4, -1e4, 1e4, 1e4)
    return Scenario("turned", *ends, tuple(obstacles), workspace, scenario.initial_range)


def random_path(rng, problem):
    """Offsets anywhere in the workspace, or rather near the line: both kinds of path occur."""
    scale = rng.choice([0.1, 0.5, 1.0])
    return scale * rng.uniform(*problem.bounds)


def random_population(rng, problem, size):
    return rng.uniform(*problem.initial_bounds, (size, problem.num_waypoints))


def padded(offsets):
    """Offsets (..., n) as the kernels store them: with zeros up to whole blocks."""
    offsets = np.asarray(offsets, dtype=np.float64)
    out = np.zeros((*offsets.shape[:-1], columns(offsets.shape[-1])))
    out[..., : offsets.shape[-1]] = offsets
    return out


def as_path(offsets):
    """Offsets (n,) as the kernels walk along them: behind the zero of the start."""
    return np.concatenate([[0.0], padded(offsets)])


def begin(
    optimizer,
    problems,
    size,
    capacity=32,
    budget=UNLIMITED,
    iterations=10,
    populations=None,
    seed=0,
    parameters=None,
    source=None,
):
    """Swarms of an optimizer, one per problem, seeded by number from `seed` on; and their stacked tables.

    First populations are drawn, or given, (members, dimension) for each problem; by parameters, where the
    optimizer has some that matter to begin with. New members come from a `naive_sources.Source`, if one is
    given.
    """
    num, cls = len(problems), get_optimizer(optimizer)
    dimension = problems[0].dimension
    tables = stack([problem.table for problem in problems])
    swarms = Swarms.allocate(
        num,
        capacity,
        dimension,
        cls.memory_columns(dimension),
        cls.num_registers(capacity),
        cls.field_size(tables),
        cls.walk_points(tables, iterations),
    )
    swarms.problem[:], swarms.budget[:], swarms.iterations[:] = np.arange(num), budget, iterations
    if source is not None:
        kind = BENDS[source.bends]
        swarms.source[:] = source.smooth_share, source.amplitude, source.immigrants, kind
    for b in range(num):
        swarms.stream[b] = seed_stream(np.random.SeedSequence(seed + b))
        if populations is not None:
            swarms.positions[b, :size] = padded(populations[b])
    everyone, sizes = np.full(num, True), np.full(num, size)
    values = cls.stacked_parameters(parameters or {}, num)
    cls.initialise(swarms, tables, everyone, sizes, MEAN_WEIGHT, populations is not None, values)
    return swarms, tables


def advance(optimizer, swarms, tables, size, repair_degree, parameters=None, num_threads=1, chosen=None):
    """One step of all swarms, or of those chosen, with the default parameters where none are given."""
    cls, num = get_optimizer(optimizer), len(swarms.size)
    values = cls.parameter_values(parameters or {})
    cls.step(
        swarms,
        tables,
        np.full(num, True) if chosen is None else chosen,
        np.broadcast_to(size, num).astype(np.int64),
        np.broadcast_to(repair_degree, num).astype(np.float64),
        np.tile(values, (num, 1)),
        MEAN_WEIGHT,
        num_threads,
    )
    swarms.iteration[:] += 1
    return values


def oracle_twin(
    optimizer,
    problem,
    size,
    budget=UNLIMITED,
    iterations=10,
    population=None,
    seed=0,
    parameters=None,
    source=None,
):
    """The first swarm of `begin` in plain Python; of those that begin by parameters, with these."""
    stream = naive.Stream(seed_stream(np.random.SeedSequence(seed)))
    oracle = naive_swarm.oracle_of(problem)
    twin = naive_optimizers.NAIVE[optimizer](oracle, stream, iterations, budget)
    if source is not None:
        twin.source = source
    if parameters:
        twin.parameters = type(twin.parameters)(
            **get_optimizer(optimizer).parameter_values(parameters)._asdict()
        )
    if population is None:
        twin.begin(size)
    else:
        twin.adopt(population)
    return twin


def assert_same_as_oracle(swarms, twin, rtol=1e-10):
    """Members in order, best so far, count of evaluations and random stream are those of the oracle.

    Of walks the best one is: where on its last piece the robot was is the same way.
    """
    members, n = twin.stored(), twin.problem.dimension
    close = {"rtol": rtol, "atol": 1e-9}
    assert swarms.evaluations[0] == twin.evaluations
    assert swarms.stream[0].tolist() == twin.stream.words()
    assert swarms.size[0] == len(members)
    stored = slice(0, len(members))
    np.testing.assert_allclose(swarms.positions[0, stored, :n], [m.position for m in members], **close)
    assert (swarms.positions[0, stored, n:] == 0).all()
    np.testing.assert_allclose(swarms.fitness[0, stored], [m.fitness for m in members], **close)
    np.testing.assert_allclose(swarms.collision[0, stored], [m.collision for m in members], **close)
    np.testing.assert_allclose(swarms.best_fitness[0], twin.best[0], **close)
    np.testing.assert_allclose(swarms.best_collision[0], twin.best[1], **close)
    if swarms.walk.shape[1] > 0:
        way = [*swarms.walk[0, : swarms.best_walk[0]], twin.problem.target]
        expected = along([*twin.best_walk, twin.problem.target])
        np.testing.assert_allclose(along(way), expected, **close)
    else:
        np.testing.assert_allclose(swarms.best_position[0, :n], twin.best[2], **close)
        np.testing.assert_allclose(swarms.feasible_fitness[0], twin.feasible[0], **close)
        if twin.feasible[1] is not None:
            np.testing.assert_allclose(swarms.feasible_position[0, :n], twin.feasible[1], **close)


def assert_same_swarm(swarms, twin):
    """Compare fireflies on the cases of the SPSFA paper with the oracle, where less rounding adds up."""
    assert_same_as_oracle(swarms, twin, rtol=1e-12)


def along(way, num_points=200):
    """Points at even distances along a polyline."""
    points = np.asarray(way)
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    at = np.linspace(0.0, lengths[-1], num_points)
    return np.stack([np.interp(at, lengths, coordinates) for coordinates in points.T], axis=-1)


def problem_of(source, num_waypoints, seed=3, length_weight=0.3):
    """A case of the paper by name, or a random one."""
    if source == "random":
        source = random_scenario(np.random.default_rng(seed))
    return make_problem(source, num_waypoints, length_weight)


def make_twins(problem, population, seed, budget=UNLIMITED):
    """Return fireflies for the kernels and their oracle in plain Python: (swarms, tables, twin)."""
    size = len(population)
    swarms, tables = begin("firefly", [problem], size, budget=budget, populations=[population], seed=seed)
    twin = oracle_twin("firefly", problem, size, budget, population=population, seed=seed)
    return swarms, tables, twin


def twins_of(source, size, seed, num_waypoints, **options):
    """(swarms, table, workspace, twin) of a random population of fireflies."""
    problem = problem_of(source, num_waypoints)
    population = random_population(np.random.default_rng(seed), problem, size)
    swarms, tables, twin = make_twins(problem, population, seed, **options)
    return swarms, compiled(select)(tables, 0), workspace(num_waypoints), twin


def workspace(num_waypoints):
    return make_workspace(columns(num_waypoints))


def make_problem(case, num_waypoints=31, length_weight=0.3):
    return AnalyticProblem(make_scenario(case), num_waypoints, length_weight)


# What they remember is evaluated anew as that of fireflies is. They are compiled for it, which takes longer
# than their tests.
ALIKE = (
    "generational-firefly", "elite-genetic", "fish-swarm", "improved-fish-swarm", "hybrid-fish-swarm",
    "differential-evolution",
)  # fmt: skip


def slow_if_alike(optimizer, *more):
    """Parameters of a test of maps that change."""
    return pytest.param(optimizer, *more, marks=pytest.mark.slow if optimizer in ALIKE else ())
