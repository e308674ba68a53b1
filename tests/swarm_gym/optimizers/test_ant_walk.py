"""Walks of ants over free cells: no corner is cut, no loop is left, dead ends are left again."""

import numpy as np
import pytest

from helpers.ants import MAPS, NAME, cells_of, length_of, optimum_of, path_of, problem_of
from helpers.builders import advance, begin
from swarm_gym.optimizers.ant_colony.ant_colony import AntColony
from swarm_gym.problem import WalkProblem
from swarm_gym.problem.geometry.traversal import path_is_free
from swarm_gym.reference import shortest_grid_path
from swarm_gym.scenarios import GridMap, GridScenario

on_maps = pytest.mark.parametrize("problem", MAPS.values(), ids=MAPS)


@on_maps
def test_best_paths_are_free_ways_without_loops_that_cost_their_length(problem):
    grid = problem.scenario.map
    swarms, tables = begin(NAME, [problem], size=12)
    for _ in range(12):
        path = path_of(swarms, problem)
        cells = cells_of(path, problem)
        assert path[0].tolist() == list(problem.scenario.start)
        if swarms.best_collision[0] == 0.0:
            # No corner is cut: the traversal is exact.
            assert path_is_free(grid.blocked, grid.to_cells(path))
            assert swarms.best_fitness[0] == pytest.approx(length_of(path), rel=1e-12)
        steps = np.abs(np.diff(cells[:-1], axis=0))
        assert ((steps.max(axis=1) == 1) if len(steps) else True).all()
        assert all(grid.is_free(cell) for cell in cells)
        assert len(set(cells)) == len(cells)
        advance(NAME, swarms, tables, 12, 0.0)
    assert swarms.best_collision[0] == 0.0


@on_maps
def test_no_path_passes_a_cell_that_it_could_have_gone_to_before(problem):
    """Loops are cut out: two cells of a path that are neighbours follow each other."""
    grid = problem.scenario.map
    swarms, tables = begin(NAME, [problem], size=6)
    for _ in range(5):
        cells = cells_of(path_of(swarms, problem), problem)
        for i, (column, row) in enumerate(cells):
            for to_column, to_row in cells[i + 2 :]:
                near = max(abs(to_column - column), abs(to_row - row)) <= 1
                open_corners = grid.is_free((column, to_row)) and grid.is_free((to_column, row))
                assert not (near and open_corners)
        advance(NAME, swarms, tables, 6, 0.0)


@on_maps
def test_members_are_ants_that_arrived_or_ended_in_a_free_cell(problem):
    grid, target = problem.scenario.map, np.array(problem.scenario.target)
    swarms, tables = begin(NAME, [problem], size=20)
    arrived = 0
    for _ in range(6):
        for i in range(20):
            position = swarms.positions[0, i, :2]
            left, collision = problem.evaluate(position)
            assert swarms.collision[0, i] == collision
            assert swarms.fitness[0, i] >= left + np.hypot(*(position - problem.scenario.start)) - 1e-9
            assert grid.is_free(grid.cell_of(position.tolist()))
            if (position == target).all():
                arrived += 1
                assert collision == 0.0
            else:
                cell = np.array(grid.to_cells(position))
                assert cell == pytest.approx(np.round(cell), abs=1e-9)
        assert (swarms.positions[0, :, 2:] == 0.0).all()
        advance(NAME, swarms, tables, 20, 0.0)
    assert arrived > 60


def test_ants_step_back_out_of_a_dead_end():
    problem = problem_of(
        """
        #########
        #....####
        #S##.###T
        #.#...##.
        #.#####..
        #.......#
        #########
        """
    )
    swarms, _ = begin(NAME, [problem], size=32)
    fitness = swarms.fitness[0, :32]
    assert (swarms.collision[0, :32] == 0.0).all()
    # There is one way only, with a corner to choose.
    assert fitness == pytest.approx(optimum_of(problem), rel=1e-12)


def test_an_ant_that_can_go_nowhere_gives_up_at_the_start():
    problem = problem_of("S... #... ...T")
    swarms, tables = begin(NAME, [problem], size=3)
    tables.blocked[0, 0, 1] = True  # as no scenario may have it
    before = swarms.stream[0].copy()
    advance(NAME, swarms, tables, 3, 0.0)
    assert (swarms.positions[0, :3, :2] == problem.scenario.start).all()
    assert (swarms.stream[0] == before).all()
    assert swarms.evaluations[0] == 6


def test_corners_are_not_cut_even_where_that_is_the_only_way():
    problem = problem_of(
        """
        S.....
        ......
        ......
        ...T..
        """
    )
    swarms, tables = begin(NAME, [problem], size=2)
    tables.blocked[0, :2, 2], tables.blocked[0, 2:, 1] = True, True  # as no scenario may have it
    for _ in range(4):
        advance(NAME, swarms, tables, 30, 0.0)
        assert (swarms.positions[0, :30, 0] <= 1.0).all()


def test_start_and_target_in_one_cell_are_joined_by_the_straight_line():
    grid = GridMap("small", np.zeros((3, 4), np.bool_))
    problem = WalkProblem(GridScenario("near", grid, (1.2, 1.0), (0.8, 1.1)))
    swarms, tables = begin(NAME, [problem], size=4)
    advance(NAME, swarms, tables, 4, 0.0)
    assert swarms.fitness[0, :4].tolist() == [problem.scenario.straight_line] * 4
    assert swarms.best_walk[0] == 1
    assert swarms.walk[0, 0].tolist() == [1.2, 1.0]
    assert swarms.evaluations[0] == 8


def test_ants_take_four_times_width_and_height_steps_and_no_more():
    """A winding corridor, one cell wide, is longer than the limit."""
    width, height = 20, 41
    blocked = np.zeros((height, width), np.bool_)
    blocked[1::4, :-1] = blocked[3::4, 1:] = True
    problem = WalkProblem(
        GridScenario("winding", GridMap("winding", blocked), (0, 0), (width - 1, height - 1))
    )
    grid = problem.scenario.map
    way = shortest_grid_path(blocked, (0, 0), (width - 1, height - 1)).cells
    swarms, tables = begin(NAME, [problem], size=5)
    assert len(way) > 4 * (width + height) + 1 == AntColony.walk_points(tables, 10)
    assert [grid.cell_of(p) for p in swarms.positions[0, :5, :2].tolist()] == [
        tuple(way[4 * 61].tolist())
    ] * 5
