"""Comparative sentences: read from files, checked against runs, about controllers that are run."""

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest

from experiments.catalogue import SUITES
from experiments.runs.claims import ClaimFileError, GroupClaim, load_claims
from experiments.runs.groups import EVERY_SET, group_controllers, scenario_sets
from experiments.studies.newcomers.suites import NEWCOMERS
from experiments.tables.claim_tables import group_claim_tables
from helpers.stored_runs import cells_of, outcomes_of

ROOT = Path(__file__).parents[3]
ONE, OTHER = "fixed:60", "fixed:80"


def claim(**values):
    return GroupClaim(**{"sentence": "it is less", "suite": "newcomers", "group": ONE, **values})


def check(gaps, *claims):
    """Return the rows of the table of these claims about made-up gaps."""
    made = group_claim_tables(dataclasses.replace(NEWCOMERS, claims=claims), outcomes_of(gaps))
    return cells_of(made, "claims") if made else []


GAPS = {(ONE, s): [0.01, 0.02, 0.03] for s in ("case1", "case2")}
GAPS |= {(OTHER, "case1"): [0.02, 0.03, 0.05], (OTHER, "case2"): [0.0, 0.02, 0.05]}


def test_a_sentence_holds_where_the_whole_interval_is_below_zero():
    first, second, both = check(GAPS, claim(rival=OTHER), claim(rival="fixed:7"))
    assert [row["scenarios"] for row in (first, second, both)] == ["case1", "case2", "all"]
    assert [row["holds"] for row in (first, second, both)] == ["yes", "**no**", "yes"]
    assert (first["controller"], first["rival or limit"]) == ("2.00", "3.33")
    assert first["difference"].startswith("-1.33 [-")
    assert first["claim"] == "it is less"


def test_a_sentence_with_a_factor_needs_as_much_less():
    half = {**GAPS, (OTHER, "case1"): [0.05, 0.06, 0.07]}
    (row,) = check(half, claim(rival=OTHER, factor=0.5, sets=("case1",)))
    assert (row["rival or limit"], row["holds"]) == ("0.5 × 6.00 = 3.00", "yes")
    (row,) = check(GAPS, claim(rival=OTHER, factor=0.5, sets=("case1",)))
    assert (row["rival or limit"], row["holds"]) == ("0.5 × 3.33 = 1.67", "**no**")


@pytest.mark.parametrize(
    ("metric", "mine", "theirs"),
    [
        ("gap", 2.0, 10.0 / 3.0),
        ("evaluations", 1.0, 2.0),
        ("objective", 2.0 + 3.0 * 0.01, 10.0 / 3.0 + 3.0 * 0.02),
        ("far", 200.0 / 3.0, 100.0),
        ("spread", 2.0 / 3.0, 1.0),
        ("infeasible", 0.0, 0.0),
    ],
)
def test_measures_are_means_over_runs(metric, mine, theirs):
    (row,) = check(GAPS, claim(rival=OTHER, metric=metric, price=3.0, sets=("case1",)))
    assert (row["controller"], row["rival or limit"]) == (f"{mine:.2f}", f"{theirs:.2f}")
    assert row["measure"] == ("objective at price 3" if metric == "objective" else metric)


def test_lengths_are_those_of_feasible_paths():
    """The fitness of a path that collides is not its length, and does not count."""
    outcomes = outcomes_of({(ONE, "case1"): [0.1, 0.2, 0.6], (OTHER, "case1"): [0.3, 0.3, 0.3]})
    outcomes.collision[0, 0, 2] = 1.0
    claims = [claim(rival=OTHER, metric=metric) for metric in ("length", "infeasible", "fitness")]
    (table,) = group_claim_tables(dataclasses.replace(NEWCOMERS, claims=tuple(claims)), outcomes)
    length, infeasible, fitness = cells_of([table], "claims")
    optimum = outcomes.optima[0]
    assert length["controller"] == f"{1.15 * optimum:.2f}"
    assert length["holds"] == "yes"
    assert infeasible["controller"] == f"{100 / 3:.2f}"
    assert infeasible["rival or limit"] == "0.00"
    assert fitness["controller"] == f"{1.3 * optimum:.3g}"
    assert fitness["holds"] == "**no**"
    assert "length is taken over the best paths that are feasible" in table.caption


def test_a_length_of_no_feasible_path_is_missing():
    outcomes = outcomes_of({(ONE, "case1"): [0.1, 0.2], (OTHER, "case1"): [0.3, 0.3]})
    outcomes.collision[:] = 1.0
    suite = dataclasses.replace(NEWCOMERS, claims=(claim(rival=OTHER, metric="length"),))
    (row,) = cells_of(group_claim_tables(suite, outcomes), "claims")
    assert (row["controller"], row["rival or limit"], row["holds"]) == ("–", "–", "**no**")


def test_a_limit_needs_no_rival():
    rows = check(GAPS, claim(limit=3.5), claim(limit=2.5, sets=("case1",)))
    assert [row["holds"] for row in rows] == ["yes", "yes", "yes", "**no**"]
    assert rows[0]["rival or limit"] == "3.50"


def test_a_yardstick_is_a_limit_for_each_set():
    suite = dataclasses.replace(
        NEWCOMERS,
        claims=(claim(rival="a number", sets=("case1", "case2")),),
        yardsticks={"a number": lambda scenario_set: {"case1": 3.5, "case2": 1.5}[scenario_set]},
    )
    first, second = cells_of(group_claim_tables(suite, outcomes_of(GAPS)), "claims")
    assert (first["rival or limit"], first["holds"]) == ("3.50", "yes")
    assert (second["rival or limit"], second["holds"]) == ("1.50", "**no**")


def test_a_claim_of_several_suites_is_one_of_each(tmp_path):
    text = "[[claim]]\nsentence='a'\nsuite=['b', 'c']\ngroup='d'\nlimit=1.0"
    (tmp_path / "claims.toml").write_text(text)
    assert [one.suite for one in load_claims(tmp_path / "claims.toml")] == ["b", "c"]


def test_a_claim_about_several_subjects_is_one_of_each(tmp_path):
    text = "[[claim]]\nsentence='less'\nabout=['a', 'b']\nsuite='c'\ngroup='{about}+d'\nrival='{about}+e'"
    (tmp_path / "claims.toml").write_text(text)
    found = load_claims(tmp_path / "claims.toml")
    assert [(one.about, one.group, one.rival) for one in found] == [("a", "a+d", "a+e"), ("b", "b+d", "b+e")]
    assert {one.sentence for one in found} == {"less"}


def test_claims_about_subjects_have_a_column_for_each():
    one, other = claim(rival=OTHER, about="sixty"), claim(group=OTHER, rival=ONE, about="eighty")
    first, second, _ = check(GAPS, one, other)
    assert (first["claim"], first["scenarios"], second["scenarios"]) == ("it is less", "case1", "case2")
    assert first["sixty"].startswith("-1.33 [-")
    assert first["eighty"].startswith("**no** +1.33 [+")
    (row,) = check(
        GAPS, dataclasses.replace(one, sets=("case1",)), dataclasses.replace(other, sets=("all",))
    )[:1]
    assert row["eighty"] == "–"


def test_training_seeds_of_both_groups_are_drawn():
    """The luck of a training widens the interval: two seeds that differ much say little."""
    rng = np.random.default_rng(0)
    policies = {(f"learned:a/{k}", "case1"): 0.01 * k + rng.uniform(0, 0.001, 50) for k in range(2)}
    (row,) = check({**policies, (ONE, "case1"): np.full(50, 0.009)}, claim(group="learned:a/*", rival=ONE))
    assert row["holds"] == "**no**"
    (row,) = check({(ONE, "case1"): [0.0051] * 9, (OTHER, "case1"): [0.009] * 9}, claim(rival=OTHER))
    assert row["holds"] == "yes"


def test_there_is_no_table_without_claims():
    assert check(GAPS) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("claim = 3 [", "not a readable file"),
        ("[[sentence]]", r"expected tables \[\[claim\]\] only, got sentence"),
        (
            "[[claim]]\nsentence = 'a'\nrivals = 'b'",
            "claim 1: unknown key 'rivals', expected some of sentence",
        ),
        ("[[claim]]\nsentence = 'a'", "claim 1: suite is missing"),
        ("[[claim]]\nsentence = 'a'\nsuite = 'b'", "claim 1: .*missing.*group"),
        ("[[claim]]\nabout = 'a'\nsuite = 'b'", "claim 1: about has to be a list of subjects, got 'a'"),
        ("[[claim]]\nsentence='a'\nsuite='b'\ngroup='c'", "claim 1: .*either a rival or a limit"),
        ("[[claim]]\nsentence='a'\nsuite='b'\ngroup='c'\nrival='d'\nlimit=1", "either a rival or a limit"),
        (
            "[[claim]]\nsentence='a'\nsuite='b'\ngroup='c'\nrival='d'\nmetric='speed'",
            "metric must be one of gap, .*'speed'",
        ),
    ],
)
def test_a_file_with_an_invalid_claim_is_refused(tmp_path, text, message):
    (tmp_path / "claims.toml").write_text(text)
    with pytest.raises(ClaimFileError, match=message):
        load_claims(tmp_path / "claims.toml")


def test_claims_are_about_controllers_that_their_suites_run():
    files = sorted((ROOT / "experiments/studies").glob("*/claims.toml"))
    assert len(files) >= 2
    for one in (claim for file in files for claim in load_claims(file)):
        groups = group_controllers(SUITES[one.suite].controllers, SUITES[one.suite].alone)
        assert one.group in groups, one.sentence
        assert one.rival in {"", *groups, *SUITES[one.suite].yardsticks}, one.sentence
        known = {*scenario_sets(SUITES[one.suite].scenarios), *SUITES[one.suite].scenarios, EVERY_SET}
        assert set(one.sets) <= known, one.sentence
        assert one in SUITES[one.suite].claims
        assert "claims" in SUITES[one.suite].tables


# Pages whose sentences compare controllers in generated blocks only, and words that compare.
PAGES = (
    "README.md", "docs/newcomers.md", "docs/newcomers-tables.md", "docs/dynamic.md", "docs/dynamic-tables.md",
    "docs/study.md", "docs/study-tables.md", "docs/moa-paper.md", "docs/iafsa-paper.md",
    "docs/iafsa-claims.md", "docs/iafsa-routes.md",
    "docs/brand-yu-paper.md", "docs/optimizers.md", "docs/optimizers-tables.md", "docs/scores.md",
    "docs/scores-tables.md", "docs/bbob.md", "docs/bbob-tables.md",
)  # fmt: skip
COMPARING = re.compile(
    r"\b(better|worse|beats?|beaten|fewer|wins?|won|as good|no controller|closer|ahead|outperform\w*)\b",
    re.IGNORECASE,
)


@pytest.mark.parametrize("page", PAGES)
def test_pages_compare_in_claims_only(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    own = re.sub(r"<!-- (\S+) -->.*?<!-- /\1 -->", "", text, flags=re.DOTALL)
    assert [line for line in own.splitlines() if COMPARING.search(line)] == []
