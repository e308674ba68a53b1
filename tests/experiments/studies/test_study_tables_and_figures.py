"""Tables and figures over training seeds and sets of scenarios say what the runs say."""

import dataclasses
import itertools
import re

import numpy as np
import pytest
from scipy import stats

from experiments.documents.figures import plan, write_figures
from experiments.documents.suite_page import make_tables
from experiments.plots.decisions import draw_decisions, load_courses
from experiments.plots.gaps import draw_front, draw_profiles, logarithmic_ticks
from experiments.plots.style import styles
from experiments.runs.database import ResultsError
from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import ControllerFamily, Suite
from experiments.statistics import holm, hypervolume
from experiments.studies.controllers import training_seeds
from experiments.studies.learned.suites import STUDY_FIGURES, STUDY_TABLES
from experiments.tables.differences import difference_tables, paired_comparison_tables
from experiments.tables.headline import headline_tables
from helpers.builders import make_problem
from helpers.stored_runs import cells_of, filled_database, line, printed_rows, stored_run
from swarm_gym.errors import ScenarioError
from swarm_gym.history import HISTORY
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import known_optimum
from swarm_gym.scenarios import SCENARIOS, Circle

FIELDS = tuple(f"fields:test:{k}" for k in range(6))
LEARNED = training_seeds("learned:a", 3)
SUITE = Suite(
    name="made",
    controllers=("fixed:60", "spsfa-tip", *LEARNED),
    scenarios=("case1", *FIELDS),
    num_seeds=4,
    baseline="spsfa-tip",
    first_seed=10_000,
    seed_step=4,
    families=(ControllerFamily("hand", ("spsfa-tip", "fixed:60")), ControllerFamily("none", ("fixed:7",))),
    tables=tuple(name for name in STUDY_TABLES if name != "free-paths"),  # made-up runs have no paths
    figures=STUDY_FIGURES,
)
WIDER = (*HISTORY, "noise", "attractiveness", "absorption")
ITERATIONS = 6


@pytest.fixture(scope="module", autouse=True)
def fields():
    """Scenarios of a set, whose optimum is known since they are case 1 by another name."""
    with pytest.MonkeyPatch.context() as patch:
        for name in FIELDS:
            patch.setitem(SCENARIOS, name, SCENARIOS["case1"])
        yield


@pytest.fixture(scope="module")
def gaps():
    """By run: heavy-tailed, of the policies the smallest, at the least evaluations."""
    rng = np.random.default_rng(0)
    scale = {"fixed:60": 0.05, "spsfa-tip": 0.03}
    return {
        (controller, scenario, seed): scale.get(controller, 0.01) * rng.exponential()
        for controller in SUITE.controllers
        for scenario, seeds in SUITE.seeds.items()
        for seed in seeds
    }


def evaluations(controller):
    return {"fixed:60": 170_000, "spsfa-tip": 90_000}.get(controller, 50_000)


def make_run(key, gap):
    controller, _, seed = key
    rng = np.random.default_rng([SUITE.controllers.index(controller), seed])
    trace = rng.uniform(1.0, 90.0, (ITERATIONS + 1, len(WIDER)))
    if controller not in LEARNED:
        trace[:, len(HISTORY) :] = 2.0, 1.0, 1e-3
    if controller == "fixed:60":
        trace[:, 1], trace[1:, 2] = 60.0, 0.5
    return stored_run(
        key,
        trace,
        final_fitness=known_optimum(make_problem("case1")) * (1.0 + gap),
        final_collision=0.0 if gap < 0.1 else 2.0 * FEASIBILITY_TOLERANCE,
        evaluations=evaluations(controller),
        seconds=0.25,
        columns=WIDER,
    )


@pytest.fixture(scope="module")
def results(tmp_path_factory, gaps):
    runs = itertools.starmap(make_run, gaps.items())
    with filled_database(tmp_path_factory.mktemp("results"), runs) as database:
        yield database


@pytest.fixture(scope="module")
def outcomes(results):
    return results.outcomes(SUITE.controllers, SUITE.seeds)


@pytest.fixture(scope="module")
def tables(results):
    made = make_tables(SUITE, results)
    return {table.name: cells_of(made, table.name) for table in made}


def of(gaps, controllers, scenarios):
    """(training seeds, scenarios, seeds) by looking up every run."""
    return np.array([[[gaps[c, s, seed] for seed in SUITE.seeds[s]] for s in scenarios] for c in controllers])


def row(table, scenarios, controller):
    (found,) = [r for r in table if (r["scenarios"], r["controller"]) == (scenarios, controller)]
    return found


def test_outcomes_are_the_runs_in_order(outcomes, gaps):
    np.testing.assert_allclose(outcomes.gap, of(gaps, SUITE.controllers, SUITE.scenarios), atol=1e-12)
    assert list(outcomes.sets) == ["case1", "fields:test", "all"]
    sample = outcomes.sample("learned:a/*", "fields:test")
    np.testing.assert_allclose(sample.gap, of(gaps, LEARNED, FIELDS), atol=1e-12)
    assert sample.set_sizes == (6,)
    assert outcomes.sample("fixed:60", "all").set_sizes == (1, 6)
    runs = outcomes.of("fixed:60", "case1")
    assert runs.fitness.shape == (4,)
    assert set(runs.evaluations) == {170_000}


def test_a_missing_run_is_named(results):
    with pytest.raises(ResultsError, match=r"fixed:60 on case1 has 4 of 5 runs"):
        results.outcomes(["fixed:60"], {"case1": range(10_000, 10_005)})


def test_a_gap_to_an_unknown_optimum_is_refused(monkeypatch):
    case = SCENARIOS["case1"]()
    moved = dataclasses.replace(case, obstacles=(*case.obstacles, Circle(500.0, 50.0, 3.0)))
    monkeypatch.setitem(SCENARIOS, "fields:new:3", lambda: moved)
    one = np.ones((1, 2, 1))
    with pytest.raises(ScenarioError, match=r"1 of 2 scenarios, the first of them fields:new:3"):
        _ = Outcomes(("fixed:60",), ("case1", "fields:new:3"), one, one, one, one).gap


def test_gaps_pool_all_training_seeds(tables, gaps):
    values = of(gaps, LEARNED, FIELDS)
    found = row(tables["gaps"], "fields:test", "learned a")
    assert (found["runs"], found["training seeds"]) == ("72", "3")
    assert found["mean gap"].startswith(f"{100 * values.mean():.2f} % [")
    middle = stats.trim_mean(values, 0.25, axis=None)
    assert found["inter-quartile mean"].startswith(f"{100 * middle:.2f} % [")
    assert found["max"] == f"{100 * values.max():.2f} %"
    assert found["mean evaluations"] == "50,000"
    assert found["mean seconds"] == "0.250"
    worst = of(gaps, ["fixed:60"], SUITE.scenarios)
    assert (worst >= 0.1).any()
    assert row(tables["gaps"], "all", "FA-60")["feasible"] == f"{100 * (worst < 0.1).mean():.1f} %"
    assert len(tables["gaps"]) == 3 * 3


def test_shares_near_the_optimum(tables, gaps):
    near = of(gaps, LEARNED, FIELDS) <= 0.01
    (found,) = [r for r in tables["near-optimum"] if r["controller"] == "learned a"]
    assert found["fields:test"].startswith(f"{100 * near.mean():.1f} % [")


def sign(differences):
    """The sign of the sum of signed ranks of differences without ties."""
    order = np.argsort(np.abs(differences))
    rank_sum = sum((k + 1) * np.sign(differences[place]) for k, place in enumerate(order))
    return "−" if rank_sum < 0 else "+"


def test_differences_are_paired_and_corrected_over_the_table(tables, gaps):
    strata = {"case1": ["case1"], "fields:test": FIELDS, "all": SUITE.scenarios}
    expected, p_values = {}, []
    for name, scenarios in strata.items():
        theirs = of(gaps, ["spsfa-tip"], scenarios)
        for controller, members in (("FA-60", ["fixed:60"]), ("learned a", LEARNED)):
            mine = of(gaps, members, scenarios)
            by_pair = (mine.mean(axis=0) - theirs[0]).ravel()
            p_values.append(stats.wilcoxon(by_pair).pvalue)
            expected[name, controller] = mine.mean() - theirs.mean(), (mine < theirs).mean(), sign(by_pair)
    assert len(tables["differences"]) == len(expected)
    for (key, (difference, improvement, mark)), p_value in zip(expected.items(), holm(p_values), strict=True):
        found = row(tables["differences"], *key)
        assert found["difference"].startswith(f"{100 * difference:+.2f} % [")
        assert found["improvement"] == f"{improvement:.2f}"
        assert found["p"] == f"{p_value:.2g} ({mark})"
    assert row(tables["differences"], "all", "FA-60")["evaluations ratio"] == "1.89"


def test_paired_comparisons_are_of_the_pairs_that_were_run(outcomes, gaps):
    pairs = (("learned:a/*", "fixed:60"), ("spsfa-tip", "learned:a/*"), ("learned:a/*", "learned:b/*"))
    (table,) = paired_comparison_tables(dataclasses.replace(SUITE, pairs=pairs), outcomes)
    assert [r[:3] for r in printed_rows(table)[:2]] == [
        ("case1", "learned a", "FA-60"),
        ("case1", "SPSFA-TIP", "learned a"),
    ]
    assert len(table.rows) == 2 * 3
    mine, theirs = of(gaps, LEARNED, ["case1"]), of(gaps, ["fixed:60"], ["case1"])
    first = cells_of([table], "duels")[0]
    assert first["difference"].startswith(f"{100 * (mine.mean() - theirs.mean()):+.2f} % [")
    by_pair = [
        (of(gaps, a, scenarios).mean(axis=0) - of(gaps, b, scenarios).mean(axis=0)).ravel()
        for scenarios in (["case1"], FIELDS, SUITE.scenarios)
        for a, b in ((LEARNED, ["fixed:60"]), (["spsfa-tip"], LEARNED))
    ]
    p_values = holm([stats.wilcoxon(differences).pvalue for differences in by_pair])
    expected = [f"{p:.2g} ({sign(d)})" for p, d in zip(p_values, by_pair, strict=True)]
    assert [r[-1] for r in printed_rows(table)] == expected
    assert paired_comparison_tables(dataclasses.replace(SUITE, pairs=pairs[2:]), outcomes) == []


def test_the_headline_table_has_each_group_beside_itself_blinded_and_the_best_blind_rival(outcomes, gaps):
    """Blinded seeds are those of `learned:a`, each with a gap that is 0.01 larger at as many evaluations."""
    fitness, collision, evaluations, seconds = numbers(outcomes)
    optimum = known_optimum(make_problem("case1"))
    rows = [outcomes.controllers.index(name) for name in LEARNED]
    stacked = [
        np.concatenate([fitness, fitness[rows] + 0.01 * optimum]),
        *(np.concatenate([values, values[rows]]) for values in (collision, evaluations, seconds)),
    ]
    names = (*outcomes.controllers, *training_seeds("blinded:a", 3))
    families = (
        ControllerFamily("sees", ("spsfa-tip",)),
        ControllerFamily("blind", ("fixed:60", "fixed:7"), blind=True),
    )
    suite = dataclasses.replace(SUITE, controllers=names, families=families)
    tables = headline_tables(suite, Outcomes(names, outcomes.scenarios, *stacked))
    cells = {cell["controller"]: cell for cell in cells_of(tables, "headline")}
    assert set(cells) == {"FA-60", "SPSFA-TIP", "learned a"}

    mine = 100 * of(gaps, LEARNED, SUITE.scenarios) + 0.5
    rival = 100 * of(gaps, ["fixed:60"], SUITE.scenarios) + 1.7
    found = cells["learned a"]
    assert found["objective"].startswith(f"{mine.mean():.3f} [")
    assert found["minus itself blinded"] == "-1.000 [-1.000, -1.000]"
    assert found["minus the best blind rival"].startswith(f"{mine.mean() - rival.mean():+.3f} [")
    assert cells["FA-60"]["minus itself blinded"] == cells["FA-60"]["minus the best blind rival"] == "–"
    ordered = [cell["controller"] for cell in cells_of(tables, "headline")]
    assert ordered == sorted(ordered, key=lambda name: float(cells[name]["objective"].split(" ")[0]))


def test_without_the_baseline_nothing_is_compared(results):
    suite = dataclasses.replace(SUITE, controllers=LEARNED, tables=("differences", "front"))
    assert [table.name for table in make_tables(suite, results)] == ["front"]


def test_training_seeds_of_a_baseline_are_drawn_independently(outcomes):
    """Two recipes with the same runs differ by nothing, but by chance by as much as their trainings do."""
    one = Outcomes(LEARNED, ("case1",), *(values[2:, :1] for values in numbers(outcomes)))
    both = [np.concatenate([values, values]) for values in numbers(one)]
    both[0] = both[0] * np.array([1.0, 1.02, 1.05] * 2)[:, None, None]
    names = (*LEARNED, *training_seeds("learned:b", 3))
    suite = dataclasses.replace(SUITE, controllers=names, scenarios=("case1",), baseline="learned:b/*")
    (table,) = difference_tables(suite, Outcomes(names, ("case1",), *both))
    ((_, controller, difference, *_, improvement, p_value),) = printed_rows(table)
    assert (controller, improvement, p_value) == ("learned a", "0.50", "1")
    centre, low, high = map(float, re.findall(r"[+-][\d.]+", difference))
    assert centre == 0.0
    assert low < -1.0
    assert high > 1.0


def numbers(outcomes):
    return outcomes.fitness, outcomes.collision, outcomes.evaluations, outcomes.seconds


def test_the_front_is_what_nothing_dominates(tables, gaps):
    assert [r["on the front"] for r in tables["front"] if r["scenarios"] == "all"] == ["no", "no", "yes"]
    (found,) = [r for r in tables["hypervolume"] if r["scenarios"] == "case1"]
    assert (found["family"], found["controllers"]) == ("hand", "SPSFA-TIP, FA-60")
    points = [(np.log10(evaluations(c)), of(gaps, [c], ["case1"]).mean()) for c in ("spsfa-tip", "fixed:60")]
    expected = hypervolume(np.array(points), (6.0, 0.2))
    assert found["hypervolume"].startswith(f"{expected:.4f} [")


def test_profiles_show_the_share_of_runs(outcomes, gaps):
    figure = draw_profiles(outcomes)
    assert [axes.get_title() for axes in figure.axes] == ["case1", "fields:test", "all"]
    x, y = line(figure.axes[1], "learned a")
    values = of(gaps, LEARNED, FIELDS).ravel()
    np.testing.assert_allclose(y[1:-1], [(values <= tau).mean() for tau in x[1:-1]])
    assert y[-1] == 1.0


def test_the_front_shows_every_group_and_connects_families(outcomes, gaps):
    axes = draw_front(SUITE, outcomes).axes[0]
    points = {c: line(axes, label(c))[:, 0] for c in ("fixed:60", "spsfa-tip", "learned:a/*")}
    np.testing.assert_allclose(points["learned:a/*"], (50_000, of(gaps, LEARNED, ["case1"]).mean()))
    np.testing.assert_array_equal(line(axes, "hand").T, [points["spsfa-tip"], points["fixed:60"]])
    assert "none" not in axes.get_legend_handles_labels()[1]


def test_decisions_are_medians_over_all_training_seeds_beside_the_baseline(results):
    among = styles(["fixed:60", "spsfa-tip", "learned:a/*"])
    panels = draw_decisions(SUITE, results, "learned:a/*", among).axes
    for axes in panels:  # they hold all that is drawn in them
        low, high = axes.get_ylim()
        assert low == 0.0
        assert axes.dataLim.y1 < high
    assert [axes.get_ylabel() for axes in panels[::2]] == [
        "population size", "repair degree φ", "noise α", "attractiveness β₀",
    ]  # fmt: skip
    runs = [
        run
        for name in LEARNED
        for field in FIELDS
        for run in results.runs(name, field, 4, SUITE.seeds[field][0])
    ]
    assert len(runs) == 3 * 6 * 4
    noise = np.median([run.course("noise") for run in runs], axis=0)
    np.testing.assert_allclose(line(panels[5], "learned a")[1], noise)
    assert "SPSFA-TIP" in panels[0].get_legend_handles_labels()[1]
    assert set(line(panels[4], "SPSFA-TIP")[1]) == {2.0}
    assert len(load_courses(SUITE, results, "spsfa-tip", FIELDS)) == 4
    panels = draw_decisions(SUITE, results, "fixed:60", among).axes
    assert [axes.get_ylabel() for axes in panels[::2]] == ["population size", "repair degree φ"]


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0.0006, 0.5, [0.001, 0.01, 0.1]),
        (0.0006, 0.05, [0.001, 0.003, 0.01, 0.03]),
        (45e3, 550e3, [50e3, 100e3, 200e3, 500e3]),
        (60e3, 160e3, [70e3, 100e3, 150e3]),
        (75e3, 160e3, [80e3, 100e3, 120e3, 150e3]),
        (105e3, 125e3, [105e3, 110e3, 115e3, 120e3, 125e3]),
    ],
)
def test_a_logarithmic_axis_has_labels_enough(low, high, expected):
    np.testing.assert_allclose(logarithmic_ticks(low, high), expected)


@pytest.mark.slow
def test_figures_of_the_study_leave_out_who_decides_nothing(results, tmp_path):
    assert list(plan(SUITE, results)) == ["profiles", "front", "decisions-learned-a-seeds"]
    first = {path.name: path.read_bytes() for path in write_figures(SUITE, results, tmp_path / "one")}
    again = {path.name: path.read_bytes() for path in write_figures(SUITE, results, tmp_path / "two")}
    assert first == again
    assert len(first) == 2 * 3


def test_ten_unknown_groups_are_told_apart_without_colour():
    many = styles([f"learned:{name}/*" for name in "abcdefghij"]).values()
    assert len({style.marker for style in many}) == 10
    assert len({str(style.line) for style in many}) == 10
