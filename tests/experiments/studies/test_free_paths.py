"""The table of free paths says what shapes of paths say."""

import numpy as np
import pytest
import shapely

from experiments.documents.suite_page import make_tables
from experiments.studies.learned.suites import HEADLINE
from helpers.shapes import shape
from helpers.stored_runs import cells_of, part_of, stored_run
from swarm_gym.final_repair import final_repair
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import make_scenario
from swarm_gym.worlds import make_problem


def _paths():
    """A path that grazes, one around everything, and one straight through all obstacles."""
    _, way = shortest_path(make_scenario("case3"))
    aside = np.diff(way, axis=0)[0][::-1] * (-1.0, 1.0)
    grazing = way.copy()
    grazing[1:-1] -= 1e-3 * aside / np.hypot(*aside)
    wide = np.array([way[0], (20.0, 900.0), (980.0, 900.0), way[-1]])
    straight = np.stack([np.linspace(way[0, 0], way[-1, 0], 33), np.full(33, way[0, 1])], axis=-1)
    return grazing, wide, straight


def _clearance_after_repair():
    """Mean over the paths of FA-60, by shapely."""
    problem = make_problem("case3")
    obstacles = shapely.union_all([shape(obstacle, 4000) for obstacle in problem.scenario.obstacles])
    repaired = [final_repair(problem, path).path for path in _paths()[:2]]
    return np.mean([shapely.LineString(path).distance(obstacles) for path in repaired])


@pytest.fixture
def rows(database):
    grazing, wide, straight = _paths()
    for controller, paths in {"fixed:60": (wide, grazing), "spsfa-tip": (straight, wide)}.items():
        for seed, path in enumerate(paths):
            key, spent = (controller, "case3", seed), {"evaluations": np.array([0.0, 500.0])}
            database.add(stored_run(key, spent, final_fitness=300.0, best_path=path))
    suite = part_of(HEADLINE, ("fixed:60", "spsfa-tip"), ("case3",), 2, tables=("free-paths",), claims=())
    return cells_of(make_tables(suite, database), "free-paths")


def test_free_paths_are_counted_before_and_after_repair(rows):
    fixed, printed = sorted(rows, key=lambda row: row["controller"])
    assert (fixed["controller"], printed["controller"]) == ("FA-60", "SPSFA-TIP")
    for row in (fixed, printed):
        assert row["strictly free"].startswith("50.0 % [")
        assert row["free after repair"].startswith("100.0 % [")
        assert row["above the shortest"].startswith("+")
    assert fixed["change of length"].startswith("-")
    assert float(fixed["clearance"]) == pytest.approx(_clearance_after_repair(), rel=0.05, abs=1e-9)
    assert printed["planned anew"] in {"0.0 %", "50.0 %"}
