"""The stored scores: complete, of the files that ship, ranked in the document, the same when run again."""

import dataclasses
from pathlib import Path

import pytest

from agents.backends.local import LocalBackend
from experiments.catalogue import SUITES
from experiments.documents.marked_blocks import fill
from experiments.publish import DOCUMENTS
from experiments.runs.episode import Episode
from experiments.scores import compute
from experiments.scoring.cases import StoredScores, make_case, packaged_cases
from experiments.scoring.files import COLUMNS, ScoreFileError, read_scores, scores_file
from experiments.scoring.ranking import ranking, ranking_block
from experiments.scoring.score import ScoreRow
from experiments.scoring.submission import digest_of
from experiments.scoring.suites import SCORED
from experiments.scoring.verdicts import Verdict, overall
from helpers.shipped import policies_on_maps
from helpers.stored_runs import cells_of, make_database

ROOT = Path(__file__).parents[3]
SCORES = ROOT / "scores"
HOLD = (Verdict.EQUAL, Verdict.CLOSE)
AGAIN = "run `make docs-scores`"


def small(name, controllers, recipes=()):
    """Return a scored suite of one scenario, one seed and these controllers, beside policies of recipes."""
    experiment = dataclasses.replace(
        SCORED[name].experiment, controllers=controllers, scenarios=("case1",), num_seeds=1
    )
    return dataclasses.replace(SCORED[name], experiment=experiment, recipes=recipes)


def made_up(controller, gap, evaluations, num_runs=2):
    runs = ((1.0,) * num_runs, (int(evaluations),) * num_runs)
    return ScoreRow(controller, "e", "s", 0, num_runs, gap, evaluations, 1.0, "ab" * 32, "", *runs)


def test_every_packaged_policy_is_scored():
    scored = {policy for suite in SCORED.values() for policy in suite.policies}
    assert set(policies_on_maps()) - scored == set(), "no pattern in experiments/scoring/suites.py fits"


@pytest.mark.parametrize("name", SCORED)
def test_every_controller_that_ships_has_its_rows_with_its_digest(name):
    suite, rows = SCORED[name], read_scores(scores_file(SCORES, name))
    found = {(row.controller, row.scenario_set): row.digest for row in rows}
    expected = {(one, chosen): digest_of(one, suite) for one in suite.entrants for chosen in suite.sets}
    assert found == expected, AGAIN
    assert len(rows) == len(found)


def test_stored_rows_are_claims_of_the_suites_as_they_are():
    cases = packaged_cases([*SCORED.values()], StoredScores(SCORES))
    assert len(cases) >= len(policies_on_maps())
    assert {path.name for path in SCORES.iterdir()} == {f"{name}.csv" for name in SCORED}


@pytest.mark.parametrize(
    ("name", "suite"), [("learned:case1/0", "single-cases"), ("glowworm+fixed:20", "optimizers-cells")]
)
def test_stored_scores_hold(name, suite):
    case = make_case(name, SCORED[suite], None, StoredScores(SCORES))
    assert case.claimed
    assert overall(case.verify()) in HOLD


@pytest.mark.slow
@pytest.mark.parametrize("suite", SCORED)
def test_the_scores_of_every_policy_hold(suite):
    cases = packaged_cases([SCORED[suite]], StoredScores(SCORES))
    compared = [one for case in cases for one in case.verify()]
    assert [one.difference for one in compared if one.verdict not in HOLD] == []


@pytest.mark.parametrize("document", DOCUMENTS["scores"], ids=lambda one: one.path.stem)
def test_the_documents_rank_the_stored_scores(document, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert fill(document, Path("results")).text == document.path.read_text(encoding="utf-8"), AGAIN


def test_the_document_explains_every_column_and_verdict():
    page = (ROOT / "docs/scores.md").read_text(encoding="utf-8")
    assert [name for name in COLUMNS if f"`{name}`" not in page] == []
    assert [verdict.value for verdict in Verdict if f"| {verdict.value} |" not in page] == []


def test_the_smallest_objective_is_first():
    rows = [
        made_up("costly", 0.01, 300_000.0),
        made_up("far", 0.03, 50_000.0),
        made_up("first", 0.01, 50_000.0),
        dataclasses.replace(made_up("first", 0.02, 150_000.0), scenario_set="t"),
    ]
    found = cells_of([ranking("headline", rows)], "headline")
    assert [row["controller"] for row in found] == ["first", "far", "costly"]
    assert [row["objective"] for row in found] == ["2.500", "3.500", "4.000"]
    assert (found[0]["place"], found[0]["runs"], found[0]["digest"]) == ("1", "4", "abababab")
    assert found[0]["mean gap"] == "1.50 %"


def test_a_ranking_of_incomplete_scores_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scores = tmp_path / "scores/headline.csv"
    compute(small("headline", ("fixed:20",)), scores, tmp_path / "headline.sqlite", LocalBackend(1))
    with pytest.raises(ScoreFileError, match=r"headline\.csv: lacks \d+ controllers, such as .*experiments"):
        ranking_block("headline", None)


def test_rows_that_are_right_stay_and_others_are_exported_from_the_database(tmp_path, monkeypatch):
    suite, path = small("headline", ("fixed:20", "fixed:30"), ("three-cases-ppo",)), tmp_path / "scores.csv"
    monkeypatch.setitem(SCORED, "headline", suite)
    database = tmp_path / "results" / "headline.sqlite"
    ran, run = [], Episode.run

    def counted(episode, *arguments):
        ran.append(episode.key[0])
        if len(ran) == 3:
            raise KeyboardInterrupt
        return run(episode, *arguments)

    def again(scored=suite):
        return compute(scored, path, database, LocalBackend(1))

    monkeypatch.setattr(Episode, "run", counted)
    with pytest.raises(KeyboardInterrupt):
        again()
    assert [row.controller for row in read_scores(path)] == ["fixed:20", "fixed:30"]
    assert again() == 3
    assert ran == ["fixed:20", "fixed:30", *["learned:three-cases-ppo/0"] * 2]
    content = path.read_text()
    path.unlink()
    assert again() == 3
    assert path.read_text() == content
    assert len(ran) == 4, "a stored run was made again"
    database.unlink()
    assert again() == 3
    assert len(ran) == 4, "a run was made though all rows are right"
    assert not database.exists()
    path.write_text(content.replace(digest_of("learned:three-cases-ppo/0", suite), "0" * 64))
    assert again() == 3
    assert ran[4:] == ["learned:three-cases-ppo/0"]
    assert path.read_text() == content
    assert again(small("headline", ("fixed:30",))) == 1


def test_rows_are_exported_from_the_runs_of_a_study_without_a_run(tmp_path, monkeypatch):
    whole = dataclasses.replace(
        SUITES["headline"], controllers=("fixed:60", "spsfa-tip"), scenarios=("case1",), num_seeds=2
    )
    database = make_database(tmp_path / "headline.sqlite", whole)
    monkeypatch.setattr(Episode, "run", None)
    scored = small("headline", ("fixed:60", "spsfa-tip"))
    assert compute(scored, tmp_path / "scores.csv", database, LocalBackend(1)) == 2
    stored = {
        row.controller: row for row in read_scores(SCORES / "headline.csv") if row.scenario_set == "case1"
    }
    for row in read_scores(tmp_path / "scores.csv"):
        assert row.fitness_of_runs == stored[row.controller].fitness_of_runs[:1]
        assert row.evaluations_of_runs == stored[row.controller].evaluations_of_runs[:1]
        assert row.digest == stored[row.controller].digest
