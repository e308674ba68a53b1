"""The study over terrain: its runs are kept, and its tables count them right."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from experiments import terrain as command
from experiments.documents.records import records_in
from experiments.studies import libraries
from experiments.studies.libraries import run_peer
from experiments.studies.terrain import best_known, library_runs, measured_costs
from experiments.studies.terrain.controllers_of_terrain import (
    EVALUATIONS,
    controller_of,
    learned_rows,
    rows,
    rule_rows,
)
from experiments.studies.terrain.measured_costs import Asked, measure
from experiments.studies.terrain.rows import PEERS, PLANNED, SIZES, ControlledRow, PeerRow, PlannedRow, Row
from experiments.studies.terrain.table_of_control import objective, table_of_control
from experiments.studies.terrain.tables_of_costs import best_costs, tables
from helpers.terrains import rolling_terrain
from swarm_gym.errors import UnknownNameError
from swarm_gym.problem import TerrainProblem
from swarm_gym.rollout import run_episodes
from swarm_gym.runs.seeds import TEST
from swarm_gym.scenarios import TerrainScenario, make_scenario, registry
from swarm_gym.worlds import make_problem

ASKED = Asked("metabox", (100, 200), 3, 3)
# Other tests fly by this optimizer, too, so that it is compiled.
ROW = Row("firefly", "waypoints", "guided")
NONE = np.full(2, np.inf)
EVEN = PLANNED["waypoints"]


@pytest.fixture
def little_terrain(monkeypatch):
    """Rolling hills by the name `little`."""
    monkeypatch.setitem(registry.SCENARIOS, "little", lambda: rolling_terrain(2))
    return "little"


def test_runs_are_kept_and_better_with_more_evaluations(little_terrain, tmp_path, monkeypatch):
    costs = measure(ROW, little_terrain, ASKED, tmp_path)
    assert costs.shape == (2, 3)
    assert (costs[1] <= costs[0]).all()
    planned = measure(PlannedRow(), little_terrain, ASKED, tmp_path)
    assert planned.shape == (2, 1)
    assert costs[0].mean() < planned[0, 0] * 1.5
    monkeypatch.setattr(measured_costs, "run_episodes", None)  # a further run would fail
    monkeypatch.setattr(measured_costs, "flight_ways", None)  # a further plan, too
    np.testing.assert_array_equal(measure(ROW, little_terrain, ASKED, tmp_path), costs)
    np.testing.assert_array_equal(measure(PlannedRow(), little_terrain, ASKED, tmp_path), planned)
    monkeypatch.setitem(registry.SCENARIOS, "little", lambda: rolling_terrain(3))
    with pytest.raises(TypeError):
        measure(ROW, little_terrain, ASKED, tmp_path)  # another terrain of the name


def test_runs_of_several_controllers_follow_one_another(little_terrain, tmp_path):
    rule = ControlledRow("two", "firefly", "guided", ("fixed:20", "fixed:30"), 200, 50)
    costs = measure(rule, little_terrain, ASKED, tmp_path)
    assert costs.shape == (2, 6)
    constant = measure(ROW, little_terrain, ASKED, tmp_path)
    np.testing.assert_array_equal(costs[1, :3], constant[1])
    assert (costs[1, 3:] != constant[1]).any()
    fewer = ASKED._replace(policy_runs=2)
    assert measure(rule, little_terrain, fewer, tmp_path).shape == (2, 6)  # no policies
    policies = measure(rule._replace(label="learned"), little_terrain, fewer, tmp_path)
    np.testing.assert_array_equal(policies[1], costs[1, [0, 1, 3, 4]])


TWO = ControlledRow("two", "firefly", "guided", ("fixed:20", "fixed:30"))


@pytest.mark.parametrize("row", [ROW, PeerRow("pymoo DE", "spherical"), TWO])
def test_more_runs_are_added_to_those_that_are_stored(row, little_terrain, tmp_path, monkeypatch):
    more = Asked("metabox", (200,), 5, 5)
    fewer = more._replace(runs=2, peer_runs=2)
    at_once = measure(row, little_terrain, more, tmp_path / "once")
    first = measure(row, little_terrain, fewer, tmp_path / "steps")
    seeds, flights = [], measured_costs._flights

    def noted(*given):
        seeds.extend(given[-1])
        return flights(*given)

    monkeypatch.setattr(measured_costs, "_flights", noted)
    np.testing.assert_array_equal(measure(row, little_terrain, more, tmp_path / "steps"), at_once)
    assert seeds == [2, 3, 4]
    np.testing.assert_array_equal(measure(row, little_terrain, fewer, tmp_path / "steps"), first)
    assert seeds == [2, 3, 4]  # fewer are read, too
    (once,) = (tmp_path / "once").glob("*-5.json")
    (steps,) = (tmp_path / "steps").glob("*-5.json")
    stored = [json.loads(file.read_text(encoding="utf-8")) for file in (once, steps)]
    assert stored[0]["flight"] == stored[1]["flight"]


def test_kept_runs_of_a_library_are_taken_and_further_ones_are_made(little_terrain, tmp_path, monkeypatch):
    row, file = PeerRow("pymoo DE", "spherical"), tmp_path / "kept.csv"
    asked = Asked("metabox", (200,), 5, 5)
    three, two = asked._replace(peer_runs=3), asked._replace(peer_runs=2)
    costs, used = measure(row, little_terrain, asked, tmp_path / "all"), set()
    measure(row, little_terrain, three, tmp_path / "three", used)
    measure(ROW, little_terrain, asked, tmp_path / "three", used)
    assert library_runs.keep(used, [row.name], file) == 0  # of too few evaluations
    monkeypatch.setattr(library_runs, "LEAST_EVALUATIONS", 200)
    assert library_runs.keep(used, [row.name], file) == 1
    fewer = set()
    measure(row, little_terrain, two, tmp_path / "two", fewer)
    assert library_runs.keep(fewer, [row.name], file) == 0

    monkeypatch.setattr(measured_costs, "kept_runs", partial(library_runs.kept_runs, file=file))
    seeds, flights = [], measured_costs._flights

    def noted(*given):
        seeds.extend(given[-1])
        return flights(*given)

    monkeypatch.setattr(measured_costs, "_flights", noted)
    for some in (two, three):
        again = measure(row, little_terrain, some, tmp_path / "again")
        np.testing.assert_array_equal(again, costs[:, : some.peer_runs])
    assert seeds == []
    new = set()
    np.testing.assert_array_equal(measure(row, little_terrain, asked, tmp_path / "again", new), costs)
    assert seeds == [3, 4]
    assert library_runs.keep(new, [row.name], file) == 1
    seeds.clear()
    np.testing.assert_array_equal(measure(row, little_terrain, asked, tmp_path / "kept"), costs)
    assert best_known.collect(tmp_path / "kept", [little_terrain], tmp_path / "known.json") == []  # no flight
    assert seeds == []
    monkeypatch.setitem(registry.SCENARIOS, "little", lambda: rolling_terrain(3))
    measure(row, little_terrain, two, tmp_path / "kept")
    assert seeds == [0, 1]  # another terrain of the name


@pytest.mark.parametrize("row", [ROW, PlannedRow(), PlannedRow("shifted"), PeerRow("pymoo DE", "spherical")])
def test_the_best_flight_of_runs_is_kept_and_replaces_a_worse_one(row, little_terrain, tmp_path):
    runs, file = tmp_path / "runs", tmp_path / "known.json"
    asked = Asked("metabox", (200,), 2, 2)
    costs = measure(row, little_terrain, asked, runs)
    assert best_known.collect(runs, [], file) == []  # of terrains that are asked for only
    assert best_known.collect(runs, [little_terrain], file) == [little_terrain]
    kept = best_known.best_known("metabox", file)[little_terrain]
    assert kept["cost"] == costs.min()
    assert kept["found_by"] == f"{row.name}, 200 evaluations"
    assert kept["replaces"] == ""
    problem = make_problem(make_scenario(little_terrain), encoding=kept["encoding"], cost="metabox")
    assert problem.evaluate(np.array(kept["vector"]))[0] == kept["cost"]
    assert best_known.collect(runs, [little_terrain], file) == []  # none is better
    worse = {**kept, "cost": 2.0 * kept["cost"], "found_by": "a worse one"}
    file.write_text(json.dumps({"metabox": {little_terrain: worse}}), encoding="utf-8")
    assert best_known.collect(runs, [little_terrain], file) == [little_terrain]
    again = best_known.best_known("metabox", file)[little_terrain]
    assert again["replaces"] == f"{worse['cost']}, a worse one"
    np.testing.assert_array_equal(
        best_known.least_costs("metabox", [little_terrain, "other"], file), [kept["cost"], np.inf]
    )


def test_a_flight_that_does_not_cost_what_is_stored_is_refused(little_terrain, tmp_path):
    measure(PlannedRow(), little_terrain, Asked("metabox", (200,), 1, 1), tmp_path)
    (file,) = tmp_path.glob("*.json")
    stored = json.loads(file.read_text(encoding="utf-8"))
    stored["costs"] = [0.5 * stored["costs"][0]]
    file.write_text(json.dumps(stored), encoding="utf-8")
    with pytest.raises(ValueError, match=r"planned-flight.*delete the file"):
        best_known.collect(tmp_path, [little_terrain], tmp_path / "known.json")


def test_tables_have_excess_over_the_best_and_count_firsts():
    one = np.array([[[10.0, 12.0], [10.0, 10.0]], [[40.0, 40.0], [30.0, 20.0]]])
    other = np.array([[[20.0, 20.0], [20.0, 20.0]], [[30.0, 30.0], [25.0, 25.0]]])
    asked = Asked("metabox", (100, 200), 2, 2)
    measured = {"PSO, one": one, EVEN: other}
    short, by_terrain = tables(measured, ["a", "b"], asked, best_costs(measured, NONE))
    found = {str(row[0]): [cell.numbers["value"] for cell in row[1:6]] for row in short.rows}
    assert found["PSO, one"] == pytest.approx([55.0, 60.0, 12.5, 0.0, 1])
    assert found[EVEN] == pytest.approx([75.0, 75.0, 62.5, 62.5, 1])
    assert [str(row[0]) for row in short.rows] == ["PSO, one", EVEN]
    assert [row[1].numbers["value"] for row in by_terrain.rows] == [10.0, 20.0]
    best = best_costs(measured, np.array([5.0, np.inf]))
    short, by_terrain = tables(measured, ["a", "b"], asked, best)
    assert [row[1].numbers["value"] for row in by_terrain.rows] == [5.0, 20.0]
    assert short.rows[0][1].numbers["value"] == pytest.approx(110.0)
    # A cheaper flight of the runs is no known one: it was refused, or waits for `--keep-best`.
    best = best_costs(measured, np.array([5.0, 80.0]))
    short, by_terrain = tables(measured, ["a", "b"], asked, best)
    assert [row[1].numbers["value"] for row in by_terrain.rows] == [5.0, 80.0]
    assert short.rows[0][1].numbers["value"] == pytest.approx((120.0 - 50.0) / 2.0)


def test_the_best_peer_is_named_and_rows_are_counted_against_it():
    mine = np.array([[[10.0, 12.0]], [[40.0, 40.0]]])
    peer = np.array([[[20.0, 20.0]], [[30.0, 30.0]]])
    measured = {"PSO, one": mine, "pymoo DE, spherical": peer, "niapy PSO, spherical": 9.0 * peer}
    best = best_costs(measured, NONE)
    short, _ = tables(measured, ["a", "b"], Asked("metabox", (100,), 2, 4), best)
    assert "that of pymoo DE, spherical, the library row" in short.caption
    assert "2 runs (4 of other libraries), of each policy where there are several, after" in short.caption
    short, _ = tables(measured, ["a", "b"], Asked("metabox", (100,), 2, 4, 1), best)
    assert "2 runs (1 of each policy, 4 of other libraries), after" in short.caption
    found = {str(row[0]): row[-1].numbers["value"] for row in short.rows}
    assert found == {"PSO, one": 1, "pymoo DE, spherical": 0, "niapy PSO, spherical": 0}


def test_a_flight_on_the_edge_of_a_threat_is_not_steady():
    heights, ends = np.zeros((101, 101)), {"start": (10.0, 500.0, 150.0), "goal": (990.0, 500.0, 150.0)}
    scenario = TerrainScenario(
        "edge", heights=heights, cell=10.0, threats=[[500.0, 500.0, np.inf, 80.0]], **ends
    )
    problem = TerrainProblem(scenario)
    aside = np.zeros(20)
    low, high = 0.0, 300.0
    for _ in range(100):
        aside[:10] = 0.5 * (low + high)
        low, high = (aside[0], high) if problem.evaluate(aside)[1] > 0.0 else (low, aside[0])
    aside[:10] = high
    assert problem.evaluate(aside)[1] == 0.0
    assert not best_known.is_steady(problem, aside)
    aside[:10] = high + 1.0
    assert best_known.is_steady(problem, aside)


def test_policies_have_longer_episodes_with_larger_budgets():
    learned = learned_rows()[0]
    assert isinstance(learned, ControlledRow)
    assert learned.iterations_of(20_000) == 8 * learned.iterations_of(EVALUATIONS) == 8 * 220
    [name, *_] = learned.controllers
    found = controller_of(learned, name, 20_000)
    assert found.env_options()["max_evaluations"] == 20_000
    assert controller_of(learned, name, EVALUATIONS).env_options()["max_evaluations"] == EVALUATIONS


def test_schedules_and_what_policies_correct_are_stretched_over_larger_budgets():
    known = {row.name: row for row in rows()}
    schedule = known["L-SHADE, blind schedule, with sources, shifted, guided"]
    assert schedule.iterations_of(20_000) == 8 * schedule.iterations
    before, after = (
        controller_of(schedule, schedule.controllers[0], budget) for budget in (EVALUATIONS, 20_000)
    )
    assert list(after.knots.iterations) == [8 * knot for knot in before.knots.iterations]
    policy = known["L-SHADE, learned, with sources, shifted, guided"]
    before, after = (
        controller_of(policy, policy.controllers[0], budget).corrects for budget in (EVALUATIONS, 20_000)
    )
    assert list(after.knots.iterations) == [8 * knot for knot in before.knots.iterations]


def test_captions_name_ranges_of_terrains():
    names = [f"terrain:test:{k}" for k in (*range(8), 9, *range(28, 30))]
    costs = np.ones((len(names), 1, 1))
    short, _ = tables({"PSO, one": costs}, names, Asked("metabox", (100,), 1, 1), np.full(len(names), np.inf))
    listed = "(terrain:test:0 to terrain:test:7, terrain:test:9, terrain:test:28 to terrain:test:29)"
    assert listed in short.caption


def test_controllers_are_compared_with_their_rival_seed_by_seed():
    shape = (4, 1, 2)
    rival = np.exp(np.random.default_rng(0).uniform(8, 9, shape))
    seen = np.concatenate([rival * np.exp(-0.02), rival * np.exp(-0.04)], axis=2)  # two policies
    blind = ControlledRow("constants", "firefly", "guided", ("fixed:20",))
    policy = ControlledRow("learned", "firefly", "guided", ("learned:a/0", "learned:a/1"))
    further = np.concatenate([rival, 9.0 * rival], axis=2)  # runs of seeds that the policies have not had
    table, beside_further = (
        table_of_control(
            [blind, policy],
            {blind.name: costs, policy.name: seen},
            {("firefly", "waypoints"): blind.name},
            Asked("metabox", (EVALUATIONS,), costs.shape[2], 2, 2),
            np.full(4, 10.0),
            [15, 15, 30, 30],
        )
        for costs in (rival, further)
    )
    assert beside_further.rows[1] == table.rows[1]
    (_, none, few, *_, no_difference), (_, two, *_, difference) = table.rows
    assert str(none) == str(no_difference) == "–"
    assert two.numbers["value"] == 2
    assert few.numbers["value"] == pytest.approx(100 * (rival[:2].mean() / 10 - 1))
    assert difference.numbers["value"] == pytest.approx(-3.0)
    assert difference.numbers["low"] == pytest.approx(-4.0)
    assert difference.numbers["high"] == pytest.approx(-2.0)
    assert objective(np.full(3, np.e)) == pytest.approx(100.0)


def test_terrains_with_equally_many_threats_stand_together_in_any_order():
    costs = np.exp(np.random.default_rng(1).uniform(8, 9, (6, 1, 2)))
    blind = ControlledRow("constants", "firefly", "guided", ("fixed:20",))
    policy = ControlledRow("learned", "firefly", "guided", ("learned:a/0",))
    measured = {blind.name: costs, policy.name: costs * np.linspace(0.9, 1.0, 6)[:, None, None]}

    def table(order, threats):
        chosen = {name: found[order] for name, found in measured.items()}
        rivals = {("firefly", "waypoints"): blind.name}
        asked = Asked("metabox", (EVALUATIONS,), 2, 2, 2)
        return table_of_control([blind, policy], chosen, rivals, asked, np.full(len(order), 10.0), threats)

    sorted_ones, mixed = (
        table([0, 1, 2, 3, 4, 5], [15] * 2 + [30] * 4),
        table([2, 0, 3, 4, 1, 5], [30, 15, 30, 30, 15, 30]),
    )
    assert mixed.rows[1] == sorted_ones.rows[1]
    assert mixed.columns[2:4] == ("excess, 15 threats", "excess, 30 threats")
    assert mixed.rows[0][2].numbers["value"] == pytest.approx(100 * (costs[:2].mean() / 10 - 1))
    [_, line] = table([3], [7]).rows
    assert line[-1].numbers["value"] == pytest.approx(100 * np.log(0.96))
    assert table([0, 1, 2, 3, 4, 5], range(6)).columns[2:4] == ("excess", "median")


def test_runs_over_a_map_of_the_user_lie_in_the_folder_itself(tmp_path, monkeypatch):
    name = "terrain-file:/maps/of the/dem.asc"
    monkeypatch.setattr(measured_costs, "make_scenario", lambda _: rolling_terrain(2))
    measure(PlannedRow(), name, ASKED, tmp_path)
    assert {file.parent for file in tmp_path.rglob("*.json")} == {tmp_path}


def test_controllers_without_a_rival_have_no_line():
    blind = ControlledRow("constants", "firefly", "guided", ("fixed:20",))
    others = [
        ControlledRow("SPSFA-TIP", "differential-evolution", "guided", ("spsfa-tip",)),
        ControlledRow("constants", "firefly", "guided", ("fixed:20",), encoding="shifted"),
    ]
    costs = np.full((4, 1, 2), 20.0)
    table = table_of_control(
        [blind, *others],
        {row.name: costs for row in (blind, *others)},
        {("firefly", "waypoints"): blind.name},
        Asked("metabox", (20_000,), 2, 2),
        np.full(4, 10.0),
        [15] * 4,
    )
    assert [str(row[0]) for row in table.rows] == ["fireflies, constants"]
    assert "after 20,000 evaluations" in table.caption


def test_rows_of_a_library_that_is_not_installed_are_left_out(monkeypatch):
    monkeypatch.setattr(libraries, "find_spec", lambda name: None)
    assert [peer for peer in PEERS if peer not in libraries.installed(PEERS)] == [
        "mealpy PSO",
        "mealpy L-SHADE",
    ]
    assert not any("mealpy" in row.name for row in rows())


@pytest.mark.parametrize("peer", libraries.installed(PEERS))
def test_a_peer_spends_its_evaluations_and_is_the_same_again(peer, little_terrain, tmp_path):
    row = PeerRow(peer, "waypoints")
    costs = measure(row, little_terrain, ASKED, tmp_path)
    problem = make_problem(make_scenario(little_terrain), cost="metabox")
    cost = run_peer(peer, problem, 200, TEST[0])
    assert cost.best == costs[1, 0] == problem.evaluate(cost.vector)[0]
    assert run_peer(peer, problem, 200, TEST[1]).best != costs[1, 0]
    assert cost.left == 0
    assert cost.calls >= 200


def test_rows_have_names_of_their_own():
    assert len({row.name for row in rows()}) == len(rows())
    others = 2 * len(libraries.installed(PEERS)) + 10 + 8 + len(learned_rows()) + 2
    assert len(rows()) == 6 * len(SIZES) + others


# Of 2,500 evaluations the first population takes 100, which are not among the iterations.
@pytest.mark.parametrize(("evaluations", "left"), [(2500, 24), (20000, 10)])
def test_linear_reduction_ends_with_few_members_when_the_budget_is_spent(little_terrain, evaluations, left):
    row = next(row for row in rule_rows() if "linear reduction" in row.name)
    swarms = []
    run_episodes(
        controller_of(row, row.controllers[0], evaluations),
        little_terrain,
        TEST[:1],
        row.optimizer,
        lambda simulation: swarms.append((simulation.swarms.size[0], simulation.swarms.evaluations[0])),
        iterations=row.iterations_of(evaluations),
        max_evaluations=evaluations,
    )
    assert swarms[0][0] == 100
    assert 4 <= swarms[-1][0] <= left
    assert swarms[-1][1] == pytest.approx(evaluations, rel=0.02)


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
        rows=("fireflies, waypoints", EVEN),
        without=("uniform",),
    )
    files = command.write(config)
    assert [file.name for file in files] == ["metabox-in-short.md", "metabox-by-terrain.md"]
    text = files[0].read_text(encoding="utf-8")
    assert "fireflies, waypoints, guided" in text
    assert "fireflies, waypoints, uniform" not in text
    assert EVEN in text
    assert "little" in files[1].read_text(encoding="utf-8")
    (record,) = records_in(tmp_path)
    assert record.commits
    shown = {"fireflies, waypoints, guided", "fireflies, waypoints, smooth"}
    assert record.digests.keys() == {*shown, "results of firefly"}


def test_tables_share_runs_and_know_the_commits_of_their_own(little_terrain, tmp_path, monkeypatch):
    config = command.TerrainConfig(
        output=tmp_path / "both",
        runs_folder=tmp_path / "runs",
        terrains=(little_terrain,),
        evaluations=(100,),
        runs=2,
        rows=(ROW.name, EVEN),
    )
    command.write(config)
    assert not (tmp_path / "both" / "runs").exists()

    def with_commit(file, letter, **changes):
        stored = json.loads(file.read_text(encoding="utf-8"))
        changed = {**stored, **changes, "provenance": {"commit": letter * 40}}
        file.write_text(json.dumps(changed), encoding="utf-8")

    (planned,) = (tmp_path / "runs").glob("*planned*")
    with_commit(planned, "f")
    (file,) = (tmp_path / "runs").glob("*guided-100-2.json")
    stale = file.with_name(file.name.replace("-2.json", "-1.json"))
    stale.write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    with_commit(stale, "e", asked={})  # of another terrain of the name
    more = file.with_name(file.name.replace("-2.json", "-9.json"))
    more.write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    with_commit(more, "d")
    monkeypatch.setattr(measured_costs, "run_episodes", None)  # a further run would fail
    command.write(replace(config, output=tmp_path / "one", rows=(ROW.name,)))
    (one,) = records_in(tmp_path / "one")
    (both,) = records_in(tmp_path / "both")
    assert one.commits == both.commits
    command.write(replace(config, output=tmp_path / "again"))
    (again,) = records_in(tmp_path / "again")
    assert again.commits.keys() == {*both.commits, "f" * 10}


def test_the_command_compares_policies_with_their_blind_rival(little_terrain, tmp_path):
    config = command.TerrainConfig(
        output=tmp_path,
        terrains=(little_terrain,) * 2,
        validation=little_terrain,
        evaluations=(100,),
        runs=2,
        policy_runs=1,
        rows=(ROW.name, "fireflies, learned, with sources", "fireflies, constants", "L-SHADE, learned"),
    )
    [*_, control] = command.write(config)
    assert control.name == "metabox-control.md"
    lines = [
        line.split("|")[1].strip() for line in control.read_text(encoding="utf-8").splitlines() if "|" in line
    ]
    # Policies of L-SHADE have no blind rival here.
    assert lines[2:] == [
        "fireflies, 20 members",
        "fireflies, constants, size and phi",
        "fireflies, constants, with sources",
        "fireflies, learned, with sources",
    ]


def test_a_single_blind_row_is_the_rival_without_runs_for_validation(little_terrain, tmp_path):
    config = command.TerrainConfig(
        output=tmp_path,
        terrains=(little_terrain,) * 2,
        validation="terrain:validation:0",
        evaluations=(100,),
        runs=2,
        policy_runs=1,
        rows=(ROW.name, "fireflies, learned, with sources"),
    )
    [*_, control] = command.write(config)
    text = " ".join(control.read_text(encoding="utf-8").split())
    assert "fireflies, learned, with sources" in text
    assert "over 2 terrains (little, little), whose best known flights are those of these runs, and 1" in text
    assert not [file.name for file in (tmp_path / "runs").iterdir() if "validation" in file.name]
