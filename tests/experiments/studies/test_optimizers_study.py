"""Tables and figures of the study of every optimizer say what the runs say."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from experiments.runs.groups import group_controllers
from experiments.studies.optimizers.figures import draw_fronts
from experiments.studies.optimizers.suites import (
    BASE_OF_SIZES,
    DRIVEN,
    FIREFLY,
    LATER_SEEDS,
    NEVER_USED,
    ON_CASES,
    ON_CELLS,
    ON_THE_CASES,
    ON_THE_CELLS,
    ON_THE_GRIDS,
    RULES,
    SIZES,
    TRANSFER,
    TRANSFER_ON_CELLS,
    base,
    blind,
    blinded,
    of_sizes,
    policies,
    rules_tuned,
)
from experiments.studies.optimizers.tables import (
    area_tables,
    budget_tables,
    gain_tables,
    optimizer_tables,
)
from experiments.studies.optimizers.transfer_tables import ALL, NAMED, one_for_all_tables, transfer_tables
from experiments.tables.front import family_hypervolume
from helpers.stored_runs import cells_of, outcomes_of
from swarm_gym.controllers import make_controller
from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.reference import shortest_grid_path, shortest_path
from swarm_gym.scenarios import make_scenario
from swarm_gym.worlds import make_problem

SWARM = "particle-swarm"


def gaps(rng, seeds=6):
    """Gaps of all controllers of particle swarms on two cases: smaller for later ones."""
    entrants = [
        *SIZES,
        "spsfa-tip",
        *rules_tuned(SWARM),
        base(SWARM),
        *blind(SWARM),
        *blinded(SWARM),
        *policies(SWARM),
    ]
    return {
        (f"{SWARM}+{name}", case): rng.uniform(0.5, 1.0, seeds) / (1 + order)
        for order, name in enumerate(entrants)
        for case in ("case1", "case2")
    }


def mean_gap(found, names, cases):
    return 100.0 * np.mean([found[f"{SWARM}+{name}", case] for name in names for case in cases])


def test_nine_optimizers_beside_fireflies_are_families_of_one_suite_each():
    """One that is added later belongs to no stored result, so it need not be among them."""
    assert len({*ON_CASES, *ON_CELLS}) == len(ON_CASES) + len(ON_CELLS) == 9
    assert {*ON_CASES, *ON_CELLS} <= set(OPTIMIZERS) - {"firefly"}
    for suite, first_seed in (
        (ON_THE_CASES, NEVER_USED), (ON_THE_CELLS, NEVER_USED), (ON_THE_GRIDS, LATER_SEEDS)
    ):  # fmt: skip
        assert suite.first_seed == first_seed
        for family in suite.families:
            assert all(name.startswith(f"{family.name}+") for name in family.controllers)
            # Fireflies have no base of their own.
            assert len(group_controllers(family.controllers)) == (7 if family.name == FIREFLY else 8)


def test_every_policy_of_size_and_phi_drives_every_optimizer():
    for suite, optimizers in ((TRANSFER, DRIVEN), (TRANSFER_ON_CELLS, ON_CELLS)):
        assert suite.first_seed == LATER_SEEDS
        for optimizer in optimizers:
            for trained_on in DRIVEN:
                assert {f"{optimizer}+{policy}" for policy in of_sizes(trained_on)} <= {*suite.controllers}


@pytest.mark.parametrize("optimizer", [*ON_CASES, *ON_CELLS])
def test_policies_and_blind_schedules_of_an_optimizer_are_made_for_it(optimizer):
    for name in (base(optimizer), *blind(optimizer), *policies(optimizer)):
        assert make_controller(name).made_for == optimizer


def test_the_table_has_a_row_for_each_optimizer_and_set():
    found = gaps(np.random.default_rng(0))
    rows = cells_of(optimizer_tables(ON_THE_CASES, outcomes_of(found)), "optimizers")
    row = next(row for row in rows if row["optimizer"] == SWARM and row["scenarios"] == "case2")
    assert row["60 members"].startswith(f"{mean_gap(found, ['fixed:60'], ['case2']):.2f} at ")
    assert row["rules tuned"].startswith(f"{mean_gap(found, rules_tuned(SWARM), ['case2']):.2f} at ")
    assert row["blind schedule"].startswith(f"{mean_gap(found, blind(SWARM), ['case2']):.2f} at ")
    assert row["PPO"].startswith(f"{mean_gap(found, policies(SWARM), ['case2']):.2f} at ")
    missing = next(row for row in rows if row["optimizer"] == "multivariate")
    assert {missing[column] for column in ("60 members", "rules tuned", "PPO")} == {"–"}


def test_the_base_stands_where_no_blind_schedule_took_as_many_steps():
    found = {("ant-colony+" + base("ant-colony"), "block:30"): [0.1, 0.3]}
    outcomes = outcomes_of({("ant-colony+fixed:60", "case1"): [0.2, 0.2], **{
        (name, "case1"): gaps for (name, _), gaps in found.items()
    }})  # fmt: skip
    row = next(
        row
        for row in cells_of(optimizer_tables(ON_THE_CELLS, outcomes), "optimizers")
        if row["optimizer"] == "ant-colony"
    )
    assert row["blind schedule"].startswith("20.00 at ")


def test_gains_are_differences_of_objectives_with_the_sign_of_the_policies():
    found = gaps(np.random.default_rng(1))
    outcomes = outcomes_of(found)
    tables = gain_tables(ON_THE_CASES, outcomes)
    assert len(tables[0].columns) <= 9
    row = next(row for row in cells_of(tables, "gains") if row["scenarios"] == "all")
    mine = outcomes.sample(f"{SWARM}+learned:optimizers-{SWARM}/*@1", "all").objective(1.0).mean()
    assert row["PPO"] == f"{mine:.2f}"
    assert row["minus the best fixed size"].endswith(" (100 members)")
    for column, group in {
        "minus the best fixed size": "fixed:100",
        "minus the rules": "spsfa-tip",
        "minus rules tuned": f"tuned:optimizers-{SWARM}-schedule/*",
        "minus the base": base(SWARM),
        "minus blind schedules": f"open-loop:optimizers-{SWARM}/*@1",
        "minus itself blinded": f"blinded:optimizers-{SWARM}/*@1",
    }.items():
        theirs = outcomes.sample(f"{SWARM}+{group}", "all").objective(1.0).mean()
        assert row[column].startswith(f"{mine - theirs:+.2f} [")
        assert mine < theirs


def test_a_budget_names_the_best_within_it():
    found = gaps(np.random.default_rng(2))
    rows = cells_of(budget_tables(ON_THE_CASES, outcomes_of(found)), "budgets")
    first = next(row for row in rows if row["scenarios"] == "case1" and row["evaluations"] == "2,000")
    # The second controller spends 2,000 evaluations; those after it spend more.
    assert (first["optimizer"], first["controller"]) == (SWARM, "60 members")
    assert first["gap in per cent"] == f"{mean_gap(found, ['fixed:60'], ['case1']):.2f}"
    last = next(row for row in rows if row["scenarios"] == "case1" and row["evaluations"] == "200,000")
    assert last["controller"] == f"learned optimizers-{SWARM}@1"


def test_the_figure_has_a_point_for_each_group_at_its_evaluations_and_seconds():
    found = gaps(np.random.default_rng(3))
    outcomes = outcomes_of(found)
    figure = draw_fronts(ON_THE_CASES, outcomes)
    assert len(figure.axes) == 2 * len(outcomes.sets)
    group = f"{SWARM}+learned:optimizers-{SWARM}/*@1"
    sample = outcomes.sample(group, "case1")
    for axes, cost in ((figure.axes[0], sample.evaluations), (figure.axes[3], sample.seconds)):
        stars = [line.get_xydata() for line in axes.lines if line.get_marker() == "*"]
        stars = [tuple(star[0]) for star in stars if len(star)]  # the legend has an empty one
        assert stars == [pytest.approx((cost.mean(), 100.0 * sample.gap.mean()))]


def test_an_area_is_that_of_all_controllers_of_the_optimizer():
    found = gaps(np.random.default_rng(4))
    outcomes = outcomes_of(found)
    (row,) = cells_of(area_tables(ON_THE_CASES, outcomes), "areas")
    family = ON_THE_CASES.families[0]
    area, _ = family_hypervolume(family, outcomes, "case2", ON_THE_CASES.reference)
    assert row["optimizer"] == SWARM == family.name
    assert row["case2"].startswith(f"{area:.3f} [")
    assert area > 0.0


def driven_gaps(rng):
    """Gaps of particle swarms and fish on one case, under policies of size and phi."""
    names = [BASE_OF_SIZES, RULES, *of_sizes(SWARM), *of_sizes("fish-swarm")]
    names += [name.replace("*", str(k)) for name in (ALL, NAMED) for k in range(2)]
    return {
        (f"{optimizer}+{name}", "case1"): rng.uniform(0.1, 0.9, 4)
        for optimizer in (SWARM, "fish-swarm")
        for name in names
    }


def test_transfer_is_an_objective_in_per_cent_of_that_of_60_members():
    outcomes = outcomes_of(driven_gaps(np.random.default_rng(6)))
    tables = transfer_tables(TRANSFER, outcomes)
    assert len(tables[0].columns) == 1 + len(DRIVEN)
    rows = cells_of(tables, "transfer")
    assert [row["optimizer"] for row in rows] == [SWARM, "fish-swarm"]
    mine, members = (
        outcomes.sample(f"fish-swarm+{name}", "case1").objective(1.0).mean()
        for name in (f"learned:optimizers-{SWARM}-sizes/*@1", BASE_OF_SIZES)
    )
    assert rows[1][SWARM] == f"{100.0 * mine / members:.0f} %"
    assert rows[1]["multivariate"] == "–"


def test_one_policy_for_all_stands_beside_the_optimizers_own():
    outcomes = outcomes_of(driven_gaps(np.random.default_rng(7)))
    tables = one_for_all_tables(TRANSFER, outcomes)
    assert len(tables[0].columns) <= 9
    first, second = cells_of(tables, "one-for-all")
    assert (first["optimizer"], second["optimizer"]) == (SWARM, "fish-swarm")
    own, shared, named = (
        outcomes.sample(f"{SWARM}+{name}", "case1").objective(1.0).mean()
        for name in (f"learned:optimizers-{SWARM}-sizes/*@1", ALL, NAMED)
    )
    assert (first["own policy"], first["one for eight"]) == (f"{own:.2f}", f"{shared:.2f}")
    assert first["minus own policy"].startswith(f"{shared - own:+.2f} [")
    assert first["told the name"] == f"{named:.2f}"
    assert first["minus not told"].startswith(f"{named - shared:+.2f} [")


def test_suites_on_cells_are_of_optimizers_that_walk():
    assert ON_THE_CELLS.scenarios == ("block:30", "block:50", "block:80")


def test_optima_of_maps_of_cells_are_shortest_paths():
    outcomes = outcomes_of({("glowworm+fixed:60", "case1"): [0.1, 0.2]})
    on_cells = dataclasses.replace(outcomes, scenarios=("block:30",), options=ON_THE_CELLS.options)
    shortest, _ = shortest_path(make_scenario("block:30"))
    assert on_cells.optima.tolist() == [pytest.approx(shortest)]
    np.testing.assert_allclose(on_cells.gap, outcomes.fitness / shortest - 1.0)


def test_the_page_has_the_gap_of_straight_and_diagonal_steps():
    gaps = []
    for name in ON_THE_CELLS.scenarios:
        scenario = make_problem(name, encoding="walk").scenario
        grid = scenario.map
        ends = [(int(x), len(grid.blocked) - 1 - int(y)) for x, y in (scenario.start, scenario.target)]
        steps = shortest_grid_path(grid.blocked, *ends).length
        gaps.append(100.0 * (steps / shortest_path(scenario)[0] - 1.0))
    page = (Path(__file__).parents[3] / "docs/optimizers.md").read_text(encoding="utf-8")
    assert f"is {np.mean(gaps):.1f} % above the shortest path at any angle" in page
