"""Inputs that the fuzzer of tests/reliability/fuzz.py has found, and the valid files that it begins with."""

from pathlib import Path

import pytest

from helpers.mutations import bounded_memory
from helpers.parsers import PARSERS, parse

FINDS = sorted(Path(__file__).with_name("fuzz_finds").glob("*/*"))


@pytest.mark.parametrize("path", FINDS, ids=lambda path: f"{path.parent.name}-{path.name[:20]}")
def test_a_find_is_taken_or_refused(path, tmp_path):
    with bounded_memory():
        parse(path.parent.name, path.read_bytes(), tmp_path)


@pytest.mark.parametrize("name", PARSERS)
def test_the_fuzzer_begins_with_files_that_are_taken(name, tmp_path):
    taken = [parse(name, content, tmp_path) for content in PARSERS[name].seeds()]
    assert any(taken)


def test_the_fuzzer_would_see_an_error_that_is_not_documented(monkeypatch, tmp_path):
    def broken(path):
        raise KeyError(path)

    monkeypatch.setitem(PARSERS, "preset", PARSERS["preset"]._replace(read=broken))
    with pytest.raises(KeyError):
        parse("preset", b"", tmp_path)
