"""The page of results repeats the blocks of other pages, counts claims, and marks what has changed."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from experiments.documents.front_page import claims_of, findings_of, marked
from experiments.documents.marked_blocks import content_of, fill
from experiments.documents.records import keep, kept_records
from experiments.publish import DOCUMENTS

ROOT = Path(__file__).parents[3]
CLAIMS = """<!-- a-claims -->
**Caption**

| claim | scenarios | measure | difference | holds |
| --- | --- | --- | --- | --- |
| One. | all | gap | -0.1 [-0.2, -0.1] | yes |
| One. | case1 | gap | +0.1 [-0.2, +0.1] | **no** |
<!-- /a-claims -->
<!-- b/claims -->
| claim | scenarios | fish | ants |
| --- | --- | --- | --- |
| Two. | all | **no** -0.83 [-1.72, +0.07] | -1.30 [-1.78, -0.98] |
| Three. | all | – | -1.30 [-1.78, -0.98] |
<!-- /b/claims -->
<!-- b/b-claims -->
| claim | holds | does not hold |
| --- | --- | --- |
| Two. | 1 | 1 |
<!-- /b/b-claims -->
"""
FINDINGS = """<!-- findings -->
* Firefly holds. All: holds, 1
  against 2.
* Fish half. All: holds, 1 against 2. Some: does
  **not** hold, 2 against 1.
* Ants hold. All: holds, 3 against 4.
<!-- /findings -->
"""


def test_the_pages_show_what_the_other_pages_say(monkeypatch):
    monkeypatch.chdir(ROOT)
    for document in DOCUMENTS["numbers"]:
        filled = fill(document, Path("results"))
        assert filled.text == document.path.read_text(encoding="utf-8"), (
            "python -m experiments.publish numbers"
        )


def test_claims_are_counted_by_sets_of_scenarios_and_by_subjects():
    assert claims_of(CLAIMS) == (1 + 2, 2 + 3)


def test_findings_that_fail_somewhere_are_told_from_those_that_hold_everywhere():
    assert [one[:6] for one in findings_of(FINDINGS, holding=True)] == ["* Fire", "* Ants"]
    (failing,) = findings_of(FINDINGS, holding=False)
    assert failing.startswith("* Fish half.")


def test_a_block_that_is_missing_is_named():
    with pytest.raises(ValueError, match="there is no block 'claims' to read"):
        content_of(FINDINGS, "claims")


def filled_with(monkeypatch, folder, change):
    """Return both pages of results after a change of the kept records, which are copied to a folder first."""
    monkeypatch.chdir(ROOT)
    records = kept_records()
    monkeypatch.setattr("experiments.documents.records.KEPT", folder / "records.json")
    keep(change(record) for record in records.values())
    return "\n".join(fill(document, Path("results")).text for document in DOCUMENTS["numbers"])


def with_digest(name, key, digest):
    """Return a function that gives the record of that name another digest, and leaves all others alone."""

    def change(record):
        if record.name != name:
            return record
        return replace(record, digests={**record.digests, key: digest})

    return change


def test_a_row_whose_digest_has_changed_is_marked(monkeypatch, tmp_path):
    before = (ROOT / "docs/results.md").read_text(encoding="utf-8")
    after = filled_with(monkeypatch, tmp_path, with_digest("learners", "SPSFA-TIP", "0" * 12))
    assert "| SPSFA-TIP (**out of date**) |" not in before
    assert "| SPSFA-TIP (**out of date**) |" in after
    assert re.search(r"`learners`, commits of [^:]+: \*\*out of date\*\*: SPSFA-TIP", " ".join(after.split()))
    assert after.count("(**out of date**)") == 1


def test_a_finding_whose_policies_have_changed_is_marked_and_no_other(monkeypatch, tmp_path):
    after = filled_with(monkeypatch, tmp_path, with_digest("headline", "spsfa-tip", "0" * 12))
    findings = content_of(after, "findings-study").split("\n* ")
    marks = ["**out of date**" in " ".join(one.split()).split("Runs made with")[0] for one in findings]
    assert marks == ["SPSFA-TIP" in one for one in findings]
    assert "**out of date**: 1 of 6 suites" in content_of(after, "studies")


def test_a_policy_that_is_no_longer_there_is_out_of_date(monkeypatch, tmp_path):
    after = filled_with(monkeypatch, tmp_path, with_digest("headline", "learned:gone/*", "0" * 12))
    assert "**out of date**: learned:gone/*" in content_of(after, "records")


def test_a_finding_that_nothing_has_changed_of_is_left_as_it_is():
    finding = "* Policies by PPO, told price 1, end closer to the optimum than SPSFA-TIP. All cases: holds."
    assert marked(finding, ["headline"], {"fixed:100"}) == finding
    assert "**out of date**: spsfa-tip" in " ".join(marked(finding, ["headline"], {"spsfa-tip"}).split())
    said = marked(finding, ["headline"], {"results of firefly"})
    assert "**out of date**: results of firefly" in " ".join(said.split())
