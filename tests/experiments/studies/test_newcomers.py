"""Tables and figures of the study of new members say what the runs say, and its document shows them."""

import dataclasses
import itertools
import re
from pathlib import Path

import numpy as np
import pytest

from experiments.documents.figures import plan
from experiments.documents.marked_blocks import block_names
from experiments.plots.decisions import draw_decisions
from experiments.plots.style import styles
from experiments.publish import publish
from experiments.runs.configuration import configuration, identity
from experiments.runs.episode import Episode
from experiments.runs.groups import group_controllers
from experiments.runs.labels import label
from experiments.studies.newcomers import findings, tables
from experiments.studies.newcomers.bends import bends_table
from experiments.studies.newcomers.corridors import MOST_NAMED, corridor_tables, ends_of
from experiments.studies.newcomers.figures import (
    POPULATION_SIZE,
    POPULATIONS,
    draw_corridors,
    draw_first_populations,
    first_population,
)
from experiments.studies.newcomers.suites import (
    BEND_CONTROLLERS,
    BEND_SUITES,
    NEWCOMERS,
    OPTIMIZERS,
    SMOOTH_MEMBERS,
    UNIFORM_MEMBERS,
    WHOLE_PATHS,
)
from experiments.studies.newcomers.tables import optimizer_tables
from experiments.tables.block_contents import CLAIM_COLUMNS, decisions_name
from experiments.tables.table import Table
from helpers.builders import make_problem
from helpers.stored_runs import (
    cells_of,
    filled_database,
    line,
    outcomes_of,
    part_of,
    stored_run,
)
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.open_loop import OpenLoop
from swarm_gym.history import HISTORY
from swarm_gym.optimizers import get_optimizer
from swarm_gym.reference import known_optimum
from swarm_gym.sources import SOURCE_DECISIONS, Source

ROOT = Path(__file__).parents[3]
PAGE, APPENDIX = Path("docs/newcomers.md"), Path("docs/newcomers-tables.md")
DOCUMENTS = ((PAGE, tables.BLOCKS), (APPENDIX, tables.TABLE_BLOCKS))
CASES = ("case1", "case2", "case3")


# First populations of other optimizers.


def test_optimizers_whose_members_are_whole_paths_are_compared():
    """One that is added later belongs to no stored result, so it need not be among them."""
    assert len(set(WHOLE_PATHS)) == 8
    assert {get_optimizer(name).encodings[0] for name in WHOLE_PATHS} == {"waypoints"}


def test_first_populations_are_compared_with_the_uniform_one():
    rng = np.random.default_rng(0)
    names = [f"particle-swarm+{m}" for m in (UNIFORM_MEMBERS, SMOOTH_MEMBERS)]
    gaps = {(c, s): rng.uniform(0.001, 0.03, 4) for c in (*names, "firefly+fixed:60") for s in CASES[:2]}
    made = optimizer_tables(OPTIMIZERS, outcomes_of(gaps))
    rows = cells_of(made, "newcomers-optimizers")
    assert [(row["optimizer"], row["scenarios"]) for row in rows] == [
        ("PSO-w", "case1"), ("PSO-w", "case2"), ("PSO-w", "all"),
    ]  # fmt: skip
    uniform, smooth = (gaps[name, "case2"] for name in names)
    assert rows[1]["gap, uniform"] == f"{100 * uniform.mean():.2f} %"
    assert rows[1]["gap, smooth"] == f"{100 * smooth.mean():.2f} %"
    assert rows[1]["difference"].startswith(f"{100 * (smooth - uniform).mean():+.2f} % [")
    assert rows[1]["improvement"] == f"{(smooth < uniform).mean():.2f}"
    assert rows[1]["near, smooth"] == f"{100 * (smooth <= 0.01).mean():.1f} %"
    assert rows[1]["evaluations ratio"] == "2.00"
    assert len(made[0].columns) <= 9
    assert optimizer_tables(OPTIMIZERS, outcomes_of({("firefly+fixed:60", "case1"): [0.1, 0.2]})) == []


# Kinds of bends.


def test_suites_of_both_kinds_of_bends_differ_in_the_kind_alone():
    for one, other in zip(*BEND_SUITES.values(), strict=True):
        assert one.options == {"source": "smooth", "bends": "harmonics"}
        assert other.options == {"source": "smooth", "bends": "stomp"}
        assert dataclasses.replace(one, name="", options={}) == dataclasses.replace(
            other, name="", options={}
        )


def test_runs_have_the_kind_of_bends_of_their_suite_and_the_source_of_their_controller():
    controller = BEND_CONTROLLERS[0]
    for kind, (suite, _) in BEND_SUITES.items():
        settings = Episode((controller, "case1", suite.first_seed), suite).simulation.settings
        assert (settings.bends, settings.source, settings.amplitude) == (kind, "smooth", 0.2)
        assert configuration(suite)["settings"]["bends"] == kind


def test_open_loops_with_other_first_populations_are_not_taken_for_each_other():
    same = (60, [0], [60.0], [0.0])
    found = [
        identity("open-loop:a", OpenLoop(Knots(*same, first_source=s))) for s in (None, Source(), Source(1.0))
    ]
    assert len(set(map(repr, found))) == 3


def test_kinds_of_bends_are_paired_by_scenario_and_seed():
    rng = np.random.default_rng(1)
    makes = [
        {(c, s): rng.uniform(0.01, 0.1, 5) for c in BEND_CONTROLLERS[:2] for s in CASES[:2]} for _ in range(2)
    ]
    found = bends_table({kind: [outcomes_of(g)] for kind, g in zip(BEND_SUITES, makes, strict=True)})
    rows = cells_of([found], "newcomers-bends")
    assert len(rows) == 3 * 2
    assert rows[0]["controller"] == "FA-20 (smooth, amplitude 0.2)"
    one, other = (made[BEND_CONTROLLERS[0], "case1"] for made in makes)
    assert rows[0]["harmonics"].startswith(f"{100 * one.mean():.2f} % [")
    assert rows[0]["stomp"].startswith(f"{100 * other.mean():.2f} % [")
    assert rows[0]["harmonics - stomp"].startswith(f"{100 * (one - other).mean():+.2f} % [")
    assert rows[0]["improvement"] == f"{(one < other).mean():.2f}"
    same = bends_table({kind: [outcomes_of(makes[0])] for kind in BEND_SUITES})
    assert {row["harmonics - stomp"] for row in cells_of([same], same.name)} == {"+0.00 % [+0.00, +0.00]"}
    assert len(found.columns) <= 9


# Corridors.


def beside(offset):
    """Return a path on case 1 whose middle part lies at this height."""
    middle = [(x, offset) for x in (60.0, 400.0, 600.0, 940.0)]
    return np.array([(20.0, 300.0), *middle, (980.0, 300.0)])


ABOVE, BELOW = beside(560.0), beside(100.0)
# Corridors whose lines pass between obstacles, from above to below.
BETWEEN = [beside(height) for height in (240.0, 200.0, 280.0, 330.0, 380.0)]


@pytest.fixture(scope="module")
def ended():
    """Outcomes of two controllers on case 1: three runs above, two below, one in each of other corridors."""
    optimum = known_optimum(make_problem("case1"))
    ends = {
        "fixed:60": [(ABOVE, 0.3), (ABOVE, 0.2), (BELOW, 0.1), (BETWEEN[0], 0.5), (BETWEEN[1], 0.6)],
        "learned:a/0": [(ABOVE, 0.4), (BELOW, 0.2), (BETWEEN[2], 0.7), (BETWEEN[3], 0.8), (BETWEEN[4], 0.9)],
    }
    runs = {name: [] for name in ends}
    for name, of in ends.items():
        for k, (path, gap) in enumerate(of):
            found = {"final_fitness": optimum * (1.0 + gap), "best_path": path}
            runs[name].append(stored_run((name, "case1", k), {"evaluations": [1.0]}, **found))
    gaps = {(name, "case1"): [gap for _, gap in of] for name, of in ends.items()}
    return outcomes_of(gaps, lambda controller, _: runs[controller])


def test_corridors_are_named_by_the_best_path_in_them_and_the_rare_ones_are_pooled(ended):
    found = ends_of("case1", ended)
    assert [corridor.name for corridor in found.corridors] == list("ABCDE")
    best, below, above, *_ = found.corridors
    assert best.runs == ()
    assert best.fitness == found.optimum
    assert below.path is BELOW
    assert above.path is ABOVE
    assert (len(below.runs), len(above.runs)) == (2, 3)
    assert above.fitness == pytest.approx(1.2 * found.optimum)
    fitness = [corridor.fitness for corridor in found.corridors]
    assert fitness == sorted(fitness)
    assert found.names["fixed:60"] == ["C", "C", "B", "D", "E"]
    assert found.names["learned:a/0"] == ["C", "B", "others", "others", "others"]
    assert found.pooled == 3


def test_shares_of_corridors_add_up(ended):
    made = corridor_tables(NEWCOMERS, ended)
    fixed, learned = cells_of(made, "corridors")
    assert fixed["A"] == "0.0 % [0.0, 0.0]"
    assert [fixed[name] for name in ("B", "C", "D", "E", "others")] == [
        "20.0 %", "40.0 %", "20.0 %", "20.0 %", "0.0 %",
    ]  # fmt: skip
    assert learned["controller"] == "learned a"
    assert learned["others"] == "60.0 %"
    optimal, below, above, *_ = cells_of(made, "corridor-paths")
    assert (optimal["corridor"], optimal["runs"], optimal["median gap"]) == ("A", "0.0 %", "–")
    assert (below["best gap"], below["median gap"], below["runs"]) == ("10.00 %", "15.00 %", "20.0 %")
    assert above["median gap"] == "30.00 %"
    assert above["other corridors"] == "3"
    assert all(len(table.columns) <= 9 for table in made)


def test_corridors_of_a_map_where_all_runs_end_in_one_have_one_letter(ended):
    only = outcomes_of({("fixed:60", "case1"): [0.1, 0.2]}, lambda *_: ended.runs("fixed:60", "case1")[:2])
    (row,) = cells_of(corridor_tables(NEWCOMERS, only), "corridors")
    assert [row[name] for name in "BCDE"] == ["100.0 %", "–", "–", "–"]


def test_the_figure_of_corridors_shows_the_best_path_in_each(ended):
    axes = draw_corridors([ends_of("case1", ended)]).axes[0]
    labels = axes.get_legend_handles_labels()[1]
    assert labels[:3] == [
        "A: the optimum, 0 % of the runs",
        "B: best gap 10.00 %, 20 % of the runs",
        "C: best gap 20.00 %, 30 % of the runs",
    ]
    assert len(labels) == MOST_NAMED
    np.testing.assert_array_equal(line(axes, labels[1]), BELOW.T)


# First populations and decisions.


def test_first_populations_come_from_their_sources():
    zigzags = []
    for options in POPULATIONS.values():
        snapshot = first_population("case2", options)
        assert snapshot.paths.shape[0] == len(snapshot.collisions) == POPULATION_SIZE
        zigzags.append(np.abs(np.diff(snapshot.paths[..., 1], n=2, axis=1)).sum(axis=1).mean())
    uniform, *smooth = zigzags
    assert max(smooth) < 0.1 * uniform
    assert smooth[0] != smooth[1]


def test_the_figure_of_first_populations_has_a_panel_for_each_source_on_each_map():
    titles = [axes.get_title() for axes in draw_first_populations().axes]
    assert len(titles) == 2 * len(POPULATIONS)
    assert titles[-1] == "case2, smooth (stomp)"


def test_decisions_on_new_members_have_rows_where_they_vary(tmp_path):
    columns = (*HISTORY, "noise", *SOURCE_DECISIONS)
    suite = part_of(NEWCOMERS, ("fixed:60", "open-loop:a"), ("case1",), 2, baseline="fixed:60")
    rng = np.random.default_rng(0)

    def run(controller, seed):
        decides = controller == "open-loop:a"
        trace = rng.uniform(0.1, 1.0, (5, len(columns) if decides else len(HISTORY) + 1))
        trace[:, columns.index("noise")] = 2.0
        if decides:
            trace[:, columns.index("immigrants")] = 0.0
        usual = {"final_fitness": 400.0, "columns": columns[: trace.shape[1]]}
        return stored_run((controller, "case1", seed), trace, **usual)

    runs = itertools.starmap(run, itertools.product(suite.controllers, suite.seeds["case1"]))
    with filled_database(tmp_path, runs) as made:
        panels = draw_decisions(suite, made, "open-loop:a", styles(suite.controllers)).axes
        drawings = plan(dataclasses.replace(suite, figures=("decisions",)), made)
    assert [axes.get_ylabel() for axes in panels] == [
        "population size", "repair degree φ", "smooth share of new members", "amplitude of new members",
    ]  # fmt: skip
    assert list(drawings) == ["decisions-open-loop-a"]


# The document.


@pytest.mark.parametrize(("path", "blocks"), DOCUMENTS)
def test_a_document_has_every_block_once(path, blocks):
    assert sorted(block_names((ROOT / path).read_text(encoding="utf-8"))) == sorted(blocks)


@pytest.mark.parametrize("path", [PAGE, APPENDIX])
def test_a_document_has_no_figures_but_those_of_its_blocks(path):
    text = (ROOT / path).read_text(encoding="utf-8")
    own = re.sub(r"<!-- (\S+) -->.*?<!-- /\1 -->", "", text, flags=re.DOTALL)
    assert "![" not in own
    assert max(map(len, own.splitlines())) <= 100


COLUMNS = {
    "gaps": tables.GAP_COLUMNS,
    "near-optimum": ("controller", "case1", "all"),
    "differences": ("scenarios", "controller", "difference"),
    "duels": ("scenarios", "controller", "rival", "difference"),
    "front": ("scenarios", "controller", "on the front"),
    "hypervolume": ("scenarios", "family", "controllers", "hypervolume"),
    "corridors": ("scenarios", "controller", "A"),
    "corridor-paths": ("scenarios", "corridor", "runs"),
    "claims": ("claim", "scenarios", *CLAIM_COLUMNS),
    "newcomers-optimizers": ("optimizer", "scenarios", "uniform"),
}

# Rows that the page picks from tables, by the name of the table.
PICKED_ROWS = {
    "gaps": lambda _: [("all", label(group), *("0.1 %",) * 6) for group in findings.STRONGEST],
    "near-optimum": lambda _: [(label(group), "95 %", "99 %") for group in findings.STRONGEST],
    "claims": lambda suite: [
        (finding.sentence, scenario_set, "gap", "1", "2", "-1", "**no**")
        for finding in findings.FINDINGS
        for of, scenario_set, _ in finding.rows
        if of == suite
    ],
}


@pytest.fixture
def results(tmp_path, monkeypatch):
    """A checkout with the page, made-up tables and figures of all suites, and databases of kinds of bends."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "docs").mkdir()
    for path in (PAGE, APPENDIX):
        (tmp_path / path).write_bytes((ROOT / path).read_bytes())
    folder = tmp_path / "results/docs/newcomers-study"
    parts = {"controllers": BEND_CONTROLLERS[:1], "num_seeds": 2}
    small = {
        kind: tuple(dataclasses.replace(suite, scenarios=suite.scenarios[:2], **parts) for suite in pair)
        for kind, pair in BEND_SUITES.items()
    }
    monkeypatch.setattr(tables, "BEND_SUITES", small)
    bends = [suite for pair in small.values() for suite in pair]
    others = ("newcomers", "newcomers-fields", "newcomers-ablation", "newcomers-optimizers")
    for name in (*others, *(suite.name for suite in bends)):
        (folder / name).mkdir(parents=True)
        (folder / name / "made-with.md").write_text(f"Runs made with: {name}.\n")
        for table, columns in COLUMNS.items():
            rows = [tuple(f"{column} {k} of {name}" for column in columns) for k in range(2)]
            rows += PICKED_ROWS[table](name) if table in PICKED_ROWS else []
            (folder / name / f"{table}.json").write_text(Table(table, f"All {table}", columns, rows).json())
        decisions = map(decisions_name, group_controllers(NEWCOMERS.controllers))
        for figure in ("first-populations", "corridors", "front", "profiles", *decisions):
            (folder / name / f"figure-{figure}.svg").write_text(f"{name} {figure}")
    for suite in bends:
        (folder / f"{suite.name}-made").mkdir()
        keys = [(c, s, k) for c in suite.controllers for s, seeds in suite.seeds.items() for k in seeds]
        runs = [stored_run(key, {"evaluations": [1.0]}, final_fitness=400.0) for key in keys]
        with filled_database(folder / f"{suite.name}-made", runs):
            pass
        (folder / f"{suite.name}-made/made.sqlite").rename(folder / f"{suite.name}.sqlite")
    return tmp_path / "results"


def test_publishing_fills_the_page_and_copies_its_figures(results):
    publish("newcomers", results)
    text, appendix = (path.read_text(encoding="utf-8") for path in (PAGE, APPENDIX))
    assert "| SPSFA-TIP | 0.1 % | 0.1 % | 99 % | 0.1 % | 0.1 % |" in text
    assert "* Policies that decide sources have a smaller objective by PPO than by CMA-ES. Three" in text
    assert "Runs made with: newcomers-stomp-fields." in appendix
    assert "| FA-20 (smooth, amplitude 0.2) |" in appendix
    assert "All corridors.\n\n**scenarios 0 of newcomers**" in appendix
    for shown_by, name, some in (
        (text, "newcomers", "first-populations"),
        (appendix, "newcomers-tables", "decisions-learned-three-cases-extended-seeds-2"),
    ):
        shown = set(re.findall(rf"\]\(results/{name}/(\S+)\)", shown_by))
        assert f"newcomers-{some}.svg" in shown
        assert {path.name for path in Path("docs/results", name).iterdir()} == shown
    publish("newcomers", results)
    assert [path.read_text(encoding="utf-8") for path in (PAGE, APPENDIX)] == [text, appendix]


def test_nothing_is_written_about_decisions_that_are_not_there(results):
    for file in (results / "docs/newcomers-study/newcomers").glob("figure-decisions-*"):
        file.unlink()
    publish("newcomers", results)
    for path in (PAGE, APPENDIX):
        assert "![decisions of" not in path.read_text(encoding="utf-8")
