"""The study over terrain: its runs are kept, and its tables count them right."""

import numpy as np
import pytest

from experiments import terrain as command
from experiments.documents.records import records_in
from experiments.studies.terrain import measured_costs
from experiments.studies.terrain.measured_costs import Asked, measure, planned_cost
from experiments.studies.terrain.peers import PEERS, Counted, best_cost
from experiments.studies.terrain.rows import PLANNED, PeerRow, Row, rows
from experiments.studies.terrain.tables_of_costs import tables
from helpers.terrains import rolling_terrain
from swarm_gym.errors import UnknownNameError
from swarm_gym.runs.seeds import TEST
from swarm_gym.scenarios import make_scenario, registry
from swarm_gym.worlds import make_problem

ASKED = Asked("metabox", (100, 200), 3)
ROW = Row("firefly", "waypoints", "guided")


@pytest.fixture
def little_terrain(monkeypatch):
    """Rolling hills by the name `little`."""
    monkeypatch.setitem(registry.SCENARIOS, "little", lambda: rolling_terrain(2))
    return "little"


def test_runs_are_kept_and_better_with_more_evaluations(little_terrain, tmp_path, monkeypatch):
    costs = measure(ROW, little_terrain, ASKED, tmp_path)
    assert costs.shape == (2, 3)
    assert (costs[1] <= costs[0]).all()
    assert costs[0].mean() < planned_cost(little_terrain, "metabox") * 1.5
    monkeypatch.setattr(measured_costs, "run_episodes", None)  # a further run would fail
    np.testing.assert_array_equal(measure(ROW, little_terrain, ASKED, tmp_path), costs)
    monkeypatch.setitem(registry.SCENARIOS, "little", lambda: rolling_terrain(3))
    with pytest.raises(TypeError):
        measure(ROW, little_terrain, ASKED, tmp_path)  # another terrain of the name


def test_tables_have_excess_over_the_best_and_count_firsts():
    one = np.array([[[10.0, 12.0], [10.0, 10.0]], [[40.0, 40.0], [30.0, 20.0]]])
    other = np.array([[[20.0, 20.0], [20.0, 20.0]], [[30.0, 30.0], [25.0, 25.0]]])
    asked = Asked("metabox", (100, 200), 2)
    short, by_terrain = tables({"PSO, one": one, PLANNED: other}, ["a", "b"], asked)
    found = {str(row[0]): [cell.numbers["value"] for cell in row[1:6]] for row in short.rows}
    assert found["PSO, one"] == pytest.approx([55.0, 60.0, 12.5, 0.0, 1])
    assert found[PLANNED] == pytest.approx([75.0, 75.0, 62.5, 62.5, 1])
    assert [str(row[0]) for row in short.rows] == ["PSO, one", PLANNED]
    assert [row[1].numbers["value"] for row in by_terrain.rows] == [10.0, 20.0]


def test_the_best_peer_is_named_and_rows_are_counted_against_it():
    mine = np.array([[[10.0, 12.0]], [[40.0, 40.0]]])
    peer = np.array([[[20.0, 20.0]], [[30.0, 30.0]]])
    measured = {"PSO, one": mine, "pymoo DE, spherical": peer, "niapy PSO, spherical": 9.0 * peer}
    short, _ = tables(measured, ["a", "b"], Asked("metabox", (100,), 2))
    assert "that of pymoo DE, spherical, the library row" in short.caption
    found = {str(row[0]): row[-1].numbers["value"] for row in short.rows}
    assert found == {"PSO, one": 1, "pymoo DE, spherical": 0, "niapy PSO, spherical": 0}


@pytest.mark.parametrize("peer", PEERS)
def test_a_peer_spends_its_evaluations_and_is_the_same_again(peer, little_terrain, tmp_path):
    row = PeerRow(peer, "waypoints")
    costs = measure(row, little_terrain, ASKED, tmp_path)
    problem = make_problem(make_scenario(little_terrain), cost="metabox")
    assert best_cost(peer, problem, 200, TEST[0]) == costs[1, 0]
    assert best_cost(peer, problem, 200, TEST[1]) != costs[1, 0]
    counted = Counted(problem, 200)
    PEERS[peer](counted, 1)
    assert counted.left == 0


def test_rows_have_names_of_their_own():
    assert len({row.name for row in rows()}) == len(rows()) == 16 + 2 * len(PEERS)


def test_the_command_refuses_by_name(tmp_path):
    with pytest.raises(ValueError, match="--rows nothing: no row has such a name"):
        command.write(command.TerrainConfig(output=tmp_path, rows=("nothing",)))
    with pytest.raises(UnknownNameError, match="cheap"):
        command.write(command.TerrainConfig(output=tmp_path, cost="cheap"))


def test_the_command_writes_its_tables(little_terrain, tmp_path):
    config = command.TerrainConfig(
        output=tmp_path,
        terrains=(little_terrain,),
        evaluations=(100,),
        runs=2,
        rows=("fireflies, waypoints",),
    )
    files = command.write(config)
    assert [file.name for file in files] == ["metabox-in-short.md", "metabox-by-terrain.md"]
    text = files[0].read_text(encoding="utf-8")
    assert "fireflies, waypoints, guided" in text
    assert PLANNED in text
    assert "little" in files[1].read_text(encoding="utf-8")
    (record,) = records_in(tmp_path)
    assert record.commits
    assert "fireflies, waypoints, guided" in record.digests
