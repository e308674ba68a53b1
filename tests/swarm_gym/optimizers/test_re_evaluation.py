"""Optimizers evaluate anew all that they remember when the map changes, as in plain Python."""

from functools import partial

import numpy as np
import pytest
from test_optimizers import spent_to_begin, tries

from helpers.builders import (
    ALIKE,
    MEAN_WEIGHT,
    METRES,
    UNLIMITED,
    advance,
    assert_same_as_oracle,
    begin,
    is_walker,
    oracle_twin,
    random_grid_scenario,
    random_population,
)
from helpers.slow import slow_but
from oracles import naive_optimizers, naive_swarm
from swarm_gym.optimizers import get_optimizer
from swarm_gym.problem import AnalyticProblem, GridProblem, WalkProblem
from swarm_gym.problem.tables import stack
from swarm_gym.scenarios import Appear, Circle, Disappear, DynamicScenario, Polygon, make_scenario, worlds_of

# Kernels that evaluate again on cells take long to compile; other tests need this one, too.
ON_GRIDS = ("firefly", "glowworm", "ant-colony")
with_an_oracle_on_both_maps = pytest.mark.parametrize(
    ("optimizer", "kind"),
    slow_but(
        [(name, "analytic") for name in naive_optimizers.NAIVE if name not in ALIKE]
        + [(name, "grid") for name in ON_GRIDS],
        [(name, kind) for name in naive_optimizers.NAIVE for kind in ("analytic", "grid")],
    ),
)

# (size, repair degree) of steps, after each of which the map changes.
PLAN = [(7, 0.0), (9, 0.5), (9, 0.0), (4, 1.0)]


def problems(optimizer, kind):
    """Return problems before and after obstacles appear and vanish; walkers have grids of both axes."""
    if is_walker(optimizer):
        base = random_grid_scenario(4, **({} if kind == "grid" else METRES))
        x, y = base.map.to_map((13.0, 8.0))
        events, make = [Appear(1, Circle(x, y, 2.5 * base.map.resolution))], WalkProblem
    elif kind == "analytic":
        base, block = make_scenario("case1"), Polygon.rectangle(500, 150, 600, 330)
        events, make = [Appear(1, block), Disappear(1, 10)], partial(AnalyticProblem, num_waypoints=9)
    else:
        base, events = random_grid_scenario(4), [Appear(1, Circle(13.0, 8.0, 2.5))]
        make = partial(GridProblem, encoding="bezier", num_points=3)
    return [make(world.scenario) for world in worlds_of(DynamicScenario("", base, events))]


def change(optimizer, swarms, tables, number):
    swarms.problem[:] = number
    get_optimizer(optimizer).re_evaluate(swarms, tables, np.full(len(swarms.size), True), MEAN_WEIGHT)


def assert_same_memory(optimizer, swarms, twin):
    assert_same_as_oracle(swarms, twin)
    if optimizer == "particle-swarm":
        width, n = swarms.positions.shape[2], twin.problem.dimension
        for memory, member in zip(swarms.memory[0], twin.members, strict=False):
            np.testing.assert_allclose(memory[:n], member.velocity, rtol=1e-10, atol=1e-9)
            np.testing.assert_allclose(memory[width : width + n], member.own_best, rtol=1e-10, atol=1e-9)
            assert memory[2 * width] == pytest.approx(member.own_fitness, rel=1e-10)


def run(optimizer, kind, plan, parameters=None, budget=UNLIMITED, size=7):
    """Run an episode on alternating maps, and compare it with the oracle after every step and change."""
    both = problems(optimizer, kind)
    options = {"budget": budget, "iterations": len(plan)}
    swarms, _ = begin(optimizer, both[:1], size, **options)
    tables = stack([problem.table for problem in both])
    twin = oracle_twin(optimizer, both[0], size, **options)
    for step, (new_size, repair_degree) in enumerate(plan, 1):
        if swarms.evaluations[0] >= budget:
            break
        values = advance(optimizer, swarms, tables, new_size, repair_degree, parameters)
        twin.step(new_size, repair_degree, values)
        assert_same_memory(optimizer, swarms, twin)
        if swarms.evaluations[0] >= budget:
            break
        change(optimizer, swarms, tables, step % 2)
        twin.re_evaluate(naive_swarm.oracle_of(both[step % 2]))
        assert_same_memory(optimizer, swarms, twin)
    return swarms


@with_an_oracle_on_both_maps
def test_episodes_on_a_map_that_changes_are_the_naive_ones(optimizer, kind):
    # On grids plain Python takes long.
    plan, size = (PLAN, 7) if kind == "analytic" else ([(6, 0.0), (4, 0.5)], 5)
    run(optimizer, kind, plan, tries(optimizer, 1), size=size)


@pytest.mark.parametrize(
    "optimizer", slow_but(("firefly", "particle-swarm", "multivariate"), naive_optimizers.NAIVE)
)
def test_episodes_of_all_budgets_on_a_map_that_changes_are_the_naive_ones(optimizer):
    """Budgets end among the members, in the other memory, or at the best so far."""
    first = spent_to_begin(optimizer, problems(optimizer, "analytic")[0], 5)
    for budget in range(first, first + 40):
        run(optimizer, "analytic", [(5, 0.0), (7, 0.5)], tries(optimizer, 1), budget, size=5)


def test_a_best_so_far_that_got_worse_gives_way_to_the_best_member():
    free, blocked = problems("firefly", "analytic")
    rng = np.random.default_rng(0)
    inside = rng.uniform(*free.initial_bounds, (400, 9))
    worse = max(inside, key=lambda vector: blocked.evaluate(vector)[0] - free.evaluate(vector)[0])
    others = [vector for vector in inside if free.evaluate(vector)[0] > free.evaluate(worse)[0]]
    others = sorted(others, key=lambda vector: blocked.evaluate(vector)[0])[:3]
    swarms, _ = begin("firefly", [free], 4, populations=[np.array([worse, *others])])
    assert swarms.best_fitness[0] == free.evaluate(worse)[0]
    change("firefly", swarms, stack([free.table, blocked.table]), 1)
    assert (swarms.best_position[0, :9] == others[0]).all()
    assert (swarms.best_fitness[0], swarms.best_collision[0]) == blocked.evaluate(others[0])


def test_a_best_so_far_that_no_member_is_at_stays_where_it_is_still_the_best():
    free, blocked = problems("firefly", "analytic")
    rng = np.random.default_rng(0)
    best = 0.1 * min(random_population(rng, free, 300), key=lambda vector: blocked.evaluate(vector)[0])
    population = [*random_population(rng, free, 5), best]
    swarms, tables = begin("firefly", [free], 6, populations=[population])
    assert (swarms.best_position[0, :9] == best).all()
    advance("firefly", swarms, tables, 6, 0.0)
    swarms.positions[0, 5] = swarms.positions[0, 0]
    change("firefly", swarms, stack([free.table, blocked.table]), 1)
    assert (swarms.best_position[0, :9] == best).all()
    assert (swarms.best_fitness[0], swarms.best_collision[0]) == blocked.evaluate(best)
