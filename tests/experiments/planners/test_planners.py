"""Planners beside the swarms: tasks, validation by shapely, tables of runs known by hand, and a small run."""

import json
from pathlib import Path

import numpy as np
import pytest

from experiments.documents.records import records_in, short_commit
from experiments.planners.__main__ import PlannersConfig, compare
from experiments.planners.found import Found, Valid, validate
from experiments.planners.measuring import AFTER_EVENTS, ON_MAPS, PlannerRun, read
from experiments.planners.short_tables import COLUMNS, PLANNING, REPLANNING
from experiments.planners.tables import length_above, seconds_to_near, tables
from experiments.planners.tasks import draw_tasks, replanning_task
from helpers.ompl import require_ompl
from swarm_gym.errors import UnknownNameError
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import GridMap, GridScenario

ROOT = Path(__file__).parents[3]
WALL = np.zeros((5, 9), dtype=np.bool_)
WALL[1:, 4] = True
SCENARIO = GridScenario("wall", GridMap("wall", WALL, resolution=0.5), (0.0, 1.0), (4.0, 1.0))
OVER = np.array([(0.0, 1.0), (1.75, 0.25), (2.25, 0.25), (4.0, 1.0)])


def test_tasks_are_the_same_for_a_seed_and_have_the_length_of_the_exact_path():
    tasks = draw_tasks("generated rooms", 3, 5)
    assert tasks == draw_tasks("generated rooms", 3, 5) != draw_tasks("generated rooms", 3, 6)
    for task in tasks:
        assert task.optimum == shortest_path(task.scenario)[0] >= task.scenario.straight_line


def test_a_free_path_is_measured_in_map_units_and_its_clearance_in_cells():
    valid = validate(SCENARIO, Found(0.5, OVER, True))
    assert valid == Valid(
        0.5, pytest.approx(0.5 + 2 * np.hypot(1.75, 0.75)), pytest.approx(0.0, abs=1e-9), True
    )
    higher = np.array([(0.0, 1.0), (1.75, 0.0), (2.25, 0.0), (4.0, 1.0)])
    assert validate(SCENARIO, Found(0.5, higher)).clearance == pytest.approx(
        0.5 * np.cos(np.arctan(2.0 / 3.5))
    )


@pytest.mark.parametrize(
    "path",
    [
        [(0.0, 1.0), (4.0, 1.0)],  # through the wall
        [(0.0, 1.0), (1.75, 0.25), (2.25, 0.26), (4.0, 1.0)],  # grazes its corner
        [(0.0, 1.0), (1.75, -0.5), (2.25, -0.5), (4.0, 1.0)],  # leaves the map
        OVER[:-1],  # ends before the target
        OVER[1:],  # begins after the start
    ],
)
def test_a_path_that_is_not_free_or_has_other_ends_is_refused(path):
    assert validate(SCENARIO, Found(0.1, np.array(path))) is None


def run_of(planner, *found, task=0, seed=0):
    return PlannerRun("rooms", task, planner, seed, 10.0, tuple(Valid(*one, 0.2, None) for one in found), 0)


def test_lengths_and_times_are_of_what_was_found_by_then():
    run = run_of("exact, any angle", (0.1, 15.0), (0.4, 10.1))
    assert [length_above(run, seconds) for seconds in (0.05, 0.1, 1.0)] == pytest.approx([np.inf, 0.5, 0.01])
    assert seconds_to_near(run) == 0.4
    assert seconds_to_near(run_of("A*, smoothed", (0.1, 15.0))) == np.inf


def test_differences_are_negative_where_the_swarm_is_shorter_and_a_miss_counts_twice_the_optimum():
    runs = [run_of(name, (0.1, 11.0), task=task) for name in ON_MAPS for task in (0, 1)]
    swarm = ON_MAPS[0]
    runs = [run for run in runs if run.planner != swarm]
    runs += [run_of(swarm, (0.1, 10.5)), run_of(swarm, task=1)]
    overall, _, differences = tables(runs, (0.2, 1.0))
    (row,) = (row for row in differences.rows if row[:2] == (swarm, "A*, smoothed"))
    assert row[2].numbers["value"] == pytest.approx((-0.05 + 0.9) / 2)
    (row,) = (row for row in overall.rows if row[0] == swarm)
    assert row[2].numbers["value"] == 0.5
    assert row[3].numbers["value"] == pytest.approx(0.05)


def test_a_small_comparison_has_free_paths_only_and_goes_on_where_it_stopped(tmp_path):
    require_ompl()
    config = PlannersConfig(tmp_path, ("caves",), tasks=1, seeds=1, seconds=(0.1, 0.2))
    assert all(file.exists() for file in compare(config))
    runs = read(tmp_path / "planning.jsonl")
    assert {run.planner for run in runs} == set(ON_MAPS)
    assert sum(run.refused for run in runs) == 0
    (exact,) = (run for run in runs if run.kind == "caves" and run.planner == "exact, any angle")
    assert length_above(exact, 10.0) == pytest.approx(0.0, abs=1e-9)
    before = (tmp_path / "planning.jsonl").read_text()
    compare(config)
    assert (tmp_path / "planning.jsonl").read_text() == before
    first = json.loads(before.splitlines()[0])
    assert first["found"]
    assert [*records_in(tmp_path)[0].commits] == [short_commit(first["commit"])]


def test_an_unknown_kind_of_map_is_refused_with_the_known_ones(tmp_path):
    with pytest.raises(UnknownNameError, match=r"'office'.*caves"):
        compare(PlannersConfig(tmp_path / "none", ("office",)))
    assert not (tmp_path / "none").exists()


def test_times_that_do_not_grow_are_refused(tmp_path):
    with pytest.raises(ValueError, match=r"growing.*\(0.5, 0.1\)"):
        compare(PlannersConfig(tmp_path / "none", seconds=(0.5, 0.1)))
    assert not (tmp_path / "none").exists()


def test_in_tasks_of_replanning_an_obstacle_is_on_the_previous_path_and_leaves_a_longer_one():
    tasks = draw_tasks("caves", 4, 3, replanning_task)
    assert tasks == draw_tasks("caves", 4, 3, replanning_task)
    for task in tasks:
        assert validate(task.scenario, Found(0.0, task.previous)) is None
        previous = float(np.hypot(*np.diff(task.previous, axis=0).T).sum())
        assert task.optimum == shortest_path(task.scenario)[0] > previous
        np.testing.assert_allclose(task.previous[[0, -1]], [task.scenario.start, task.scenario.target])


def test_a_small_comparison_of_replanning_has_free_paths_of_every_planner(tmp_path):
    require_ompl()
    config = PlannersConfig(tmp_path, ("generated rooms",), 1, 1, replanning=True, seconds=(0.2, 0.4))
    files = compare(config)
    assert [file.name for file in files] == ["replanning.md", "replanning-differences.md"]
    runs = read(tmp_path / "replanning.jsonl")
    assert {run.planner for run in runs} == set(AFTER_EVENTS)
    assert sum(run.refused for run in runs) == 0
    for name in ("exact, any angle, map prepared anew", "swarm, fixed size, from the previous path"):
        (run,) = (run for run in runs if run.planner == name)
        assert 0.0 <= length_above(run, 10.0) + 1e-9 < 0.2


def rows_of_block(page, name):
    """Return the rows of a block of a page, as cells by heads."""
    block = (
        (ROOT / page).read_text(encoding="utf-8").split(f"<!-- {name} -->\n")[1].split(f"<!-- /{name} -->")[0]
    )
    cells = [line[2:-2].split(" | ") for line in block.splitlines() if line.startswith("| ")]
    return [dict(zip(cells[0], row, strict=True)) for row in cells[2:]]


@pytest.mark.parametrize(("name", "planners"), [("planners", PLANNING), ("replanning", REPLANNING)])
def test_the_page_shows_rows_of_its_appendix(name, planners):
    everything = {row["planner"]: row for row in rows_of_block("docs/planners-tables.md", name)}
    shown = [{column: everything[planner][column] for column in COLUMNS} for planner in planners]
    assert rows_of_block("docs/planners.md", name) == shown
