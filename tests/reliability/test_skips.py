"""The closing lines list every skip; where everything is required, only allowed skips remain skips."""

import pytest

from helpers.skips import ALLOWED, REQUIRE_ALL, is_allowed
from helpers.slow import slow_but

MAP = "needs den400d.map in the folder that SWARM_GYM_DATA names"
GPU = "there is no GPU; make test-slow runs it in the simulator, with NUMBA_ENABLE_CUDASIM=1"
TESTS = f"""
    import pytest

    def test_that_needs_nothing():
        pass

    @pytest.mark.parametrize("number", [1, 2])
    def test_on_a_map(number):
        pytest.skip("{MAP}")

    @pytest.mark.skip(reason="{GPU}")
    def test_on_a_gpu():
        pass

    @pytest.mark.xfail(reason="known")
    def test_that_is_known_to_fail():
        assert False
"""
FILE = """
    import pytest

    pytest.importorskip("no_such_library", reason="needs the extra `no-such`")

    def test_with_a_library():
        pass
"""


@pytest.fixture
def run(pytester, monkeypatch):
    """Return a function that runs small tests with this plugin, with a value of REQUIRE_ALL or without it."""

    def run(required, *options, **files):
        monkeypatch.delenv(REQUIRE_ALL, raising=False)
        if required is not None:
            monkeypatch.setenv(REQUIRE_ALL, required)
        pytester.makepyfile(**files)
        return pytester.runpytest_inprocess("-p", "helpers.skips", "-p", "no:cacheprovider", *options)

    return run


@pytest.mark.parametrize("required", [None, "", "0"])
def test_without_the_variable_skips_stay_skips(run, required):
    found = run(required, test_these=TESTS)
    found.assert_outcomes(passed=1, skipped=3, xfailed=1)
    assert found.ret == pytest.ExitCode.OK


@pytest.mark.parametrize("workers", slow_but(["0"], ["0", "2"]))
def test_with_the_variable_what_is_missing_is_a_failure_that_names_it(run, workers):
    found = run("1", "-n", workers, test_these=TESTS)
    found.assert_outcomes(passed=1, failed=2, skipped=1, xfailed=1)
    lines = ["*= 1 skips, by reason =*", f"1 x {GPU}", "    test_these.py: 1"]
    lines += ["*= 2 refused by REQUIRE_ALL, by reason =*", f"2 x {MAP}", "    test_these.py: 2"]
    found.stdout.fnmatch_lines(lines, consecutive=True)
    assert f"REQUIRE_ALL is set, so this skip is a failure: {MAP}" in found.stdout.str()
    assert found.ret == pytest.ExitCode.TESTS_FAILED


def test_with_the_variable_tests_that_lack_nothing_pass(run):
    found = run("1", test_these="def test_that_needs_nothing(): pass")
    found.assert_outcomes(passed=1)
    found.stdout.no_fnmatch_line("*by reason*")


@pytest.mark.parametrize("workers", ["0", "2"])
def test_the_closing_lines_list_every_reason_with_its_number_and_files(run, workers):
    found = run(None, "-n", workers, test_these=TESTS, test_those=TESTS, test_file=FILE)
    found.stdout.fnmatch_lines(
        [
            "*= 7 skips, by reason =*",
            f"4 x {MAP}",
            "    test_these.py: 2",
            "    test_those.py: 2",
            f"2 x {GPU}",
            "    test_these.py: 1",
            "    test_those.py: 1",
            "1 x needs the extra `no-such`",
            "    test_file.py: 1",
        ],
        consecutive=True,
    )


@pytest.mark.parametrize("workers", ["0", pytest.param("2", marks=pytest.mark.slow)])
def test_with_the_variable_a_file_that_is_skipped_as_a_whole_is_an_error(run, workers):
    files = {"test_file": FILE, "test_these": "def test_that_needs_nothing(): pass"}
    assert run(None, "-n", workers, **files).ret == pytest.ExitCode.OK
    found = run("1", "-n", workers, **files)
    assert found.ret in (pytest.ExitCode.INTERRUPTED, pytest.ExitCode.TESTS_FAILED)
    found.stdout.fnmatch_lines(["*so this skip is a failure: needs the extra `no-such`"])
    found.stdout.fnmatch_lines(["1 x needs the extra `no-such`", "    test_file.py: 1"], consecutive=True)


@pytest.mark.parametrize(
    ("reason", "allowed"),
    [
        (GPU, True),
        ("this machine has 1 thread(s)", True),
        ("needs POSIX: it kills by signals", True),
        ("needs the extra `dacbench`", True),
        ("needs dacbench, of the extra `dacbench`", True),
        ("needs Paris_1_256.map in the folder that SWARM_GYM_DATA names", True),
        (MAP, False),
        ("no Chromium is installed; see `make browser`", False),
        ("needs the extra `ray`", False),
        ("could not import 'pygame': there is no GPU", False),
        ("", False),
    ],
)
def test_only_the_listed_reasons_are_allowed(reason, allowed):
    assert is_allowed(reason) == allowed


def test_every_allowed_reason_says_why():
    assert all(why[0].isalpha() or why[0] == "`" for why in ALLOWED.values())
    assert not any(is_allowed(prefix) for prefix in ("needs", "needs the extra", "is not installed"))
