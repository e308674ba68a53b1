"""Tables and figures of recovery from events, and of robots that drive meanwhile, say what the runs say."""

import numpy as np
import pytest

from experiments.documents.figures import plan
from experiments.documents.suite_page import make_tables
from experiments.studies.dynamic.figures import draw_events
from experiments.studies.dynamic.recovery import Recovery
from experiments.studies.dynamic.suites import DYNAMIC, DYNAMIC_ROBOTS
from helpers.stored_runs import cells_of, line, part_of, stored_run
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import make_scenario, worlds_of

NONE = np.nan


def test_recovery_is_counted_from_the_row_of_the_event():
    """The event follows iteration 3: the row of that shows the changed map already."""
    feasible = [
        [NONE, NONE, 310, NONE, NONE, 312, 312],  # before, and two iterations after
        [NONE, NONE, NONE, 311, NONE, NONE, NONE],  # at once
        [310, 310, NONE, NONE, NONE, NONE, NONE],  # no longer before, never again
    ]
    courses = [{"feasible_fitness": np.array(one), "evaluations": 10.0 ** np.arange(7)} for one in feasible]
    found = Recovery.of([stored_run(("spsfa", "", 0), one, final_fitness=1.0) for one in courses], 3)
    assert found.was_feasible.tolist() == [1.0, 0.0, 0.0]
    assert found.stayed_feasible.tolist() == [0.0, 1.0, 0.0]
    assert found.iterations.tolist() == [2.0, 0.0, np.inf]
    assert found.evaluations.tolist() == [99_000.0, 0.0, np.inf]


SEEDS = ("open-loop:random-fields-sourced/0@1", "open-loop:random-fields-sourced/1@1")
LOOP = "open loop random-fields-sourced@1"
AGAIN = {"spsfa-tip": (60, 55, None), SEEDS[0]: (50, 52, 58), SEEDS[1]: (None, None, None)}  # feasible from
OPTIMA = {"dynamic:case1-gate@50": (299.00284, 299.00284), "dynamic:case3-gate@50": (300.27415, 306.51812)}


@pytest.fixture
def gates(database):
    """Three runs each, whose courses are random but for feasibility."""
    rng = np.random.default_rng(0)
    courses = {}
    for name in OPTIMA:
        for controller, places in AGAIN.items():
            for seed, place in enumerate(places):
                feasible = np.full(101, NONE)
                feasible[49 if seed else 48] = 400.0
                feasible[101 if place is None else place :] = 400.0
                best = rng.uniform(310.0, 400.0, 101)
                of = {"best_fitness": best, "feasible_fitness": feasible}
                of["evaluations"] = 1000.0 * np.arange(1, 102)
                database.add(stored_run((controller, name, seed), of, final_fitness=best[-1]))
                courses.setdefault((name, controller), []).append(best)
    return part_of(DYNAMIC, AGAIN, OPTIMA, 3, tables=("recovery",), figures=("recovery",), claims=()), courses


def test_recovery_tables_have_quartiles_of_all_events_and_seeds(database, gates):
    rows = cells_of(make_tables(gates[0], database), "recovery")
    assert [row["scenarios"] for row in rows[::2]] == ["dynamic:case1-gate", "dynamic:case3-gate", "all"]
    for printed, looped in zip(rows[::2], rows[1::2], strict=True):
        assert (printed["controller"], looped["controller"]) == (
            "SPSFA-TIP",
            "open loop random-fields-sourced@1",
        )
        assert printed["feasible before"] == looped["feasible before"] == "66.7 %"
        assert (printed["right after"], looped["right after"]) == ("0.0 %", "16.7 %")
        assert (printed["at last"], looped["at last"]) == ("66.7 %", "50.0 %")
        assert (printed["iterations"], looped["iterations"]) == ("10 [5, never]", "8 [2, never]")
        assert (printed["evaluations"], looped["evaluations"]) == (
            "10,000 [5,000, never]",
            "8,000 [2,000, never]",
        )
    assert [row["events"] for row in rows] == ["3", "6", "3", "6", "6", "12"]


def test_recovery_is_drawn_as_medians_beside_the_optimum_of_the_map_in_force(database, gates):
    suite, courses = gates
    panels = plan(suite, database)["recovery"]().axes
    for axes, (name, optima) in zip(panels, OPTIMA.items(), strict=True):
        assert axes.get_title() == name
        for text, controllers in (
            ("SPSFA-TIP", ("spsfa-tip",)),
            (LOOP, SEEDS),
        ):
            made = [course for controller in controllers for course in courses[name, controller]]
            np.testing.assert_allclose(line(axes, text), [np.arange(101), np.median(made, axis=0)])
        np.testing.assert_allclose(line(axes, "optimum"), [(0, 50, 100), (*optima, optima[1])], rtol=1e-7)
        assert [each.get_drawstyle() for each in axes.lines][-2] == "steps-post"
        assert line(axes, "the obstacle appears")[0].tolist() == [50.0, 50.0]


def test_events_are_drawn_with_the_shortest_ways_before_and_after():
    panels = draw_events().axes
    assert [panel.get_title().split(":")[0] for panel in panels] == [
        "case1-gate", "case2-gate", "case3-gate", "case1-block", "case2-block", "case3-block"
    ]  # fmt: skip
    for panel in panels:
        before, after = (
            length_of(np.column_stack(line(panel, f"shortest way {when}"))) for when in ("before", "after")
        )
        assert after >= before
        assert (after > before) == (panel not in panels[:2])
        *_, faces, outlines = panel.collections
        assert len(faces.get_paths()) == len(outlines.get_paths()) == 1


def test_robots_count_as_arrived_at_the_target_only(database):
    drive = "dynamic:case3-gate@47-drive@40,every=5,distance=120"
    *_, (_, changed) = worlds_of(make_scenario(drive))
    shortest, way = shortest_path(changed)
    longer = np.array([changed.start, (500.0, 900.0), changed.target])
    ways = {"spsfa-tip": (way[:-1], way[:1]), "fixed:60": (way, longer)}
    for controller, each in ways.items():
        for seed, trajectory in enumerate(each):
            key, spent = (controller, drive, seed), {"evaluations": np.array([0.0, 500.0])}
            database.add(stored_run(key, spent, final_fitness=300.0, trajectory=np.array(trajectory)))
    rows = cells_of(make_tables(part_of(DYNAMIC_ROBOTS, ways, (drive,), 2), database), "robots")
    assert [row["controller"] for row in rows] == ["FA-60", "SPSFA-TIP"]
    assert [row["arrived"].split(" [")[0] for row in rows] == ["100.0 %", "0.0 %"]
    excess = np.hypot(*np.diff(longer, axis=0).T).sum() / shortest - 1.0
    assert rows[0]["driven"].startswith(f"{50.0 * excess:+.2f} % [")
    assert rows[1]["driven"] == "–"
    assert rows[0]["evaluations"].startswith("500 [")
