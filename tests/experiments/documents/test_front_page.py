"""The page of results repeats the blocks of other pages, counts their claims, and finds their commits."""

from pathlib import Path

import pytest

from experiments.documents.front_page import claims_of, commits_of, findings_of
from experiments.documents.marked_blocks import content_of, fill
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
MADE = """<!-- made-with -->
Runs made with: commits 0123456789, abcdef0123-dirty; numba 0.68.1.
<!-- /made-with -->
<!-- other/made-with -->
Runs made with: commit 0123456789; numba 0.68.1.
<!-- /other/made-with -->
"""
FINDINGS = """<!-- findings -->
* Firefly holds. All: holds, 1
  against 2.
* Fish half. All: holds, 1 against 2. Some: does
  **not** hold, 2 against 1.
* Ants hold. All: holds, 3 against 4.
<!-- /findings -->
"""


def test_the_page_shows_what_the_other_pages_say(monkeypatch):
    monkeypatch.chdir(ROOT)
    (document,) = DOCUMENTS["numbers"]
    filled = fill(document, Path("results"))
    assert filled.text == document.path.read_text(encoding="utf-8"), "python -m experiments.publish numbers"


def test_claims_are_counted_by_sets_of_scenarios_and_by_subjects():
    assert claims_of(CLAIMS) == (1 + 2, 2 + 3)


def test_commits_are_named_once_in_their_order():
    assert commits_of(MADE) == ["0123456789", "abcdef0123-dirty"]


def test_findings_that_fail_somewhere_are_told_from_those_that_hold_everywhere():
    assert [one[:6] for one in findings_of(FINDINGS, holding=True)] == ["* Fire", "* Ants"]
    (failing,) = findings_of(FINDINGS, holding=False)
    assert failing.startswith("* Fish half.")


def test_a_block_that_is_missing_is_named():
    with pytest.raises(ValueError, match="there is no block 'claims' to read"):
        content_of(FINDINGS, "claims")
