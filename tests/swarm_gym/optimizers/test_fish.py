"""Tests of all three fish swarms; the file with its name has those of a single one."""

import pytest
from test_optimizers import problems, run

from helpers import fish
from helpers.builders import advance, begin
from helpers.slow import slow_but
from swarm_gym.optimizers import get_optimizer

STANDARD, IMPROVED, HYBRID = "fish-swarm", "improved-fish-swarm", "hybrid-fish-swarm"
FISH = (STANDARD, IMPROVED, HYBRID)
OTHERS = {
    STANDARD: [
        {"tries": 1.0, "visual": 1.0, "crowding": 1.0},
        {"tries": 7.0, "crowding": 0.1},
        {"tries": 2.9, "visual": 0.05, "step": 0.5},
        {"visual": 1.0, "step": 1.0, "crowding": 0.1},
    ],
    IMPROVED: [
        {"origin_pull": 0.5, "tries": 1.0, "crowding": 1.0},
        {"origin_pull": 1.0, "visual": 0.05, "tries": 7.0},
        {"visual": 1.0, "crowding": 1.0, "first_beta": 0.2, "last_beta": 0.9},
        {"tries": 2.9, "crowding": 0.1, "smallest_visual": 0.2, "smallest_step": 0.2},
    ],
    HYBRID: [
        {"tries": 1.0, "visual": 1.0, "crowding": 1.0},
        {"tries": 7.0, "crowding": 0.1},
        {"tries": 2.9, "visual": 0.05, "step": 0.5},
        {"tries": 2.0, "smallest_visual": 0.2, "smallest_step": 0.2, "crowding": 0.1},
    ],
}
# (size, repair degree) of steps; the hybrid one looks around most often.
PLANS = {name: [(6, 0.0), (9, 0.7), (4, 1.0)] for name in (STANDARD, IMPROVED)} | {
    HYBRID: [(4, 0.0), (6, 0.7), (3, 1.0)]
}


@pytest.mark.parametrize(
    ("name", "parameters", "kind"),
    slow_but(
        # On a polyline plain Python takes long.
        [(name, each, "analytic") for name in OTHERS for each in OTHERS[name]]
        + [(name, OTHERS[name][0], kind) for name in OTHERS for kind in ("one waypoint", "polyline")],
        [
            (name, each, kind)
            for name in OTHERS
            for each in OTHERS[name]
            for kind in ("analytic", "one waypoint", "polyline")
        ],
    ),
)
def test_episodes_with_other_parameters_are_the_naive_ones(name, parameters, kind):
    plan = PLANS[name]
    run(name, problems(name)[kind], plan, parameters, size=plan[0][0], iterations=3)


@pytest.mark.parametrize("name", [STANDARD, HYBRID])
def test_a_fish_steps_straight_to_a_better_companion(name):
    here = fish.zigzags(1)[0] * 3.0
    ways = fish.displacements(name, [here, 0.0 * here], {"visual": 0.9, "crowding": 1.0}, num=60)[:, 0]
    along, is_all = fish.components_along(ways, -here)
    assert is_all.all()
    assert (along > 0).all()
    fish.assert_up_to(fish.lengths(ways), 0.1)


@pytest.mark.parametrize("name", [STANDARD, HYBRID])
@pytest.mark.parametrize(("crowding", "count"), [(0.5, 5 + 5), (0.51, 3 + 5)])
def test_as_many_companions_as_the_crowding_allows_are_too_many(name, crowding, count):
    """Each of two fish is half the swarm to the other; the second one is at the best place, and preys.

    One try from the best place fails, so that prey costs 2; that of the other fish of the hybrid may cost 3.
    """
    parameters = {"visual": 0.9, "crowding": crowding, "tries": 1.0}
    found = fish.spent(name, [[60.0] * 9, [0.0] * 9], parameters)
    assert count <= found <= count + (2 if (name, crowding) == (HYBRID, 0.5) else 0)


@pytest.mark.parametrize("name", [STANDARD, IMPROVED])
def test_where_fish_come_to_is_repaired(name):
    still = {
        parameter: 0.0
        for parameter in get_optimizer(name).parameters
        if "visual" in parameter or "step" in parameter
    }
    assert all(fish.repairs_in_place(name, still, 1))


def bounds_of(name, tries, iteration):
    """Least and most evaluations of an iteration of fifteen fish."""
    return {
        # Three at least; two full preys and a centre at most.
        STANDARD: (3 * 15, (2 * tries + 3) * 15),
        IMPROVED: (1 + 15 * 2, 1 + 15 * (2 * tries + 4)),
        # From a centre and two steps to a centre and two preys of three rounds.
        HYBRID: (15 * 3, 15 * (1 + 2 * 3 * tries * (1 + iteration))),
    }[name]


@pytest.mark.parametrize("few", [True, False])
@pytest.mark.parametrize("kind", ["analytic", "curve"])
@pytest.mark.parametrize("name", FISH)
def test_evaluations_of_an_iteration_lie_between_what_the_rules_give(name, kind, few):
    tries = 1 if few else 4 if name == HYBRID else 5
    degrees = (0.0, 1.0, 0.0) if name == HYBRID else (0.0, 0.0, 1.0, 1.0)
    options = {"iterations": 3} if name == HYBRID else {}
    swarms, tables = begin(name, [problems(name)[kind]], size=15, **options)
    for iteration, repair_degree in enumerate(degrees):
        before = swarms.evaluations[0]
        advance(name, swarms, tables, 15, repair_degree, {"tries": float(tries)})
        least, most = bounds_of(name, tries, iteration)
        assert least <= swarms.evaluations[0] - before <= most
