"""Records say which commits made runs, when, and which digests of what decided them have changed."""

import json
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from experiments.catalogue import SUITES
from experiments.documents.digests import (
    SEVERAL,
    digest,
    digests_of_groups,
    digests_of_results,
    digests_today,
    seeing,
)
from experiments.documents.made_with import NOT_RECORDED, days, span, state
from experiments.documents.records import (
    Record,
    commits_in,
    keep,
    kept_records,
    record_of,
    records_in,
    time_of,
    write_record,
)
from experiments.documents.suite_page import record_of_suite
from experiments.runs.configuration import identities

OLD = {"0123456789": "2026-11-25T23:00:00+00:00"}
NEW = {"abcdef0123": "2026-11-26T10:00:00+00:00"}
SUITE = replace(SUITES["paper"], controllers=("fixed:60", "spsfa-tip", "learned:three-cases/0@1"))


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A repository with two commits of a golden file, by their digits; the code asks git there."""

    def git(*arguments):
        command = ("git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments)
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        return done.stdout.strip()

    monkeypatch.setattr("experiments.documents.records.__file__", str(tmp_path / "records.py"))
    git("init", "-q")
    commits = []
    for number in (1.0, 2.0):
        (tmp_path / "tests/golden").mkdir(parents=True, exist_ok=True)
        content = {"because": "of a test", "courses": {"case1": [[number]]}}
        (tmp_path / "tests/golden/firefly.json").write_text(json.dumps(content))
        git("add", "-A")
        git("commit", "-q", "-m", "golden")
        commits.append(git("rev-parse", "HEAD"))
    return commits


def test_commits_have_the_time_of_the_commit_also_with_changed_files(checkout):
    record = record_of("a", [f"{checkout[1]}-dirty", checkout[0], "unknown", "f" * 40], {})
    first, second = (commit[:10] for commit in checkout)
    assert record.commits.keys() == {"f" * 10, first, f"{second}-dirty"}
    assert next(iter(record.commits)) == "f" * 10
    assert record.commits["f" * 10] == ""
    assert record.commits[first] == time_of(checkout[0]) != ""


def test_results_of_an_optimizer_are_those_of_the_commits_that_ran_it(checkout):
    old, new = (digests_of_results(["firefly"], [commit])["results of firefly"] for commit in checkout)
    assert old == digest({"case1": [[1.0]]}) != new
    assert digests_of_results(["firefly"], checkout) == {"results of firefly": SEVERAL}
    assert digests_of_results(["firefly"], [f"{checkout[0]}-dirty"]) == {}
    assert digests_of_results(["firefly", "own:Optimizer"]).keys() == {"results of firefly"}


def test_records_are_read_as_they_were_written_and_others_stay(tmp_path, monkeypatch):
    monkeypatch.setattr("experiments.documents.records.KEPT", tmp_path / "kept.json")
    first, second = Record("a", OLD, {"x": "1"}), Record("b", NEW, {})
    write_record(first, tmp_path)
    assert records_in(tmp_path) == [first]
    keep([first])
    keep([second])
    assert kept_records() == {"a": first, "b": second}
    keep([replace(first, digests={"x": "2"})])
    assert kept_records()["a"].digests == {"x": "2"}


def test_the_state_says_what_has_changed_and_what_is_not_recorded(monkeypatch):
    same = {"x": "1", "results of y": "2"}
    monkeypatch.setattr("experiments.documents.made_with.today", lambda name: same)
    assert state(Record("a", {}, {})) == NOT_RECORDED
    assert state(Record("a", NEW, same)) == "as today"
    assert state(Record("a", NEW, {"x": "1"})) == "digests of optimizers not recorded"
    assert state(Record("a", NEW, {**same, "x": "0"})) == "**out of date**: x"
    assert state(Record("a", OLD, {})) == "before portable numbers; digests not recorded"
    assert state(Record("a", NEW | OLD, same)) == "before portable numbers"


def test_days_name_each_day_once_in_order():
    later = {"fedcba0123": "2026-11-26T11:00:00+00:00"}
    assert days(OLD | NEW | later) == "2026-11-25 (0123456789), 2026-11-26 (abcdef0123, fedcba0123)"
    assert days({}) == span(["no record has this name"]) == NOT_RECORDED


def test_a_group_has_another_digest_if_one_of_its_controllers_is_another():
    identity = identities(SUITE)
    before = digests_of_groups(SUITE, identity)
    after = digests_of_groups(SUITE, {**identity, "learned:three-cases/0@1": "another"})
    assert [key for key in before if before[key] != after[key]] == ["learned:three-cases/*@1"]
    assert digests_of_groups(SUITE, {"fixed:60": identity["fixed:60"]}).keys() == {"fixed:60"}


def test_blinded_policies_have_no_digest_since_they_follow_from_others():
    suite = replace(SUITE, controllers=(*SUITE.controllers, "blinded:three-cases/0@1"))
    assert seeing(suite).controllers == SUITE.controllers
    assert digests_today(suite) == digests_today(SUITE)


class Stored:
    """A results database as far as a record needs it."""

    def __init__(self, configuration):
        self.configuration = lambda: configuration
        self.provenances = lambda controllers, seeds: [{"commit": "f" * 40}]


def test_the_record_of_a_suite_has_what_its_controllers_were():
    stored = json.loads(json.dumps({f"controller {key}": one for key, one in identities(SUITE).items()}))
    record = record_of_suite(SUITE, Stored({"identities": "from content", **stored}))
    assert record.changed(digests_today(SUITE)) == []
    assert len(record.digests) == len(SUITE.controllers)
    stored["controller spsfa-tip"] = "another"
    changed = record_of_suite(SUITE, Stored({"identities": "from content", **stored}))
    assert changed.changed(digests_today(SUITE)) == ["spsfa-tip"]
    assert record_of_suite(SUITE, Stored(stored)).digests == {}  # a database of an earlier version


def test_commits_of_files_are_found_where_files_have_them(tmp_path):
    (tmp_path / "a.json").write_text(json.dumps({"provenance": {"commit": "f" * 40}}))
    (tmp_path / "b.json").write_text(json.dumps({"costs": []}))
    assert commits_in(tmp_path.glob("*.json")) == {"f" * 40}


def test_every_record_belongs_to_runs_that_the_page_shows(monkeypatch):
    root = Path(__file__).parents[3]
    monkeypatch.chdir(root)
    page = (root / "docs/results-runs.md").read_text(encoding="utf-8")
    assert len(kept_records()) > 20
    assert [name for name in kept_records() if f"| `{name}` |" not in page] == []
