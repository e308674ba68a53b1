"""The paper is built from the blocks of the documents; a block that is missing ends the build by its name."""

import re
import shutil
from pathlib import Path

import pytest
import typst

ROOT = Path(__file__).parents[3]


def test_the_paper_is_built_with_numbers_of_the_documents():
    made = typst.compile(ROOT / "paper/paper.typ", root=ROOT)
    assert made.startswith(b"%PDF")
    counted = re.search(rb"/Type/Pages/Count (\d+)", made)
    assert counted is not None
    assert int(counted[1]) >= 3


def test_a_block_that_is_missing_is_named(tmp_path):
    for name in ("paper/paper.typ", "paper/references.bib", "README.md", "docs/results.md"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    page = tmp_path / "docs/results.md"
    page.write_text(page.read_text(encoding="utf-8").replace("one-parameter", "other"), encoding="utf-8")
    with pytest.raises(RuntimeError, match=r"docs/results\.md has no block one-parameter"):
        typst.compile(tmp_path / "paper/paper.typ", root=tmp_path)
