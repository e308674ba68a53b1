"""The list of faults of the mutation check follows the sources, and the check sees what tests find."""

from pathlib import Path

import pytest

import mutants

FAULT = mutants.Fault("a sum is a difference", "sums.py", "a + b", "a - b", ("test_sums.py",))


@pytest.fixture
def folder(tmp_path):
    """Return a folder with a source of one function and a test of it."""
    (tmp_path / "sums.py").write_text("def total(a, b):\n    return a + b\n")
    (tmp_path / "test_sums.py").write_text(
        "from sums import total\n\ndef test_it():\n    assert total(2, 0) == 2\n"
        "\ndef test_more():\n    assert total(2, 1) == 3\n"
    )
    return tmp_path


def test_every_fault_changes_one_place_of_the_sources():
    faults = mutants.faults()
    assert len({fault.name for fault in faults}) == len(faults)
    for fault in faults:
        fault.seeded((mutants.ROOT / fault.file).read_text(encoding="utf-8"))


def test_the_tests_of_every_fault_exist():
    paths = {Path(one) for fault in mutants.faults() for one in fault.tests if one.startswith("tests/")}
    assert [path for path in sorted(paths) if not (mutants.ROOT / path).exists()] == []


def test_a_text_that_is_not_there_once_is_refused():
    assert FAULT.seeded("c = a + b") == "c = a - b"
    for source in ("", "a + b, a + b"):
        with pytest.raises(ValueError, match="expected once"):
            FAULT.seeded(source)


def test_a_fault_is_found_if_a_test_fails_and_removed_afterwards(folder):
    before = (folder / "sums.py").read_text()
    assert mutants.is_found(FAULT, folder)
    assert (folder / "sums.py").read_text() == before
    assert mutants.status_of(folder, FAULT.tests, jit=True) == mutants.PASSED


def test_a_fault_survives_if_all_tests_pass(folder):
    path = folder / "test_sums.py"
    path.write_text(path.read_text().partition("\ndef test_more")[0])
    assert not mutants.is_found(FAULT, folder)


def test_a_choice_without_tests_is_an_error(folder):
    none = mutants.Fault(*(getattr(FAULT, name) for name in ("name", "file", "old", "new")), ("missing.py",))
    with pytest.raises(RuntimeError, match="status 4"):
        mutants.is_found(none, folder)
