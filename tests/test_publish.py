"""Numbers in the documents come out of results."""

import pytest

from experiments.publish import publish, replace_block

TEXT = "above\n<!-- results -->\nold\nlines\n<!-- /results -->\nbelow <!-- speed -->\n<!-- /speed -->\n"


def test_a_block_is_replaced_and_the_rest_left_alone():
    found = replace_block(TEXT, "results", "new \\1 text\n")
    assert found == TEXT.replace("old\nlines", "new \\1 text")
    assert replace_block(found, "results", "new \\1 text") == found


def test_a_missing_block_is_refused():
    with pytest.raises(ValueError, match="tables"):
        replace_block(TEXT, "tables", "new")


def test_publishing_copies_the_page_and_fills_the_readme(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    suite = tmp_path / "suite"
    suite.mkdir()
    (tmp_path / "README.md").write_text(TEXT)
    for name in ("README.md", "summary.md", "a.svg", "a.png"):
        (suite / name).write_text(f"content of {name}")
    (suite / "speed.md").write_text("fast")
    publish(suite, suite / "speed.md")
    assert "content of summary.md" in (tmp_path / "README.md").read_text()
    assert "fast" in (tmp_path / "README.md").read_text()
    assert {p.name for p in (tmp_path / "docs/results").iterdir()} == {"README.md", "a.svg"}


def test_nothing_is_written_where_something_is_missing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "README.md").write_text(TEXT)
    with pytest.raises(OSError, match="summary"):
        publish(tmp_path, tmp_path / "speed.md")
    assert (tmp_path / "README.md").read_text() == TEXT
    assert not (tmp_path / "docs").exists()
