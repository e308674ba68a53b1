"""Tables and figures of Brand and Yu's paper say what the runs say."""

import dataclasses
from math import acos, degrees, hypot, sqrt

import numpy as np
import pytest
from scipy import stats

from experiments.catalogue import SUITES
from experiments.documents.figures import plan
from experiments.documents.suite_page import make_tables
from experiments.runs.run import Snapshot
from experiments.studies.brand_yu.suites import ANTS, FEW, TABLE_1
from helpers.stored_runs import cells_of, line, part_of, printed_rows, stored_run
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE

STATIC, DYNAMIC, GRIDS = (SUITES[f"brand-yu-{name}"] for name in ("static", "dynamic", "grids"))
TEN, NONE, ONE, MANY = (f"glowworm+fixed:{count}" for count in (10, 65, 11, 122))


def made_run(key, trajectory=(), path=(), collision=99.0, seconds=0.1, fitness=1.0, snapshots=(), **courses):
    """A run with these courses; the others are 0."""
    trajectory, path = (np.array(points, dtype=np.float64).reshape(-1, 2) for points in (trajectory, path))
    of = {"final_fitness": fitness, "final_collision": collision, "seconds": seconds, "snapshots": snapshots}
    return stored_run(key, courses, best_path=path, trajectory=trajectory, **of)


def kinked(start, target, length):
    """Return a trajectory of that length with one turn in its middle."""
    (a, b), (x, y) = start, np.subtract(target, start)
    aside = sqrt(length**2 - x**2 - y**2) / 2.0 / hypot(x, y)
    return np.array([(a, b), (a + x / 2.0 + aside * y, b + y / 2.0 - aside * x), target])


def claims_of(tables, name):
    return {row["claim"]: (row["holds"], row["does not hold"]) for row in cells_of(tables, name)}


# Table 1.


def test_the_papers_numbers_are_those_printed():
    assert list(TABLE_1) == [10, 26, 65, 122, 626]
    assert [row.length for row in TABLE_1.values()] == [449, 430, 435, 447, 443]
    assert [row.seconds for row in TABLE_1.values()] == [14.2, 14.3, 18.0, 49.8, 1088.3]


START, TARGET = (25.0, 5.0), (25.0, 45.0)
LENGTHS = {TEN: (50.0, 52.0, 54.0), NONE: (), ONE: (48.0,), FEW: (43.0, 43.5, 44.0, 45.0)}
LENGTHS[MANY] = (45.0, 46.0, 46.2, 46.4)
CROWD = np.arange(24.0).reshape(3, 4, 1, 2)  # three populations of four


def turn_of(length):
    return degrees(2.0 * acos(40.0 / length))


@pytest.fixture
def static(database):
    """Four runs each on 50 x 50 cells; those without a length stop far from the target."""
    kept = tuple(Snapshot(k, at, np.zeros(4)) for k, at in zip((0, 50, 90), CROWD, strict=True))
    for controller, lengths in LENGTHS.items():
        for seed in range(4):
            there = seed < len(lengths)
            gone = kinked(START, TARGET, lengths[seed]) if there else kinked(START, (0.0, 9.0), 900.0)
            course = np.full(121, np.nan)  # of a run that may end before the last iteration
            course[: 31 + 10 * seed if there else 121] = 1.0
            # The best path says nothing of where the robot has come to.
            of = {"collision": 99.0 if there else 0.0, "seconds": 0.1 * (seed + 1), "snapshots": kept}
            database.add(made_run((controller, "block:50", seed), gone, gone, best_fitness=course, **of))
    return part_of(STATIC, LENGTHS, ("block:50",), 4, snapshots=((TEN, "block:50", 0, (0, 90)),))


@pytest.mark.slow
def test_counts_are_means_of_the_runs_that_arrived_beside_the_papers(database, static):
    ten, none, one, few, many = cells_of(make_tables(static, database), "brand-yu-static-counts")
    optimum = hypot(6.5, 16.5) + 6.0 + hypot(6.5, 17.5)  # around the right end of the block
    of_runs = ("arrived", "mean length", "above the shortest", "iterations", "turning, degrees", "seconds")
    turning = np.mean([turn_of(length) for length in LENGTHS[TEN]])
    expected = ["3 of 4", "52.0", f"{100.0 * (52.0 / optimum - 1.0):.1f} %", "40", f"{turning:.0f}", "0.250"]
    assert ten["fireflies"] == "10"
    assert [ten[column].partition(" [")[0] for column in of_runs] == expected
    assert few["above the shortest"] == f"{100.0 * (43.875 / optimum - 1.0):.1f} %"
    assert [none[column] for column in of_runs] == ["0 of 4", "–", "–", "–", "–", "0.250"]
    assert [one[column] for column in of_runs] == [
        "1 of 4", "48.0", f"{100.0 * (48.0 / optimum - 1.0):.1f} %", "30", f"{turn_of(48.0):.0f}", "0.250",
    ]  # fmt: skip
    printed = [(row["length, paper"], row["seconds, paper"]) for row in (ten, none, one, few, many)]
    assert printed == [("449", "14.2"), ("435", "18.0"), ("–", "–"), ("430", "14.3"), ("447", "49.8")]


@pytest.mark.slow
def test_claims_about_counts_say_where_they_do_not_hold(database, static):
    missing = "10 fireflies, 65 fireflies, 11 fireflies"
    assert claims_of(make_tables(static, database), "brand-yu-static-claims") == {
        "all runs arrive": ("2 of 5", missing),
        "mean length within 8 % of the shortest possible": ("1 of 5", f"{missing}, 122 fireflies"),
    }
    (turning,) = cells_of(make_tables(static, database), "claims")
    assert (turning["measure"], turning["holds"]) == ("turning", "yes")
    suite = dataclasses.replace(static, controllers=(TEN, FEW))
    assert "claims" not in {table.name for table in make_tables(suite, database)}


def test_ways_are_drawn_as_the_robots_went(database, static):
    drawings = plan(static, database)
    first, second, *_ = drawings["ways-block:50"]().axes
    assert first.get_title() == f"10 fireflies: length 50.0, turns {turn_of(50.0):.0f}°"
    assert second.get_title().startswith("65 fireflies: length 900.0, turns ")
    np.testing.assert_array_equal(line(first, "way of the robot").T, kinked(START, TARGET, 50.0))
    around = [START, (31.5, 21.5), (31.5, 27.5), TARGET]
    np.testing.assert_allclose(line(first, "shortest path, 42.4").T, around)
    np.testing.assert_array_equal(line(first, "at first").T, CROWD[0, :, 0])
    np.testing.assert_array_equal(line(first, "after iteration 90").T, CROWD[2, :, 0])
    assert not any("iteration" in text for text in second.get_legend_handles_labels()[1])


# By seed: places of robots when the block appears, and length from there relative to the shortest path.
PLACES = ((240.0, 200.0), (262.0, 235.0), (180.0, 100.0), (300.0, 60.0))
FACTORS = {TEN: (1.01, 1.04, 1.12), MANY: (1.30, 1.02, 1.02, 1.20)}


def least_around(x, y):
    """From there to (250, 450), around either end of a block of columns 175 to 324 and rows 270 to 329."""
    return 60.0 + min(hypot(x - end, 269.5 - y) + hypot(250.0 - end, 120.5) for end in (174.5, 324.5))


def test_where_the_map_changes_the_least_is_what_was_gone_and_the_shortest_from_there(database):
    """Robots go astray until the block appears after three iterations; of ten fireflies one never arrives."""
    name, lengths = "dynamic:open:500-block@3", {TEN: [], MANY: []}
    for controller, factors in FACTORS.items():
        for seed, (place, factor) in enumerate(zip(PLACES, (*factors, 9.0), strict=False)):
            gone, least = [(250.0, 50.0), (220.0, 80.0), (250.0, 110.0), place], least_around(*place)
            there, before = seed < len(factors), 60.0 * sqrt(2.0) + hypot(place[0] - 250.0, place[1] - 110.0)
            rest = kinked(place, (250.0, 450.0 if there else 449.0), factor * least)[1:]
            database.add(made_run((controller, name, seed), [*gone, *rest], best_fitness=np.ones(9)))
            if there:
                lengths[controller].append((before + factor * least, before + least))
    tables = make_tables(part_of(DYNAMIC, FACTORS, (name,), 4), database)
    for row, found in zip(cells_of(tables, "brand-yu-dynamic-counts"), lengths.values(), strict=True):
        length, least = np.mean(found, axis=0)
        assert row["arrived"] == f"{len(found)} of 4"
        assert row["mean length"].startswith(f"{length:.1f} [")
        assert row["above the shortest"] == f"{100.0 * (length / least - 1.0):.1f} %"
        assert length > 1.08 * least_around(250.0, 50.0)
    assert claims_of(tables, "brand-yu-dynamic-claims") == {
        "all runs arrive": ("1 of 2", "10 fireflies"),
        "mean length within 8 % of the shortest possible": ("1 of 2", "122 fireflies"),
    }
    (turning,) = cells_of(tables, "claims")
    assert turning["holds"] == "**no**"
    assert f"whose shortest path is {least_around(250.0, 50.0):.1f}" in tables[1].caption


# Growing grids: ants are exact powers of the side, fireflies are so but for the same factors on all of them.
SIDES = np.array([50, 100, 200, 400])
SPREAD = np.array([0.97, 0.98, 1.00, 1.05])
MADE = {FEW: (1.07 * SIDES, 8e-4 * SIDES), ANTS: (0.678 * SIDES**1.1, 1e-4 * SIDES**1.5)}
ASIDE = SIDES * 65 // 100 - SIDES // 2  # from the middle column to the first one right of the block
OCTILE = 0.8 * SIDES + (sqrt(2.0) - 1.0) * 2 * ASIDE
STRAIGHT = (
    np.hypot(ASIDE - 0.5, 0.34 * SIDES - 0.5) + 0.12 * SIDES + np.hypot(ASIDE - 0.5, 0.34 * SIDES + 0.5)
)


@pytest.fixture
def grids(database):
    """Four runs each; one of the ants on 200 x 200 cells has found no path."""
    for (controller, made), by_spread in zip(MADE.items(), (1.0, 0.0), strict=True):
        for k, seed in np.ndindex(4, 4):
            lost = (controller, k, seed) == (ANTS, 2, 3)
            length, seconds = (values[k] * SPREAD[seed] ** by_spread for values in made)
            start, target = (SIDES[k] / 2.0, SIDES[k] * 0.1), (SIDES[k] / 2.0, SIDES[k] * 0.9)
            path = kinked(start, target, 900.0 if lost else length)
            key, gone = (controller, f"block:{SIDES[k]}", seed), path if controller == FEW else ()
            collision = FEASIBILITY_TOLERANCE * (1.5 if lost or controller == FEW else 0.5)
            database.add(made_run(key, gone, path, collision, seconds))
    return part_of(GRIDS, GRIDS.controllers, [f"block:{side}" for side in SIDES], 4)


def test_lengths_on_grids_are_beside_the_shortest(database, grids):
    tables = make_tables(grids, database)
    rows = cells_of(tables, "brand-yu-grids-lengths")
    assert [row["grid"] for row in rows] == [f"{side} x {side}" for side in SIDES for _ in MADE]
    for number, row in enumerate(rows):
        k, (length, seconds) = number // 2, list(MADE.values())[number % 2]
        assert row["method"] == ("glowworms", "ants")[number % 2]
        assert row["arrived"] == ("3 of 4" if number == 5 else "4 of 4")
        assert row["mean length"].startswith(f"{length[k]:.1f} [")
        assert row["above shortest path"] == f"{100.0 * (length[k] / STRAIGHT[k] - 1.0):.1f} %"
        assert row["against octile"] == f"{100.0 * (length[k] / OCTILE[k] - 1.0):+.1f} %"
        assert row["seconds"] == f"{seconds[k]:.3f}"
    assert list(claims_of(tables, "brand-yu-grids-claims").values()) == [
        ("3 of 4", "200 x 200"),  # all ants arrive
        ("1 of 3", "100 x 100, 200 x 200"),  # at most 10 % above octile: +9.5, +16.3 and +24.6 %
    ]
    shorter, faster = ([row for row in cells_of(tables, "claims") if row["measure"] == measure]
                       for measure in ("way", "seconds"))  # fmt: skip
    # Ways of all ants are shorter than those of fireflies, between them, longer.
    assert [(row["scenarios"], row["holds"]) for row in shorter] == [
        ("block:50", "**no**"), ("block:100", "**no**"), ("block:200", "yes")
    ]  # fmt: skip
    assert [row["holds"] for row in faster] == ["yes", "**no**", "**no**"]


def test_exponents_are_those_of_the_powers(database, grids):
    few, ants = (row[1:] for row in printed_rows(make_tables(grids, database)[2]))
    assert ants == ("1.10", "[1.10, 1.10]", "1.50", "[1.50, 1.50]")
    _, covariance = np.polyfit(
        np.log(np.repeat(SIDES, 4)), np.log(np.outer(SIDES, SPREAD).ravel()), 1, cov=True
    )
    margin = stats.t.ppf(0.975, 14) * sqrt(covariance[0, 0])
    assert few[:2] == few[2:] == ("1.00", f"[{1.0 - margin:.2f}, {1.0 + margin:.2f}]")


def test_lengths_and_times_are_drawn_against_the_side(database, grids):
    lengths, times = plan(grids, database)["grids"]().axes
    for axes, number in ((lengths, 0), (times, 1)):
        few = line(axes, "glowworms, 26 members")
        ants = line(axes, "ants, 50 members, 100 iterations")
        np.testing.assert_allclose(few, [SIDES, MADE[FEW][number]])
        np.testing.assert_allclose(ants[:, [0, 1, 3]], [SIDES[[0, 1, 3]], MADE[ANTS][number][[0, 1, 3]]])
        heights = axes.collections[0].get_paths()[0].vertices[:, 1]
        assert (heights.min(), heights.max()) == pytest.approx(MADE[FEW][number][[0, 3]] * SPREAD[[0, 3]])
    np.testing.assert_allclose(line(lengths, "shortest path"), [SIDES, STRAIGHT])
