"""The parameter studies: the paper's grid, ratios to the printed setting, figures that show the runs."""

import dataclasses

import numpy as np
import pytest

from agents import make_controller
from experiments.catalogue import get_suite
from experiments.documents.figures import plan, write_figures
from experiments.documents.suite_page import make_tables
from experiments.plots.stored import load_cases
from experiments.runs.database import ResultsError
from experiments.statistics import ratio_interval
from experiments.studies.spsfa.figures import draw_courses, draw_outcomes
from experiments.studies.spsfa.suites import CONTROLLERS, PARAMETER_STUDIES, PARAMETERS, SCENARIO
from helpers.builders import make_problem
from helpers.stored_runs import cells_of, filled_database, line, stored_run
from swarm_gym.controllers.schedules import SelfAdaptiveSchedule

NUM_SEEDS, ITERATIONS = 4, 6
SUITE = dataclasses.replace(PARAMETERS, num_seeds=NUM_SEEDS)
GROWTH, DECAY, LOW_DEVIATION = PARAMETER_STUDIES
EVALUATIONS = {GROWTH.controller(500.0): 700, "spsfa-tip": 1000, DECAY.controller(0.1): 2500}


def made_run(controller, seed):
    """A run with evaluations of EVALUATIONS, twice as many where that has none, on average over the seeds."""
    rng = np.random.default_rng([CONTROLLERS.index(controller), seed])
    rows = ITERATIONS + 1
    trace = rng.uniform(1.0, 90.0, (rows, 6))
    trace[:, 3] = np.sort(rng.uniform(310.0, 900.0, rows))[::-1]
    trace[:, 4] = np.cumsum(rng.integers(60, 2000, rows))
    spent = EVALUATIONS.get(controller, 2000) + 10 * (2 * seed - NUM_SEEDS + 1)
    of = {"final_collision": 0.0 if seed else 2.5, "evaluations": spent, "seconds": 2e-3 * spent}
    path = make_problem(SCENARIO).points(np.zeros(31))
    return stored_run((controller, SCENARIO, seed), trace, final_fitness=trace[-1, 3], best_path=path, **of)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    runs = (made_run(controller, seed) for controller in CONTROLLERS for seed in range(NUM_SEEDS))
    with filled_database(tmp_path_factory.mktemp("results"), runs) as database:
        yield database


@pytest.fixture(scope="module")
def case(results):
    (found,) = load_cases(SUITE, results)
    return found


def test_the_suite_is_the_papers_grid_with_the_printed_setting_once():
    assert GROWTH.values == tuple(range(500, 2251, 250))
    np.testing.assert_allclose(DECAY.values, np.arange(1, 10) / 10)
    assert LOW_DEVIATION.values == tuple(range(10, 101, 10))
    assert [study.printed for study in PARAMETER_STUDIES] == [1000.0, 0.2, 20.0]
    assert len(CONTROLLERS) == len(set(CONTROLLERS)) == 8 + 9 + 10 - 2
    assert get_suite("parameters").controllers == CONTROLLERS


@pytest.mark.parametrize("study", PARAMETER_STUDIES)
def test_a_study_varies_one_parameter_and_nothing_else(study):
    assert study.controller(study.printed) == "spsfa-tip"
    for value in study.values:
        expected = SelfAdaptiveSchedule(True)
        setattr(expected, study.parameter, value)
        assert make_controller(study.controller(value)) == expected


def test_tables_show_our_ratios_beside_the_papers(results):
    tables = make_tables(SUITE, results)
    names = ("table-12-parameter-growth", "table-13-parameter-decay", "table-parameter-low-deviation")
    assert tuple(table.name for table in tables) == names
    growth, decay, low_deviation = (cells_of(tables, name) for name in names)
    first = [growth[0][column] for column in ("ω", "evaluations ratio", "seconds ratio", "paper seconds")]
    assert first == ["500", "0.70", "0.70", "204.7044"]
    paper = [row["paper ratio"] for row in growth]
    assert paper == ["0.72", "0.80", "1.00", "0.88", "0.68", "0.70", "1.54", "1.88"]
    assert (decay[0]["η"], decay[0]["evaluations ratio"], decay[0]["paper ratio"]) == ("0.1", "2.50", "2.80")
    assert (decay[1]["η"], decay[1]["mean evaluations"], decay[1]["feasible"]) == ("**0.2**", "1,000", "75 %")
    fitness = [run.final_fitness for run in results.runs("spsfa-tip", SCENARIO, NUM_SEEDS)]
    assert decay[1]["mean fitness"] == f"{np.mean(fitness):.1f}"
    assert decay[1]["std"] == f"{np.std(fitness, ddof=1):.1f}"
    assert {row["paper seconds"] for row in low_deviation} == {"–"}
    assert "prints no numbers" in tables[2].caption
    assert "prints no numbers" not in tables[0].caption


def test_a_study_that_is_not_complete_is_refused(results):
    with pytest.raises(ResultsError, match="growth=500 on case3 has 4 of 5 runs"):
        make_tables(dataclasses.replace(SUITE, num_seeds=5), results)


def test_only_parameters_that_were_varied_have_tables_and_figures(results):
    some = dataclasses.replace(SUITE, controllers=("spsfa-tip", DECAY.controller(0.5)))
    (table,) = make_tables(some, results)
    assert [str(row[0]) for row in table.rows] == ["**0.2**", "0.5"]
    assert list(plan(some, results)) == ["parameter-decay-courses", "parameter-decay-outcomes"]
    for alone in ("spsfa-tip", DECAY.controller(0.5)):
        nothing = dataclasses.replace(SUITE, controllers=(alone,))
        assert make_tables(nothing, results) == []
        assert plan(nothing, results) == {}


def test_interval_of_a_ratio_covers_it_and_pairs_the_seeds():
    rng = np.random.default_rng(0)
    unit = rng.exponential(1000.0, 50)
    low, high = ratio_interval(1.5 * unit, unit)
    assert (low, high) == pytest.approx((1.5, 1.5))  # with other seeds each it would be wide
    low, high = ratio_interval(1.5 * unit + rng.normal(0.0, 100.0, 50), unit)
    assert 1.3 < low < 1.5 < high < 1.7
    assert ratio_interval(unit, unit) == (1.0, 1.0)


@pytest.mark.parametrize("study", PARAMETER_STUDIES)
def test_courses_are_medians_of_the_fitness_and_means_of_the_rest(study, case):
    panels = draw_courses(study, case).axes
    centres = {
        "best_fitness": np.median,
        **dict.fromkeys(("population_size", "repair_degree", "evaluations"), np.mean),
    }
    for value in study.values:
        text = f"{study.symbol} = {value:g}{' (printed)' if value == study.printed else ''}"
        for axes, (name, centre) in zip(panels, centres.items(), strict=True):
            expected = centre([run.course(name) for run in case.runs[study.controller(value)]], axis=0)
            np.testing.assert_array_equal(line(axes, text)[1], expected)
    looks = {(each.get_color(), each.get_marker()) for each in panels[1].lines}
    assert len(looks) == len(study.values)


@pytest.mark.parametrize("study", PARAMETER_STUDIES)
def test_outcomes_show_every_run_and_the_papers_ratios_where_it_prints_times(study, case):
    figure = draw_outcomes(study, case)
    runs = {value: case.runs[study.controller(value)] for value in study.values}
    quality, cost = figure.axes
    for value, points in zip(runs, quality.lines, strict=False):
        assert list(points.get_ydata()) == [run.final_fitness for run in runs[value]]
        assert np.abs(points.get_xdata() - value).max() < 0.2 * np.diff(study.values).min()
    spent = np.array([np.mean([run.evaluations for run in group]) for group in runs.values()])
    ours = line(cost, "our evaluations")
    np.testing.assert_allclose(ours, [study.values, spent / spent[study.values.index(study.printed)]])
    paper = [each for each in cost.lines if each.get_label() == "the paper's time"]
    assert len(paper) == (study.table is not None)
    assert ("prints no numbers" in figure.get_suptitle()) == (study.table is None)
    for each in paper:
        assert list(each.get_xdata()) == list(study.values)
        assert each.get_ydata()[study.values.index(study.printed)] == 1.0


@pytest.mark.slow
def test_figures_are_written_and_the_same_runs_give_the_same_bytes(results, tmp_path):
    some = dataclasses.replace(SUITE, controllers=("spsfa-tip", GROWTH.controller(500.0)))
    first, second = (write_figures(some, results, tmp_path / name) for name in ("a", "b"))
    stems = ("figure-parameter-growth-courses", "figure-parameter-growth-outcomes")
    assert [path.name for path in first] == [f"{stem}.{form}" for stem in stems for form in ("svg", "png")]
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
