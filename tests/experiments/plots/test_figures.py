import dataclasses
import itertools
import struct
import subprocess
import sys
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest

from experiments.documents.figures import plan, write_figures
from experiments.plots.courses import (
    CASE_DRAWINGS,
    best_by_evaluations,
    draw_best_path_maps,
    draw_best_paths,
    draw_box_plots,
    draw_collision,
    draw_convergence,
    draw_population_size,
    draw_snapshots,
)
from experiments.plots.stored import load_cases, load_snapshots
from experiments.plots.style import KNOWN_STYLES, render, settings, styles
from experiments.runs.labels import label
from experiments.runs.run import Snapshot
from experiments.runs.suite import Suite
from experiments.studies.spsfa.suites import PAPER
from helpers.builders import CASES, function_problem, make_problem
from helpers.loops import looped
from helpers.stored_runs import filled_database, line, stored_run
from swarm_gym.scenarios import SCENARIOS, Polygon, Scenario

CONTROLLERS = ("fixed:60", "spsfa", "spsfa-tip", "learned:tiny")
NUM_SEEDS, ITERATIONS, MEMBERS = 4, 6, 5
SUITE = Suite(
    name="tiny",
    controllers=CONTROLLERS,
    scenarios=CASES,
    num_seeds=NUM_SEEDS,
    baseline="spsfa",
    snapshots=(("spsfa", "case2", 1, (0, ITERATIONS)),),
)
OF_A_CASE = ("convergence", "population-size", "best-paths", "box-plots")
FILES = [
    "figure-03-population-snapshots",
    "figure-04-population-collision",
    *(
        f"figure-{8 + 4 * c + k:02}-{kind}-{case}"
        for c, case in enumerate(CASES)
        for k, kind in enumerate(OF_A_CASE)
    ),
]
DRAW_AGAIN = """
import sys
from pathlib import Path
from experiments.documents.figures import write_figures
from experiments.runs.database import Results
from experiments.runs.suite import Suite

database, folder, *controllers = sys.argv[1:]
suite = Suite("tiny", tuple(controllers), ("case1",), 4, "spsfa")
write_figures(suite, Results(Path(database)), Path(folder))
print(*(name for name in sys.modules if name.startswith("matplotlib.pyplot")))
"""


def make_run(controller, scenario, seed, problem=None):
    """A run whose numbers look like those of a real one and differ from all others'."""
    rng = np.random.default_rng([CONTROLLERS.index(controller), len(scenario), seed])
    problem = problem or make_problem(scenario)
    rows = ITERATIONS + 1
    repair = rng.uniform(0.1, 0.3, rows) if controller == "spsfa-tip" else np.zeros(rows)
    fitness = np.sort(rng.uniform(310.0, 900.0, rows))[::-1]
    courses = {
        "evaluations": np.cumsum(rng.integers(60, 2000, rows)),
        "population_collision": rng.uniform(1.0, 90.0, rows),
        "population_size": rng.integers(20, 90, rows),
        "repair_degree": repair,
        "best_fitness": fitness,
    }
    offsets = rng.uniform(-100.0, 100.0, (MEMBERS, problem.num_waypoints))
    collisions = np.array([0.0, 3.0, 0.0, 2.0, 1.0])
    populations = [Snapshot(k, problem.points(offsets + k), collisions) for k in (0, 3, ITERATIONS)]
    kept = populations if (controller, scenario, seed) == ("spsfa", "case2", 1) else []
    return stored_run(
        (controller, scenario, seed),
        courses,
        final_fitness=fitness[-1],
        final_collision=rng.choice([0.0, 0.5]),
        best_path=problem.points(offsets[0]),
        snapshots=tuple(kept),
    )


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Runs of all controllers on the paper's cases."""
    runs = itertools.starmap(make_run, itertools.product(CONTROLLERS, CASES, range(NUM_SEEDS)))
    with filled_database(tmp_path_factory.mktemp("results"), runs) as database:
        yield database


@pytest.fixture(scope="module")
def cases(results):
    return {case.scenario.name: case for case in load_cases(SUITE, results)}


@pytest.fixture(scope="module")
def case(cases):
    return cases["case2"]


@pytest.fixture(scope="module")
def written(results, tmp_path_factory):
    return write_figures(SUITE, results, tmp_path_factory.mktemp("figures") / "made" / "here")


def course(case, controller, name):
    return np.array([run.course(name) for run in case.runs[controller]])


def labels(axes):
    return axes.get_legend_handles_labels()[1]


def test_every_figure_of_the_paper_is_written_under_its_number(written):
    expected = [f"{stem}.{form}" for stem in FILES for form in ("svg", "png")]
    assert [path.name for path in written] == expected
    assert sorted(path.name for path in written[0].parent.iterdir()) == sorted(expected)


def test_vector_files_are_well_formed(written):
    for path in written[::2]:
        root = ElementTree.parse(path).getroot()
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) > 20


@pytest.mark.slow
def test_pixel_files_have_the_size_of_the_figure(results, written):
    heads = [path.read_bytes()[:24] for path in written[1::2]]
    figures = [draw() for draw in plan(SUITE, results).values()]
    for head, figure in zip(heads, figures, strict=True):
        assert head[:8] == b"\x89PNG\r\n\x1a\n"
        expected = 150 * figure.get_size_inches()
        np.testing.assert_allclose(struct.unpack(">II", head[16:]), expected, atol=1.0)


@pytest.mark.slow
def test_another_process_writes_the_same_bytes_and_needs_no_pyplot(results, written, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", DRAW_AGAIN, str(results.path), str(tmp_path), *CONTROLLERS],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == []
    by_name = {path.name: path for path in written}
    again = [path for path in tmp_path.iterdir() if "case1" in path.name]
    assert len(again) == 2 * len(CASE_DRAWINGS)
    for path in again:
        assert path.read_bytes() == by_name[path.name].read_bytes(), path.name


def user_settings():
    # To look at the backend is to choose one.
    return {name: mpl.rcParams[name] for name in mpl.rcParams.copy().keys() - {"backend"}}


def test_convergence_reaches_the_last_evaluation_of_runs_that_a_budget_ends(case):
    ended = {}
    for controller, runs in case.runs.items():
        spent = [int(run.course("evaluations")[-4]) for run in runs]
        traces = [
            np.where(np.arange(len(run.trace))[:, None] > len(run.trace) - 4, np.nan, run.trace)
            for run in runs
        ]
        ended[controller] = [
            dataclasses.replace(run, trace=trace, evaluations=last)
            for run, trace, last in zip(runs, traces, spent, strict=True)
        ]
    _, by_evaluations = draw_convergence(dataclasses.replace(case, runs=ended)).axes
    for controller in CONTROLLERS:
        x, y = line(by_evaluations, label(controller))
        assert x[-1] == pytest.approx(max(run.evaluations for run in ended[controller]))
        assert np.isfinite(y).all()


def test_settings_of_the_user_neither_matter_nor_change(case):
    def drawn():
        with settings():
            return render(draw_box_plots(case), "svg")

    expected = drawn()
    with mpl.rc_context({"lines.linewidth": 7.0, "font.size": 20.0, "svg.hashsalt": "other"}):
        before = user_settings()
        assert drawn() == expected
        assert user_settings() == before


def test_convergence_shows_the_median_of_the_runs_in_a_band_of_their_quartiles(case):
    by_iteration, by_evaluations = draw_convergence(case).axes
    for controller, band in zip(CONTROLLERS, by_iteration.collections, strict=True):
        fitness = course(case, controller, "best_fitness")
        heights = set(band.get_paths()[0].vertices[:, 1])
        assert heights >= set(np.quantile(fitness, [0.25, 0.75], axis=0).ravel())
        x, y = line(by_iteration, label(controller))
        np.testing.assert_array_equal(x, np.arange(ITERATIONS + 1))
        np.testing.assert_array_equal(y, np.median(fitness, axis=0))
        x, y = line(by_evaluations, label(controller))
        assert x[-1] == pytest.approx(max(run.evaluations for run in case.runs[controller]))
        assert y[-1] == np.median(fitness[:, -1])
    for axes in (by_iteration, by_evaluations):
        np.testing.assert_array_equal(line(axes, f"known optimum, {case.optimum:.2f}")[1], [case.optimum] * 2)
        assert axes.get_ylim()[0] < case.optimum


def test_a_run_is_worth_what_it_has_reached_when_so_much_is_spent():
    fitness = np.array([[9.0, 5.0, 4.0], [8.0, 7.0, 1.0]])
    evaluations = np.array([[10.0, 20.0, 30.0], [10.0, 40.0, 50.0]])
    found = best_by_evaluations(fitness, evaluations, np.array([10.0, 19.9, 20.0, 40.0, 99.0]))
    np.testing.assert_array_equal(found, [[9, 9, 5, 4, 4], [8, 8, 8, 7, 1]])


def test_population_size_shows_means_and_phi_of_those_that_repair_where_somebody_does(case):
    sizes, repair_degrees = draw_population_size(case).axes
    assert labels(sizes) == [label(controller) for controller in CONTROLLERS]
    assert labels(repair_degrees) == ["SPSFA-TIP"]
    for axes, name in ((sizes, "population_size"), (repair_degrees, "repair_degree")):
        expected = course(case, "spsfa-tip", name).mean(axis=0)
        np.testing.assert_array_equal(line(axes, "SPSFA-TIP")[1], expected)
        assert axes.get_ylim()[1] > expected.max()
    # There is no panel for phi when nobody repairs.
    others = {name: runs for name, runs in case.runs.items() if name != "spsfa-tip"}
    assert len(draw_population_size(dataclasses.replace(case, runs=others)).axes) == 1


def test_collision_is_shown_for_every_case_beside_its_first_value(cases):
    figure = draw_collision(list(cases.values()))
    for axes, case in zip(figure.axes, cases.values(), strict=True):
        assert labels(axes) == ["FA-60", "SPSFA", "SPSFA-TIP"]
        for controller in ("fixed:60", "spsfa", "spsfa-tip"):
            mean = course(case, controller, "population_collision").mean(axis=0)
            np.testing.assert_array_equal(line(axes, label(controller))[1], mean)
            dotted = [each for each in axes.lines if set(each.get_ydata()) == {mean[0]}]
            assert [each.get_linestyle() for each in dotted] == [":"]


def test_best_paths_are_those_of_the_best_runs(case):
    axes = draw_best_paths(case).axes[0]
    for controller in CONTROLLERS:
        best = min(case.runs[controller], key=lambda run: run.final_fitness)
        text = f"{label(controller)}: {best.final_fitness:.2f} ({best.final_collision:.2f})"
        np.testing.assert_array_equal(line(axes, text), best.best_path.T)
    shortest = line(axes, "exact shortest path, length 1053.6").T
    assert np.hypot(*np.diff(shortest, axis=0).T).sum() == pytest.approx(1053.551, abs=1e-3)


def on_a_function(case, name):
    """The case with its runs made those on a test function, whose fitness goes down to 1e-15."""
    problem = function_problem(name)
    moved = {}
    for controller, runs in case.runs.items():
        moved[controller] = []
        for run in runs:
            trace = run.trace.copy()
            trace[:, 3] = np.geomspace(300.0, 1e-15, len(trace))
            vector = np.full(problem.dimension, 0.1 * run.seed)
            changes = {"best_path": problem.points(vector), "trace": trace, "final_fitness": trace[-1, 3]}
            moved[controller].append(dataclasses.replace(run, **changes))
    return dataclasses.replace(case, scenario=problem.scenario, optimum=0.0, runs=moved)


@pytest.mark.parametrize("dimension", [1, 10])
def test_best_vectors_of_a_test_function_are_drawn_by_component_with_the_optimum(case, dimension):
    case = on_a_function(case, f"function:easom-{dimension}")
    axes = draw_best_paths(case).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("component", "value")
    assert axes.get_ylim() == (-10.0, 10.0)
    numbers = np.arange(1, dimension + 1)
    np.testing.assert_array_equal(line(axes, "optimum"), [numbers, [np.pi] * dimension])
    best = line(axes, "SPSFA: 1e-15 (0.00)")
    assert best.shape == (2, dimension)


def test_fitness_of_a_test_function_is_on_a_logarithmic_axis_down_to_a_limit(case):
    case = on_a_function(case, "function:booth-2")
    for axes in (draw_convergence(case).axes[0], draw_box_plots(case).axes[0]):
        assert axes.get_yscale() == "log"
        assert axes.get_ylim()[0] == pytest.approx(5e-13)
        assert not any("optimum" in text for text in labels(axes))


def test_box_plots_show_every_run(case):
    fitness, evaluations = draw_box_plots(case).axes
    for place, controller in enumerate(CONTROLLERS, start=1):
        for axes, name in ((fitness, "final_fitness"), (evaluations, "evaluations")):
            values = [getattr(run, name) for run in case.runs[controller]]
            marker = styles(CONTROLLERS)[controller].marker
            (points,) = [each for each in axes.lines if each.get_marker() == marker]
            assert list(points.get_ydata()) == values
            assert np.abs(points.get_xdata() - place).max() < 0.5
            box = axes.patches[place - 1].get_bbox()
            assert (box.y0, box.y1) == pytest.approx(tuple(np.quantile(values, [0.25, 0.75])))
    assert [text.get_text() for text in fitness.get_xticklabels()] == [
        label(controller) for controller in CONTROLLERS
    ]


def test_box_plots_of_many_runs_show_some_of_them_and_say_so(case, monkeypatch):
    monkeypatch.setattr("experiments.plots.courses.MOST_POINTS", 3)
    figure = draw_box_plots(case)
    values = [run.final_fitness for run in case.runs[CONTROLLERS[0]]]
    assert list(figure.axes[0].lines[0].get_ydata()) == values[:3]
    box = figure.axes[0].patches[0].get_bbox()
    assert (box.y0, box.y1) == pytest.approx(tuple(np.quantile(values, [0.25, 0.75])))
    assert f"3 of {NUM_SEEDS} runs" in figure.get_suptitle()


def test_snapshots_show_every_member_and_tell_the_colliding_ones_apart(results):
    snapshots = load_snapshots(SUITE, results)
    ((key, kept),) = snapshots.items()
    assert key == ("spsfa", "case2", 1)
    assert [snapshot.iteration for snapshot in kept] == [0, ITERATIONS]
    panels = [axes for axes in draw_snapshots(snapshots).axes if axes.axison]
    for axes, snapshot in zip(panels, kept, strict=True):
        feasible, colliding = axes.collections[-2:]
        clear = snapshot.collisions == 0.0
        np.testing.assert_array_equal(feasible.get_segments(), snapshot.paths[clear])
        np.testing.assert_array_equal(colliding.get_segments(), snapshot.paths[~clear])
        assert feasible.get_linestyle() != colliding.get_linestyle()
        title = f"iteration {snapshot.iteration}: {MEMBERS} members, 2 feasible"
        assert axes.get_title() == title


def test_controllers_and_scenarios_without_runs_are_left_out(database):
    assert plan(SUITE, database) == {}
    database.add(*(make_run("learned:tiny", "case1", seed) for seed in range(2)))
    assert list(plan(SUITE, database)) == [f"{kind}-case1" for kind in CASE_DRAWINGS]
    database.add(make_run("spsfa", "case1", 0))
    assert next(iter(plan(SUITE, database))) == "population-collision"
    (case,) = load_cases(SUITE, database)
    assert list(case.runs) == ["spsfa", "learned:tiny"]
    assert labels(draw_convergence(case).axes[0])[:2] == ["SPSFA", "learned (tiny)"]


@pytest.mark.slow
def test_other_scenarios_get_figures_without_number_and_without_an_optimum(database, tmp_path, monkeypatch):
    walls = [(650, 50, 950, 80), (650, 320, 950, 350), (650, 70, 680, 330), (920, 70, 950, 330)]
    obstacles = tuple(Polygon.rectangle(*wall) for wall in walls)
    besieged = Scenario("besieged", (100.0, 200.0), (800.0, 200.0), obstacles, (0.0, 0.0, 1000.0, 400.0))
    monkeypatch.setitem(SCENARIOS, "besieged", lambda: besieged)
    database.add(*(make_run("spsfa-tip", "besieged", seed, make_problem(besieged)) for seed in range(2)))
    suite = dataclasses.replace(SUITE, scenarios=("besieged",))
    written = write_figures(suite, database, tmp_path)
    assert {path.stem for path in written} == {
        "figure-04-population-collision",
        *(f"figure-{kind}-besieged" for kind in CASE_DRAWINGS),
    }
    (case,) = load_cases(suite, database)
    assert labels(draw_convergence(case).axes[0]) == ["SPSFA-TIP"]
    assert len(labels(draw_best_paths(case).axes[0])) == 1
    assert draw_best_path_maps([case]).axes[0].get_title() == "besieged"


def test_no_two_controllers_look_alike_and_each_looks_the_same_everywhere():
    many = styles([*PAPER.controllers, "learned:a", "learned:b", "learned:c"]).values()
    assert len({(style.colour, style.marker) for style in many}) == len(many)
    assert len({style.marker for style in styles(PAPER.controllers).values()}) == len(PAPER.controllers)
    assert styles(["learned:a", "spsfa"])["spsfa"] == KNOWN_STYLES["spsfa"]
    assert styles(["learned:a", "spsfa"])["learned:a"] == styles(["fixed:60", "learned:a"])["learned:a"]


@looped(
    ("controller", "expected"),
    [
        ("fixed:60", "FA-60"),
        ("spsfa", "SPSFA"),
        ("spsfa-tip", "SPSFA-TIP"),
        ("spsfa-tip:growth=500,decay=0.1", "SPSFA-TIP (growth=500, decay=0.1)"),
        ("random", "random"),
        ("learned:three-cases", "learned (three-cases)"),
        ("learned:three-cases/3", "learned (three-cases/3)"),
        ("open-loop:three-cases-constant", "open loop (three-cases-constant)"),
        ("tuned:random-fields", "tuned schedule (random-fields)"),
        ("tuned:dynamic-periodic/3@1", "tuned (dynamic-periodic/3@1)"),
        ("learned:three-cases/*", "learned three-cases"),
        ("learned:three-cases/*@0.3", "learned three-cases@0.3"),
        ("improved-fish-swarm(200)+fixed:100", "IAFSA, 100 members, 200 iterations"),
        ("hybrid-fish-swarm+fixed:100", "HAAFSA-R, 100 members"),
        ("open-loop:three-cases-sourced/*@1", "open loop three-cases-sourced@1"),
        ("tuned:three-cases-restart/*", "tuned three-cases-restart"),
        ("fixed:60,smooth_share=1", "FA-60 (smooth)"),
        ("fixed:60,smooth_share=0", "FA-60 (uniform)"),
        ("fixed:20,smooth_share=0.4,amplitude=0.3", "FA-20 (40 % smooth, amplitude 0.3)"),
        ("particle-swarm+fixed:60,smooth_share=1", "PSO-w, 60 members, smooth"),
        ("fish-swarm+fixed:60,smooth_share=1,amplitude=0.5", "AFSA, 60 members, smooth, amplitude 0.5"),
        ("firefly(50)+fixed:60", "FA, 60 members, 50 iterations"),
        ("multivariate+spsfa-tip", "MOA, SPSFA-TIP"),
        ("multivariate(50)+learned:a/*@1", "MOA, learned a@1, 50 iterations"),
    ],
)
def test_controllers_are_called_as_in_their_papers_and_groups_by_their_recipe(controller, expected):
    assert label(controller) == expected
