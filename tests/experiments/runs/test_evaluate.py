"""Suites and the results database: nothing lost, nothing doubled, nothing mixed."""

import dataclasses
import sqlite3
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np
import pytest

from agents.backends import BackendOptions
from agents.backends.local import LocalBackend
from experiments.catalogue import COLLECTIONS, SUITES
from experiments.documents.marked_blocks import fill
from experiments.documents.records import records_in
from experiments.documents.suite_page import make_tables
from experiments.evaluate import EvaluateConfig, evaluate
from experiments.runs import episode
from experiments.runs.configuration import configuration, stated
from experiments.runs.database import Results, ResultsError
from experiments.runs.episode import Episode
from experiments.runs.runner import run_missing
from experiments.runs.suite import Suite
from experiments.tables.document import Document
from helpers.stored_runs import filled_database, make_database, stored_run
from helpers.trainings import make_correction
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.open_loop import save_open_loop
from swarm_gym.controllers.tuned import save_tuned
from swarm_gym.errors import UnknownNameError
from swarm_gym.history import HISTORY
from swarm_gym.scenarios import expand_name
from swarm_gym.settings import Settings

SUITE = Suite(
    name="tiny",
    controllers=("fixed:3", "fixed:60", "spsfa-tip"),
    scenarios=("case1", "case3"),
    num_seeds=2,
    baseline="spsfa-tip",
    snapshots=(("fixed:3", "case1", 1, (0, 7, 100)),),
)
KEYS = {(c, s, k) for c in SUITE.controllers for s in SUITE.scenarios for k in range(2)}


@pytest.fixture(scope="module")
def database(tmp_path_factory):
    return make_database(tmp_path_factory.mktemp("results") / "tiny.sqlite", SUITE)


@pytest.fixture
def copied(database, tmp_path):
    copy = tmp_path / "tiny.sqlite"
    copy.write_bytes(database.read_bytes())
    return copy


@pytest.fixture
def results(copied):
    with closing(Results(copied, configuration(SUITE))) as opened:
        yield opened


@pytest.fixture
def known(monkeypatch):
    """The suite, known by its name."""
    monkeypatch.setitem(SUITES, "tiny", SUITE)


def asked(suite, folder, **options):
    """Return the configuration of an evaluation by one process into a folder, without figures."""
    return EvaluateConfig(suite, output=folder, where=BackendOptions(jobs=1), figures=False, **options)


@contextmanager
def results_of(suite, path, workers=1):
    """Open a database with all runs of a suite, made here."""
    with closing(Results(path, configuration(suite))) as made:
        run_missing(suite, made, LocalBackend(workers))
        yield made


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_every_run_of_a_suite_is_stored_once(results):
    assert results.finished() == KEYS
    runs = results.runs("spsfa-tip", "case1", 2)
    assert [run.seed for run in runs] == [0, 1]
    for run in runs:
        assert run.columns == (*HISTORY, "noise", "attractiveness", "absorption")
        assert run.trace.shape == (101, len(run.columns))
        assert set(run.course("noise")) == {2.0}
        assert run.course("best_fitness")[-1] == run.final_fitness
        assert run.course("evaluations")[-1] == run.evaluations
        assert run.course("population_size")[0] == 80
        assert (np.diff(run.course("best_fitness")) <= 0).all()
        np.testing.assert_allclose(run.best_path[[0, -1]], [[20, 300], [980, 300]])
        length = np.linalg.norm(np.diff(run.best_path, axis=0), axis=1).sum()
        assert run.final_fitness == pytest.approx(0.3 * length + 0.7 * run.final_collision)
        assert run.seconds > 0
        assert run.provenance["numba"]


def test_provenances_are_those_of_the_runs_asked_for(results):
    with results.connection as connection:
        connection.execute("UPDATE runs SET provenance = '{\"numba\": \"9\"}' WHERE controller = 'fixed:3'")
    assert results.provenances(("fixed:3",), {"case1": range(2)}) == [{"numba": "9"}]
    assert len(results.provenances(SUITE.controllers, SUITE.seeds)) == 2
    assert results.provenances(SUITE.controllers, {"case1": range(7, 9)}) == []


def test_snapshots_of_chosen_runs_are_stored(results):
    kept = results.snapshots("fixed:3", "case1", 1)
    assert [snapshot.iteration for snapshot in kept] == [0, 7, 100]
    assert kept[0].paths.shape == (3, 33, 2)
    assert results.snapshots("fixed:3", "case1", 0) == []


def test_runs_equal_in_one_process_and_in_several(results, tmp_path):
    with results_of(SUITE, tmp_path / "other.sqlite", workers=2) as other:
        for controller, scenario, _ in KEYS:
            both = (of.runs(controller, scenario, 2) for of in (results, other))
            for one, two in zip(*both, strict=True):
                np.testing.assert_array_equal(one.trace, two.trace)
                np.testing.assert_array_equal(one.best_path, two.best_path)


def test_a_suite_that_dies_keeps_what_it_had_finished_and_goes_on_without_recomputing(results, monkeypatch):
    with results.connection as connection:
        connection.execute("DELETE FROM runs")
    ran, run = [], Episode.run

    def dying(episode, *arguments):
        ran.append(episode.key)
        if len(ran) == 5:
            raise KeyboardInterrupt
        return run(episode, *arguments)

    monkeypatch.setattr(Episode, "run", dying)
    with pytest.raises(KeyboardInterrupt):
        run_missing(SUITE, results, LocalBackend(1))
    assert results.finished() == set(ran[:4])
    run_missing(SUITE, results, LocalBackend(1))
    assert results.finished() == set(ran) == KEYS
    run_missing(SUITE, results, LocalBackend(1))
    assert len(ran) == len(KEYS) + 1


def test_a_stored_run_is_never_overwritten(results):
    run = results.runs("fixed:3", "case1", 1)[0]
    results.add(dataclasses.replace(run, final_fitness=0.0))
    assert results.runs("fixed:3", "case1", 1)[0].final_fitness == run.final_fitness


@pytest.mark.parametrize(
    ("key", "value"),
    [("settings", {"iterations": 50}), ("scenario case1", "0123")],
)
def test_a_database_of_another_configuration_is_refused(copied, key, value):
    with pytest.raises(ResultsError, match=f"another configuration: {key} was"):
        Results(copied, {**configuration(SUITE), key: value})
    with closing(Results(copied, configuration(SUITE))) as again:  # nothing was changed by the refusal
        assert again.finished() == KEYS


def test_an_option_that_is_added_to_the_environments_leaves_stored_runs_usable(monkeypatch):
    before = configuration(SUITE)

    @dataclasses.dataclass(frozen=True)
    class Later(Settings):
        wind: float = 0.0

    monkeypatch.setattr("experiments.runs.configuration.Settings", Later)
    assert configuration(SUITE) == before
    assert stated(Later(wind=2.0)) == {**stated(Settings()), "wind": 2.0}


def test_what_a_controllers_file_says_is_part_of_the_configuration(tmp_path):
    def identity(name):
        episode._controller.cache_clear()
        return configuration(dataclasses.replace(SUITE, controllers=(name,)))[f"controller {name}"]

    loop, tuned = tmp_path / "loop.json", tmp_path / "tuned.json"
    save_open_loop(loop, Knots(6, [0, 9], [6.0, 9.0], [0.1, 0.7]), {})
    save_tuned(tuned, "spsfa:growth=500", {})
    policy = make_correction(tmp_path / "p.safetensors", np.random.default_rng(0), f"open-loop:{loop}")
    names = (f"open-loop:{loop}", f"tuned:{tuned}", f"learned:{policy}")
    before = [identity(name) for name in names]
    assert before == [identity(name) for name in names]
    save_open_loop(loop, Knots(6, [0, 9], [6.0, 9.5], [0.1, 0.7]), {})
    save_tuned(tuned, "spsfa:growth=501", {})
    assert all(old != identity(name) for old, name in zip(before, names, strict=True))


def test_controllers_may_be_added_to_a_database(results, tmp_path):
    wider = dataclasses.replace(SUITE, controllers=(*SUITE.controllers, "fixed:4"))
    with results_of(wider, results.path) as again:
        assert len(again.finished()) == len(KEYS) + 4


@pytest.mark.parametrize("content", [b"not a database at all, but long enough" * 50, None])
def test_what_is_no_database_is_refused(copied, content):
    before = copied.read_bytes()[:5000] if content is None else content
    copied.write_bytes(before)
    with pytest.raises(ResultsError, match=r"tiny\.sqlite"):
        Results(copied, configuration(SUITE)).runs("fixed:3", "case1", 2)
    assert copied.read_bytes() == before


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"where": BackendOptions(jobs=-1)}, ValueError, "--jobs must be positive"),
        (
            {"suite": "paper", "seeds": 1},
            ResultsError,
            "intervals need 2 runs of each set of scenarios, got 1",
        ),
        ({"suite": "generalisation", "seeds": 0}, ResultsError, "at least 1"),
        ({"suite": "everything"}, UnknownNameError, r"unknown suite 'everything'; valid: .* in all"),
    ],
)
def test_options_that_cannot_be_leave_no_database(known, tmp_path, options, error, message):
    with pytest.raises(error, match=message):
        evaluate(EvaluateConfig(**{"suite": "tiny", "output": tmp_path, **options}))
    assert list(tmp_path.iterdir()) == []


def test_the_command_writes_tables_and_keeps_the_database(known, tmp_path):
    config = asked("tiny", tmp_path)
    page = evaluate(config)
    folder = page.parent
    assert "Table 3. Final fitness on case1" in page.read_text()
    for stem in ("table-03-optimal-solutions-case1", "table-11-running-times-case3", "comparison"):
        for suffix in ("md", "csv", "tex", "json"):
            assert (folder / f"{stem}.{suffix}").stat().st_size > 100
    assert page.read_text().count("Runs made with: commit") == 1
    made_with = (folder / "made-with.md").read_text()
    assert made_with.startswith("2 seeds per controller and scenario, scenarios: 2. Runs")
    (record,) = records_in(folder)
    assert record.name == "tiny"
    assert record.digests.keys() >= set(SUITE.controllers)
    stored = contents(folder)
    evaluate(config)
    assert contents(folder) == stored


def test_tables_of_an_incomplete_suite_are_refused(results):
    more = dataclasses.replace(SUITE, num_seeds=3)
    with pytest.raises(ResultsError, match="2 of 3 runs"):
        make_tables(more, results)


def test_without_simulating_the_same_comes_from_the_database_alone(known, results, tmp_path, monkeypatch):
    config = asked("tiny", tmp_path, database=results.path)
    expected = contents(evaluate(config).parent)

    def never(*_):
        raise AssertionError("a run was made")

    monkeypatch.setattr(Episode, "run", never)
    monkeypatch.setattr("experiments.runs.configuration.controller_of", never)  # nor are policies needed
    offline = dataclasses.replace(config, simulate=False, output=tmp_path / "offline")
    assert contents(evaluate(offline).parent) == expected


def test_without_simulating_what_is_missing_is_named(results, tmp_path, monkeypatch):
    more = dataclasses.replace(SUITE, controllers=(*SUITE.controllers, "learned:a/0", "learned:a/1"))
    monkeypatch.setitem(SUITES, "tiny", more)
    config = asked("tiny", tmp_path, database=results.path, simulate=False)
    missing = r"lacks 8 runs.*4 of learned:a/\* on case1, 4 of learned:a/\* on case3"
    with pytest.raises(ResultsError, match=missing):
        evaluate(config)
    assert results.finished() == KEYS
    nowhere = tmp_path / "nowhere.sqlite"
    with pytest.raises(ResultsError, match="does not exist"):
        evaluate(dataclasses.replace(config, database=nowhere))
    assert not nowhere.exists()


def test_seeds_of_a_suite_may_start_anywhere_and_differ_by_scenario(tmp_path):
    shifted = dataclasses.replace(
        SUITE, controllers=("fixed:3",), num_seeds=1, first_seed=10_000, seed_step=1, snapshots=()
    )
    with results_of(shifted, tmp_path / "shifted.sqlite") as results:
        assert results.finished() == {("fixed:3", "case1", 10_000), ("fixed:3", "case3", 10_001)}
        (run,) = results.runs("fixed:3", "case3", 1, 10_001)
        assert results.runs("fixed:3", "case3", 1) == results.runs("fixed:3", "case3", 1, 10_002) == []
        fitness = results.outcomes(shifted.controllers, shifted.seeds).fitness
    assert fitness.shape == (1, 2, 1)
    assert fitness[0, 1, 0] == run.final_fitness


def test_an_entrant_has_episodes_of_its_own_length(tmp_path):
    names = ("fixed:3", "particle-swarm(7)+fixed:3", "particle-swarm+fixed:3")
    suite = dataclasses.replace(SUITE, controllers=names, scenarios=("case1",), snapshots=())
    with results_of(suite, tmp_path / "entrants.sqlite") as results:
        lengths = [len(results.runs(name, "case1", 1)[0].trace) - 1 for name in names]
    assert lengths == [100, 7, 100]


@pytest.fixture
def collection(monkeypatch):
    """Two suites by one name."""
    small = dataclasses.replace(
        SUITE, name="small", controllers=("fixed:3", "spsfa-tip"), scenarios=("case1",), snapshots=()
    )
    other = dataclasses.replace(small, name="other", options={"iterations": 5}, tables=("comparison",))
    for suite in (small, other):
        monkeypatch.setitem(SUITES, suite.name, suite)
    monkeypatch.setitem(COLLECTIONS, "both", ("small", "other"))
    return "both"


def test_a_collection_is_run_by_one_name_into_a_folder_for_each_suite(collection, tmp_path):
    config = asked(collection, tmp_path)
    page = evaluate(config)
    assert page == tmp_path / "both/README.md"
    assert "[other](other/README.md)" in page.read_text()
    assert {p.name for p in (tmp_path / "both").glob("*.sqlite")} == {"small.sqlite", "other.sqlite"}
    assert (tmp_path / "both/small/summary.md").exists()
    assert not (tmp_path / "both/other/summary.md").exists()
    assert evaluate(dataclasses.replace(config, simulate=False)) == page


def test_a_collection_has_no_single_database(collection, tmp_path):
    with pytest.raises(ResultsError, match="--database is for one suite; both has several"):
        evaluate(EvaluateConfig(collection, output=tmp_path, database=tmp_path / "one.sqlite"))


def test_a_document_shows_tables_and_figures_of_all_suites_of_a_collection(collection, tmp_path, monkeypatch):
    evaluate(asked(collection, tmp_path))
    (tmp_path / "both/other/figure-a.svg").write_text("<svg/>")
    document = tmp_path / "docs/page.md"
    document.parent.mkdir()
    names = ("small/summary", "other/comparison", "other/made-with")
    document.write_text("\n".join(f"<!-- {name} -->\n<!-- /{name} -->" for name in names))
    monkeypatch.chdir(tmp_path)
    fill(Document(Path("docs/page.md"), "both", "both"), tmp_path).write()
    text = document.read_text()
    assert text.count("Runs made with: ") == 1
    for name in names:
        assert (tmp_path / f"both/{name}.md").read_text().strip() in text
    assert (tmp_path / "docs/results/both/figure-a.svg").read_text() == "<svg/>"


def test_a_run_says_what_its_trace_holds(tmp_path):
    columns = (*HISTORY, "noise")
    trace = np.arange(3.0 * len(columns)).reshape(3, -1)
    made = stored_run(("spsfa", "case1", 0), trace, final_fitness=1.0, columns=columns)
    with filled_database(tmp_path, [made]) as results:
        (run,) = results.runs("spsfa", "case1", 1)
    assert run.columns == columns
    np.testing.assert_array_equal(run.course("noise"), trace[:, -1])


def test_a_database_that_does_not_say_what_its_traces_hold_is_refused(results):
    with results.connection as connection:
        connection.execute("ALTER TABLE runs DROP COLUMN columns")
    with pytest.raises(ResultsError, match="not a results database of this version"):
        Results(results.path)


@pytest.mark.slow
def test_random_fields_are_run_and_drawn_as_the_cases_are(tmp_path, monkeypatch):
    fields = dataclasses.replace(
        SUITES["generalisation"],
        name="fields",
        scenarios=(*expand_name("random-fields:test:0-2"), *expand_name("random-fields:larger:0-1")),
    )
    monkeypatch.setitem(SUITES, "fields", fields)
    config = dataclasses.replace(
        asked("fields", tmp_path), controllers=("fixed:3", "spsfa-tip"), figures=True
    )
    page = evaluate(config)
    text = page.read_text()
    assert text.startswith("# Suite fields: 1 seed per controller and scenario")
    assert "--suite fields --seeds 1 --controllers fixed:3 spsfa-tip`" in text
    assert "| random-fields:larger | FA-3 | 2 | 1 |" in text
    assert {path.name for path in page.parent.glob("*.svg")} == {"figure-profiles.svg", "figure-front.svg"}
    before = contents(page.parent)
    evaluate(dataclasses.replace(config, simulate=False))
    assert contents(page.parent) == before


def test_the_database_is_readable_by_anyone(database):
    with sqlite3.connect(database) as connection:
        (count,) = connection.execute("SELECT count(*) FROM runs WHERE final_fitness > 290").fetchone()
    assert count == len(KEYS)


def test_an_entrant_with_long_episodes_may_run_on_a_late_event(tmp_path):
    for options, scenario, name in (
        ({}, "dynamic:case1-block@120", "firefly(121)+fixed:5"),
        ({"iterations": 20}, "dynamic:case1-block@29", "firefly(31)+fixed:5"),
    ):
        suite = Suite("late", (name,), (scenario,), 2, name, options=options)
        with results_of(suite, tmp_path / f"{len(options)}.sqlite") as made:
            assert len(made.finished()) == 2


def test_a_controller_whose_file_is_replaced_while_runs_are_made_is_refused(tmp_path):
    tuned = tmp_path / "tuned.json"
    save_tuned(tuned, "spsfa:growth=500", {})
    suite = dataclasses.replace(SUITE, controllers=("fixed:3", f"tuned:{tuned}"), snapshots=())
    with closing(Results(tmp_path / "tiny.sqlite", configuration(suite))) as results:
        save_tuned(tuned, "spsfa:growth=501", {})
        with pytest.raises(ResultsError, match=r"tuned\.json has changed since this command began"):
            run_missing(suite, results, LocalBackend(2))
        assert {controller for controller, *_ in results.finished()} <= {"fixed:3"}
